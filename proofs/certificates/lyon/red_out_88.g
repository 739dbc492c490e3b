# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 88: accepted. To check: gappa red_out_88.g
# SHA-256 of the script below: 551eb351d8223a179b86f1dbccae4bee630f676e7ae841883f88dde6ffeffb4d
# The hypotheses hold at dx = -0.0332183837890625, dy = -0.0616302490234375, dz = -1.4999847412109375, shift = 9

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_18 = 16 * adder2_10;
exact_19 = 1 - exact_18;
difference_24 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [2,3.9999999701976776123046875]
  /\ shift in [9,9]
  /\ exact_19 <= 0
  -> |difference_24| <= 0.62451171875 }

exact_18 -> (16) * adder2_10;
exact_19 -> 1 + (-16) * adder2_10;

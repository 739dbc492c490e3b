# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 50: accepted. To check: gappa red_out_50.g
# SHA-256 of the script below: eb48422832f18090af194902c3dba0a4cb8379847979949eba13c74c27e70c65
# The hypotheses hold at dx = 0.9667816162109375, dy = -0.0616302490234375, dz = 0.0000152587890625, shift = 7

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_18 = 4 * adder2_10;
exact_19 = 1 - exact_18;
difference_24 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [0.5,0.999999992549419403076171875]
  /\ shift in [7,7]
  /\ exact_19 <= 0
  -> |difference_24| <= 0.62451171875 }

exact_18 -> (4) * adder2_10;
exact_19 -> 1 + (-4) * adder2_10;

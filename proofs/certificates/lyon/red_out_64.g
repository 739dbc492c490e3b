# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 64: accepted. To check: gappa red_out_64.g
# SHA-256 of the script below: 2a3698111c41b0ad8f17fb984308a40d2bb98338ef68a27d793148205b8db061
# The hypotheses hold at dx = 0.4667816162109375, dy = 0.4383697509765625, dz = 0.0000152587890625, shift = 8

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_18 = 8 * adder2_10;
exact_19 = 1 - exact_18;
difference_24 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [0.25,0.4999999962747097015380859375]
  /\ shift in [8,8]
  /\ exact_19 <= 0
  -> |difference_24| <= 0.62451171875 }

exact_18 -> (8) * adder2_10;
exact_19 -> 1 + (-8) * adder2_10;

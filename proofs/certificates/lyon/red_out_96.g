# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 96: accepted. To check: gappa red_out_96.g
# SHA-256 of the script below: 52f7aeca12ca241d7b2273dd3df2356edde969770f4b9a3535cee8ffb731c58b
# The hypotheses hold at dx = -0.0332183837890625, dy = 0.1883697509765625, dz = 0.0000152587890625, shift = 10

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_17 = 32 * adder2_10;
exact_18 = 1 - exact_17;
difference_23 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [0.03125,0.0624999995343387126922607421875]
  /\ shift in [10,10]
  /\ exact_18 <= 0
  -> |difference_23| <= 0.62451171875 }

exact_17 -> (32) * adder2_10;
exact_18 -> 1 + (-32) * adder2_10;

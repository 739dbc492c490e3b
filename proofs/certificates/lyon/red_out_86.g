# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 86: accepted. To check: gappa red_out_86.g
# SHA-256 of the script below: efc1ad3093b82b5de4ba3c7efa4d4d4f70ec8513987031ef1f08bd2ce381ac36
# The hypotheses hold at dx = -0.0332183837890625, dy = -0.0616302490234375, dz = -0.9999847412109375, shift = 9

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
  /\ distance_rounded_11 in [1,1.99999998509883880615234375]
  /\ shift in [9,9]
  /\ exact_19 <= 0
  -> |difference_24| <= 0.62451171875 }

exact_18 -> (16) * adder2_10;
exact_19 -> 1 + (-16) * adder2_10;

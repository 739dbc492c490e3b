# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 20: accepted. To check: gappa red_out_20.g
# SHA-256 of the script below: 692ae3a133445221363cbef4f9c2863fd40bec369c8380fd1ba8262c458bcfaa
# The hypotheses hold at dx = -0.0332183837890625, dy = 1.9383697509765625, dz = -1.9999847412109375, shift = 4

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_18 = 0.5 * adder2_10;
exact_19 = 1 - exact_18;
difference_24 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [4,7.999999940395355224609375]
  /\ shift in [4,4]
  /\ exact_19 <= 0
  -> |difference_24| <= 0.62451171875 }

exact_18 -> (0.5) * adder2_10;
exact_19 -> 1 + (-0.5) * adder2_10;

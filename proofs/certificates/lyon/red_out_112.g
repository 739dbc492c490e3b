# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 112: accepted. To check: gappa red_out_112.g
# SHA-256 of the script below: 30571449fbb02ad3930f5c5c1e141e8b52faabd8ba07d126cecdb8828638e626
# The hypotheses hold at dx = 1.9667816162109375, dy = 1.9383697509765625, dz = -1.9999847412109375, shift = 10

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
  /\ distance_rounded_11 in [8,12]
  /\ shift in [10,10]
  /\ exact_18 <= 0
  -> |difference_23| <= 0.62451171875 }

exact_17 -> (32) * adder2_10;
exact_18 -> 1 + (-32) * adder2_10;

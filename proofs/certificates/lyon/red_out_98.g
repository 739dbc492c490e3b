# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 98: accepted. To check: gappa red_out_98.g
# SHA-256 of the script below: c2923c36c7c8dba96aa0abc28fbd7e4d4e8362bb3bc11633dbf352d516823f51
# The hypotheses hold at dx = 0.2167816162109375, dy = 0.1883697509765625, dz = 0.0000152587890625, shift = 10

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
  /\ distance_rounded_11 in [0.0625,0.124999999068677425384521484375]
  /\ shift in [10,10]
  /\ exact_18 <= 0
  -> |difference_23| <= 0.62451171875 }

exact_17 -> (32) * adder2_10;
exact_18 -> 1 + (-32) * adder2_10;

# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 30: accepted. To check: gappa red_out_30.g
# SHA-256 of the script below: 0cdd280813801253dfd7dd51ba75fdff52e9774f14ea5c02eeca870a2f87a5d0
# The hypotheses hold at dx = -0.0332183837890625, dy = 1.9383697509765625, dz = -1.9999847412109375, shift = 5

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_16 = 1 - adder2_10;
difference_21 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [4,7.999999940395355224609375]
  /\ shift in [5,5]
  /\ exact_16 <= 0
  -> |difference_21| <= 0.62451171875 }

exact_16 -> 1 - adder2_10;

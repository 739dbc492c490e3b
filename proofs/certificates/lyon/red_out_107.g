# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 107: accepted; its hypotheses contradict each other. To check: gappa red_out_107.g
# SHA-256 of the script below: 60398776c774c4d5c7db6587a653366be57623f5be3a8176553427dd55d4e3df

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_17 = 32 * adder2_10;
exact_18 = 1 - exact_17;
exact_19 = exact_18 * exact_18;
exact_20 = exact_19 * exact_19;
exact_21 = exact_20 * exact_20;
exact_22 = exact_21 * exact_21;
exact_23 = exact_22 * red;
difference_24 = 0 - exact_23;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ red in [0,255]
  /\ distance_rounded_11 in [2,3.9999999701976776123046875]
  /\ shift in [10,10]
  /\ exact_18 >= 0
  -> |difference_24| <= 0.62451171875 }

exact_17 -> (32) * adder2_10;
exact_18 -> 1 + (-32) * adder2_10;

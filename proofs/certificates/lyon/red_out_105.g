# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 105: accepted; its hypotheses contradict each other. To check: gappa red_out_105.g
# SHA-256 of the script below: 178dbcb81ed3ae8b8eaa6d8c3eced87ef45d7e6e170d51397d0de7c7520e9b78

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
  /\ distance_rounded_11 in [1,1.99999998509883880615234375]
  /\ shift in [10,10]
  /\ exact_18 >= 0
  -> |difference_24| <= 0.62451171875 }

exact_17 -> (32) * adder2_10;
exact_18 -> 1 + (-32) * adder2_10;

# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 97: accepted; its hypotheses contradict each other. To check: gappa red_out_97.g
# SHA-256 of the script below: 6b2ab79e4d7040c860a5a13032d5b991d6070166e73fe0806eceb6e0ada68d31

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
  /\ distance_rounded_11 in [0.0625,0.124999999068677425384521484375]
  /\ shift in [10,10]
  /\ exact_18 >= 0
  -> |difference_24| <= 0.62451171875 }

exact_17 -> (32) * adder2_10;
exact_18 -> 1 + (-32) * adder2_10;

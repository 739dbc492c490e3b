# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 41: accepted; its hypotheses contradict each other. To check: gappa red_out_41.g
# SHA-256 of the script below: 55fa663c735e9ec56a594d4ce573ed8bc1a44109075915156f12c52872af1f64

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_18 = 2 * adder2_10;
exact_19 = 1 - exact_18;
exact_20 = exact_19 * exact_19;
exact_21 = exact_20 * exact_20;
exact_22 = exact_21 * exact_21;
exact_23 = exact_22 * exact_22;
exact_24 = exact_23 * red;
difference_25 = 0 - exact_24;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ red in [0,255]
  /\ distance_rounded_11 in [4,7.999999940395355224609375]
  /\ shift in [6,6]
  /\ exact_19 >= 0
  -> |difference_25| <= 0.62451171875 }

exact_18 -> (2) * adder2_10;
exact_19 -> 1 + (-2) * adder2_10;

# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 25: accepted; no witness is found. To check: gappa red_out_25.g
# SHA-256 of the script below: 36bba22f6573beb03c787a620cc7fd5fdb8c0b3b3f857a0da4c850731568da59

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_16 = 1 - adder2_10;
exact_17 = exact_16 * exact_16;
exact_18 = exact_17 * exact_17;
exact_19 = exact_18 * exact_18;
exact_20 = exact_19 * exact_19;
exact_21 = exact_20 * red;
difference_22 = 0 - exact_21;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ red in [0,255]
  /\ distance_rounded_11 in [1,1.99999998509883880615234375]
  /\ shift in [5,5]
  /\ exact_16 >= 0
  -> |difference_22| <= 0.62451171875 }

exact_16 -> 1 - adder2_10;

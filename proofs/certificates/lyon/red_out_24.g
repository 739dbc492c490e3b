# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 24: accepted; its hypotheses contradict each other. To check: gappa red_out_24.g
# SHA-256 of the script below: 711e30dc553f0ee64f0ec4266d833ae7c850a0c988df9cba2a62f1fa9464762e

multiplier1_1 = dx * dx;
multiplier2_3 = dy * dy;
adder1_4 = multiplier1_1 + multiplier2_3;
multiplier3_6 = dz * dz;
adder2_7 = adder1_4 + multiplier3_6;
distance_rounded_8 = fixed<-20,dn>(adder2_7);
beta_distance_bits_9 = fixed<-16,dn>(distance_rounded_8);
inverse_11 = 0.9999847412109375 - beta_distance_bits_9;
multiplier4_12 = inverse_11 * inverse_11;
accumulator_13 = fixed<-16,dn>(multiplier4_12);
multiplier4_14 = accumulator_13 * accumulator_13;
accumulator_15 = fixed<-16,dn>(multiplier4_14);
multiplier4_16 = accumulator_15 * accumulator_15;
accumulator_17 = fixed<-16,dn>(multiplier4_16);
multiplier4_18 = accumulator_17 * accumulator_17;
accumulator_19 = fixed<-16,dn>(multiplier4_18);
red_product_21 = accumulator_19 * red;
red_intensity_22 = fixed<0,na>(red_product_21);
exact_28 = 1 - adder2_7;
difference_34 = red_intensity_22 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_8 in [0,0.99999998509883880615234375]
  /\ red in [0,255]
  /\ shift in [5,5]
  /\ exact_28 <= 0
  -> |difference_34| <= 0.62451171875 }

exact_28 -> 1 - adder2_7;
inverse_11 ~ exact_28;

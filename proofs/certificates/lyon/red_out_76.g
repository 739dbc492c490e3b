# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 76: accepted; its hypotheses contradict each other. To check: gappa red_out_76.g
# SHA-256 of the script below: 35309389f66a7753dcccdf5964c0c91d54353a7074ebe319484c13568f487f41

multiplier1_1 = dx * dx;
multiplier2_3 = dy * dy;
adder1_4 = multiplier1_1 + multiplier2_3;
multiplier3_6 = dz * dz;
adder2_7 = adder1_4 + multiplier3_6;
distance_rounded_8 = fixed<-20,dn>(adder2_7);
beta_distance_bits_9 = fixed<-20,dn>(distance_rounded_8);
inverse_11 = 16 * beta_distance_bits_9;
inverse_13 = 0.9999847412109375 - inverse_11;
multiplier4_14 = inverse_13 * inverse_13;
accumulator_15 = fixed<-16,dn>(multiplier4_14);
multiplier4_16 = accumulator_15 * accumulator_15;
accumulator_17 = fixed<-16,dn>(multiplier4_16);
multiplier4_18 = accumulator_17 * accumulator_17;
accumulator_19 = fixed<-16,dn>(multiplier4_18);
multiplier4_20 = accumulator_19 * accumulator_19;
accumulator_21 = fixed<-16,dn>(multiplier4_20);
red_product_23 = accumulator_21 * red;
red_intensity_24 = fixed<0,na>(red_product_23);
exact_31 = 16 * adder2_7;
exact_32 = 1 - exact_31;
difference_38 = red_intensity_24 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_8 in [0,0.062499999068677425384521484375]
  /\ red in [0,255]
  /\ shift in [9,9]
  /\ exact_32 <= 0
  -> |difference_38| <= 0.62451171875 }

exact_31 -> (16) * adder2_7;
exact_32 -> 1 + (-16) * adder2_7;
inverse_11 ~ exact_31;
inverse_13 ~ exact_32;

# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 16: accepted; its hypotheses contradict each other. To check: gappa red_out_16.g
# SHA-256 of the script below: 8396063635962ae5ad120ba67aed0f879f78f9dfea069fbbc9393d0a3bf73d81

multiplier1_1 = dx * dx;
multiplier2_3 = dy * dy;
adder1_4 = multiplier1_1 + multiplier2_3;
multiplier3_6 = dz * dz;
adder2_7 = adder1_4 + multiplier3_6;
distance_rounded_8 = fixed<-20,dn>(adder2_7);
beta_distance_bits_9 = fixed<-15,dn>(distance_rounded_8);
inverse_11 = 0.5 * beta_distance_bits_9;
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
exact_31 = 0.5 * adder2_7;
exact_32 = 1 - exact_31;
difference_38 = red_intensity_24 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_8 in [0,1.9999999701976776123046875]
  /\ red in [0,255]
  /\ shift in [4,4]
  /\ exact_32 <= 0
  -> |difference_38| <= 0.62451171875 }

exact_31 -> (0.5) * adder2_7;
exact_32 -> 1 + (-0.5) * adder2_7;
inverse_11 ~ exact_31;
inverse_13 ~ exact_32;

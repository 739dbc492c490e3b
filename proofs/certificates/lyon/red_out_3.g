# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 3: accepted. To check: gappa red_out_3.g
# SHA-256 of the script below: 37b3bde6e3003a22baa72f6c14af110c0d9b6c7fa0ec3b67ce8e9b754645ea9b
# The hypotheses hold at dx = 1.9667816162109375, dy = 1.9383697509765625, dz = -1.9999847412109375, red = 98, shift = 1

multiplier1_1 = dx * dx;
multiplier2_3 = dy * dy;
adder1_4 = multiplier1_1 + multiplier2_3;
multiplier3_6 = dz * dz;
adder2_7 = adder1_4 + multiplier3_6;
distance_rounded_8 = fixed<-20,dn>(adder2_7);
beta_distance_bits_9 = fixed<-12,dn>(distance_rounded_8);
inverse_11 = 0.0625 * beta_distance_bits_9;
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
exact_31 = 0.0625 * adder2_7;
exact_32 = 1 - exact_31;
exact_34 = exact_32 * exact_32;
exact_35 = exact_34 * exact_34;
exact_36 = exact_35 * exact_35;
exact_37 = exact_36 * exact_36;
exact_38 = exact_37 * red;
difference_39 = red_intensity_24 - exact_38;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ red in [0,255]
  /\ shift in [1,1]
  /\ exact_32 >= 0
  -> |difference_39| <= 0.62451171875 }

exact_31 -> (0.0625) * adder2_7;
exact_32 -> 1 + (-0.0625) * adder2_7;
inverse_11 ~ exact_31;
inverse_13 ~ exact_32;
multiplier4_14 ~ exact_34;
accumulator_15 ~ exact_34;
multiplier4_16 ~ exact_35;
accumulator_17 ~ exact_35;
multiplier4_18 ~ exact_36;
accumulator_19 ~ exact_36;
multiplier4_20 ~ exact_37;
accumulator_21 ~ exact_37;
red_product_23 ~ exact_38;

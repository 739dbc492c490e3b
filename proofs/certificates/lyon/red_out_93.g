# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 93: accepted. To check: gappa red_out_93.g
# SHA-256 of the script below: f3c7284140774c45b4fe0b32fd1b959a872ec1348160786ba5ee5b2acaacd134
# The hypotheses hold at dx = -0.0332183837890625, dy = -0.0616302490234375, dz = 0.0000152587890625, red = 98, shift = 10

multiplier1_1 = dx * dx;
multiplier2_3 = dy * dy;
adder1_4 = multiplier1_1 + multiplier2_3;
multiplier3_6 = dz * dz;
adder2_7 = adder1_4 + multiplier3_6;
distance_rounded_8 = fixed<-20,dn>(adder2_7);
beta_distance_bits_9 = fixed<-21,dn>(distance_rounded_8);
inverse_11 = 32 * beta_distance_bits_9;
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
exact_30 = 32 * adder2_7;
exact_31 = 1 - exact_30;
exact_33 = exact_31 * exact_31;
exact_34 = exact_33 * exact_33;
exact_35 = exact_34 * exact_34;
exact_36 = exact_35 * exact_35;
exact_37 = exact_36 * red;
difference_38 = red_intensity_24 - exact_37;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ @FIX(red,0)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_8 in [0,0.0312499995343387126922607421875]
  /\ red in [0,255]
  /\ shift in [10,10]
  /\ exact_31 >= 0
  -> |difference_38| <= 0.62451171875 }

exact_30 -> (32) * adder2_7;
exact_31 -> 1 + (-32) * adder2_7;
inverse_11 ~ exact_30;
inverse_13 ~ exact_31;
multiplier4_14 ~ exact_33;
accumulator_15 ~ exact_33;
multiplier4_16 ~ exact_34;
accumulator_17 ~ exact_34;
multiplier4_18 ~ exact_35;
accumulator_19 ~ exact_35;
multiplier4_20 ~ exact_36;
accumulator_21 ~ exact_36;
red_product_23 ~ exact_37;
red_intensity_24 ~ exact_37;

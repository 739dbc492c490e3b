# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 23: accepted. To check: gappa red_out_23.g
# SHA-256 of the script below: 87ff9989b00399ed1dc0a95c4821b9378399e51ca6ec5ee08528aa668ff6a5be
# The hypotheses hold at dx = -0.0332183837890625, dy = -0.0616302490234375, dz = 0.0000152587890625, red = 98, shift = 5

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
exact_30 = exact_28 * exact_28;
exact_31 = exact_30 * exact_30;
exact_32 = exact_31 * exact_31;
exact_33 = exact_32 * exact_32;
exact_34 = exact_33 * red;
difference_35 = red_intensity_22 - exact_34;

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
  /\ exact_28 >= 0
  -> |difference_35| <= 0.62451171875 }

exact_28 -> 1 - adder2_7;
inverse_11 ~ exact_28;
multiplier4_12 ~ exact_30;
accumulator_13 ~ exact_30;
multiplier4_14 ~ exact_31;
accumulator_15 ~ exact_31;
multiplier4_16 ~ exact_32;
accumulator_17 ~ exact_32;
multiplier4_18 ~ exact_33;
accumulator_19 ~ exact_33;
red_product_21 ~ exact_34;
red_intensity_22 ~ exact_34;

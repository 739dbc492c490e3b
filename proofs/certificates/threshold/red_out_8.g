# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 8: accepted. To check: gappa red_out_8.g
# SHA-256 of the script below: 721c66e7575efe3ac3f055f933cf67993a9df1063d2fa39024deb57b0adefc84
# The hypotheses hold at cos_gamma = 0.99999904632568359375, exponent_over_2 = 492, red = 0, levels_at_exponent_over_2 = 0.0019683837890625

adder1_2 = cos_gamma - (-1);
adder1_4 = (-2) + adder1_2;
multiplier1_6 = adder1_4 * exponent_over_2;
multiplier1_kept_inside_7 = fixed<-16,dn>(multiplier1_6);
scaled_same_9 = 2 + multiplier1_kept_inside_7;
adder2_10 = (-1) + scaled_same_9;
multiplier2_11 = adder2_10 * adder2_10;
multiplier2_kept_inside_12 = fixed<-16,dn>(multiplier2_11);
red_product_14 = multiplier2_kept_inside_12 * red;
red_intensity_15 = fixed<0,na>(red_product_14);
exact_20 = cos_gamma - 1;
exact_21 = exact_20 * exponent_over_2;
exact_22 = 1 + exact_21;
exact_24 = exact_22 * exact_22;
exact_28 = exact_24 - 0.001922607421875;
exact_31 = exact_24 - 0.00201416015625;
exact_33 = exact_24 * red;
difference_34 = red_intensity_15 - exact_33;
unrounded_35 = 2 + multiplier1_6;
unrounded_36 = (-1) + unrounded_35;
unrounded_37 = unrounded_36 * unrounded_36;
unrounded_38 = unrounded_37 * red;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_2,-1)
  /\ @FIX(red,0)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent_over_2 in [0.5,500]
  /\ multiplier1_6 in [-1,-0.000000476837158203125]
  /\ multiplier2_kept_inside_12 in [0.0019683837890625,0.999969482421875]
  /\ red in [0,255]
  /\ levels_at_exponent_over_2 in [0.0019683837890625,0.0019683837890625]
  /\ exact_22 >= 0
  /\ exact_28 >= 0
  /\ exact_31 >= 0
  -> |difference_34| <= 0.5116729736328125 }

exact_20 -> -2 + adder1_2;
exact_20 -> adder1_4;
exact_21 -> multiplier1_6;
exact_22 -> 1 + multiplier1_6;
exact_24 -> unrounded_37;
exact_33 -> unrounded_38;
multiplier1_kept_inside_7 ~ exact_21;
scaled_same_9 ~ exact_21;
adder2_10 ~ exact_21;
multiplier1_kept_inside_7 ~ exact_22;
scaled_same_9 ~ exact_22;
adder2_10 ~ exact_22;
multiplier2_11 ~ exact_24;
multiplier2_kept_inside_12 ~ exact_24;
multiplier2_11 ~ exact_28;
multiplier2_kept_inside_12 ~ exact_28;
multiplier2_11 ~ exact_31;
multiplier2_kept_inside_12 ~ exact_31;
red_product_14 ~ exact_33;
red_intensity_15 ~ exact_33;

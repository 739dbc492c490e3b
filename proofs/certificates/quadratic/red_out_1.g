# Certificate by Glint: quadratic.toml, red_out and green_out and blue_out, statement 1: accepted. To check: gappa red_out_1.g
# SHA-256 of the script below: 2f6ddc84b82b2a0c1d601ee06b972ae7b851c059460f123d860c1487f76f4dde
# The hypotheses hold at cos_gamma = 0.99999904632568359375, coefficient_at_exponent = 506.859375, red = 0

multiplier5_1 = cos_gamma * cos_gamma;
inverters_3 = (-0.0000000000009094947017729282379150390625) - cos_gamma;
adder1_4 = inverters_3 + multiplier5_1;
adder1_6 = 0.0000000000009094947017729282379150390625 + adder1_4;
difference_7 = fixed<-19,dn>(adder1_6);
multiplier1_9 = difference_7 * coefficient_at_exponent;
adder2_10 = multiplier1_9 + cos_gamma;
adder2_kept_inside_11 = fixed<-16,dn>(adder2_10);
red_product_13 = adder2_kept_inside_11 * red;
red_intensity_14 = fixed<0,na>(red_product_13);
exact_19 = 1 - cos_gamma;
exact_20 = exact_19 * coefficient_at_exponent;
exact_21 = 1 - exact_20;
exact_22 = exact_21 * cos_gamma;
exact_24 = exact_22 * red;
difference_25 = red_intensity_14 - exact_24;
unrounded_26 = adder1_6 * coefficient_at_exponent;
unrounded_27 = unrounded_26 + cos_gamma;
unrounded_28 = unrounded_27 * red;

{ @FIX(cos_gamma,-20)
  /\ @FIX(red,0)
  /\ @FIX(coefficient_at_exponent,-8)
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ coefficient_at_exponent in [0,514.7890625]
  /\ adder2_10 in [0,132.656222097575664520263671875]
  /\ red in [0,255]
  /\ cos_gamma >= 0
  /\ exact_22 >= 0
  -> |difference_25| <= 0.84526692814504833517474935433710925281047821044921875 }

exact_19 -> 1.0000000000009094947017729282379150390625 + inverters_3;
exact_22 -> unrounded_27;
exact_24 -> unrounded_28;
multiplier1_9 ~ exact_22;
adder2_10 ~ exact_22;
adder2_kept_inside_11 ~ exact_22;
red_product_13 ~ exact_24;
red_intensity_14 ~ exact_24;

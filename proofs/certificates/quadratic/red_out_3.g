# Certificate by Glint: quadratic.toml, red_out and green_out and blue_out, statement 3: accepted. To check: gappa red_out_3.g
# SHA-256 of the script below: 7107cc787be804e8c2be66cc759bcc9378aaa9e34927ca77ebba7d6203469af4
# The hypotheses hold at cos_gamma = 0, coefficient_at_exponent = 506.859375, red = 0

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
difference_24 = red_intensity_14 - 0;

{ @FIX(cos_gamma,-20)
  /\ @FIX(red,0)
  /\ @FIX(coefficient_at_exponent,-8)
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ coefficient_at_exponent in [0,514.7890625]
  /\ adder2_10 in [0,132.656222097575664520263671875]
  /\ red in [0,255]
  /\ cos_gamma <= 0
  -> |difference_24| <= 0.84526692814504833517474935433710925281047821044921875 }


# Certificate by Glint: quadratic.toml, red_out and green_out and blue_out, statement 5: accepted. To check: gappa red_out_5.g
# SHA-256 of the script below: aa10bbf177989bb6d63a24d8ded160fae7ad7445c4da30ca01755d0c2253c1a1
# The hypotheses hold at cos_gamma = 0.99170017242431640625, coefficient_at_exponent = 506.859375

multiplier5_6 = cos_gamma * cos_gamma;
inverters_8 = (-0.0000000000009094947017729282379150390625) - cos_gamma;
adder1_9 = inverters_8 + multiplier5_6;
adder1_11 = 0.0000000000009094947017729282379150390625 + adder1_9;
difference_12 = fixed<-19,dn>(adder1_11);
multiplier1_13 = difference_12 * coefficient_at_exponent;
adder2_14 = multiplier1_13 + cos_gamma;
adder2_kept_bits_2_15 = fixed<0,dn>(adder2_14);
adder2_kept_bits_2_17 = 256 + adder2_kept_bits_2_15;
exact_20 = 1 - cos_gamma;
exact_21 = exact_20 * coefficient_at_exponent;
exact_22 = 1 - exact_21;
exact_23 = exact_22 * cos_gamma;
difference_24 = 0 - 0;
unrounded_25 = adder1_11 * coefficient_at_exponent;
unrounded_26 = unrounded_25 + cos_gamma;

{ @FIX(cos_gamma,-20)
  /\ @FIX(coefficient_at_exponent,-8)
  /\ coefficient_at_exponent in [0,514.7890625]
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ adder2_14 in [-131.6572265625,-0.000000007450580596923828125]
  /\ adder2_kept_bits_2_17 in [1,255]
  /\ cos_gamma >= 0
  /\ exact_23 <= 0
  -> |difference_24| <= 0.84526692814504833517474935433710925281047821044921875 }

exact_20 -> 1.0000000000009094947017729282379150390625 + inverters_8;
exact_23 -> unrounded_26;
multiplier1_13 ~ exact_23;
adder2_14 ~ exact_23;
adder2_kept_bits_2_15 ~ exact_23;

# Certificate by Glint: quadratic.toml, red_out and green_out and blue_out, statement 4: accepted. To check: gappa red_out_4.g
# SHA-256 of the script below: ebb81d5ef8c8057093ddfcc987bc6ab3c8776ef658a0c07624a6cace0b009c5b
# The hypotheses hold at cos_gamma = 0.00000095367431640625, coefficient_at_exponent = 0.80078125, red = 0

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
exact_24 = exact_23 * red;
difference_25 = 0 - exact_24;
unrounded_26 = adder1_11 * coefficient_at_exponent;
unrounded_27 = unrounded_26 + cos_gamma;

{ @FIX(cos_gamma,-20)
  /\ @FIX(red,0)
  /\ @FIX(coefficient_at_exponent,-8)
  /\ coefficient_at_exponent in [0,514.7890625]
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ red in [0,255]
  /\ adder2_14 in [-131.6572265625,-0.000000007450580596923828125]
  /\ adder2_kept_bits_2_17 in [1,255]
  /\ cos_gamma >= 0
  /\ exact_23 >= 0
  -> |difference_25| <= 0.84526692814504833517474935433710925281047821044921875 }

exact_20 -> 1.0000000000009094947017729282379150390625 + inverters_8;
exact_23 -> unrounded_27;
multiplier1_13 ~ exact_23;
adder2_14 ~ exact_23;
adder2_kept_bits_2_15 ~ exact_23;

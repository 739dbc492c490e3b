# Certificate by Glint: quadratic.toml, red_out and green_out and blue_out, statement 6: accepted; its hypotheses contradict each other. To check: gappa red_out_6.g
# SHA-256 of the script below: 0267122a4a5d4ecdfd5bffe218a5c2aca7b21e5ad6c22e2c3818993d905f6a6e

multiplier5_6 = cos_gamma * cos_gamma;
inverters_8 = (-0.0000000000009094947017729282379150390625) - cos_gamma;
adder1_9 = inverters_8 + multiplier5_6;
adder1_11 = 0.0000000000009094947017729282379150390625 + adder1_9;
difference_12 = fixed<-19,dn>(adder1_11);
multiplier1_13 = difference_12 * coefficient_at_exponent;
adder2_14 = multiplier1_13 + cos_gamma;
adder2_kept_bits_2_15 = fixed<0,dn>(adder2_14);
adder2_kept_bits_2_17 = 256 + adder2_kept_bits_2_15;
difference_24 = 0 - 0;

{ @FIX(cos_gamma,-20)
  /\ @FIX(coefficient_at_exponent,-8)
  /\ coefficient_at_exponent in [0,514.7890625]
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ adder2_14 in [-131.6572265625,-0.000000007450580596923828125]
  /\ adder2_kept_bits_2_17 in [1,255]
  /\ cos_gamma <= 0
  -> |difference_24| <= 0.84526692814504833517474935433710925281047821044921875 }


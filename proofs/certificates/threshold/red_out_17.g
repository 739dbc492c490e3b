# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 17: accepted. To check: gappa red_out_17.g
# SHA-256 of the script below: 39e5e198afd2a91e9a313ae9d0c64102deb5211a609708d4e275f3b73da8a480
# The hypotheses hold at cos_gamma = 0.5, exponent_over_2 = 2, levels_at_exponent_over_2 = 0.0019683837890625

adder1_7 = cos_gamma - (-1);
adder1_9 = (-2) + adder1_7;
multiplier1_10 = adder1_9 * exponent_over_2;
multiplier1_kept_inside_11 = fixed<-16,dn>(multiplier1_10);
scaled_same_13 = 2 + multiplier1_kept_inside_11;
adder2_14 = (-1) + scaled_same_13;
multiplier2_15 = adder2_14 * adder2_14;
multiplier2_kept_inside_16 = fixed<-16,dn>(multiplier2_15);
exact_19 = cos_gamma - 1;
exact_20 = exact_19 * exponent_over_2;
exact_21 = 1 + exact_20;
difference_31 = 0 - 0;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_2,-1)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent_over_2 in [0.5,500]
  /\ levels_at_exponent_over_2 in [0.0019683837890625,0.0019683837890625]
  /\ multiplier1_10 in [-1,-0.000000476837158203125]
  /\ multiplier2_kept_inside_16 in [0,0.001953125]
  /\ exact_21 <= 0
  -> |difference_31| <= 0.5116729736328125 }

exact_19 -> -2 + adder1_7;
exact_19 -> adder1_9;
exact_20 -> multiplier1_10;
exact_21 -> 1 + multiplier1_10;
multiplier1_kept_inside_11 ~ exact_20;
scaled_same_13 ~ exact_20;
adder2_14 ~ exact_20;
multiplier1_kept_inside_11 ~ exact_21;
scaled_same_13 ~ exact_21;
adder2_14 ~ exact_21;

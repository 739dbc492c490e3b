# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 15: accepted; its hypotheses contradict each other. To check: gappa red_out_15.g
# SHA-256 of the script below: f52ccb38837edea9fd9832b85040684959e254dc594546c695c71a0a815aeaf2

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
exact_22 = exact_21 * exact_21;
exact_26 = exact_22 - 0.001922607421875;
exact_29 = exact_22 - 0.00201416015625;
difference_31 = 0 - 0;
unrounded_32 = 2 + multiplier1_10;
unrounded_33 = (-1) + unrounded_32;
unrounded_34 = unrounded_33 * unrounded_33;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_2,-1)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent_over_2 in [0.5,500]
  /\ levels_at_exponent_over_2 in [0.0019683837890625,0.0019683837890625]
  /\ multiplier1_10 in [-1,-0.000000476837158203125]
  /\ multiplier2_kept_inside_16 in [0,0.001953125]
  /\ exact_21 >= 0
  /\ exact_26 <= 0
  /\ exact_29 >= 0
  -> |difference_31| <= 0.5116729736328125 }

exact_19 -> -2 + adder1_7;
exact_19 -> adder1_9;
exact_20 -> multiplier1_10;
exact_21 -> 1 + multiplier1_10;
exact_22 -> unrounded_34;
multiplier1_kept_inside_11 ~ exact_20;
scaled_same_13 ~ exact_20;
adder2_14 ~ exact_20;
multiplier1_kept_inside_11 ~ exact_21;
scaled_same_13 ~ exact_21;
adder2_14 ~ exact_21;
multiplier2_15 ~ exact_22;
multiplier2_kept_inside_16 ~ exact_22;
multiplier2_15 ~ exact_26;
multiplier2_kept_inside_16 ~ exact_26;
multiplier2_15 ~ exact_29;
multiplier2_kept_inside_16 ~ exact_29;

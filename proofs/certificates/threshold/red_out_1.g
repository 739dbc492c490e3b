# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 1: accepted; its hypotheses contradict each other. To check: gappa red_out_1.g
# SHA-256 of the script below: 94ca0bf6a05912487b68e2594f16700fba310cf1bc5d35067b288544606d7e57

adder1_6 = cos_gamma - (-1);
adder1_8 = (-2) + adder1_6;
multiplier1_9 = adder1_8 * exponent_over_2;
multiplier1_kept_bits_2_10 = fixed<0,dn>(multiplier1_9);
multiplier1_kept_bits_2_12 = 1024 + multiplier1_kept_bits_2_10;
exact_15 = cos_gamma - 1;
exact_16 = exact_15 * exponent_over_2;
exact_17 = 1 + exact_16;
exact_18 = exact_17 * exact_17;
exact_22 = exact_18 - 0.001922607421875;
exact_25 = exact_18 - 0.00201416015625;
exact_27 = exact_18 * red;
difference_28 = 0 - exact_27;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_2,-1)
  /\ @FIX(red,0)
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ exponent_over_2 in [0.5,500]
  /\ red in [0,255]
  /\ multiplier1_9 in [-511.5,-1.000000476837158203125]
  /\ multiplier1_kept_bits_2_12 in [0,1022]
  /\ cos_gamma >= 0
  /\ exact_17 >= 0
  /\ exact_22 >= 0
  /\ exact_25 >= 0
  -> |difference_28| <= 0.5116729736328125 }

exact_15 -> -2 + adder1_6;
exact_15 -> adder1_8;
exact_16 -> multiplier1_9;
exact_17 -> 1 + multiplier1_9;
multiplier1_kept_bits_2_10 ~ exact_16;
multiplier1_kept_bits_2_10 ~ exact_17;

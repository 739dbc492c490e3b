# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 6: accepted. To check: gappa red_out_6.g
# SHA-256 of the script below: 582612f761c6a82a027b046ff3e782387575c372b7e324d31d59033d5114f38f
# The hypotheses hold at cos_gamma = 0, exponent_over_2 = 492

adder1_6 = cos_gamma - (-1);
adder1_8 = (-2) + adder1_6;
multiplier1_9 = adder1_8 * exponent_over_2;
multiplier1_kept_bits_2_10 = fixed<0,dn>(multiplier1_9);
multiplier1_kept_bits_2_12 = 1024 + multiplier1_kept_bits_2_10;
difference_27 = 0 - 0;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_2,-1)
  /\ cos_gamma in [0,0.99999904632568359375]
  /\ exponent_over_2 in [0.5,500]
  /\ multiplier1_9 in [-511.5,-1.000000476837158203125]
  /\ multiplier1_kept_bits_2_12 in [0,1022]
  /\ cos_gamma <= 0
  -> |difference_27| <= 0.5116729736328125 }


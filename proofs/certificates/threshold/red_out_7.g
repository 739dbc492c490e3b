# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 7: accepted. To check: gappa red_out_7.g
# SHA-256 of the script below: 4f27587afb6b088a4c8fe3ee3f6471b585f55d1b7e04a50e45a68bfadc817156
# The hypotheses hold at exponent_over_2 = 0.5, cos_gamma = 0

multiplier1_5 = (-1) * exponent_over_2;
difference_8 = 0 - 0;

{ @FIX(exponent_over_2,-1)
  /\ exponent_over_2 in [0.5,500]
  /\ multiplier1_5 in [-1,-0.000000476837158203125]
  /\ cos_gamma in [0,0]
  -> |difference_8| <= 0.5116729736328125 }


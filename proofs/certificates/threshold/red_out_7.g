# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 7: accepted. To check: gappa red_out_7.g
# SHA-256 of the script below: 39d18f82682e3999f312edd301582b4eb29900af0d80879e972c5a26968112f2

multiplier1_5 = (-1) * exponent_over_2;
difference_8 = 0 - 0;

{ @FIX(exponent_over_2,-1)
  /\ exponent_over_2 in [0.5,500]
  /\ multiplier1_5 in [-1,-0.000000476837158203125]
  -> |difference_8| <= 0.5116729736328125 }


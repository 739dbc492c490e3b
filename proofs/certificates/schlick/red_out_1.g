# Certificate by Glint: schlick.toml, red_out and green_out and blue_out, statement 1: accepted. To check: gappa red_out_1.g
# SHA-256 of the script below: 446a7a49ba13e328ccefd824fe0d78519260b1807d5dc88bc03e2c816a1c6353

difference_6 = 0 - 0;

{ |difference_6| <= 0.7490234375 }


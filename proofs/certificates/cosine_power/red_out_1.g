# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 1: accepted. To check: gappa red_out_1.g
# SHA-256 of the script below: f02ba34693cf4f231f2de7b055bce3cfcbb8e6d337a370c9ba3375f673e466ea
# The hypotheses hold at exponent_over_16 = 0.0625, cos_gamma = 0

product_5 = 1 * exponent_over_16;
difference_8 = 0 - 0;

{ @FIX(exponent_over_16,-4)
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_5 in [0,0.999999940395355224609375]
  /\ cos_gamma in [0,0]
  -> |difference_8| <= 0.6206207275390625 }


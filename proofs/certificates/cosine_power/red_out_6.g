# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 6: accepted. To check: gappa red_out_6.g
# SHA-256 of the script below: fc0e4c014b94543b8ad85aa5bc5eb0a252e45dc69c1eaf5978eb537b323cceba
# The hypotheses hold at cos_gamma = 0.00000095367431640625, exponent_over_16 = 61.5

complement_6 = 1 - cos_gamma;
product_7 = complement_6 * exponent_over_16;
product_view_kept_bits_8 = fixed<0,dn>(product_7);
exact_10 = cos_gamma - 1;
exact_11 = exact_10 * exponent_over_16;
exact_12 = 1 + exact_11;
difference_17 = 0 - 0;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_16,-4)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_7 in [1,63.9375]
  /\ product_view_kept_bits_8 in [1,63]
  /\ exact_12 <= 0
  -> |difference_17| <= 0.6206207275390625 }

exact_10 -> 0 - complement_6;
exact_11 -> 0 - product_7;
exact_12 -> 1 - product_7;

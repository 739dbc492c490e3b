# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 4: accepted. To check: gappa red_out_4.g
# SHA-256 of the script below: 39e1097dfdac93a4b811a5098c664942dcfeb29679e3acd99314b1639d3aa26c
# The hypotheses hold at exponent_over_16 = 61.9375, cos_gamma = 0

product_5 = 1 * exponent_over_16;
product_view_kept_bits_6 = fixed<0,dn>(product_5);
difference_9 = 0 - 0;

{ @FIX(exponent_over_16,-4)
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_5 in [1,63.9375]
  /\ product_view_kept_bits_6 in [1,63]
  /\ cos_gamma in [0,0]
  -> |difference_9| <= 0.6206207275390625 }


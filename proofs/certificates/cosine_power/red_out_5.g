# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 5: accepted; no witness is found. To check: gappa red_out_5.g
# SHA-256 of the script below: 1a4f4931c489f3a2babdefbe5ee33e8c2863fdc08af2a42c2c5d82e4b7efbad0

complement_6 = 1 - cos_gamma;
product_7 = complement_6 * exponent_over_16;
product_view_kept_bits_8 = fixed<0,dn>(product_7);
exact_10 = cos_gamma - 1;
exact_11 = exact_10 * exponent_over_16;
exact_12 = 1 + exact_11;
exact_13 = exact_12 * exact_12;
exact_14 = exact_13 * exact_13;
exact_15 = exact_14 * exact_14;
exact_16 = exact_15 * exact_15;
exact_17 = exact_16 * red;
difference_18 = 0 - exact_17;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_16,-4)
  /\ @FIX(red,0)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent_over_16 in [0.0625,62.5]
  /\ red in [0,255]
  /\ product_7 in [1,63.9375]
  /\ product_view_kept_bits_8 in [1,63]
  /\ exact_12 >= 0
  -> |difference_18| <= 0.6206207275390625 }

exact_10 -> 0 - complement_6;
exact_11 -> 0 - product_7;
exact_12 -> 1 - product_7;

# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 4: accepted. To check: gappa red_out_4.g
# SHA-256 of the script below: f60c97bd9c60eec98ea682a0aba0ec2685e19aab5ccff3d0f30469d282c8d326

product_5 = 1 * exponent_over_16;
product_view_kept_bits_6 = fixed<0,dn>(product_5);
difference_9 = 0 - 0;

{ @FIX(exponent_over_16,-4)
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_5 in [1,63.9375]
  /\ product_view_kept_bits_6 in [1,63]
  -> |difference_9| <= 0.6206207275390625 }


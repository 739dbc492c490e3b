# Certificate by Glint: configs/cosine_power.toml, blue_out, statement 4: accepted. To check: gappa blue_out_4.g

product_5 = 1048576 * exponent_over_16;
product_view_kept_bits_6 = fixed<20,dn>(product_5);
difference_9 = 0 - 0;

{ @FIX(exponent_over_16,-4)
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_5 in [1048576,67043328]
  /\ product_view_kept_bits_6 in [1048576,66060288]
  -> |difference_9| <= 0.6206207275390625 }


# Certificate by Glint: configs/cosine_power.toml, green_out, statement 7: accepted. To check: gappa green_out_7.g

green_product_2 = 65520 * green;
green_intensity_3 = fixed<16,na>(green_product_2);
out_9 = green_intensity_3 * 0.0000152587890625;
difference_12 = out_9 - green;

{ @FIX(green,0)
  /\ green in [0,255]
  -> |difference_12| <= 0.6206207275390625 }


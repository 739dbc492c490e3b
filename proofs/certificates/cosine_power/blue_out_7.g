# Certificate by Glint: configs/cosine_power.toml, blue_out, statement 7: accepted. To check: gappa blue_out_7.g

blue_product_2 = 65520 * blue;
blue_intensity_3 = fixed<16,na>(blue_product_2);
out_9 = blue_intensity_3 * 0.0000152587890625;
difference_12 = out_9 - blue;

{ @FIX(blue,0)
  /\ blue in [0,255]
  -> |difference_12| <= 0.6206207275390625 }


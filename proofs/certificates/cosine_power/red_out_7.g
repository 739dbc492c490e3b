# Certificate by Glint: configs/cosine_power.toml, red_out, statement 7: accepted. To check: gappa red_out_7.g

red_product_2 = 65520 * red;
red_intensity_3 = fixed<16,na>(red_product_2);
out_9 = red_intensity_3 * 0.0000152587890625;
difference_12 = out_9 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  -> |difference_12| <= 0.6206207275390625 }


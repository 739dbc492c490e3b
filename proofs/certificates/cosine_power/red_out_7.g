# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 7: accepted. To check: gappa red_out_7.g
# SHA-256 of the script below: 27eabd57d296dca2caf166c703f8ff72f7c4fd4e731f9b067d84739f3a72ffd6

red_product_2 = 0.999755859375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_10 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  -> |difference_10| <= 0.6206207275390625 }


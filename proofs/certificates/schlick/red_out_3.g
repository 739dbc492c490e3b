# Certificate by Glint: schlick.toml, red_out and green_out and blue_out, statement 3: accepted. To check: gappa red_out_3.g
# SHA-256 of the script below: b000c7e7b4f959a071f10487496dfb8d47b427dbdb6101fae8b276b002286c45

red_product_2 = 0.9990234375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_10 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  -> |difference_10| <= 0.7490234375 }


# Certificate by Glint: configs/threshold.toml, red_out and green_out and blue_out, statement 18: accepted. To check: gappa red_out_18.g

red_product_2 = 0.9999847412109375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_18 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  -> |difference_18| <= 0.5116729736328125 }


# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 18: accepted. To check: gappa red_out_18.g
# SHA-256 of the script below: a2c16a9252383bc62357553855b3264502fec42826bfeaf7f9c7d253dd427645
# The hypotheses hold at red = 252, cos_gamma = 1

red_product_2 = 0.9999847412109375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_18 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  /\ cos_gamma in [1,1]
  -> |difference_18| <= 0.5116729736328125 }


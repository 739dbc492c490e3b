# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 7: accepted. To check: gappa red_out_7.g
# SHA-256 of the script below: e9a90dc3b9050a483f6051482a30487f85444f4b5e42de55038d2edc56341d13
# The hypotheses hold at red = 252, cos_gamma = 1

red_product_2 = 0.999755859375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_10 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  /\ cos_gamma in [1,1]
  -> |difference_10| <= 0.6206207275390625 }


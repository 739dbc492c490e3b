# Certificate by Glint: schlick.toml, red_out and green_out and blue_out, statement 3: accepted. To check: gappa red_out_3.g
# SHA-256 of the script below: 928203d418c84c7a8cbc1a4ba4a811fe6f6514c1bbd418684980401bfe3d0ad7
# The hypotheses hold at red = 252, cos_gamma = 1

red_product_2 = 0.9990234375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_10 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  /\ cos_gamma in [1,1]
  -> |difference_10| <= 0.7490234375 }


# Certificate by Glint: quadratic.toml, red_out and green_out and blue_out, statement 7: accepted. To check: gappa red_out_7.g
# SHA-256 of the script below: d0035f2d06b48b594e383072b9be276c558044820d56c132004d862bc71dac34
# The hypotheses hold at red = 252, cos_gamma = 1

red_product_2 = 0.9999847412109375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_11 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  /\ cos_gamma in [1,1]
  -> |difference_11| <= 0.84526692814504833517474935433710925281047821044921875 }


# Certificate by Glint: threshold.toml, red_out and green_out and blue_out, statement 18: accepted. To check: gappa red_out_18.g
# SHA-256 of the script below: 9182202d5e88955f997746c5e411ca79deb6c5843a5f0564cb787c740797cf67

red_product_2 = 0.9999847412109375 * red;
red_intensity_3 = fixed<0,na>(red_product_2);
difference_18 = red_intensity_3 - red;

{ @FIX(red,0)
  /\ red in [0,255]
  -> |difference_18| <= 0.5116729736328125 }


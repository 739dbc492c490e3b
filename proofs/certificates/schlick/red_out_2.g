# Certificate by Glint: schlick.toml, red_out and green_out and blue_out, statement 2: accepted. To check: gappa red_out_2.g
# SHA-256 of the script below: 178ad15771b5bb02ce1d274dcfeadb081411cd9e020fa1e9963a0968ca9e26ba
# The hypotheses hold at cos_gamma = 0.00000095367431640625, exponent = 984, quotient_175 = 0, red = 98

complement_2 = 1 - cos_gamma;
scaled_4 = complement_2 * exponent;
denominator_5 = scaled_4 + cos_gamma;
quotient_exact_6 = cos_gamma / denominator_5;
quotient_rest_8 = quotient_exact_6 - quotient_175;
red_product_10 = quotient_175 * red;
red_intensity_11 = fixed<0,na>(red_product_10);
exact_14 = quotient_exact_6 * red;
difference_15 = red_intensity_11 - exact_14;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent,0)
  /\ @FIX(red,0)
  /\ @FIX(quotient_175,-10)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent in [1,1000]
  /\ quotient_175 in [0,0.9990234375]
  /\ quotient_rest_8 in [0,0.0009765625]
  /\ red in [0,255]
  -> |difference_15| <= 0.7490234375 }

denominator_5 -> 1 - complement_2 * (1 - exponent);

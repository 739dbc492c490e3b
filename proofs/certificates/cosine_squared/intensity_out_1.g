# Certificate by Glint: cosine_squared.toml, intensity_out, statement 1: accepted. To check: gappa intensity_out_1.g
# SHA-256 of the script below: be21d882eff03edac85eec012be575371020ef7a0da624b32b68f97c64c28dcf
# The hypotheses hold at cosine_45 = 0, amplitude = 251, f = 0.00024700164794921875

intensity_product_2 = cosine_45 * amplitude;
intensity_rounded_3 = fixed<0,na>(intensity_product_2);
apart_5 = cosine_45 - f;
exact_6 = amplitude * f;
difference_7 = intensity_rounded_3 - exact_6;

{ @FIX(amplitude,0)
  /\ @FIX(cosine_45,-10)
  /\ cosine_45 in [0,0.9990234375]
  /\ amplitude in [0,255]
  /\ apart_5 in [-0.001252956643611469189636409282684326171875,0.001252956643611469189636409282684326171875]
  -> |difference_7| <= 0.81950394416121075114034510988858528435230255126953125 }

intensity_product_2 - exact_6 -> amplitude * (cosine_45 - f);
intensity_rounded_3 ~ exact_6;

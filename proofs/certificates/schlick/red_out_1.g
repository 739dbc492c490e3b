# Certificate by Glint: schlick.toml, red_out and green_out and blue_out, statement 1: accepted. To check: gappa red_out_1.g
# SHA-256 of the script below: 0109cfead93f3470cc9a50c813a62a9f99a3c6d6d1237bf5bbb5fab4b7bfec44
# The hypotheses hold at cos_gamma = 0

difference_6 = 0 - 0;

{ cos_gamma in [0,0]
  -> |difference_6| <= 0.7490234375 }


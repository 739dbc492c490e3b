# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 1: accepted. To check: gappa red_out_1.g
# SHA-256 of the script below: 1c561a7b137b2699810bf7ec2aaf4c76e2517648fda44acacc2911e7a385526c

product_5 = 1 * exponent_over_16;
difference_8 = 0 - 0;

{ @FIX(exponent_over_16,-4)
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_5 in [0,0.999999940395355224609375]
  -> |difference_8| <= 0.6206207275390625 }


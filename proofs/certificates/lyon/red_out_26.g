# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 26: accepted. To check: gappa red_out_26.g
# SHA-256 of the script below: faa5c0eea1d7dde90051b5f0f7e2928281ac3e80e5ec5ba2b8aafdde8f815471
# The hypotheses hold at dx = -0.0332183837890625, dy = -0.0616302490234375, dz = -0.9999847412109375, shift = 5

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_16 = 1 - adder2_10;
difference_21 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [1,1.99999998509883880615234375]
  /\ shift in [5,5]
  /\ exact_16 <= 0
  -> |difference_21| <= 0.62451171875 }

exact_16 -> 1 - adder2_10;

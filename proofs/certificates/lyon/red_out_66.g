# Certificate by Glint: lyon.toml, red_out and green_out and blue_out, statement 66: accepted. To check: gappa red_out_66.g
# SHA-256 of the script below: 31ae8c0bf6f1f3a21347483441746323d5e535889536d4c7e433de80d9ebc607
# The hypotheses hold at dx = 0.9667816162109375, dy = -0.0616302490234375, dz = 0.0000152587890625, shift = 8

multiplier1_6 = dx * dx;
multiplier2_7 = dy * dy;
adder1_8 = multiplier1_6 + multiplier2_7;
multiplier3_9 = dz * dz;
adder2_10 = adder1_8 + multiplier3_9;
distance_rounded_11 = fixed<-20,dn>(adder2_10);
exact_18 = 8 * adder2_10;
exact_19 = 1 - exact_18;
difference_24 = 0 - 0;

{ @FIX(dx,-16)
  /\ @FIX(dy,-16)
  /\ @FIX(dz,-16)
  /\ dx in [-2,1.9999847412109375]
  /\ dy in [-2,1.9999847412109375]
  /\ dz in [-2,1.9999847412109375]
  /\ distance_rounded_11 in [0.5,0.999999992549419403076171875]
  /\ shift in [8,8]
  /\ exact_19 <= 0
  -> |difference_24| <= 0.62451171875 }

exact_18 -> (8) * adder2_10;
exact_19 -> 1 + (-8) * adder2_10;

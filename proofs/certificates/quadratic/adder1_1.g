# Certificate by Glint: quadratic.toml, adder1, statement 1: accepted. To check: gappa adder1_1.g
# SHA-256 of the script below: bb87bafbfa27f29ce827cf4444415f00b2a0bc369a64ff2bbfb81f3506a58fe4
# The hypotheses hold at cos_gamma = 0.99170017242431640625

multiplier5_1 = cos_gamma * cos_gamma;
inverters_3 = (-0.0000000000009094947017729282379150390625) - cos_gamma;
adder1_4 = inverters_3 + multiplier5_1;
adder1_6 = 0.0000000000009094947017729282379150390625 + adder1_4;

{ @FIX(cos_gamma,-20)
  /\ cos_gamma in [0,0.99999904632568359375]
  -> adder1_6 in [-0.25,0] }

adder1_6 -> (1) * ((cos_gamma - (0.5)) * (cos_gamma - (0.5))) + (-0.25);

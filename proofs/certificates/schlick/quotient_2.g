# Certificate by Glint: schlick.toml, quotient, statement 2: accepted. To check: gappa quotient_2.g
# SHA-256 of the script below: 62055a5c27d811b48b92064f00bbb017d6d5f12bf693d4868967ff13b2e8c5d2
# The hypotheses hold at remainder = 0.9917011260986328125

doubled = 2 * remainder;
left = doubled - 1;

{ remainder in [0,1]
  /\ doubled - 1 >= 0
  -> left in [0,1] }


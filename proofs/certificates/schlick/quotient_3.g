# Certificate by Glint: schlick.toml, quotient, statement 3: accepted. To check: gappa quotient_3.g
# SHA-256 of the script below: 15e5b0ec9931a6d3dcdc255f71320fbd699c44aab9392bd9ad4c0c7d7f766d64
# The hypotheses hold at remainder = 0

doubled = 2 * remainder;
left = doubled;

{ remainder in [0,1]
  /\ doubled - 1 <= 0
  -> left in [0,1] }


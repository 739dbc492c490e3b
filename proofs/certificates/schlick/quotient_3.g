# Certificate by Glint: configs/schlick.toml, quotient, statement 3: accepted. To check: gappa quotient_3.g

doubled = 2 * remainder;
left = doubled;

{ remainder in [0,1]
  /\ doubled - 1 <= 0
  -> left in [0,1] }


# Certificate by Glint: configs/schlick.toml, quotient, statement 2: accepted. To check: gappa quotient_2.g

doubled = 2 * remainder;
left = doubled - 1;

{ remainder in [0,1]
  /\ doubled - 1 >= 0
  -> left in [0,1] }


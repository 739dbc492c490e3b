# Certificate by Glint: schlick.toml, quotient, statement 1: accepted. To check: gappa quotient_1.g
# SHA-256 of the script below: 85de6d87223483e1b1c721ccfeab3837ac48c27711ebc528e6b50912fe36ac92
# The hypotheses hold at cos_gamma = 0.99170017242431640625, exponent = 984

complement_2 = 1 - cos_gamma;
scaled_4 = complement_2 * exponent;
denominator_5 = scaled_4 + cos_gamma;
rest_6 = denominator_5 - cos_gamma;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent,0)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent in [1,1000]
  -> rest_6 >= 0 /\ cos_gamma >= 0 /\ denominator_5 >= 0.0000000000000000000542101086242752217003726400434970855712890625 }

rest_6 -> scaled_4;
denominator_5 -> 1 - complement_2 * (1 - exponent);

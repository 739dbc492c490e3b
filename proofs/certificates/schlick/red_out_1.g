# Certificate by Glint: configs/schlick.toml, red_out and green_out and blue_out, statement 1: accepted. To check: gappa red_out_1.g

difference_6 = 0 - 0;

{ |difference_6| <= 0.7490234375 }


# Certificate by Glint: cosine_power.toml, red_out and green_out and blue_out, statement 3: accepted; its hypotheses contradict each other. To check: gappa red_out_3.g
# SHA-256 of the script below: 923d8f2542bb2dc686069fe51e822520028552cd6d382d3be302f85de5beeedd

complement_2 = 1 - cos_gamma;
product_4 = complement_2 * exponent_over_16;
product_view_kept_inside_5 = fixed<-16,dn>(product_4);
inverse_7 = 0.9999847412109375 - product_view_kept_inside_5;
product_8 = inverse_7 * inverse_7;
accumulator_9 = fixed<-16,dn>(product_8);
product_10 = accumulator_9 * accumulator_9;
accumulator_11 = fixed<-16,dn>(product_10);
product_12 = accumulator_11 * accumulator_11;
accumulator_13 = fixed<-16,dn>(product_12);
product_14 = accumulator_13 * accumulator_13;
accumulator_15 = fixed<-16,dn>(product_14);
red_product_17 = accumulator_15 * red;
red_intensity_18 = fixed<0,na>(red_product_17);
exact_21 = cos_gamma - 1;
exact_22 = exact_21 * exponent_over_16;
exact_23 = 1 + exact_22;
difference_29 = red_intensity_18 - 0;

{ @FIX(cos_gamma,-20)
  /\ @FIX(exponent_over_16,-4)
  /\ @FIX(red,0)
  /\ cos_gamma in [0.00000095367431640625,0.99999904632568359375]
  /\ exponent_over_16 in [0.0625,62.5]
  /\ product_4 in [0,0.999999940395355224609375]
  /\ red in [0,255]
  /\ exact_23 <= 0
  -> |difference_29| <= 0.6206207275390625 }

exact_21 -> 0 - complement_2;
exact_22 -> 0 - product_4;
exact_23 -> 1 - product_4;
inverse_7 ~ exact_23;

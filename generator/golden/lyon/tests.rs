//! Values worked out by hand.

use super::contract::of_keys;
use super::*;
use crate::base::fixed::Rounding;
use crate::golden::Contract;
use crate::golden::highlight::Reflectance;
use crate::golden::watch;
use crate::keys::common::{Colours, Domain, Intensity};

/// V = 4, D = 6, F = 4, K = 4, small enough to follow by hand.
fn small(power: u32, scale: Scale) -> Keys {
    Keys {
        power,
        scale,
        vector_fraction: 4,
        distance_fraction: 6,
        distance_rounding: Rounding::Truncate,
        distance_multipliers: 3,
        exponent_bits: 4,
        colours: Colours::small(),
        f: Intensity::small(),
        domain: Domain::small(),
    }
}

#[test]
fn points_by_hand() {
    let f = |power, scale, control: [i64; 4]| Arithmetic::new(small(power, scale)).f(&control);
    // D² = (9 + 4 + 1)/256 → 3/64. n = 12, m = 2: 36/256 → 2/16; base 13/16; 169/256 → 10.
    assert_eq!(f(2, Scale::Multiplier, [3, -2, 1, 12]), 10);
    // m = 4: 36/512 → 1/16; 14 → 196/256 → 12 → 144/256 → 9.
    assert_eq!(f(4, Scale::Multiplier, [3, -2, 1, 12]), 9);
    // 2³ = 8 for 12: 24/256 → 1/16; 14 → 12.
    assert_eq!(f(2, Scale::Shift, [3, -2, 1, 3]), 12);
    // D = 0: the base is an ulp below 1.0: 15 → 14.
    assert_eq!(f(2, Scale::Shift, [0, 0, 0, 3]), 14);
    // D² = 2.0: β·D² is 1.0 at n = 2, and beyond at n = 3.
    assert_eq!(f(2, Scale::Multiplier, [16, 16, 0, 1]), 3);
    assert_eq!(f(2, Scale::Multiplier, [16, 16, 0, 2]), 0);
    assert_eq!(f(2, Scale::Multiplier, [16, 16, 0, 3]), 0);
    // The farthest D² = 12.0, at the largest shift.
    assert_eq!(f(2, Scale::Shift, [-32, -32, -32, 7]), 0);
    assert_eq!(f(16, Scale::Shift, [-32, -32, -32, 0]), 0);
}

#[test]
fn exponents_round_to_powers_of_two_by_their_ratio() {
    let keys = small(4, Scale::Shift);
    let shifts = [0, 1, 2, 3, 5, 6, 11, 12, 15].map(|n| keys.scale_operand(n));
    assert_eq!(shifts, [0, 0, 1, 2, 2, 3, 3, 4, 4]);
    assert_eq!(keys.scale_format().width(), 3);
}

#[test]
fn operands_of_an_angle() {
    let contract = of_keys(small(4, Scale::Shift));
    // N − H = (−sin 60°, 0, 1/2), in sixteenths; 11 is nearest to 2³.
    let third = std::f64::consts::FRAC_PI_3;
    let control = contract.at(third, 11.0).unwrap();
    assert_eq!(control, [-14, 0, 8, 3]);
    // D² = (196 + 64)/256.
    assert_eq!(contract.cosine(&control), Some(1.0 - 260.0 / 512.0));
    assert_eq!([0.0, 2.5, 16.0].map(|n| contract.at(third, n)), [const { None }; 3]);
}

/// The sweep's error is the worst over what rounds to a word.
#[test]
fn a_word_stands_for_an_interval() {
    let contract = of_keys(small(2, Scale::Multiplier));
    // Word 3 and n = 12: 10/16 is held against (1 − 3/64·3)² and (1 − 4/64·3)².
    let ends: [f64; 2] = [55.0 / 64.0, 52.0 / 64.0];
    let worst = ends.map(|base| (base * base - 0.625).abs());
    assert_eq!(contract.sweep_error(&[12, 3]), worst[0].max(worst[1]));
}

/// One point with the shift register followed clock by clock.
#[test]
fn a_point_clock_by_clock() {
    let mut model = clocked(small(4, Scale::Shift));
    // D = (3, −2, 1)/16, shift 2, red 15, written together with start.
    let first = [1, 1, 3, 1, 62, 1, 1, 1, 2, 1, 15, 1, 0, 0, 0, 0];
    // Writes while busy change nothing.
    let then = [1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0];
    let names =
        ["run", "word_address", "shift_register", "remaining", "accumulator", "valid", "done"];
    let expected = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        // 3/64 of D², read as 3/1024, and three times doubled.
        [1, 2, 3, 2, 0, 0, 0],
        [1, 2, 6, 1, 0, 0, 0],
        [1, 2, 12, 0, 0, 0, 0],
        [1, 3, 24, 7, 0, 0, 0],
        // 24/1024 → 0; base 15/16; 225/256 → 14, then 196/256 → 12.
        [1, 4, 24, 1, 14, 0, 0],
        [1, 5, 24, 0, 12, 1, 1],
        [0, 0, 24, 0, 12, 0, 0],
    ];
    assert_eq!(watch(&mut model, names, &first, &then), expected);
    assert_eq!(model.value("dx_reg").unwrap(), 1);
}

/// One multiplier for all components takes two microinstructions more for the same point.
#[test]
fn squares_in_turn_clock_by_clock() {
    let keys = Keys { distance_multipliers: 1, ..small(4, Scale::Shift) };
    let mut model = clocked(keys);
    let first = [1, 1, 3, 1, 62, 1, 1, 1, 2, 1, 15, 1, 0, 0, 0, 0];
    let then = [1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0];
    let names = ["run", "word_address", "distance_sum", "shift_register", "accumulator", "valid"];
    let expected = [
        [1, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0],
        // 9/256, and 4/256 more.
        [1, 2, 9, 0, 0, 0],
        [1, 3, 13, 0, 0, 0],
        // 14/256 of D².
        [1, 4, 13, 3, 0, 0],
        [1, 4, 13, 6, 0, 0],
        [1, 4, 13, 12, 0, 0],
        [1, 5, 13, 24, 0, 0],
        [1, 6, 13, 24, 14, 0],
        [1, 7, 13, 24, 12, 1],
        [0, 0, 13, 24, 12, 0],
    ];
    assert_eq!(watch(&mut model, names, &first, &then), expected);
}

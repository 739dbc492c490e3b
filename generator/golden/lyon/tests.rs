//! Compares the golden model and the contract of `lyon` with values worked out by hand.

use super::contract::of_keys;
use super::*;
use crate::Contract;
use glint_base::fixed::Rounding;
use glint_keys::common::{ColourKeys, Domain, Intensity};

/// Returns keys with few bits, so a reader can work out results by hand. Components and f have 4 fraction bits, D² has 6, and
/// colours have 4 bits.
fn small(power: u32, scale: Scale) -> Keys {
    Keys {
        power,
        scale,
        vector_fraction: 4,
        distance_fraction: 6,
        distance_rounding: Rounding::Truncate,
        distance_multipliers: 3,
        exponent_bits: 4,
        colours: ColourKeys::small(),
        f: Intensity::small(),
        domain: Domain::small(),
    }
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

/// The error of a sweep's case is the largest error over all D² that are rounded to the word.
#[test]
fn a_word_stands_for_an_interval() {
    let contract = of_keys(small(2, Scale::Multiplier));
    // Word 3 and n = 12: 10/16 is compared with (1 − 3/64·3)² and (1 − 4/64·3)².
    let ends: [f64; 2] = [55.0 / 64.0, 52.0 / 64.0];
    let worst = ends.map(|base| (base * base - 0.625).abs());
    assert_eq!(contract.sweep_error(&[12, 3]), worst[0].max(worst[1]));
}

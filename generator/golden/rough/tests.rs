//! `rough` worked by hand in words of a few bits.

use super::clock_model::clocked;
use super::contract::Domains as _;
use super::*;
use crate::base::fixed::Rounding;
use crate::golden::highlight::Reflectance;
use crate::golden::{Model, watch};
use crate::keys::common::{Domain, Intensity, Operands};

/// C = 4, S = P = 6, F = 4, and the sine table that `sine.rs` works out by hand.
fn small() -> Keys {
    Keys {
        arithmetic: Kind::Exact,
        clamp: true,
        operands: Operands::small(),
        product_fraction: 6,
        product_rounding: Rounding::Truncate,
        f: Intensity::small(),
        scheme: Scheme::Segmented,
        sine_fraction: 6,
        synchronous: true,
        address: 4,
        segments: vec![2],
        slope_fraction: 5,
        domain: Domain::small(),
        deviation: 30.0,
    }
}

fn f(keys: &Keys, control: [i64; 4]) -> i64 {
    Arithmetic::new(keys.clone()).f(&control)
}

#[test]
fn exact_arithmetic() {
    // c = 12/16, cd = 14/16; sines 43/64 and 31/64. Register 11: 168/256 → 42/64; register 12:
    // 1333/4096 → 20/64.
    // dγ negative, n = 4: (42 + 20 − 64)/64 · 2 = −8/128 → −1/16; (15/16)² = 225/256 → 14/16.
    assert_eq!(f(&small(), [12, 14, 4, 1]), 14);
    // dγ positive, n = 1: (42 − 20 − 64)/64 / 2 = −42/128 → −6/16; (10/16)² = 100/256 → 6/16.
    assert_eq!(f(&small(), [12, 14, 1, 0]), 6);
    // n = 4: −168/128 clamps to −1.0.
    assert_eq!(f(&small(), [12, 14, 4, 0]), 0);
    // To the nearest: 168/256 → 42/64 and 1333/4096 → 21/64, n = 1: −43/128 → −5/16, 121/256 → 8/16.
    let rounding = Rounding::Nearest;
    let f_nearest = Intensity { rounding, ..Intensity::small() };
    let nearest = Keys { product_rounding: rounding, f: f_nearest, ..small() };
    assert_eq!(f(&nearest, [12, 14, 1, 0]), 8);
}

#[test]
fn ends_of_the_operands() {
    // γ = dγ = 0: 1.0 saturates to 15/16. A cosine beyond 1.0 is taken as 1.0, a negative one as 0.
    assert_eq!(f(&small(), [16, 16, 15, 0]), 15);
    assert_eq!(f(&small(), [31, 31, 15, 1]), 15);
    assert_eq!(f(&small(), [0, 14, 1, 1]), 0);
    assert_eq!(f(&small(), [-3, 14, 1, 1]), 0);
}

#[test]
fn without_the_clamp_the_parabola_rises_again() {
    let keys = Keys { clamp: false, ..small() };
    // n = 4: −168/128 → −21/16; (−5/16)² = 25/256 → 1/16.
    assert_eq!(f(&keys, [12, 14, 4, 0]), 1);
    // n = 15: −630/128 saturates to −2.0; (−1.0)² is 1.0, of which f has an ulp less.
    assert_eq!(f(&keys, [12, 14, 15, 0]), 15);
    // And so at the peak.
    assert_eq!(f(&keys, [16, 16, 15, 0]), 15);
    assert_eq!(f(&keys, [0, 14, 15, 0]), 0);
}

#[test]
fn patent_arithmetic() {
    let keys = Keys { arithmetic: Kind::Patent, scheme: Scheme::Direct, ..small() };
    // Sines at 12.5/16 and 14.5/16: 0.6242 and 0.4227, or 10/16 and 7/16. Register 11: 168/256 →
    // 10/16; register 12: 70/256 → 4/16.
    // dγ positive, n = 4: 10 + ¬4 = 10 + 11 = 21 → 5; 5·2 = 10; 10 + 1 = 11; 121/256 → 7/16.
    assert_eq!(f(&keys, [12, 14, 4, 0]), 7);
    // dγ negative: 10 + (4 − 1) + 1 = 14; 28 → 12; 13; 169/256 → 10/16. n = 5 loses its low bit.
    assert_eq!(f(&keys, [12, 14, 4, 1]), 10);
    assert_eq!(f(&keys, [12, 14, 5, 1]), 10);
}

/// c = 12/16, cd = 14/16, n = 4, dγ negative, red 15; all written, together with start.
const START: [u64; 16] = [1, 1, 12, 1, 14, 1, 4, 1, 1, 1, 15, 1, 0, 1, 0, 1];

/// One point followed through the patent's ten words; the writes of the clock of `start` count, those
/// while busy do not.
#[test]
fn a_point_clock_by_clock() {
    let mut model = clocked(small());
    let names = ["reg19_sin_gamma", "reg11_cos_cos", "reg12_sin_sin", "reg13_result", "valid"];
    let expected = [
        [0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0],
        [43, 42, 0, 0, 0],
        [43, 42, 0, 0, 0],
        [43, 42, 20, 0, 0],
        [43, 42, 20, 0, 0],
        // −1 in five bits.
        [43, 42, 20, 31, 0],
        [43, 42, 20, 31, 0],
        [43, 42, 20, 14, 1],
        [43, 42, 20, 14, 0],
    ];
    let late = [1, 0, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1];
    assert_eq!(watch(&mut model, names, &START, &late), expected);
    // 14/16 · 15 = 13.125.
    let names = ["run", "word_address", "red_out", "cos_gamma_reg"];
    assert_eq!(names.map(|name| model.value(name).unwrap()), [0, 0, 13, 12]);
}

/// A reset in word 5 ends the point, but the word's transfer still takes place.
#[test]
fn a_reset_stops_the_words_alone() {
    let mut model = clocked(small());
    let mut inputs = [0; 16];
    inputs[0] = 1;
    let _: [[u64; 1]; 5] = watch(&mut model, ["run"], &START, &inputs);
    inputs[..2].copy_from_slice(&[0, 1]);
    model.clock(&inputs);
    let names = ["run", "word_address", "reg13_result", "exponent_reg"];
    assert_eq!(names.map(|name| model.value(name).unwrap()), [0, 0, 31, 4]);
}

/// The bound is that of every operand, one by one: never below the largest error, and where the search has found that, it.
#[test]
fn the_bound_is_the_largest_error_of_all_operands() {
    let mut wide = Keys {
        product_fraction: 12,
        segments: vec![4, 3],
        slope_fraction: 10,
        sine_fraction: 12,
        domain: Domain { least: 1, most: 30 },
        ..small()
    };
    wide.operands.cosine.fraction = 8;
    wide.f.fraction = 10;
    let rounding = Rounding::Nearest;
    let f = Intensity { rounding, ..wide.f.clone() };
    let all = [
        Keys { product_rounding: rounding, f, ..wide.clone() },
        Keys { scheme: Scheme::Direct, address: 7, ..wide.clone() },
        Keys { deviation: 90.0, domain: Domain { least: 3, most: 9 }, ..wide.clone() },
        Keys { sine_fraction: 9, product_fraction: 16, ..wide.clone() },
        Keys { clamp: false, ..wide.clone() },
        wide,
    ];
    let mut met = 0;
    for keys in all {
        let it = Arithmetic::new(keys.clone());
        let (lowest, one) = (keys.cos_dgamma_domain().0, keys.largest_cosine());
        let mut largest = 0.0_f64;
        for (x, y) in (0..=one).flat_map(|x| (lowest..=one).map(move |y| (x, y))) {
            for n in keys.domain.least..=keys.domain.most {
                for negative in [0, 1] {
                    let control = [x, y, n, negative];
                    let f = it.f(&control) as f64 / 1024.0;
                    largest = largest.max((f - it.reference(&control)).abs());
                }
            }
        }
        let bound: f64 = it.shares().iter().map(|share| share.2).sum();
        assert!(bound >= largest, "{bound} is below {largest}");
        met += usize::from(bound < largest + 2e-9);
    }
    assert!(met >= 3, "{met}");
}

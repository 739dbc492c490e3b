//! `blinn` and `gauss` worked by hand in words of a few bits.

use super::*;
use crate::golden::highlight::Reflectance;
use crate::keys::common::{Domain, Intensity, Operands};

/// C = 4, S = 6 with one range and a tail; y with 1 + 2 fraction bits; F = 6.
fn small(function: Function) -> Arithmetic {
    let f = Intensity { fraction: 6, ..Intensity::small() };
    let keys = Keys {
        operands: Operands::small(),
        decay_fraction: 6,
        segments: vec![2],
        tail: 0,
        slope_fraction: 6,
        coarse_fraction: 4,
        address: 1,
        offset_bits: vec![2],
        offset_address: vec![0],
        fraction: 6,
        synchronous: true,
        f,
        domain: Domain::small(),
    };
    Arithmetic::new(Params { function, keys })
}

#[test]
fn words_by_hand() {
    let it = small(Function::Logarithm);
    // c = 14/16: u = 7 − 6 = 1, of three bits. In 1/64 −log₂(1 − (u + 1)/16) for u = 0 … 7 is 5.96, 12.33, 19.17,
    // 26.56, 34.60, 43.40, 53.13, 64. Tail u = 0, 1 (to 2): slope 13.21 → 13, 6.5 a step; above: 5.96, 5.83:
    // 5.89 + 0.5 → 6. u = 1: 6 + 6.
    assert_eq!(it.operand(14), (0, 1));
    assert_eq!(it.decay(14), 12);
    // c = 5/16 is 10/16 in octave 1: u = 7 − 2 = 5; segment u = 4, 5 (to 6): slope 18.53 → 19, 9.5 a
    // step; above: 34.60, 33.90: 34.25 + 0.5 → 35; 35 + 9 = 44.
    assert_eq!(it.operand(5), (1, 5));
    assert_eq!(it.decay(5), 44);
    // Small: 12·3 = 36/64 → 4/8. Not small: octave 1 before 44/64 → 11/16: 27·3/16 → 40/8.
    assert_eq!(it.halvings(14, 12, 3), 4);
    assert_eq!(it.halvings(5, 44, 3), 40);
    // Not small in octave 0: 26 → 6/16; 15 times that 45/8. Saturation at 16 − 1/8.
    assert_eq!(it.halvings(12, 26, 15), 45);
    assert_eq!(it.halvings(1, 0, 15), 127);
}

#[test]
fn f_by_hand() {
    let contract = small(Function::Logarithm);
    let f = |cosine, exponent| contract.f(&[cosine, exponent]);
    // 2^−½ by the tables that `halving.rs` works out: bend −2, chord 44/64; 46. In f64 42.9.
    assert_eq!(f(14, 3), 46);
    // 2^−5 of what x = 0 gives, 62/64: 1.
    assert_eq!(f(5, 3), 1);
    // The ends: c ≤ 0; c ≥ 1.0; n = 0.
    assert_eq!([f(0, 0), f(-3, 1), f(0, 15)], [0, 0, 0]);
    assert_eq!([f(16, 15), f(31, 15), f(1, 0)], [63, 63, 63]);
}

#[test]
fn gauss_by_hand() {
    let it = small(Function::Angle);
    // γ²/(4 ln 2) in 1/64 for u = 0, 1, … is 2.92, 5.90, 8.94, 12.04, 15.21: tail u = 0 … 3 (to 4): slope
    // 12.29 → 12, 3 a step; above: 2.92, 2.90, 2.94, 3.04: 2.97 + 0.5 → 3.
    assert_eq!(it.operand(14), (0, 1));
    assert_eq!(it.decay(14), 6);
    // Twice 6·5/64 → 7/8.
    assert_eq!(it.halvings(14, 6, 5), 7);
    assert_eq!(it.reflectance(16, 0), 63);
    assert_eq!(it.reflectance(0, 0), 0);
}

/// One point clock by clock: words 0 to 5, and idle.
#[test]
fn a_point_clock_by_clock() {
    let mut model = clocked(small(Function::Logarithm));
    // c = 14/16, n = 3, red 15, written together with start.
    model.clock(&[1, 1, 14, 1, 3, 1, 15, 1, 0, 0, 0, 0]);
    let names = ["run", "word_address", "decay", "halvings", "reflectance", "valid", "done"];
    let expected = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 2, 12, 0, 0, 0, 0],
        [1, 3, 12, 4, 0, 0, 0],
        [1, 4, 12, 4, 0, 0, 0],
        [1, 5, 12, 4, 46, 1, 1],
        [0, 0, 12, 4, 46, 0, 0],
    ];
    for row in expected {
        assert_eq!(names.map(|name| model.value(name).unwrap()), row);
        // Writes while busy change nothing.
        let late = row[0];
        model.clock(&[1, 0, 1, late, 1, late, 1, late, 0, 0, 0, 0]);
    }
    // 46/64·15 = 10.8.
    assert_eq!(model.value("red_out").unwrap(), 11);
    assert_eq!(model.value("f_out").unwrap(), 46);
    assert_eq!(model.value("cos_gamma_reg").unwrap(), 14);
}

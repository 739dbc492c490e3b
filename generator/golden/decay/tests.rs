//! `blinn` and `gauss` worked by hand in words of a few bits.

use super::*;
use glint_keys::common::{Domain, Intensity, Operands};

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

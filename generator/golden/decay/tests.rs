//! Compares the golden models of `blinn` and `gauss` with values worked out by hand, in words of a few bits.

use super::*;
use glint_keys::common::{Domain, Intensity, Operands};

/// Cosines have 4 fraction bits, ratio, decay and f have 6, and n·decay has 2.
fn small(of: Decay) -> DecayArithmetic {
    let f = Intensity { fraction: 6, ..Intensity::small() };
    let degree = || "auto".to_owned();
    let keys = Keys {
        operands: Operands::small(),
        ratio_fraction: 6,
        ratio_degree: degree(),
        decay_fraction: 6,
        coarse_fraction: 4,
        argument: 2,
        fraction: 6,
        degree: degree(),
        f,
        domain: Domain::small(),
    };
    DecayArithmetic::new(of, keys)
}

#[test]
fn words_by_hand() {
    let it = small(Decay::Logarithm);
    // c = 14/16: u = 7 − 6 = 1, of three bits. c = 5/16 is 10/16 in octave 1: u = 7 − 2 = 5.
    assert_eq!((it.operand(14), it.operand(5)), ((0, 1), (1, 5)));
    // −log₂(14/16) is 0.19265, of 2/16 that is 1.5412: 98.6 in 1/64. 2·99/16 = 12 in 1/64, below ¼.
    assert_eq!(it.factor(0, 2, 99), (12, true));
    // −log₂(10/16) is 0.67807, of 6/16 that is 1.8082: 115.7. 6·116/16 = 43; octave 1 before 43/64 → 10/16.
    assert_eq!(it.factor(1, 6, 116), (26, false));
    // Three times 12/64 → 2/4, three times 26/16 → 19/4.
    assert_eq!((it.halvings((12, true), 3), it.halvings((26, false), 3)), (2, 19));
    // 2^−¼ is 53.8 in 1/64; shifted by 2: 13. All is shifted out from y = 7 on.
    assert_eq!(it.reflectance(14, 2 << 2 | 1, 54), 13);
    assert_eq!(it.reflectance(14, 7 << 2, 64), 0);
    // At the ends. A result that would round to 1.0 is an ulp below it.
    assert_eq!([16, 0].map(|cosine| it.reflectance(cosine, 0, 54)), [63, 0]);
    assert_eq!(it.reflectance(14, 0, 64), 63);
}

#[test]
fn tables_are_near_what_they_stand_for() {
    for (of, decay) in [
        (Decay::Logarithm, (|c| -libm::log2(c)) as fn(f64) -> f64),
        (Decay::Angle, |c| libm::acos(c).powi(2) / (2.0 * LN_2)),
    ] {
        let it = small(of);
        for u in 0..1i64 << it.keys.distance(of) {
            let v = (u + 1) as f64 / 16.0;
            let exact = decay(1.0 - v) / v * 64.0;
            assert!((it.ratio.result(u) as f64 - exact).abs() < 1.0, "{of:?} {u}");
        }
    }
    // The table of 2^−x holds the value at each quarter's middle: at 1/8, 3/8, 5/8 and 7/8.
    let it = small(Decay::Angle);
    for x in 0..4 {
        let exact = libm::exp2(-(x as f64 + 0.5) / 4.0) * 64.0;
        assert!((it.power.result(x) as f64 - exact).abs() < 1.0, "{x}");
    }
}

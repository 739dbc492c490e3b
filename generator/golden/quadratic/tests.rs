//! Values worked out by hand.

use super::*;
use crate::base::fixed::Rounding;
use crate::golden::watch;
use crate::keys::common::{Domain, Intensity, Operands};

/// C = 4, D = 6, F = 4, K = 4, small enough to follow by hand.
fn small(scheme: Scheme, multipliers: u32) -> Arithmetic {
    let mut operands = Operands::small();
    operands.colours.multipliers = multipliers;
    Arithmetic::new(Keys {
        scheme,
        fraction: 2,
        operands,
        difference_fraction: 6,
        difference_rounding: Rounding::Truncate,
        f: Intensity::small(),
        domain: Domain::small(),
    })
}

#[test]
fn points_by_hand() {
    let contract = small(Scheme::Taylor, 3);
    let f = |cosine, n| contract.f(&[cosine, n]);
    // n = 1 and n = 0: f = c.
    assert_eq!((f(14, 1), f(14, 0)), (14, 14));
    // n = 2: c². 196/256 − 14/16 = −28/256 = −7/64; 56/64 − 7/64 = 49/64 → 12/16.
    assert_eq!(f(14, 2), 12);
    // c = 13/16: 169/256 − 208/256 = −39/256 → −10/64; 52 − 10 = 42/64 → 10/16.
    assert_eq!(f(13, 2), 10);
    // n = 5: 56/64 − 28/64 → 7/16. n = 9: 0. n = 10: below.
    assert_eq!((f(14, 5), f(14, 9), f(14, 10)), (7, 0, 0));
    // The ends, and what is above 1.0 at the port.
    assert_eq!((f(16, 15), f(31, 1), f(0, 1)), (15, 15, 0));
}

#[test]
fn minimax_words_by_hand() {
    let contract = small(Scheme::Minimax, 3);
    // n = 3: the errors are equal, 0.0424, at a = 1.535; six quarters.
    assert_eq!(contract.words[..4], [0, 0, 4, 6]);
    // c = 14/16: 56/64 − 1.5·7/64 = 45.5/64 → 11/16.
    assert_eq!(contract.f(&[14, 3]), 11);
}

/// The table makes both errors equal: on a grid, no larger and no smaller coefficient does better.
#[test]
fn the_table_is_minimax() {
    let table = coefficient::table(Scheme::Minimax, 4096);
    for n in [3, 5, 16, 250, 1000, 4095] {
        let a = table[n];
        let error = |a: f64| {
            (0..=100_000)
                .map(|step| {
                    let c = 1.0 - f64::from(step) * 1e-5 * (8.0 / n as f64).min(1.0);
                    let parabola = (c + a * (c * c - c)).max(0.0);
                    (parabola - libm::pow(c, n as f64)).abs()
                })
                .fold(0.0, f64::max)
        };
        let own = error(a);
        assert!(error(a * 1.0005) > own && error(a * 0.9995) > own, "n = {n}, a = {a}");
    }
}

/// One point followed clock by clock: words 0, 1, 2, 3 and idle.
#[test]
fn a_point_clock_by_clock() {
    let mut model = clocked(small(Scheme::Taylor, 3));
    // c = 14/16, n = 5, red 15, written together with start.
    let first = [1, 1, 14, 1, 5, 1, 15, 1, 0, 0, 0, 0];
    // Writes while busy change nothing.
    let then = [1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0];
    let names = ["run", "word_address", "difference", "intensity", "valid", "done"];
    let expected = [
        [1, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0],
        // −7/64 in five bits.
        [1, 2, 25, 0, 0, 0],
        [1, 3, 25, 7, 1, 1],
    ];
    assert_eq!(watch(&mut model, names, &first, &then), expected);
    // 7/16 of 15 units.
    assert_eq!(model.value("red_out").unwrap(), 7);
}

/// One multiplier for all colours takes three microinstructions more for the same point, and its outputs hold.
#[test]
fn colours_in_turn_clock_by_clock() {
    let mut model = clocked(small(Scheme::Taylor, 1));
    // As above, with green 9 and blue 4.
    let first = [1, 1, 14, 1, 5, 1, 15, 1, 9, 1, 4, 1];
    // The last of these writes come when it is idle again, and change no output.
    let then = [1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1];
    let names = ["run", "word_address", "intensity", "red_out", "green_out", "blue_out", "valid"];
    let expected = [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [1, 2, 0, 0, 0, 0, 0],
        [1, 3, 7, 0, 0, 0, 0],
        // 7/16 of 15, of 9 and of 4: 6.6, 3.9 and 1.8 units.
        [1, 4, 7, 7, 0, 0, 0],
        [1, 5, 7, 7, 4, 0, 0],
        [1, 6, 7, 7, 4, 2, 1],
        [0, 0, 7, 7, 4, 2, 0],
        [0, 0, 7, 7, 4, 2, 0],
    ];
    assert_eq!(watch(&mut model, names, &first, &then), expected);
    assert_eq!(model.value("red_reg").unwrap(), 1);
}

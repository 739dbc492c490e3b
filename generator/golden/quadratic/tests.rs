//! Compares the table a(n) of `quadratic` with values worked out by hand, and tests that it is minimax.

use super::*;
use glint_base::fixed::Rounding;
use glint_keys::common::{Domain, Intensity, Operands};

#[test]
fn minimax_words_by_hand() {
    let contract = QuadraticArithmetic::new(Keys {
        scheme: Scheme::Minimax,
        fraction: 2,
        operands: Operands::small(),
        difference_fraction: 6,
        difference_rounding: Rounding::Truncate,
        f: Intensity::small(),
        domain: Domain::small(),
    });
    // n = 3: the errors are equal, 0.0424, at a = 1.535; six quarters.
    assert_eq!(contract.words[..4], [0, 0, 4, 6]);
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

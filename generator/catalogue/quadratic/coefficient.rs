//! Computes the coefficients a(n) of the device `quadratic`, with which `max(0, c + a·(c² − c))` approximates `cⁿ`
//! ([symbols](crate#symbols)).
//!
//! With x = 1 − c the parabola is `(1 − x)·(1 − a·x)`, with a zero at x = 1/a. For 1 < a < n − 1 the parabola lies above cⁿ near
//! the peak c = 1. The error is largest where both curves have the same slope. Farther from the peak the parabola lies below cⁿ,
//! and the error is largest at the zero. For n ≤ 2 the parabola with a = n − 1 (0 for n = 0) is used.

/// Returns n − 1, with which the parabola and cⁿ have the same value and slope at c = 1, or 0 for n = 0.
pub fn taylor(n: u32) -> f64 {
    f64::from(n.max(1) - 1)
}

/// Returns the coefficient with the smallest maximum error over 0 ≤ c ≤ 1: its largest errors above and below cⁿ are equal. For n
/// ≤ 2 it is the coefficient of [`taylor`].
///
/// For each x there is one coefficient with which the slopes agree at x. The function bisects x until the two errors are equal.
pub fn minimax(n: u32) -> f64 {
    // The parabola is cⁿ itself for n = 1 and n = 2.
    if n <= 2 {
        return taylor(n);
    }
    let exponent = f64::from(n);
    // At x = 0 the coefficient is n − 1. At the upper end of x it is 0.
    let (mut low, mut high) = (0.0, -libm::expm1(-libm::log(exponent) / (exponent - 1.0)));
    loop {
        let x = (low + high) / 2.0;
        if x <= low || x >= high {
            return touching(exponent, x);
        }
        let a = touching(exponent, x);
        let above = (1.0 - x) * (1.0 - a * x) - libm::exp(exponent * libm::log1p(-x));
        if above < error(a, n) {
            low = x;
        } else {
            high = x;
        }
    }
}

/// Returns the coefficient whose parabola has the same slope as cⁿ at c = 1 − x.
fn touching(n: f64, x: f64) -> f64 {
    (n * libm::exp((n - 1.0) * libm::log1p(-x)) - 1.0) / (1.0 - 2.0 * x)
}

/// Returns the error of the parabola with the coefficient `a` at its zero, which is the value of cⁿ there. This is the largest
/// error below cⁿ, and for the coefficients of [`taylor`] and [`minimax`] the largest error of all. For n ≤ 2 these coefficients
/// make no error, and for a ≤ 1 the zero is not within 0 < c < 1. Both cases give 0.
pub fn error(a: f64, n: u32) -> f64 {
    if n <= 2 || a <= 1.0 { 0.0 } else { libm::exp(f64::from(n) * libm::log1p(-1.0 / a)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The grid of x is fine where cⁿ is large.
    fn on_a_grid(a: f64, n: u32) -> f64 {
        (1..20_000)
            .map(|step| {
                let x = f64::from(step) / 20_000.0 * (8.0 / f64::from(n)).min(1.0);
                let parabola = ((1.0 - x) * (1.0 - a * x)).max(0.0);
                let parabola = if a * x > 1.0 { 0.0 } else { parabola };
                (parabola - libm::pow(1.0 - x, f64::from(n))).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn no_other_coefficient_is_better() {
        for n in [3, 4, 7, 20, 100, 1000, 4095] {
            let a = minimax(n);
            let own = on_a_grid(a, n);
            assert!((own - error(a, n)).abs() < 1e-5, "n = {n}: {own}");
            for other in [a * 0.999, a * 1.001, taylor(n)] {
                assert!(on_a_grid(other, n) > own, "n = {n}: {other} beats {a}");
            }
        }
    }

    #[test]
    fn the_error_of_taylor_by_hand() {
        assert_eq!([0, 1, 2, 3].map(taylor), [0.0, 0.0, 1.0, 2.0]);
        // n = 3: zero at c = 1/2, where c³ is 1/8.
        assert!((error(2.0, 3) - 0.125).abs() < 1e-15);
        assert!((on_a_grid(2.0, 3) - 0.125).abs() < 1e-4);
        assert_eq!([1, 2].map(minimax), [0.0, 1.0]);
    }
}

//! Computes the coefficients a(n) of the device `quadratic` (its table ROM(n)), independently of the hardware description.
//!
//! The device computes c + a·(c² − c), a parabola in c = cos γ that approximates cⁿ. With x = 1 − c, the parabola exceeds cⁿ by
//! `h(x) = (1 − x)·(1 − a·x) − (1 − x)ⁿ` up to its zero at x = 1/a. Beyond the zero the result is 0 and cⁿ exceeds it. The
//! minimax a makes the maximum of h equal to the error at the zero, (1 − 1/a)ⁿ.

use glint_keys::quadratic::Scheme;

/// Returns the exact a(n) for n = 0 … `count` − 1: n − 1 for the scheme `taylor`, and the minimax coefficient for `minimax`.
/// The entry for n = 0 is 0, as for n = 1.
pub fn table(scheme: Scheme, count: u32) -> Vec<f64> {
    (0..count)
        .map(|n| match scheme {
            Scheme::Minimax if n > 2 => minimax(f64::from(n)),
            _ => f64::from(n.max(1) - 1),
        })
        .collect()
}

/// Returns the minimax a(n) for n > 2, by Newton's iteration. The iteration makes the maximum of h equal to the error at the
/// zero.
fn minimax(n: f64) -> f64 {
    // For large n the solution of 1 + α·ln α − α = exp(−1/α) is a/n.
    let mut a = 0.513 * (n - 1.0) + 0.5;
    for _ in 0..40 {
        let x = summit(n, a);
        let above = (1.0 - x) * (1.0 - a * x) - libm::exp(n * libm::log1p(-x));
        let below = libm::exp(n * libm::log1p(-1.0 / a));
        // At its largest value h has the slope 0 in x, so a change of a changes h only directly, by −x·(1 − x).
        let slope = -x * (1.0 - x) - below * n / (a * (a - 1.0));
        let step = (above - below) / slope;
        a -= step;
        if step.abs() < 1e-14 * a {
            break;
        }
    }
    a
}

/// Returns the x at which h is largest, by Newton's iteration from x = 0.
fn summit(n: f64, a: f64) -> f64 {
    let mut x = 0.0;
    for _ in 0..60 {
        let power = n * libm::exp((n - 2.0) * libm::log1p(-x));
        let (slope, bend) =
            (power * (1.0 - x) - (1.0 + a) + 2.0 * a * x, 2.0 * a - power * (n - 1.0));
        let step = slope / bend;
        x -= step;
        if step.abs() <= 1e-16 * x {
            break;
        }
    }
    x
}

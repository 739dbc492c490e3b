//! Builds the last step of the computation of 2^−y with y ≥ 0: a shift to the right.
//!
//! The device computes 2^−x first, where x is the fraction of y. [`halved`] then shifts 2^−x to the right by the integer
//! part of y, and rounds the result. For example, 2^−2.5 is 2^−0.5, shifted to the right by two bits.

use super::shift;
use crate::dsl::{Designer, Signal};
use glint_base::fixed::{Format, Overflow, Rounding};

/// Returns `power · 2^−halvings` in the format `u0.F` with F = `frac`. `power` = 0.75 and `halvings` = 2 give 0.1875. A
/// result that rounds to 1.0 becomes the largest fraction, 1 − 2^−F. `power` must be at most 1.0, and `halvings` an
/// unsigned integer.
#[track_caller]
pub fn halved<'d>(
    d: &'d Designer,
    name: &str,
    power: Signal<'d>,
    halvings: Signal<'d>,
    frac: i32,
    rounding: Rounding,
) -> Signal<'d> {
    // Lower bits of `power` do not affect the result. Rounding to nearest depends on one bit more than the result has.
    let kept = match rounding {
        Rounding::Truncate => frac,
        Rounding::Nearest => frac + 1,
    };
    let format = Format::unsigned(power.format().int, kept);
    let kept =
        d.narrow(&format!("{name}_kept"), power, format, Rounding::Truncate, Overflow::Saturate);
    let shifted = shift::right_by(d, &format!("{name}_shift"), kept, halvings);
    let format = Format::unsigned(0, frac);
    d.narrow(&format!("{name}_rounded"), shifted, format, rounding, Overflow::Saturate)
}

//! Writes constants of formulas as fixed-point numbers.

use glint_formula::{Expression, RBig};

/// The largest number of fraction bits that a constant may have to count as exact.
const MOST_CONSTANT_BITS: u32 = 18;

/// Returns a constant as a raw value and its number of fraction bits, if it is exact with at most 18 fraction bits and 32 bits
/// in all. For example, `3/4` gives (3, 2). Returns `None` otherwise.
pub(super) fn dyadic(part: &Expression) -> Option<(i128, i32)> {
    let value = part.rational()?;
    for frac in 0..=MOST_CONSTANT_BITS {
        let scaled = value.clone() * RBig::from(1u64 << frac);
        if scaled.is_int() {
            let raw = i64::try_from(scaled.numerator().clone()).ok()?;
            return (raw.unsigned_abs() < 1 << 32).then_some((raw.into(), frac as i32));
        }
    }
    None
}

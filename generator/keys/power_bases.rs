//! Refuses powers with a constant base of 0 or less and an exponent that varies. Such a power has no value for many exponents:
//! `0^x` for x below 0, and `(-2)^x` for an x that is no integer.

use glint_base::config_error::ConfigError;
use glint_formula::{Expression, Kind, Operator};

/// Checks the powers of a formula whose exponents vary. `key` is the configuration key for errors.
///
/// # Errors
/// Fails if the base of such a power is a constant that is not above 0.
pub(super) fn check(formula: &Expression, key: &str) -> Result<(), ConfigError> {
    let mut wrong = None;
    formula.walk(&mut |part| {
        let Kind::Binary(Operator::Power, base, exponent) = &part.kind else { return };
        if base.varies() || !exponent.varies() {
            return;
        }
        if base.enclose(&[]).is_ok_and(|base| base.high <= 0.0) {
            wrong.get_or_insert(part);
        }
    });
    let Some(part) = wrong else { return Ok(()) };
    let message = "the base of this power is not above 0, and its exponent varies";
    let remedy = "write a base above 0. The sign of (-1)^n is `1 - 2 * (n % 2)`, and 0^x is 0 for every x above 0";
    Err(ConfigError::new(key, message, remedy).at(part.span.bytes.clone()))
}

//! Reading a configuration's values in the types that the models want.

use crate::base::fixed::Rounding;
use crate::config::Config;

/// A number of bits.
///
/// # Panics
/// If the value is negative or no integer: the schema of the device allows neither.
pub fn bits(config: &Config, key: &str) -> u32 {
    u32::try_from(config.integer(key)).expect("a number of bits")
}

/// `"truncate"` or `"nearest"`.
pub fn rounding(config: &Config, key: &str) -> Rounding {
    match config.choice(key) {
        "nearest" => Rounding::Nearest,
        _ => Rounding::Truncate,
    }
}

/// `colour.multipliers`: whether one multiplier makes the products with the colours, one after the other.
pub fn colours_in_turn(config: &Config) -> bool {
    config.choice("colour.multipliers") == "1"
}

/// `domain.exponent_min` and `domain.exponent_max`.
pub fn exponents(config: &Config) -> (i64, i64) {
    (config.integer("domain.exponent_min"), config.integer("domain.exponent_max"))
}

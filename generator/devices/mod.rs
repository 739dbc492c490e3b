//! The devices of the seeds: one file each, with its keys and its description and nothing else.

mod common;
pub mod cosine_power;
pub mod lyon;
pub mod quadratic;
pub mod rough;
pub mod threshold;

use crate::config::Config;
use crate::fixed::Rounding;

/// The rounding that a key chooses.
fn rounding(config: &Config, key: &str) -> Rounding {
    match config.choice(key) {
        "nearest" => Rounding::Nearest,
        _ => Rounding::Truncate,
    }
}

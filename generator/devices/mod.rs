//! The devices of the seeds: one file each, with its keys and its description and nothing else.

pub mod blinn;
mod common;
pub mod cosine_power;
pub mod cosine_squared;
mod decay;
pub mod gauss;
pub mod quad_cosine;
pub mod rough;

use crate::config::Config;
use crate::fixed::Rounding;

/// The rounding that a key chooses.
fn rounding(config: &Config, key: &str) -> Rounding {
    match config.choice(key) {
        "nearest" => Rounding::Nearest,
        _ => Rounding::Truncate,
    }
}

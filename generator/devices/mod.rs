//! The devices of the seeds: one file each, with its keys and its description and nothing else.

pub mod blinn;
mod common;
pub mod cosine_power;
pub mod cosine_squared;
mod decay;
pub mod gauss;
pub mod lyon;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
pub mod schlick;
pub mod threshold;

use crate::base::fixed::Rounding;
use crate::config::Config;

/// The rounding that a key chooses.
fn rounding(config: &Config, key: &str) -> Rounding {
    match config.choice(key) {
        "nearest" => Rounding::Nearest,
        _ => Rounding::Truncate,
    }
}

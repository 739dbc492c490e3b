//! Declares the configuration keys of the device `gauss`, which computes exp(−n·γ²/2) with the specular exponent n. The module
//! `decay` declares and checks the keys, the same as for `blinn`, because the result is 2^(−n·decay) with the decay γ²/(2 ln 2).

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

pub fn schema() -> Schema {
    decay::schema("gauss", |config, problems| decay::check(config, Decay::Angle, problems))
}

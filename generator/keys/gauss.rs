//! Declares the configuration keys of the device `gauss`, which computes exp(−n·γ²/2) with the specular exponent n. The keys are
//! the same as for `blinn`, and the module `decay` declares them. The module also checks the keys, for the decay γ²/(2 ln 2),
//! because the result is 2^(−n·decay).

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the schema of the device `gauss`: its configuration keys, and the check of their combinations.
pub fn schema() -> Schema {
    decay::schema("gauss", |config, problems| decay::check(config, Decay::Angle, problems))
}

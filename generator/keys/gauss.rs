//! Declares the configuration keys of the device `gauss`, which computes exp(−n·γ²/2). They are the keys of [`super::decay`],
//! checked for the decay γ²/(2 ln 2).

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the schema of the device `gauss`: its configuration keys, and the check of their combinations.
pub fn schema() -> Schema {
    decay::schema("gauss", |config, problems| decay::check(config, Decay::Angle, problems))
}

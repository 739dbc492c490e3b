//! Declares the configuration keys of `blinn`: those of [`super::decay`], checked for its decay −log₂ c.

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the keys of the device.
pub fn schema() -> Schema {
    decay::schema("blinn", |config, problems| decay::check(config, Decay::Logarithm, problems))
}

//! Declares the configuration keys of `blinn`: the keys of [`super::decay`], checked for the decay −log₂ c of this device.

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the keys of the device.
pub fn schema() -> Schema {
    decay::schema("blinn", |config, problems| decay::check(config, Decay::Logarithm, problems))
}

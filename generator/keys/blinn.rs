//! Declares the configuration keys of the device `blinn`, which computes cⁿ with c = cos γ. They are the keys of
//! [`super::decay`], checked for the decay −log₂ c.

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the schema of the device `blinn`: its configuration keys, and the check of their combinations.
pub fn schema() -> Schema {
    decay::schema("blinn", |config, problems| decay::check(config, Decay::Logarithm, problems))
}

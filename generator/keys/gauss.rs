//! Declares the configuration keys of `gauss`: the keys of [`super::decay`], checked for the decay γ²/(2 ln 2) of this
//! device.

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the keys of the device.
pub fn schema() -> Schema {
    decay::schema("gauss", |config, problems| decay::check(config, Decay::Angle, problems))
}

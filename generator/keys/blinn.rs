//! The keys of `blinn`, which are those of [`super::decay`].

pub use super::decay::Keys;

use super::decay;
use glint_config::Schema;

/// The keys of the device.
pub fn schema() -> Schema {
    // Normalised, the top bit of the cosine is known.
    decay::schema("blinn", 19, |config, problems| decay::check(config, 1, problems))
}

//! The keys of `gauss`, which are those of [`super::decay`].

pub use super::decay::Keys;

use super::decay;
use glint_config::Schema;

/// The keys of the device.
pub fn schema() -> Schema {
    decay::schema("gauss", 24, |config, problems| decay::check(config, 0, problems))
}

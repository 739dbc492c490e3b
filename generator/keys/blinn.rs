//! Declares the configuration keys of the device `blinn`, which computes cⁿ with c = cos γ and the specular exponent n. The keys
//! are the same as for `gauss`, and the module `decay` declares them. The module also checks the keys, for the decay −log₂ c,
//! because cⁿ is 2^(−n·decay).

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

/// Returns the schema of the device `blinn`: its configuration keys, and the check of their combinations.
pub fn schema() -> Schema {
    decay::schema("blinn", |config, problems| decay::check(config, Decay::Logarithm, problems))
}

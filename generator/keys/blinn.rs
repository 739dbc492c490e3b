//! Declares the configuration keys of the device `blinn`, which computes cⁿ with c = cos γ and the specular exponent n. The
//! module `decay` declares and checks the keys, the same as for `gauss`, because cⁿ is 2^(−n·decay) with the decay −log₂ c.

pub use super::decay::Keys;

use super::decay::{self, Decay};
use glint_config::Schema;

pub fn schema() -> Schema {
    decay::schema("blinn", |config, problems| decay::check(config, Decay::Logarithm, problems))
}

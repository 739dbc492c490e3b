//! The golden model and the accuracy contract of the device `blinn`. It computes Blinn's highlight f = cⁿ, and f = 0 if c ≤ 0.
//! c is the cosine of the angle between the surface normal and the half vector, and n is the specular exponent.
//!
//! The module [`decay`] serves the devices `blinn` and `gauss`: it computes f = 2^(−n·decay). The decay of `blinn` is −log₂ c.
//! For example, c = 0.5 and n = 2 give the decay 1 and f = 0.25.

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Returns the golden model. Panics if `config` has not passed the check against the schema.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Logarithm)
}

/// Returns the accuracy contract. Panics if `config` has not passed the check against the schema.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Logarithm)
}

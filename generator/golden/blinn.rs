//! The golden model and the accuracy contract of the device `blinn`, which computes f = cⁿ, or 0 if c ≤ 0
//! ([symbols](crate#symbols)). This is Blinn's formula. The module [`decay`] computes it as 2^(−n·decay), for `blinn` and
//! `gauss`, here with the decay −log₂ c.

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Panics if the check of the schema has not accepted the configuration.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Logarithm)
}

/// Panics if the check of the schema has not accepted the configuration.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Logarithm)
}

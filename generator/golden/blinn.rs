//! The golden model and the accuracy contract of `blinn`: cⁿ itself (seeds 000–002).
//!
//! [`decay`] makes both: they compute 2^(−n·decay) with the decay −log₂ c.

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Returns the golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Logarithm)
}

/// Returns the accuracy contract.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Logarithm)
}

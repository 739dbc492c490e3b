//! The golden model and the accuracy contract of the device `gauss`. It computes f = exp(−n·γ²/2) with γ = arccos c, or 0 if c ≤
//! 0 ([symbols](crate#symbols)). The source is seed 002. The module [`decay`] computes 2^(−n·decay) for `blinn` and `gauss`; the
//! decay of `gauss` is γ²/(2 ln 2).

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Returns the golden model. Panics if `config` has not passed the check against the schema.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Angle)
}

/// Returns the accuracy contract. Panics if `config` has not passed the check against the schema.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Angle)
}

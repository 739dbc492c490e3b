//! The golden model and the accuracy contract of `gauss`: exp(−n·γ²/2) (seed 002).
//!
//! [`decay`] makes both: they compute 2^(−n·decay) with the decay γ²/(2 ln 2).

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Returns the golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Angle)
}

/// Returns the accuracy contract.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Angle)
}

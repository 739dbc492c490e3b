//! The golden model and the accuracy contract of the device `blinn`, which computes f = cⁿ.
//!
//! c = cos γ, where γ is the angle between the surface normal and the half vector; n is the specular exponent; f is the
//! reflectance, the factor by which the device multiplies colours. f is 0 if c ≤ 0. This is Blinn's formula. The module
//! [`decay`] computes it as 2^(−n·decay), for `blinn` and `gauss`. The decay of `blinn` is −log₂ c.

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Returns the golden model of the device `blinn` for a configuration. Panics if the check of the schema has not accepted the
/// configuration.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Logarithm)
}

/// Returns the accuracy contract of the device `blinn` for a configuration. Panics if the check of the schema has not accepted
/// the configuration.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Logarithm)
}

//! The golden model and the accuracy contract of the device `gauss`, which computes f = exp(−n·γ²/2).
//!
//! γ = arccos c is the angle between the surface normal and the half vector; n is the specular exponent; f is the reflectance,
//! the factor by which the device multiplies colours. The source is the paper "A model for reproducing the specular component
//! of colour in computer graphics" (in Ukrainian; Glint calls it seed 002). f is 0 if c ≤ 0. The module [`decay`] computes the
//! formula as 2^(−n·decay), for `blinn` and `gauss`. The decay of `gauss` is γ²/(2 ln 2).

use super::decay;
use super::{Contract, Model};
use glint_config::Config;
use glint_keys::decay::Decay;

/// Returns the golden model of the device `gauss` for a configuration. Panics if the check of the schema has not accepted the
/// configuration.
pub fn model(config: &Config) -> Box<dyn Model> {
    decay::model(config, Decay::Angle)
}

/// Returns the accuracy contract of the device `gauss` for a configuration. Panics if the check of the schema has not accepted
/// the configuration.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    decay::contract(config, Decay::Angle)
}

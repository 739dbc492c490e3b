//! `blinn`: cⁿ itself (seeds 000–002), by formula: 2^(−n·decay) with the decay −log₂ c.

use super::decay::{DecayContract, DecayModel, Function, Params};
use crate::config::Config;

/// The device at power-up.
///
/// # Panics
/// If the configuration is one that [`Params::check`] refuses and the device's schema does not.
pub fn model(config: &Config) -> DecayModel {
    DecayModel::from_params(&Params::from_config(config, Function::Logarithm))
        .expect("a configuration that its schema accepts")
}

/// The accuracy contract.
///
/// # Panics
/// As [`model`].
pub fn contract(config: &Config) -> DecayContract {
    DecayContract::from_params(&Params::from_config(config, Function::Logarithm))
        .expect("a configuration that its schema accepts")
}

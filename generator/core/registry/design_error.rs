//! Defines the error of a configuration from which no netlist can be built.

use std::fmt;

use glint_base::config_error::ConfigError;
use glint_base::diagnostic::Diagnostics;

#[derive(Clone, Debug)]
pub enum DesignError {
    /// Every architecture of the device has these mistakes.
    Description(Diagnostics),
    /// A pipeline cannot be made. The error names the key to change.
    Key(ConfigError),
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Description(mistakes) => mistakes.fmt(f),
            Self::Key(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for DesignError {}

impl From<Diagnostics> for DesignError {
    fn from(mistakes: Diagnostics) -> Self {
        Self::Description(mistakes)
    }
}

impl From<ConfigError> for DesignError {
    fn from(error: ConfigError) -> Self {
        Self::Key(error)
    }
}

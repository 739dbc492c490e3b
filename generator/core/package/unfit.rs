//! Defines the error of a key that asks for something that the core cannot have.

use std::fmt;

/// A key that asks for something that the core cannot have. A caller who knows the configuration file can add the line of the
/// key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unfit {
    /// The dotted name of the key.
    pub key: &'static str,
    /// The message.
    pub message: String,
    /// The remedy.
    pub remedy: String,
}

impl Unfit {
    /// Makes the error from a key, the fault, and the remedy.
    pub fn new(key: &'static str, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { key, message: message.into(), remedy: remedy.into() }
    }
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}; {}", self.key, self.message, self.remedy)
    }
}

impl std::error::Error for Unfit {}

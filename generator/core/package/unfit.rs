//! The error of a key that asks for what a core cannot have.

use std::fmt;

/// A key that asks for what the core cannot have. Whoever knows the file of the configuration can say where.
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
    /// Takes a key, what is wrong with it, and what to do about it.
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

//! What a configuration asks for around a core.

use crate::config::Config;

/// What is put around a core.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    /// A model in C, in `software/<name>/`.
    pub software: bool,
}

impl Surroundings {
    /// What the keys that every device shares say.
    pub fn new(config: &Config) -> Self {
        Self { software: config.flag("package.software") }
    }
}

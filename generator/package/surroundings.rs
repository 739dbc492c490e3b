//! What a configuration asks for around a core.

use crate::config::Config;

/// What is put around a core.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    /// The core between two AXI4-Streams.
    pub stream: bool,
    /// The width of their `tuser`.
    pub user_bits: u32,
    /// A model in C, in `software/<name>/`.
    pub software: bool,
}

impl Surroundings {
    /// What the keys that every device shares say.
    pub fn new(config: &Config) -> Self {
        Self {
            stream: config.flag("interface.stream"),
            user_bits: config.integer("interface.user_bits") as u32,
            software: config.flag("package.software"),
        }
    }
}

//! What a configuration asks for around a core.

use crate::config::Config;

/// A bus on which registers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bus {
    /// AXI4-Lite.
    AxiLite,
    /// Wishbone B4, classic cycles.
    Wishbone,
}

/// What is put around a core.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    /// The core between two AXI4-Streams.
    pub stream: bool,
    /// The width of their `tuser`.
    pub user_bits: u32,
    /// The core behind registers.
    pub registers: Option<Bus>,
    /// A model in C, in `software/<name>/`.
    pub software: bool,
}

impl Surroundings {
    /// What the keys that every device shares say.
    pub fn new(config: &Config) -> Self {
        Self {
            stream: config.flag("interface.stream"),
            user_bits: config.integer("interface.user_bits") as u32,
            registers: match config.choice("interface.registers") {
                "axi-lite" => Some(Bus::AxiLite),
                "wishbone" => Some(Bus::Wishbone),
                _ => None,
            },
            software: config.flag("package.software"),
        }
    }
}

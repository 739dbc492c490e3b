//! What a configuration asks for around a core.

use crate::config::{Config, Schema};

/// A bus on which registers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bus {
    /// AXI4-Lite.
    AxiLite,
    /// Wishbone B4, classic cycles.
    Wishbone,
}

/// What is put around a core.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// The core between two AXI4-Streams.
    pub stream: bool,
    /// The width of their `tuser`.
    pub user_bits: u32,
    /// The core behind registers.
    pub registers: Option<Bus>,
    /// A model in C, in `software/<name>/`.
    pub software: bool,
    /// ROM contents stand in the Verilog.
    pub inline_memories: bool,
    /// A module for LiteX.
    pub litex: bool,
    /// The clock of constraints, if there are any.
    pub clock_mhz: Option<f64>,
    /// Tcl for Vivado.
    pub vivado: bool,
    /// Tcl for Quartus.
    pub quartus: bool,
    /// Components of IP-XACT.
    pub ip_xact: bool,
    /// Who is said to make the core.
    pub vendor: String,
    /// Three numbers with dots between them.
    pub version: String,
    /// An SPDX expression.
    pub licence: String,
}

/// What the keys say at their defaults.
impl Default for Surroundings {
    fn default() -> Self {
        let schema = Schema { device: "", keys: Vec::new(), check: |_, _| () };
        Self::new(&Config::defaults(&schema, ""))
    }
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
            inline_memories: config.choice("package.memories") == "inline",
            litex: config.flag("package.litex"),
            clock_mhz: config
                .flag("package.constraints")
                .then(|| config.number("package.clock_mhz")),
            vivado: config.flag("package.vivado"),
            quartus: config.flag("package.quartus"),
            ip_xact: config.flag("package.ip_xact"),
            vendor: config.text("package.vendor").to_owned(),
            version: config.text("package.version").to_owned(),
            licence: config.text("package.licence").to_owned(),
        }
    }
}

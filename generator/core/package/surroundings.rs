//! Reads the configuration keys that ask for files around a core, for example bus wrappers, a C model or constraints.
//!
//! The module also checks that the core allows two of these keys, `package.clock_mhz` and `package.rom_style`.

use super::bus::{BUSES, Bus};
use super::processor::{PROCESSORS, ProcessorInterface};
use glint_base::config_error::ConfigError;
use glint_config::{Config, Schema, Shared};
use glint_rtl::netlist::{Design, Pipeline};
use glint_rtl::verilog::naming::{RomStyle, Style};

/// The default clock frequency of the constraints for a sequential core, in MHz.
const CLOCK_MHZ: f64 = 100.0;

/// The key with the clock frequency of the constraints, in MHz.
const CLOCK: &str = "package.clock_mhz";

/// The key that says whether ROMs should be in memory blocks or in look-up tables.
const ROM_STYLE: &str = "package.rom_style";

const MEMORIES: &str = "package.memories";

/// Checks that the clock of the constraint files is not faster than the clock for which the pipeline is scheduled.
///
/// # Errors
/// Fails if `package.clock_mhz` is larger than the clock of the pipeline. The error names valid values.
pub fn check_clock(config: &Config, pipeline: &Pipeline) -> Result<(), ConfigError> {
    let (asked, made_for) = (config.number(CLOCK), pipeline.clock_mhz);
    if asked <= made_for {
        return Ok(());
    }
    let (made, faster) = match config.integer("pipeline.stages") {
        0 => ("the pipeline is made for".to_owned(), format!("set pipeline.clock_mhz to {asked}")),
        stages => {
            let (plural, verb) = if stages == 1 { ("", "allows") } else { ("s", "allow") };
            let made = format!("{stages} stage{plural} {verb} on {}", pipeline.target);
            (made, "raise pipeline.stages".to_owned())
        }
    };
    let faster = if asked <= pipeline.most_mhz { format!("{faster}, or ") } else { String::new() };
    Err(ConfigError::new(
        CLOCK,
        format!("`{CLOCK}` = {asked:?} is above the {made_for} MHz that {made}"),
        format!("{faster}set {CLOCK} to {made_for} or less"),
    ))
}

/// Checks that the Verilog has a memory for the attribute that `package.rom_style` asks for.
///
/// # Errors
/// Fails if the core has no ROM that is read on the clock, or if `package.memories` writes ROMs as functions.
pub fn check_rom_style(config: &Config, design: &Design) -> Result<(), ConfigError> {
    let style = config.choice(ROM_STYLE);
    if style == "auto" {
        return Ok(());
    }
    if config.choice(MEMORIES) == "case" {
        let message = format!(
            "`{ROM_STYLE}` = \"{style}\" has no effect with package.memories = \"case\": a ROM is then a \
             Verilog function, which cannot have an attribute"
        );
        let remedy = "remove the key, or set package.memories = \"files\" or \"inline\"";
        return Err(ConfigError::new(ROM_STYLE, message, remedy));
    }
    if design.roms.iter().any(|rom| rom.synchronous) {
        return Ok(());
    }
    Err(ConfigError::new(
        ROM_STYLE,
        format!(
            "`{ROM_STYLE}` = \"{style}\" has no effect: `{}` has no ROM that is read at a clock edge",
            design.name
        ),
        "remove the key",
    ))
}

/// Checks that the Verilog can write the table of the core.
///
/// # Errors
/// Fails if the core has a table that can be written, and `package.memories` writes ROMs as functions.
pub fn check_written_memories(config: &Config, design: &Design) -> Result<(), ConfigError> {
    if design.has_write_port() && config.choice(MEMORIES) == "case" {
        let message = format!(
            "`{MEMORIES}` = \"case\" writes tables as Verilog functions, and the table of `{}` can be written",
            design.name
        );
        let remedy = "set package.memories = \"files\" or \"inline\"";
        return Err(ConfigError::new(MEMORIES, message, remedy));
    }
    Ok(())
}

/// The wrappers and packages that a configuration asks for besides the core.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    pub stream: bool,
    /// The number of bits of `tuser`, the user's own data that travel with each point on the streams.
    pub user_bits: u32,
    /// Whether the number of bits of a transfer is padded to a power of two.
    pub power_of_two: bool,
    /// Whether the streams have `tkeep`, which marks the valid bytes of a transfer.
    pub keep: bool,
    pub registers: Option<&'static Bus>,
    /// The number of results of a pipeline that can wait behind its bus registers.
    pub queue: u32,
    pub processor: Option<&'static ProcessorInterface>,
    /// Whether to emit a C model, in `software/<name>/`.
    pub software: bool,
    /// Whether to emit a C program that compares the results of every combination of operands with the formulas.
    pub recomputation: bool,
    /// How the Verilog declares memories and registers.
    pub style: Style,
    pub litex: bool,
    /// The clock frequency of the constraint files in MHz, or `None` for no constraint files.
    pub clock_mhz: Option<f64>,
    pub vivado: bool,
    pub quartus: bool,
    pub ip_xact: bool,
    pub vhdl: bool,
    pub systemverilog: bool,
    /// The vendor in the emitted packages.
    pub vendor: String,
    /// The version in the emitted packages: three numbers with dots between them.
    pub version: String,
    /// The licence as an SPDX expression.
    pub licence: String,
}

/// Gives the values of a configuration that sets no key of `interface` and `package`.
impl Default for Surroundings {
    fn default() -> Self {
        let schema = Schema { device: "", keys: Vec::new(), check: |_, _| () };
        Self::new(&Config::defaults(&schema, ""), None)
    }
}

impl Surroundings {
    /// Returns the number of results that wait behind bus registers of a pipeline. Returns `None` for a sequential core, and
    /// if one point is computed at a time.
    pub fn queue_of(&self, design: &Design) -> Option<u32> {
        (design.pipeline.is_some() && self.queue > 1).then_some(self.queue)
    }

    /// Reads the keys of the tables `interface` and `package`. The default clock of the constraint files is the clock of
    /// `pipeline`, or 100 MHz without one.
    pub fn new(config: &Config, pipeline: Option<&Pipeline>) -> Self {
        let keys = Shared::of(config);
        Self {
            stream: keys.stream,
            user_bits: keys.user_bits,
            power_of_two: keys.data_width == "power-of-two",
            keep: keys.keep,
            registers: BUSES.iter().find(|bus| bus.key == keys.registers),
            queue: keys.queue.parse().unwrap_or(1),
            processor: PROCESSORS.iter().find(|it| it.key == keys.processor),
            software: keys.software,
            recomputation: keys.recomputation,
            style: Style {
                inline: keys.memories != "files",
                case: keys.memories == "case",
                rom_style: match keys.rom_style.as_str() {
                    "block" => Some(RomStyle::Block),
                    "distributed" => Some(RomStyle::Distributed),
                    _ => None,
                },
                initial: keys.initial_values,
            },
            litex: keys.litex,
            clock_mhz: keys.constraints.then(|| {
                let made_for = pipeline.map_or(CLOCK_MHZ, |pipeline| pipeline.clock_mhz);
                Some(keys.clock_mhz).filter(|&given| given > 0.0).unwrap_or(made_for)
            }),
            vivado: keys.vivado,
            quartus: keys.quartus,
            ip_xact: keys.ip_xact,
            vhdl: keys.vhdl,
            systemverilog: keys.systemverilog,
            vendor: keys.vendor,
            version: keys.version,
            licence: keys.licence,
        }
    }
}

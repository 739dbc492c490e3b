//! Makes the register map of a core: gives each operand, each result and each status bit an address on the bus.
//!
//! The Verilog of the bus wrapper, the C header and the documentation use the same map. For example, the first operand is at
//! word 8, which is byte address 32.

use std::collections::BTreeSet;

use anyhow::{Result, bail};
use serde::Deserialize;

use super::inputs::EmitInputs;
use super::wrap::started::{WAITING, colliding_port, count_width, started};
use glint_base::config_error::ConfigError;
use glint_base::fixed::Format;
use glint_rtl::netlist::{Design, Port, Role, TABLE_ADDRESS};
use glint_rtl::verilog::text::ascii;

/// The number of bits of a register.
const WORD: u32 = 32;

/// The number of registers with constant contents, at the lowest addresses.
pub const CONSTANTS: u32 = 4;

/// The word address of the control register, the first that software can write.
pub const CONTROL: u32 = 5;

pub const INTERRUPT_ENABLE: u32 = 6;

pub const INTERRUPT_PENDING: u32 = 7;

const FIRST_OPERAND: u32 = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Access {
    /// Software can read the bits, and writes have no effect.
    Read,
    /// Software can write and read the bits.
    Write,
    /// Writing 1 triggers an action, such as a start. The bits read as 0.
    Trigger,
    /// Software can read the bits, and writing 1 to a bit clears it.
    Clear,
}

/// A field of a bus register of a core: some of its bits with a meaning of their own.
#[derive(Clone, Debug, Deserialize)]
pub struct RegisterBits {
    /// The name, in plain lower-case words.
    pub name: String,
    #[serde(default)]
    pub low: u32,
    pub width: u32,
    pub access: Access,
    #[serde(default)]
    pub reset: u64,
    /// The meaning for software, as a sentence without its full stop.
    pub doc: String,
}

/// A register of 32 bits, which software reads or writes over a bus.
#[derive(Clone, Debug, Deserialize)]
pub struct BusRegister {
    /// The name, in plain lower-case words.
    pub name: String,
    /// The address in words of 32 bits.
    #[serde(default)]
    pub place: u32,
    /// The purpose for software, as a sentence without its full stop.
    pub doc: String,
    /// The fields, from the lowest bits to the highest.
    pub bits: Vec<RegisterBits>,
}

impl BusRegister {
    /// Returns the address in bytes.
    pub fn offset(&self) -> u32 {
        4 * self.place
    }
}

/// An operand or a result in bus registers, the lowest bits first. For example, an operand of 40 bits takes two registers,
/// with 32 and 8 of its bits.
#[derive(Clone, Debug)]
pub struct PortPlacement {
    pub name: String,
    pub format: Format,
    /// For an operand, the input port that writes it.
    pub strobe: String,
    pub parts: Vec<PortBits>,
}

/// Some bits of a port in a bus register.
#[derive(Clone, Copy, Debug)]
pub struct PortBits {
    /// The address of the bus register, in words of 32 bits.
    pub place: u32,
    /// The lowest of the bits in the register.
    pub at: u32,
    /// The lowest of the bits in the port.
    pub low: u32,
    pub width: u32,
}

/// The register map of a core: the registers that software reads and writes over a bus, with their addresses.
#[derive(Clone, Debug)]
pub struct Map {
    /// The registers in the order of their addresses, which have no gaps.
    pub registers: Vec<BusRegister>,
    /// The operands in the order of the ports.
    pub operands: Vec<PortPlacement>,
    /// The ports of a writable table: the parts of a word, then the address. A write to the address writes the word into the
    /// table.
    pub table: Vec<PortPlacement>,
    /// The results in the order of the ports.
    pub results: Vec<PortPlacement>,
}

impl Map {
    /// Fails if the core computes several results after one `start`, or lacks the handshake, operands or results. Fails if two
    /// registers would have the same name, for example because an operand is called `status`, or if a port of a pipeline has the
    /// name of a signal in the module around it.
    pub fn new(core: &Design, inputs: &EmitInputs) -> Result<Self> {
        let name = core.name.as_str();
        let queue = inputs.around.queue_of(core);
        if let Some(message) = colliding_port(core, queue) {
            bail!(registers_error(
                message,
                "remove interface.registers, or rename the operand or the result with this name in the \
                 description",
            ));
        }
        let started = started(core, queue);
        let design = started.as_ref();
        let length = inputs.accuracy.as_ref().and_then(|accuracy| accuracy.length.as_ref());
        if let Some(length) = length {
            bail!(registers_error(
                format!(
                    "`{name}` computes a line of `{length}` results, which bus registers cannot hold"
                ),
                "remove interface.registers; for such a core, set interface.stream = true",
            ));
        }
        design.handshake()?;
        let mut place = FIRST_OPERAND;
        let mut operands = Vec::new();
        for port in design.inputs() {
            if let Role::Operand { strobe } = port.role {
                let strobe = design.net(strobe).name.clone();
                operands.push(placed(design, port, strobe, &mut place));
            }
        }
        let last_operand = place - 1;
        let mut table = Vec::new();
        for wanted in [Role::TableWord, Role::TableAddress] {
            for port in design.inputs().filter(|port| port.role == wanted) {
                table.push(placed(design, port, String::new(), &mut place));
            }
        }
        let results = results(design, &mut place);
        if operands.is_empty() || results.is_empty() {
            let what = if operands.is_empty() { "operand" } else { "result" };
            bail!(registers_error(
                format!("`{name}` has no {what}, so there is nothing for a bus register"),
                "remove interface.registers"
            ));
        }
        let mut registers =
            fixed(inputs, (operands.len(), results.len()), (last_operand, place - 1))?;
        if let Some(depth) = queue {
            describe_queue(&mut registers, depth);
        }
        for operand in &operands {
            registers.extend(own(operand, Access::Write, &doc(design, &operand.name)));
        }
        for port in &table {
            let doc = match port.name.as_str() {
                TABLE_ADDRESS => {
                    "The word of the table to write; a write to this register writes the word, when no computation runs"
                        .to_owned()
                }
                name => doc(design, name),
            };
            registers.extend(own(port, Access::Write, &doc));
        }
        registers.extend(of_results(&results, design));
        let map = Self { registers, operands, table, results };
        map.check(name)?;
        Ok(map)
    }

    /// Returns the ports that software writes through registers: the operands, then the ports of a writable table.
    pub fn written(&self) -> impl Iterator<Item = &PortPlacement> {
        self.operands.iter().chain(&self.table)
    }

    /// Returns the word address of the last register that software can write.
    pub fn last_written(&self) -> u32 {
        last_place(self.written())
    }

    /// Returns the word address of the last operand.
    pub fn last_operand(&self) -> u32 {
        last_place(self.operands.iter())
    }

    /// Returns the word addresses of the first and the last register of a writable table.
    pub fn table_places(&self) -> Option<(u32, u32)> {
        (!self.table.is_empty()).then(|| (self.last_operand() + 1, self.last_written()))
    }

    /// Returns the word address of the last register, which holds a result.
    pub fn last(&self) -> u32 {
        last_place(self.results.iter())
    }

    /// Returns the number of bits of a byte address: a map whose last register has word address 15 needs 6 bits.
    pub fn address_bits(&self) -> u32 {
        (4 * self.last()).ilog2() + 1
    }

    /// Checks that no two registers have the same name, by which software refers to them.
    fn check(&self, core: &str) -> Result<()> {
        let mut names = BTreeSet::new();
        for register in &self.registers {
            if !names.insert(&register.name) {
                bail!(registers_error(
                    format!("two registers of `{core}` are named `{}`", register.name),
                    "remove interface.registers, or rename the operand or the result with this name in the \
                     description",
                ));
            }
        }
        Ok(())
    }
}

fn registers_error(message: String, remedy: &str) -> ConfigError {
    ConfigError::new("interface.registers", message, remedy)
}

fn last_place<'p>(ports: impl Iterator<Item = &'p PortPlacement>) -> u32 {
    let parts = ports.flat_map(|port| &port.parts);
    parts.map(|part| part.place).max().unwrap_or_default()
}

/// Places a port in as many registers as it needs, from the word address `place` on, and advances `place` behind them.
/// `strobe` is the name of the port that writes an operand.
fn placed(design: &Design, port: &Port, strobe: String, place: &mut u32) -> PortPlacement {
    let net = design.net(port.net);
    let width = net.format.width();
    let parts: Vec<PortBits> = (0..width.div_ceil(WORD))
        .map(|number| {
            let low = number * WORD;
            PortBits { place: *place + number, at: 0, low, width: (width - low).min(WORD) }
        })
        .collect();
    *place += parts.len() as u32;
    PortPlacement { name: net.name.clone(), format: net.format, strobe, parts }
}

/// Places the results from the word address `place` on, and advances `place` behind them. If all results fit into one
/// register, each in whole bytes, they share it. For example, three colours of 8 bits are at bits 0, 8 and 16.
fn results(design: &Design, place: &mut u32) -> Vec<PortPlacement> {
    let ports: Vec<&Port> = design.outputs().filter(|port| port.role == Role::Result).collect();
    let padded = |port: &Port| design.width(port.net).next_multiple_of(8);
    if ports.iter().map(|port| padded(port)).sum::<u32>() > WORD {
        return ports.iter().map(|port| placed(design, port, String::new(), place)).collect();
    }
    let mut at = 0;
    let mut results = Vec::new();
    for port in ports {
        let net = design.net(port.net);
        let part = PortBits { place: *place, at, low: 0, width: net.format.width() };
        at += padded(port);
        results.push(PortPlacement {
            name: net.name.clone(),
            format: net.format,
            strobe: String::new(),
            parts: vec![part],
        });
    }
    *place += 1;
    results
}

#[derive(Deserialize)]
struct CommonRegisters {
    register: Vec<BusRegister>,
}

/// Returns the registers of every core. The constant registers have an identification, the version of Glint, the digest of the
/// configuration, and the numbers of `operands` and `results`. `last_operand` and `last` are word addresses.
///
/// # Errors
/// Fails if `registers.toml`, which is part of the program, is not valid.
fn fixed(
    inputs: &EmitInputs,
    (operands, results): (usize, usize),
    (last_operand, last): (u32, u32),
) -> Result<Vec<BusRegister>> {
    let [major, minor, patch] = [
        env!("CARGO_PKG_VERSION_MAJOR"),
        env!("CARGO_PKG_VERSION_MINOR"),
        env!("CARGO_PKG_VERSION_PATCH"),
    ]
    .map(|part| part.parse::<u64>().unwrap_or_default());
    let version = major << 16 | minor << 8 | patch;
    let hash = inputs.configuration.get(..8).unwrap_or_default();
    let hash = u64::from_str_radix(hash, 16).unwrap_or_default();
    let CommonRegisters { register: mut registers } =
        toml::from_str(include_str!("registers.toml"))?;
    for (place, register) in (0..).zip(&mut registers) {
        register.place = place;
        for bits in &mut register.bits {
            match (register.name.as_str(), bits.name.as_str()) {
                ("version", _) => bits.reset = version,
                ("configuration", _) => bits.reset = hash,
                (_, "operands") => bits.reset = operands as u64,
                (_, "results") => bits.reset = results as u64,
                (_, "start_word") => {
                    (bits.reset, bits.width) = (last_operand.into(), last.ilog2() + 1);
                }
                _ => {}
            }
        }
    }
    Ok(registers)
}

/// Adds the fields of a queue of results to the registers that every core has, and describes the fields that a queue changes.
/// `depth` is the largest number of results that wait.
fn describe_queue(registers: &mut [BusRegister], depth: u32) {
    for register in registers {
        match register.name.as_str() {
            "capabilities" => {
                let doc = "how many results can wait until software reads them";
                register.bits.push(bits("queue", (16, 8), Access::Read, depth.into(), doc));
            }
            "status" => {
                register.bits[0].doc = "the results of a point are under way".to_owned();
                register.bits[1].doc = "all points that were started have results".to_owned();
                let doc = "how many results wait; a read of the last result register takes one";
                let places = (8, count_width(depth));
                register.bits.push(bits(WAITING, places, Access::Read, 0, doc));
            }
            "control" => {
                register.bits[0].doc =
                    "starts a computation; an error if the queue has no room for its results"
                        .to_owned();
            }
            _ => {}
        }
    }
}

fn bits(
    name: &str,
    (low, width): (u32, u32),
    access: Access,
    reset: u64,
    doc: &str,
) -> RegisterBits {
    RegisterBits { name: name.to_owned(), low, width, access, reset, doc: doc.to_owned() }
}

fn of_results(results: &[PortPlacement], design: &Design) -> Vec<BusRegister> {
    let alone = results.len() == 1;
    let places: BTreeSet<u32> =
        results.iter().flat_map(|result| &result.parts).map(|part| part.place).collect();
    if alone || places.len() > 1 {
        let mut registers = Vec::new();
        for result in results {
            registers.extend(own(result, Access::Read, &doc(design, &result.name)));
        }
        return registers;
    }
    let mut fields = Vec::new();
    for result in results {
        let part = result.parts[0];
        let width = if result.format.signed { part.width.next_multiple_of(8) } else { part.width };
        let doc = doc(design, &result.name);
        fields.push(bits(&result.name, (part.at, width), Access::Read, 0, &doc));
    }
    vec![BusRegister {
        name: "results".to_owned(),
        place: results[0].parts[0].place,
        doc: "All results; a read waits until the computation has ended".to_owned(),
        bits: fields,
    }]
}

/// Returns the registers of a port that shares no register with another port. A port of more than 32 bits has several, named
/// `<port>_0`, `<port>_1` and so on, with the lowest bits in the first.
fn own(port: &PortPlacement, access: Access, doc: &str) -> Vec<BusRegister> {
    let mut registers = Vec::new();
    for (number, part) in port.parts.iter().enumerate() {
        let (name, doc) = match port.parts.len() {
            1 => (port.name.clone(), doc.to_owned()),
            _ => (
                format!("{}_{number}", port.name),
                format!("{doc}, bits {} to {}", part.low, part.low + part.width - 1),
            ),
        };
        // Software reads a signed result with copies of its sign bit above it, and an operand as it was written.
        let (width, raw) = match access {
            Access::Read if port.format.signed => (WORD, "raw, sign-extended"),
            _ => (part.width, "raw"),
        };
        let value = bits("value", (0, width), access, 0, raw);
        registers.push(BusRegister { name, place: part.place, doc, bits: vec![value] });
    }
    registers
}

fn doc(design: &Design, name: &str) -> String {
    let net = design.find(name).map(|id| design.net(id));
    net.map_or_else(String::new, |net| match net.doc.as_str() {
        "" => net.format.to_string(),
        doc => ascii(&format!("{}: {doc}", net.format)),
    })
}

//! Assigns bus registers to the operands, results and status bits of a core, for the Verilog and for software. For example,
//! the first operand is at word 8.

use std::collections::BTreeSet;

use anyhow::{Result, bail};
use serde::Deserialize;

use super::inputs::EmitInputs;
use glint_base::fixed::Format;
use glint_base::key_error::KeyError;
use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::text::ascii;

/// Bits of a register.
const WORD: u32 = 32;

/// The number of registers that never change. They come first.
pub const CONSTANTS: u32 = 4;

/// The first register that can be written; [`INTERRUPT_ENABLE`] and [`INTERRUPT_PENDING`] follow.
pub const CONTROL: u32 = 5;

/// Its place, in words.
pub const INTERRUPT_ENABLE: u32 = 6;

/// Its place, in words.
pub const INTERRUPT_PENDING: u32 = 7;

/// The place of the first operand, in words.
const FIRST_OPERAND: u32 = 8;

/// The access of software to bits of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Access {
    /// They can be read.
    Read,
    /// They can be written and read.
    Write,
    /// Writing 1 does something; they read as 0.
    Trigger,
    /// Writing 1 clears them.
    Clear,
}

/// Bits of a register.
#[derive(Clone, Debug, Deserialize)]
pub struct RegisterBits {
    /// Plain lower-case words.
    pub name: String,
    /// The lowest of them.
    #[serde(default)]
    pub low: u32,
    /// How many.
    pub width: u32,
    /// The access of software to them.
    pub access: Access,
    /// Their value after a reset.
    #[serde(default)]
    pub reset: u64,
    /// One sentence without its full stop.
    pub doc: String,
}

/// A register of 32 bits.
#[derive(Clone, Debug, Deserialize)]
pub struct BusRegister {
    /// Plain lower-case words.
    pub name: String,
    /// In words.
    #[serde(default)]
    pub place: u32,
    /// One sentence without its full stop.
    pub doc: String,
    /// From the lowest on.
    pub bits: Vec<RegisterBits>,
}

impl BusRegister {
    /// Returns the address offset in bytes. For example, the first operand, at place 8, has the offset 32.
    pub fn offset(&self) -> u32 {
        4 * self.place
    }
}

/// A port of the core in the registers that hold it, the lowest bits first. For example, an operand of 40 bits takes two
/// registers, the first with 32 bits and the second with 8.
#[derive(Clone, Debug)]
pub struct PortPlacement {
    /// The name of the port.
    pub name: String,
    /// Its format.
    pub format: Format,
    /// The name of the port that writes an operand.
    pub strobe: String,
    /// The parts of it.
    pub parts: Vec<PortBits>,
}

/// Bits of a port in a register.
#[derive(Clone, Copy, Debug)]
pub struct PortBits {
    /// The register, in words.
    pub place: u32,
    /// The lowest bit in the register.
    pub at: u32,
    /// The lowest bit of the port.
    pub low: u32,
    /// How many.
    pub width: u32,
}

/// The registers of a core.
#[derive(Clone, Debug)]
pub struct Map {
    /// In the order of their places, which have no gap.
    pub registers: Vec<BusRegister>,
    /// In the order of the ports.
    pub operands: Vec<PortPlacement>,
    /// In the order of the ports.
    pub results: Vec<PortPlacement>,
}

impl Map {
    /// Gives the operands, results and status bits of a core their registers.
    ///
    /// # Errors
    /// Fails if the core is no single computation of operands to results, or if names collide in the map.
    pub fn new(design: &Design, inputs: &EmitInputs) -> Result<Self> {
        let name = design.name.as_str();
        if design.pipeline.is_some() {
            bail!(registers_error(
                format!("`{name}` is a pipeline, for which a bus is too slow"),
                "remove it, or set architecture = \"sequential\"; interface.stream = true is for pipelines",
            ));
        }
        let length = inputs.accuracy.as_ref().and_then(|accuracy| accuracy.length.as_ref());
        if let Some(length) = length {
            bail!(registers_error(
                format!(
                    "`{name}` shows as many results as `{length}` says, which no register can hold"
                ),
                "remove it; interface.stream = true is for such a core",
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
        let results = results(design, &mut place);
        if operands.is_empty() || results.is_empty() {
            let what = if operands.is_empty() { "operand" } else { "result" };
            bail!(registers_error(
                format!("`{name}` has no {what} to put into a register"),
                "remove it"
            ));
        }
        let mut registers =
            fixed(inputs, (operands.len(), results.len()), (last_operand, place - 1))?;
        for operand in &operands {
            registers.extend(own(operand, Access::Write, &doc(design, &operand.name)));
        }
        registers.extend(of_results(&results, design));
        let map = Self { registers, operands, results };
        map.check(name)?;
        Ok(map)
    }

    /// Returns the place of the last operand's last register, in words.
    pub fn last_operand(&self) -> u32 {
        last_place(&self.operands)
    }

    /// Returns the place of the last register, in words, which is one of a result.
    pub fn last(&self) -> u32 {
        last_place(&self.results)
    }

    /// Returns the number of bits of an address in bytes. For example, a map whose last register has place 15 needs 6.
    pub fn address_bits(&self) -> u32 {
        (4 * self.last()).ilog2() + 1
    }

    /// Checks that no two registers have the same name: software knows registers and their bits by name.
    fn check(&self, core: &str) -> Result<()> {
        let mut names = BTreeSet::new();
        for register in &self.registers {
            if !names.insert(&register.name) {
                bail!(registers_error(
                    format!("two registers of `{core}` are named `{}`", register.name),
                    "remove it, or give the operand or the result of that name another one in the description",
                ));
            }
        }
        Ok(())
    }
}

/// Returns the error of the key that asks for registers on a bus.
fn registers_error(message: String, remedy: &str) -> KeyError {
    KeyError::new("interface.registers", message, remedy)
}

fn last_place(ports: &[PortPlacement]) -> u32 {
    let parts = ports.iter().flat_map(|port| &port.parts);
    parts.map(|part| part.place).max().unwrap_or_default()
}

/// Returns a port in registers of its own.
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

/// Returns the places of the results. All share one register, each in whole bytes, if they fit there; else each has its own.
/// For example, three colours of 8 bits share a register, from bits 0, 8 and 16 on.
fn results(design: &Design, place: &mut u32) -> Vec<PortPlacement> {
    let ports: Vec<&Port> = design.outputs().filter(|port| port.role == Role::Result).collect();
    let padded = |port: &Port| design.width(port.net).next_multiple_of(8);
    if ports.iter().map(|port| padded(port)).sum::<u32>() > WORD {
        return ports.iter().map(|port| placed(design, port, String::new(), place)).collect();
    }
    let mut at = 0;
    let together = |port: &&Port| {
        let net = design.net(port.net);
        let part = PortBits { place: *place, at, low: 0, width: net.format.width() };
        at += padded(port);
        PortPlacement {
            name: net.name.clone(),
            format: net.format,
            strobe: String::new(),
            parts: vec![part],
        }
    };
    let results = ports.iter().map(together).collect();
    *place += 1;
    results
}

/// The registers that every core has, in `registers.toml`.
#[derive(Deserialize)]
struct CommonRegisters {
    register: Vec<BusRegister>,
}

/// Returns the registers that every core has, in this one.
fn fixed(
    inputs: &EmitInputs,
    (operands, results): (usize, usize),
    (last_operand, last): (u32, u32),
) -> Result<Vec<BusRegister>> {
    let version = |part: &str| part.parse::<u64>().unwrap_or_default();
    let version = version(env!("CARGO_PKG_VERSION_MAJOR")) << 16
        | version(env!("CARGO_PKG_VERSION_MINOR")) << 8
        | version(env!("CARGO_PKG_VERSION_PATCH"));
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
        let own = |result: &PortPlacement| own(result, Access::Read, &doc(design, &result.name));
        return results.iter().flat_map(own).collect();
    }
    let of_result = |result: &PortPlacement| {
        let part = result.parts[0];
        let width = if result.format.signed { part.width.next_multiple_of(8) } else { part.width };
        bits(&result.name, (part.at, width), Access::Read, 0, &doc(design, &result.name))
    };
    vec![BusRegister {
        name: "results".to_owned(),
        place: results[0].parts[0].place,
        doc: "All results; a read waits for the computation that is under way".to_owned(),
        bits: results.iter().map(of_result).collect(),
    }]
}

/// Returns the registers of a port, which no other port has a part in.
fn own(port: &PortPlacement, access: Access, doc: &str) -> Vec<BusRegister> {
    let register = |(number, part): (usize, &PortBits)| {
        let (name, doc) = match port.parts.len() {
            1 => (port.name.clone(), doc.to_owned()),
            _ => (
                format!("{}_{number}", port.name),
                format!("{doc}, bits {} to {}", part.low, part.low + part.width - 1),
            ),
        };
        // A result is read with copies of its sign; an operand as it was written.
        let (width, raw) = match access {
            Access::Read if port.format.signed => (WORD, "raw, with copies of the sign"),
            _ => (part.width, "raw"),
        };
        let value = bits("value", (0, width), access, 0, raw);
        BusRegister { name, place: part.place, doc, bits: vec![value] }
    };
    port.parts.iter().enumerate().map(register).collect()
}

fn doc(design: &Design, name: &str) -> String {
    let net = design.find(name).map(|id| design.net(id));
    net.map_or_else(String::new, |net| match net.doc.as_str() {
        "" => net.format.to_string(),
        doc => ascii(&format!("{}: {doc}", net.format)),
    })
}

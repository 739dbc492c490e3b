//! The registers for software: a C header, a Rust module without `std`, and SystemRDL.

use anyhow::Result;
use askama::Template;

use crate::base::fixed::Format;
use crate::hdl::netlist::Design;
use crate::hdl::verilog::text::{ascii, constant_name};
use crate::package::map::{Access, Bits, Map, Register};
use crate::package::surroundings::Bus;
use crate::package::{EmitInputs, render};

/// A register as the templates print it.
struct View<'a> {
    register: &'a Register,
    /// In upper case.
    constant: String,
    fields: Vec<Field<'a>>,
}

/// Bits of a register.
struct Field<'a> {
    bits: &'a Bits,
    /// In upper case.
    constant: String,
}

impl Field<'_> {
    fn mask(&self) -> String {
        format!("0x{:08x}", ((1u64 << self.bits.width) - 1) << self.bits.low)
    }

    fn high(&self) -> u32 {
        self.bits.low + self.bits.width - 1
    }

    /// Returns the access of software and hardware, in SystemRDL.
    fn rdl(&self) -> &'static str {
        match (self.bits.access, self.bits.name.as_str()) {
            (Access::Read, _) if self.bits.reset != 0 => "sw = r; hw = na;",
            (Access::Read, _) => "sw = r; hw = w;",
            (Access::Write, _) => "sw = rw; hw = r;",
            (Access::Trigger, _) => "sw = w; hw = r; singlepulse;",
            (Access::Clear, _) => "sw = rw; hw = r; onwrite = woclr; hwset;",
        }
    }
}

/// An operand and its conversion.
struct Operand {
    name: String,
    constant: String,
    format: Format,
}

impl Operand {
    /// Returns the bits of the raw integer as the registers hold it.
    fn bits(&self) -> u32 {
        if self.format.width() <= 32 { 32 } else { 64 }
    }

    /// The smallest and the largest raw integer, as C writes 64 bits.
    fn limits(&self) -> (String, String) {
        let least = match self.format.min_raw() {
            least if least == i64::MIN.into() => "(-9223372036854775807 - 1)".to_owned(),
            least => least.to_string(),
        };
        (least, self.format.max_raw().min(i64::MAX.into()).to_string())
    }

    fn rust_limits(&self) -> (String, String) {
        let most = self.format.max_raw().min(i64::MAX.into());
        (self.format.min_raw().to_string(), most.to_string())
    }
}

#[derive(Template)]
#[template(path = "registers.h")]
struct Header<'a> {
    name: &'a str,
    title: &'a str,
    regenerate: &'a str,
    guard: &'a str,
    prefix: &'a str,
    bus: &'a str,
    registers: &'a [View<'a>],
    operands: &'a [Operand],
}

#[derive(Template)]
#[template(path = "registers.rs")]
struct Module<'a> {
    name: &'a str,
    title: &'a str,
    regenerate: &'a str,
    bus: &'a str,
    registers: &'a [View<'a>],
    operands: &'a [Operand],
}

#[derive(Template)]
#[template(path = "registers.rdl")]
struct Rdl<'a> {
    name: &'a str,
    title: &'a str,
    regenerate: &'a str,
    registers: &'a [View<'a>],
}

/// The files, pairs of a plain name and contents.
///
/// # Errors
/// A template that fails.
pub fn files(
    design: &Design,
    inputs: &EmitInputs,
    bus: Bus,
    map: &Map,
) -> Result<Vec<(String, String)>> {
    let name = design.name.as_str();
    let title = ascii(&design.about.title).replace("*/", "* /").replace('"', "'");
    let bus = match bus {
        Bus::AxiLite => "AXI4-Lite",
        Bus::Wishbone => "Wishbone",
    };
    let registers: Vec<View> = map.registers.iter().map(view).collect();
    let operands: Vec<Operand> = map
        .operands
        .iter()
        .map(|operand| Operand {
            name: operand.name.clone(),
            constant: constant_name(&operand.name),
            format: operand.format,
        })
        .collect();
    let (regenerate, prefix) = (inputs.config.as_str(), constant_name(name));
    let header = Header {
        name,
        title: &title,
        regenerate,
        guard: &format!("{prefix}_REGISTERS_H"),
        prefix: &prefix,
        bus,
        registers: &registers,
        operands: &operands,
    };
    let module =
        Module { name, title: &title, regenerate, bus, registers: &registers, operands: &operands };
    let rdl = Rdl { name, title: &title, regenerate, registers: &registers };
    Ok(vec![
        (format!("{name}_registers.h"), render(&header)?),
        (format!("{name}_registers.rs"), render(&module)?),
        (format!("{name}.rdl"), render(&rdl)?),
    ])
}

fn view(register: &Register) -> View<'_> {
    let field = |bits| Field { bits, constant: constant_name(&bits.name) };
    View {
        register,
        constant: constant_name(&register.name),
        fields: register.bits.iter().map(field).collect(),
    }
}

//! Generates descriptions of a core's bus registers for software: a C header, a Rust module without `std`, and SystemRDL.
//!
//! The C header and the Rust module also have functions that convert a number to the raw integer of an operand.

use anyhow::Result;
use glint_base::fill;

use super::model::c_integer;
use crate::package::bus::Bus;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::map::{Access, BusRegister, Map, RegisterBits};
use crate::package::output_files::OutputFiles;
use glint_base::fixed::Format;
use glint_rtl::verilog::text::{ascii, constant_name};

struct Printed<'a> {
    register: &'a BusRegister,
    /// The name in upper case, for constants in C and Rust.
    constant: String,
    fields: Vec<BitField<'a>>,
}

struct BitField<'a> {
    bits: &'a RegisterBits,
    /// The name in upper case, for constants in C and Rust.
    constant: String,
}

impl BitField<'_> {
    fn mask(&self) -> String {
        format!("0x{:08x}", ((1u64 << self.bits.width) - 1) << self.bits.low)
    }

    fn high(&self) -> u32 {
        self.bits.low + self.bits.width - 1
    }

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

/// An operand, for which the files have a function that converts a fixed-point number to its raw integer.
struct OperandConversion {
    name: String,
    constant: String,
    format: Format,
}

impl OperandConversion {
    /// Returns the number of bits of the registers that hold the raw integer: 32 or 64.
    fn bits(&self) -> u32 {
        if self.format.width() <= 32 { 32 } else { 64 }
    }

    /// Returns the smallest and the largest raw value as C expressions of 64 bits, the largest limited to 2^63 − 1.
    fn limits(&self) -> (String, String) {
        let least = match self.format.min_raw() {
            least if least == i64::MIN.into() => "(-9223372036854775807 - 1)".to_owned(),
            least => least.to_string(),
        };
        (least, self.format.max_raw().min(i64::MAX.into()).to_string())
    }

    fn c_fraction(&self) -> String {
        c_integer(self.format.frac)
    }

    fn rust_limits(&self) -> (String, String) {
        let most = self.format.max_raw().min(i64::MAX.into());
        (self.format.min_raw().to_string(), most.to_string())
    }
}

/// Fails if a template fails.
pub fn files(job: &EmitJob, bus: &Bus, map: &Map, files: &mut OutputFiles) -> Result<()> {
    let (name, regenerate, bus) = (job.name(), job.regenerate(), bus.title);
    let title = &ascii(&job.design.about.title).replace("*/", "* /").replace('"', "'");
    let registers: Vec<Printed> = map.registers.iter().map(view).collect();
    let mut operands: Vec<OperandConversion> = Vec::new();
    for operand in &map.operands {
        operands.push(OperandConversion {
            name: operand.name.clone(),
            constant: constant_name(&operand.name),
            format: operand.format,
        });
    }
    let prefix = constant_name(name);
    let header = fill!("registers.h" {
        name: &'a str, title: &'a str, regenerate: &'a str,
        guard: String = format!("{prefix}_REGISTERS_H"),
        prefix: &'a str = &prefix,
        bus: &'a str, registers: &'a [Printed<'a>] = &registers, operands: &'a [OperandConversion] = &operands,
    })?;
    let module = fill!("registers.rs" {
        name: &'a str, title: &'a str, regenerate: &'a str, bus: &'a str,
        registers: &'a [Printed<'a>] = &registers, operands: &'a [OperandConversion] = &operands,
    })?;
    let rdl = fill!("registers.rdl" {
        name: &'a str, title: &'a str, regenerate: &'a str, registers: &'a [Printed<'a>] = &registers,
    })?;
    files.add(FileKind::Software, format!("{name}_registers.h"), header);
    files.add(FileKind::Software, format!("{name}_registers.rs"), module);
    files.add(FileKind::Software, format!("{name}.rdl"), rdl);
    Ok(())
}

fn view(register: &BusRegister) -> Printed<'_> {
    let fields = register.bits.iter().map(|bits| {
        let constant = constant_name(&bits.name);
        BitField { bits, constant }
    });
    Printed { register, constant: constant_name(&register.name), fields: fields.collect() }
}

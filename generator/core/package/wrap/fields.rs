//! Operands and results side by side in whole bytes.

use anyhow::{Context, Result};

use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::text::{ascii, literal, statement};

/// An operand or a result in the bytes of a stream.
pub struct Field {
    pub name: String,
    /// Name and format, for comments.
    pub label: String,
    pub signed: bool,
    pub width: u32,
    /// Its lowest bit.
    pub low: u32,
    /// The port that writes it, of an operand of a core with a microprogram.
    pub strobe: String,
}

impl Field {
    /// Its bits and those that fill its last byte.
    pub fn padded(&self) -> u32 {
        self.width.next_multiple_of(8)
    }

    pub fn high(&self) -> u32 {
        self.low + self.width - 1
    }

    pub fn bits(&self) -> String {
        match self.width {
            1 => format!("[{}]", self.low),
            _ => format!("[{}:{}]", self.high(), self.low),
        }
    }

    /// In whole bytes, from a net of the given name.
    fn packed(&self, net: &str) -> Vec<String> {
        match (self.padded() - self.width, self.signed) {
            (0, _) => vec![net.to_owned()],
            (pad, false) => vec![literal(0, pad), net.to_owned()],
            (pad, true) if self.width == 1 => vec![format!("{{{pad}{{{net}}}}}"), net.to_owned()],
            (pad, true) => vec![format!("{{{pad}{{{net}[{}]}}}}", self.width - 1), net.to_owned()],
        }
    }
}

/// The operands, in the order of the ports.
pub fn operands(design: &Design) -> Vec<Field> {
    let ports = design.inputs().filter_map(|port| match port.role {
        Role::Operand { strobe } => Some((port, design.net(strobe).name.clone())),
        Role::Point => Some((port, String::new())),
        _ => None,
    });
    side_by_side(design, ports)
}

/// The results, in the order of the ports.
pub fn results(design: &Design) -> Vec<Field> {
    let ports = design.outputs().filter(|port| port.role == Role::Result);
    side_by_side(design, ports.map(|port| (port, String::new())))
}

fn side_by_side<'a>(
    design: &Design,
    ports: impl Iterator<Item = (&'a Port, String)>,
) -> Vec<Field> {
    let mut low = 0;
    let field = |(port, strobe): (&Port, String)| {
        let net = design.net(port.net);
        let field = Field {
            name: net.name.clone(),
            label: ascii(&format!("{}, {}", net.name, net.format)),
            signed: net.format.signed,
            width: net.format.width(),
            low,
            strobe,
        };
        low += field.padded();
        field
    };
    ports.map(field).collect()
}

/// The parts of a concatenation of all fields; the last field in the top bits.
pub fn packed(fields: &[Field], prefix: &str) -> Vec<String> {
    let of_field = |field: &Field| field.packed(&format!("{prefix}{}", field.name));
    fields.iter().rev().flat_map(of_field).collect()
}

/// The bits of all fields.
///
/// # Errors
/// There is none.
pub fn bits(fields: &[Field]) -> Result<u32> {
    let last = fields.last().context("a wrapper needs a core with operands and results")?;
    Ok(last.low + last.padded())
}

/// The bits of operands that only fill their bytes, as parts of `net`.
pub fn padding(fields: &[Field], net: &str) -> Vec<String> {
    let padded = fields.iter().filter(|field| field.padded() > field.width);
    let bits = padded.map(|field| {
        let (low, high) = (field.high() + 1, field.low + field.padded() - 1);
        if low == high { format!("{net}[{low}]") } else { format!("{net}[{high}:{low}]") }
    });
    bits.collect()
}

/// A wire that reads what nothing else does, for linters; nothing for nothing.
pub fn sink(unused: &[String]) -> Vec<String> {
    match unused {
        [] => Vec::new(),
        _ => statement(4, &format!("wire unused = &{{1'b0, {}}};", unused.join(", "))),
    }
}

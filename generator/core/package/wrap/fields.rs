//! Lays out operands and results as bytes, as the transfers of an AXI4-Stream carry them.
//!
//! Each value begins at a byte and is padded to whole bytes. For example, a result of 12 bits occupies 2 bytes.

use anyhow::{Context, Result};

use crate::package::emit_job::EmitJob;
use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::text::{ascii, literal, statement};

/// An operand or a result as a field in a transfer of an AXI4-Stream.
pub struct StreamField {
    pub name: String,
    /// The name and the format of the value, for comments.
    pub label: String,
    pub signed: bool,
    pub width: u32,
    /// The lowest bit of the value in the transfer.
    pub low: u32,
    /// The input that writes the operand, if the core has a microprogram; otherwise empty.
    pub strobe: String,
}

impl StreamField {
    /// Returns the width with the padding of the last byte: a cosine of 21 bits has 24.
    pub fn padded(&self) -> u32 {
        self.width.next_multiple_of(8)
    }

    pub fn high(&self) -> u32 {
        self.low + self.width - 1
    }

    /// Returns the part-select of the value, for example `[28:8]`, or `[8]` for one bit.
    pub fn bits(&self) -> String {
        match self.width {
            1 => format!("[{}]", self.low),
            _ => format!("[{}:{}]", self.high(), self.low),
        }
    }

    /// Returns the parts of a Verilog concatenation that extends the net `net` to whole bytes by its sign or zeros, the upper
    /// part first.
    fn packed(&self, net: &str) -> Vec<String> {
        match (self.padded() - self.width, self.signed) {
            (0, _) => vec![net.to_owned()],
            (pad, false) => vec![literal(0, pad), net.to_owned()],
            (pad, true) if self.width == 1 => vec![format!("{{{pad}{{{net}}}}}"), net.to_owned()],
            (pad, true) => vec![format!("{{{pad}{{{net}[{}]}}}}", self.width - 1), net.to_owned()],
        }
    }
}

/// Returns the fields of the operands in the order of the ports.
pub fn operands(design: &Design) -> Vec<StreamField> {
    let ports = design.inputs().filter_map(|port| match port.role {
        Role::Operand { strobe } => Some((port, design.net(strobe).name.clone())),
        Role::Point => Some((port, String::new())),
        _ => None,
    });
    side_by_side(design, ports)
}

/// Returns the fields of the results in the order of the ports: three colours of 8 bits begin at bits 0, 8 and 16.
pub fn results(design: &Design) -> Vec<StreamField> {
    let ports = design.outputs().filter(|port| port.role == Role::Result);
    side_by_side(design, ports.map(|port| (port, String::new())))
}

/// Places some ports in whole bytes, one behind the other. Each port comes with the name of its strobe, or an empty text.
fn side_by_side<'a>(
    design: &Design,
    ports: impl Iterator<Item = (&'a Port, String)>,
) -> Vec<StreamField> {
    let mut low = 0;
    let mut fields = Vec::new();
    for (port, strobe) in ports {
        let net = design.net(port.net);
        let field = StreamField {
            name: net.name.clone(),
            label: ascii(&format!("{}, {}", net.name, net.format)),
            signed: net.format.signed,
            width: net.format.width(),
            low,
            strobe,
        };
        low += field.padded();
        fields.push(field);
    }
    fields
}

/// The layout of a transfer: its fields, and its total number of bits.
pub struct Transfer {
    pub fields: Vec<StreamField>,
    pub bits: u32,
}

impl Transfer {
    /// Returns the layout of a transfer to the core, which carries the operands. Fails if the core has no operands.
    pub fn sent(job: &EmitJob) -> Result<Self> {
        Self::new(job, operands(job.design))
    }

    /// Returns the layout of a transfer from the core, which carries the results. Fails if the core has no results.
    pub fn received(job: &EmitJob) -> Result<Self> {
        Self::new(job, results(job.design))
    }

    fn new(job: &EmitJob, fields: Vec<StreamField>) -> Result<Self> {
        let last = fields.last().context("a wrapper needs a core with operands and results")?;
        let bits = last.low + last.padded();
        let bits = if job.inputs.around.power_of_two { bits.next_power_of_two() } else { bits };
        Ok(Self { fields, bits })
    }

    pub fn high(&self) -> u32 {
        self.bits - 1
    }

    /// Returns the number of bits that the fields occupy, including the padding in the last byte of each.
    pub fn filled(&self) -> u32 {
        self.fields.last().map_or(0, |last| last.low + last.padded())
    }

    pub fn field(&self, name: &str) -> Option<&StreamField> {
        self.fields.iter().find(|field| field.name == name)
    }

    pub fn has_signs(&self) -> bool {
        self.fields.iter().any(|field| field.signed && field.padded() > field.width)
    }

    /// Returns the parts of a Verilog concatenation that forms the whole transfer, from the top bits down. `prefix` is put
    /// before the name of each port.
    pub fn packed(&self, prefix: &str) -> Vec<String> {
        let mut parts = Vec::new();
        let above = self.bits - self.filled();
        if above > 0 {
            parts.push(literal(0, above));
        }
        for field in self.fields.iter().rev() {
            parts.extend(field.packed(&format!("{prefix}{}", field.name)));
        }
        parts
    }

    /// Returns the bits of a transfer that belong to no value, as part-selects of the net `net`. Above a value of 21 bits, for
    /// example, these are `operands[23:21]`.
    pub fn padding(&self, net: &str) -> Vec<String> {
        let mut ranges = Vec::new();
        for field in &self.fields {
            ranges.push((field.high() + 1, field.low + field.padded()));
        }
        ranges.push((self.filled(), self.bits));
        let mut selects = Vec::new();
        for (low, end) in ranges {
            if end == low + 1 {
                selects.push(format!("{net}[{low}]"));
            } else if low < end {
                selects.push(format!("{net}[{}:{low}]", end - 1));
            }
        }
        selects
    }
}

/// Returns Verilog of a wire that reads all nets in `unused`, so that linters do not warn of unread nets.
pub fn sink(unused: &[String]) -> Vec<String> {
    match unused {
        [] => Vec::new(),
        _ => statement(4, &format!("wire unused = &{{1'b0, {}}};", unused.join(", "))),
    }
}

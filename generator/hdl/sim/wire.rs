//! What a circuit shows to rust_hdl's probes: atoms with run-time widths.
//!
//! They are made when a probe comes by and hold nothing of their own but the id, which is the same
//! every time; rust_hdl needs no more. Simulation without a trace never makes one.

use rust_hdl::core::ast::VerilogLiteral;
use rust_hdl::core::atom::{Atom, AtomKind};
use rust_hdl::core::constraint::PinConstraint;
use rust_hdl::core::synth::VCDValue;
use rust_hdl::core::type_descriptor::{TypeDescriptor, TypeKind};

/// What a wire is to the circuit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Input,
    Output,
    Local,
}

/// A net.
#[derive(Debug)]
pub(super) struct Wire {
    /// From rust_hdl's counter, so that it is distinct from the ids of signals.
    pub id: usize,
    pub width: u32,
    pub signed: bool,
    pub direction: Direction,
    pub connected: bool,
    pub changed: bool,
    pub bits: u64,
}

impl Atom for Wire {
    fn bits(&self) -> usize {
        self.width as usize
    }

    fn connected(&self) -> bool {
        self.connected
    }

    fn changed(&self) -> bool {
        self.changed
    }

    fn kind(&self) -> AtomKind {
        match self.direction {
            Direction::Input => AtomKind::InputParameter,
            Direction::Output => AtomKind::OutputParameter,
            Direction::Local => AtomKind::LocalSignal,
        }
    }

    fn descriptor(&self) -> TypeDescriptor {
        let width = self.bits();
        let (name, kind) = if self.signed {
            (format!("Signed::<{width}>"), TypeKind::Signed(width))
        } else {
            (format!("Bits::<{width}>"), TypeKind::Bits(width))
        };
        TypeDescriptor { name, kind }
    }

    fn vcd(&self) -> VCDValue {
        let bit = |at: u32| vcd::Value::from(self.bits >> at & 1 == 1);
        VCDValue::Vector((0..self.width).rev().map(bit).collect())
    }

    fn id(&self) -> usize {
        self.id
    }

    /// Only the value counts: rust_hdl emits no Verilog from a netlist.
    fn verilog(&self) -> VerilogLiteral {
        self.bits.into()
    }

    fn constraints(&self) -> Vec<PinConstraint> {
        Vec::new()
    }
}

/// The name of the microinstruction that is executed, `idle` when none is.
#[derive(Debug)]
pub(super) struct MicroinstructionName<'a> {
    pub id: usize,
    pub names: &'a [String],
    pub connected: bool,
    pub changed: bool,
    pub address: u64,
    pub run: bool,
}

impl MicroinstructionName<'_> {
    fn text(&self) -> String {
        let name = usize::try_from(self.address).ok().and_then(|address| self.names.get(address));
        match (self.run, name) {
            (false, _) => "idle".to_owned(),
            (true, Some(name)) => vcd_text(name),
            (true, None) => format!("microinstruction_{}", self.address),
        }
    }
}

/// A string as VCD can hold it: a space would end it.
fn vcd_text(text: &str) -> String {
    let graphic = |c: char| if c.is_ascii_graphic() { c } else { '_' };
    text.chars().map(graphic).collect()
}

impl Atom for MicroinstructionName<'_> {
    fn bits(&self) -> usize {
        self.names.len().next_power_of_two().ilog2() as usize
    }

    fn connected(&self) -> bool {
        self.connected
    }

    fn changed(&self) -> bool {
        self.changed
    }

    fn kind(&self) -> AtomKind {
        AtomKind::LocalSignal
    }

    fn descriptor(&self) -> TypeDescriptor {
        let names = self.names.iter().map(|name| vcd_text(name));
        TypeDescriptor {
            name: "microinstruction".to_owned(),
            kind: TypeKind::Enum(["idle".to_owned()].into_iter().chain(names).collect()),
        }
    }

    fn vcd(&self) -> VCDValue {
        VCDValue::String(self.text())
    }

    fn id(&self) -> usize {
        self.id
    }

    /// Only the value counts: rust_hdl emits no Verilog from a netlist.
    fn verilog(&self) -> VerilogLiteral {
        self.address.into()
    }

    fn constraints(&self) -> Vec<PinConstraint> {
        Vec::new()
    }
}

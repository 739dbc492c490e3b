//! Shows the ports and the named nets of a circuit to rust_hdl's probes, as atoms (rust_hdl's term for a signal). The widths of
//! nets are known only at run time.
//!
//! A probe that visits the circuit gets an atom for each port and each named net, with its value in lane 0. A further atom shows
//! the name of the executed microinstruction. New atoms are made at every visit. The id of a net's atom stays the same. rust_hdl
//! visits a new circuit to check its ports, and later only for a waveform.

use rust_hdl::core::ast::VerilogLiteral;
use rust_hdl::core::atom::{Atom, AtomKind};
use rust_hdl::core::constraint::PinConstraint;
use rust_hdl::core::synth::VCDValue;
use rust_hdl::core::type_descriptor::{TypeDescriptor, TypeKind};

/// Whether a net is a port of the circuit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Input,
    Output,
    Local,
}

#[derive(Debug)]
pub(super) enum ProbeView<'a> {
    /// A net inside the circuit, or one of its ports.
    Net { width: u32, signed: bool, direction: Direction },
    /// The name of the executed microinstruction, or `idle` if `run` is false. The bits are the address, an index of `names`.
    Microinstruction { names: &'a [String], run: bool },
}

/// The value of one net in lane 0.
#[derive(Debug)]
pub(super) struct Wire<'a> {
    /// The id comes from rust_hdl's counter, so that it differs from the ids of rust_hdl's own signals.
    pub id: usize,
    pub connected: bool,
    pub changed: bool,
    pub bits: u64,
    pub seen: ProbeView<'a>,
}

/// Replaces characters that a VCD string cannot contain: `12 <- sin` becomes `12_<-_sin`.
fn vcd_text(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() { c } else { '_' }).collect()
}

impl Atom for Wire<'_> {
    fn bits(&self) -> usize {
        match self.seen {
            ProbeView::Net { width, .. } => width as usize,
            ProbeView::Microinstruction { names, .. } => {
                names.len().next_power_of_two().ilog2() as usize
            }
        }
    }

    fn connected(&self) -> bool {
        self.connected
    }

    fn changed(&self) -> bool {
        self.changed
    }

    fn kind(&self) -> AtomKind {
        match self.seen {
            ProbeView::Net { direction: Direction::Input, .. } => AtomKind::InputParameter,
            ProbeView::Net { direction: Direction::Output, .. } => AtomKind::OutputParameter,
            _ => AtomKind::LocalSignal,
        }
    }

    fn descriptor(&self) -> TypeDescriptor {
        let width = self.bits();
        let (name, kind) = match self.seen {
            ProbeView::Net { signed: true, .. } => {
                (format!("Signed::<{width}>"), TypeKind::Signed(width))
            }
            ProbeView::Net { .. } => (format!("Bits::<{width}>"), TypeKind::Bits(width)),
            ProbeView::Microinstruction { names, .. } => {
                let mut values = vec!["idle".to_owned()];
                values.extend(names.iter().map(|name| vcd_text(name)));
                ("microinstruction".to_owned(), TypeKind::Enum(values))
            }
        };
        TypeDescriptor { name, kind }
    }

    fn vcd(&self) -> VCDValue {
        match self.seen {
            ProbeView::Net { width, .. } => {
                let bit = |at: u32| vcd::Value::from(self.bits >> at & 1 == 1);
                VCDValue::Vector((0..width).rev().map(bit).collect())
            }
            ProbeView::Microinstruction { run: false, .. } => VCDValue::String("idle".to_owned()),
            ProbeView::Microinstruction { names, .. } => {
                let name = usize::try_from(self.bits).ok().and_then(|at| names.get(at));
                VCDValue::String(match name {
                    Some(name) => vcd_text(name),
                    None => format!("microinstruction_{}", self.bits),
                })
            }
        }
    }

    fn id(&self) -> usize {
        self.id
    }

    /// rust_hdl never emits Verilog from this circuit.
    fn verilog(&self) -> VerilogLiteral {
        self.bits.into()
    }

    fn constraints(&self) -> Vec<PinConstraint> {
        Vec::new()
    }
}

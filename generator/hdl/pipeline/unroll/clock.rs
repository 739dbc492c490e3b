//! Executes one clock of a design symbolically.

use std::collections::HashMap;

use super::Executor;
use crate::netlist::{self, Driver, Net, NetId, RegId, RegisterKind, Role, RomId, Topic};
use crate::pipeline::graph::{Cell, Graph, Label, NodeId, NodeOp};
use glint_base::fixed::Format;

/// The symbolic contents of registers and synchronous ROM outputs between two clocks.
#[derive(Clone)]
pub(super) struct State {
    pub(super) registers: Vec<NodeId>,
    /// The entry of a ROM without a clock is unused.
    pub(super) roms: Vec<NodeId>,
}

/// One clock of the symbolic execution, which finds the node of each net.
pub(super) struct Clock<'e, 'a> {
    executor: &'e mut Executor<'a>,
    state: &'e State,
    /// The executed microinstruction. If it is unknown (`None`), the registers of the sequencer have nodes instead of
    /// constants.
    address: Option<usize>,
    /// Whether this clock accepts `start`.
    first: bool,
    values: HashMap<NetId, NodeId>,
}

impl<'e, 'a> Clock<'e, 'a> {
    pub(super) fn new(
        executor: &'e mut Executor<'a>,
        state: &'e State,
        address: Option<usize>,
        first: bool,
    ) -> Self {
        Self { executor, state, address, first, values: HashMap::new() }
    }

    /// Returns the node of a net in this clock.
    pub(super) fn value(&mut self, id: NetId) -> NodeId {
        if let Some(&value) = self.values.get(&id) {
            return value;
        }
        let design = self.executor.design;
        let net = design.net(id);
        let label = label(net);
        let value = match &net.driver {
            Driver::Constant(bits) => self.graph().described_constant(*bits, net.format, &label),
            Driver::Input => self.input(id, net, &label),
            Driver::Field(field) => match self.address {
                Some(address) => {
                    let bits = design.control.microprogram[address].values[field.index()];
                    self.constant(bits, net.format, &label)
                }
                None => {
                    let of = self.value(design.rom(design.control.rom).data);
                    let low = design.field_positions()[field.index()];
                    self.graph().op(NodeOp::Slice { of, low }, net.format, &label)
                }
            },
            Driver::Register(register) => match self.of_sequencer(*register) {
                Some(bits) => self.constant(bits, net.format, &label),
                None => self.state.registers[register.index()],
            },
            Driver::Rom(rom) if design.rom(*rom).synchronous => self.state.roms[rom.index()],
            Driver::Rom(rom) => self.read(*rom),
            Driver::Op(op) => {
                // A mux whose select is a constant, such as a field, passes one input.
                let mut chosen = None;
                if let netlist::Op::Mux { select, inputs } = op {
                    let select = self.value(*select);
                    let select = self.graph().constant_of(select);
                    chosen = select.map(|it| inputs[(it as usize).min(inputs.len() - 1)]);
                }
                let op = match chosen {
                    Some(input) => NodeOp::Relabel(self.value(input)),
                    None => op.map(|&operand| self.value(operand)),
                };
                self.graph().op(op, net.format, &label)
            }
            Driver::Undriven => unreachable!("a checked design has no undriven net"),
        };
        self.values.insert(id, value);
        value
    }

    /// Returns the value of a register of the sequencer: the counter has `self.address`, and the run flag is 0 only in the clock
    /// that accepts `start`. Returns `None` for any other register, and if the address is unknown.
    fn of_sequencer(&self, register: RegId) -> Option<u64> {
        let (control, address) = (&self.executor.design.control, self.address?);
        match register {
            it if it == control.run => Some(u64::from(!self.first)),
            it if it == control.address => Some(address as u64),
            _ => None,
        }
    }

    pub(super) fn graph(&mut self) -> &mut Graph {
        &mut self.executor.unrolled.graph
    }

    fn constant(&mut self, bits: u64, format: Format, label: &Label) -> NodeId {
        self.graph().constant(bits, format, label)
    }

    fn input(&mut self, id: NetId, net: &Net, label: &Label) -> NodeId {
        let design = self.executor.design;
        let role = design.ports.iter().find(|port| port.net == id).map(|port| port.role);
        match role {
            Some(Role::Start | Role::Strobe) => {
                self.constant(u64::from(self.first), net.format, label)
            }
            Some(Role::Reset) => self.constant(1, net.format, label),
            _ => {
                let operands = &self.executor.unrolled.operands;
                let at = operands.iter().position(|&operand| operand == id);
                let cell = match at {
                    Some(at) if self.first => Cell::Operand(at),
                    _ => Cell::Unknown(net.name.clone()),
                };
                self.graph().insert(cell, net.format, net.range, label)
            }
        }
    }

    fn read(&mut self, rom: RomId) -> NodeId {
        let design = self.executor.design;
        let address = self.value(design.rom(rom).address);
        let net = design.net(design.rom(rom).data);
        let words = &design.rom(rom).words;
        if design.rom(rom).write.is_some() {
            // Its words are not known.
            let read = Cell::Read { rom, address };
            return self.graph().insert(read, net.format, net.format.range(), &label(net));
        }
        // ROMs with the same words become reads of the first one, so that equal reads are merged.
        let first = design
            .roms
            .iter()
            .position(|it| it.words == *words && design.net(it.data).format == net.format);
        let rom = first.map_or(rom, |first| RomId(first as u32));
        self.graph().read(rom, address, words, net.format, &label(net))
    }

    /// Performs the rising edge at the end of this clock.
    pub(super) fn edge(&mut self) -> State {
        let design = self.executor.design;
        let mut after = self.state.clone();
        for (number, register) in design.registers.iter().enumerate() {
            // If the microinstruction is known, the caller decides which one follows.
            if register.kind == RegisterKind::Sequencer && self.address.is_some() {
                continue;
            }
            let enable = register.enable.map(|enable| self.value(enable));
            let fixed = enable.map_or(Some(1), |it| self.graph().constant_of(it));
            if fixed == Some(0) {
                continue;
            }
            let data = self.value(register.data.expect("a checked design has no register without"));
            let net = design.net(register.q);
            let before = self.state.registers[number];
            let graph = self.graph();
            let mut held = graph.op(NodeOp::Relabel(data), net.format, &label(net));
            if let (Some(select), None) = (enable, fixed) {
                let inputs = vec![before, held];
                held = graph.op(NodeOp::Mux { select, inputs }, net.format, &label(net));
            }
            after.registers[number] = if register.kind == RegisterKind::Internal {
                held
            } else {
                graph.name_after(held, &label(net));
                graph.refine(held, net.range)
            };
        }
        for (number, rom) in design.roms.iter().enumerate() {
            if rom.synchronous {
                after.roms[number] = self.read(RomId(number as u32));
            }
        }
        after
    }
}

pub(super) fn label(net: &Net) -> Label {
    Label {
        name: net.name.clone(),
        doc: if net.doc_topic == Topic::Device { net.doc.clone() } else { String::new() },
        block: net.block,
        named: net.named,
        part_of: None,
        location: net.location,
    }
}

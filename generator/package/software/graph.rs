//! Values that follow from operands: a graph without clocks.
//!
//! A value is made once, is folded where its operands are constants, and stands for the bit pattern that a
//! net has in some clock.

use std::collections::HashMap;

use anyhow::{Result, ensure};

use crate::fixed::{Format, mask};
use crate::netlist::{Driver, NetId, Op, RegId, RomId};

/// What makes a value. The operands of an [`Op`] are numbers of values here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Node {
    /// A bit pattern.
    Constant(u64),
    /// An input port.
    Input(NetId),
    /// A register before the clock, where that is not known otherwise.
    State(RegId),
    /// The data of a synchronous ROM before the clock, where that is not known otherwise.
    Read(RomId),
    /// What a word of a ROM holds.
    Rom(RomId, NetId),
    /// An operation.
    Op(Op),
}

/// A value with what is known of it.
#[derive(Clone, Debug)]
pub struct Value {
    /// What makes it.
    pub node: Node,
    /// Its width and sign.
    pub format: Format,
    /// What to call it, or nothing.
    pub name: String,
    /// It is a register's: the name stays.
    pub kept: bool,
    /// The number of the section that it is computed in.
    pub section: usize,
}

/// All values, each after what it needs.
#[derive(Default)]
pub struct Graph {
    /// By number.
    pub values: Vec<Value>,
    /// The number of the section that new values belong to.
    pub section: usize,
    known: HashMap<String, NetId>,
}

impl Graph {
    /// The value `id`.
    pub fn value(&self, id: NetId) -> &Value {
        &self.values[id.index()]
    }

    /// Its width.
    pub fn width(&self, id: NetId) -> u32 {
        self.value(id).format.width()
    }

    /// The bit pattern of a constant.
    pub fn constant_of(&self, id: NetId) -> Option<u64> {
        match self.value(id).node {
            Node::Constant(bits) => Some(bits),
            _ => None,
        }
    }

    /// A bit pattern.
    pub fn constant(&mut self, bits: u64, format: Format) -> NetId {
        self.make(Node::Constant(bits & mask(format.width())), format)
    }

    /// The value that a node makes: one that is there already, or a new one.
    pub fn make(&mut self, node: Node, format: Format) -> NetId {
        let key = format!("{node:?}{}{}", format.width(), format.signed);
        let next = NetId(self.values.len() as u32);
        let section = self.section;
        let id = *self.known.entry(key).or_insert(next);
        if id == next {
            self.values.push(Value { node, format, name: String::new(), kept: false, section });
        }
        id
    }

    /// Suggests a name; that of a register is kept whatever others suggest.
    pub fn name(&mut self, id: NetId, name: &str, kept: bool) {
        let value = &mut self.values[id.index()];
        let computed = matches!(value.node, Node::Op(_) | Node::Rom(..));
        if computed && !value.kept && (kept || value.name.is_empty()) {
            name.clone_into(&mut value.name);
            value.kept = kept;
        }
    }

    /// What an operation makes of values, which have the widths that [`Op`] documents.
    ///
    /// # Errors
    /// A product of more than 64 bits.
    pub fn op(&mut self, op: Op, format: Format) -> Result<NetId> {
        ensure!(format.width() <= 64, "a value of more than 64 bits");
        if let Some(same) = self.alias(&op, format) {
            return Ok(same);
        }
        let operands: Option<Vec<u64>> =
            op.operands().iter().map(|operand| self.constant_of(*operand)).collect();
        if let Some(bits) = operands.map(|bits| self.folded(&op, &bits, format)) {
            return Ok(self.constant(bits, format));
        }
        Ok(self.make(Node::Op(op), format))
    }

    /// The operand that an operation only passes on.
    fn alias(&mut self, op: &Op, format: Format) -> Option<NetId> {
        let zeros = |graph: &Self, id: &NetId| graph.constant_of(*id) == Some(0);
        let ones = |graph: &Self, id: &NetId| {
            graph.constant_of(*id) == Some(mask(graph.width(*id)))
        };
        let passed = match op {
            Op::Relabel(of) | Op::Extend(of) if self.width(*of) == format.width() => *of,
            Op::Any(of) | Op::All(of) if self.width(*of) == 1 => *of,
            Op::Slice { of, low: 0 } if self.width(*of) == format.width() => *of,
            Op::Mux { select, inputs } => match self.constant_of(*select) {
                Some(at) => inputs[(at as usize).min(inputs.len() - 1)],
                None if inputs.iter().all(|input| *input == inputs[0]) => inputs[0],
                None => return None,
            },
            Op::And(a, b) if zeros(self, a) || ones(self, b) => *a,
            Op::And(a, b) if zeros(self, b) || ones(self, a) => *b,
            Op::Or(a, b) if zeros(self, b) || ones(self, a) => *a,
            Op::Or(a, b) if zeros(self, a) || ones(self, b) => *b,
            Op::Equal(a, b) if a == b => return Some(self.constant(1, format)),
            _ => return None,
        };
        // The same bits with another sign are another value: comparisons and products ask for it.
        let value = self.value(passed);
        if value.format.signed == format.signed {
            return Some(passed);
        }
        match value.node {
            Node::Constant(bits) => Some(self.constant(bits, format)),
            _ => Some(self.make(Node::Op(Op::Relabel(passed)), format)),
        }
    }

    /// The bit pattern of an operation on constants.
    fn folded(&self, op: &Op, bits: &[u64], format: Format) -> u64 {
        let of = |at: usize| self.value(op.operands()[at]).format;
        let signed = |at: usize| of(at).raw(bits[at]);
        let result = match op {
            Op::Relabel(_) => bits[0],
            Op::Extend(_) => signed(0) as u64,
            Op::Slice { low, .. } => bits[0] >> low,
            Op::Concat(parts) => {
                let parts = parts.iter().zip(bits);
                parts.fold(0, |high, (part, bits)| {
                    high.checked_shl(self.width(*part)).unwrap_or(0) | bits
                })
            }
            Op::Not(_) => !bits[0],
            Op::And(..) => bits[0] & bits[1],
            Op::Or(..) => bits[0] | bits[1],
            Op::Xor(..) => bits[0] ^ bits[1],
            Op::Add { .. } => bits.iter().fold(0, |sum: u64, bits| sum.wrapping_add(*bits)),
            Op::Sub(..) => bits[0].wrapping_sub(bits[1]),
            Op::Mul(..) => signed(0).wrapping_mul(signed(1)) as u64,
            Op::Equal(..) => u64::from(bits[0] == bits[1]),
            Op::Less(..) => u64::from(signed(0) < signed(1)),
            Op::Any(_) => u64::from(bits[0] != 0),
            Op::All(_) => u64::from(bits[0] == mask(of(0).width())),
            Op::Mux { inputs, .. } => bits[1 + (bits[0] as usize).min(inputs.len() - 1)],
        };
        result & mask(format.width())
    }
}

/// The values of all nets in one clock.
pub struct Clock {
    /// By net.
    pub nets: Vec<NetId>,
}

/// What stands in registers and behind synchronous ROMs before a clock.
#[derive(Clone)]
pub struct State {
    /// By register.
    pub registers: Vec<NetId>,
    /// By ROM; only synchronous ones are read.
    pub reads: Vec<NetId>,
}

impl Graph {
    /// The values of all nets of a design in a clock.
    ///
    /// # Errors
    /// A loop; a net without a driver.
    pub fn clock(
        &mut self,
        design: &crate::netlist::Design,
        order: &[NetId],
        state: &State,
        input: impl Fn(&mut Self, NetId) -> NetId,
    ) -> Result<Clock> {
        let positions = design.field_positions();
        let mut nets = vec![NetId(0); design.nets.len()];
        for &id in order {
            let net = design.net(id);
            let value = match &net.driver {
                Driver::Undriven => anyhow::bail!("`{}` has no driver", net.name),
                Driver::Input => input(self, id),
                Driver::Constant(bits) => self.constant(*bits, net.format),
                Driver::Register(register) => state.registers[register.index()],
                Driver::Rom(rom) if design.rom(*rom).synchronous => state.reads[rom.index()],
                Driver::Rom(rom) => {
                    let address = nets[design.rom(*rom).address.index()];
                    self.read(design, *rom, address)
                }
                Driver::Field(field) => {
                    let word = nets[design.rom(design.control.rom).data.index()];
                    self.op(Op::Slice { of: word, low: positions[field.index()] }, net.format)?
                }
                Driver::Op(op) => {
                    let mut op = op.clone();
                    for operand in op.operands_mut() {
                        *operand = nets[operand.index()];
                    }
                    self.op(op, net.format)?
                }
            };
            if net.named {
                self.name(value, &net.name, false);
            }
            nets[id.index()] = value;
        }
        Ok(Clock { nets })
    }

    /// What stands in registers and behind synchronous ROMs after the clock.
    ///
    /// # Errors
    /// A register that takes nothing.
    pub fn after(
        &mut self,
        design: &crate::netlist::Design,
        state: &State,
        clock: &Clock,
    ) -> Result<State> {
        let mut after = state.clone();
        for (at, register) in design.registers.iter().enumerate() {
            let Some(data) = register.data else {
                anyhow::bail!("`{}` takes nothing", design.net(register.q).name);
            };
            let (data, old) = (clock.nets[data.index()], state.registers[at]);
            let net = design.net(register.q);
            let new = match register.enable {
                None => data,
                Some(enable) => {
                    let select = clock.nets[enable.index()];
                    self.op(Op::Mux { select, inputs: vec![old, data] }, net.format)?
                }
            };
            if new != old {
                self.name(new, &net.name, true);
            }
            after.registers[at] = new;
        }
        for (at, rom) in design.roms.iter().enumerate() {
            if rom.synchronous {
                let read = self.read(design, RomId(at as u32), clock.nets[rom.address.index()]);
                self.name(read, &design.net(rom.data).name, true);
                after.reads[at] = read;
            }
        }
        Ok(after)
    }

    fn read(&mut self, design: &crate::netlist::Design, rom: RomId, address: NetId) -> NetId {
        let (words, format) = (&design.rom(rom).words, design.net(design.rom(rom).data).format);
        match self.constant_of(address) {
            Some(at) => self.constant(words.get(at as usize).copied().unwrap_or(0), format),
            None => self.make(Node::Rom(rom, address), format),
        }
    }

    /// Which values those in `wanted` need, themselves among them.
    pub fn needed(&self, wanted: &[NetId]) -> Vec<bool> {
        let mut needed = vec![false; self.values.len()];
        for id in wanted {
            needed[id.index()] = true;
        }
        for at in (0..self.values.len()).rev() {
            if needed[at] {
                for operand in self.operands(NetId(at as u32)) {
                    needed[operand.index()] = true;
                }
            }
        }
        needed
    }

    /// The values that a value is made of.
    pub fn operands(&self, id: NetId) -> Vec<NetId> {
        match &self.value(id).node {
            Node::Op(op) => op.operands(),
            Node::Rom(_, address) => vec![*address],
            Node::Constant(_) | Node::Input(_) | Node::State(_) | Node::Read(_) => Vec::new(),
        }
    }
}

//! Values that follow from operands: a graph without clocks.
//!
//! A value is made once, is folded where its operands are constants, and stands for the bit pattern that a
//! net has in some clock.

use std::collections::HashMap;

use anyhow::{Result, ensure};

use crate::base::cone;
use crate::base::fixed::{Format, mask};
use crate::hdl::netlist::{Design, Driver, NetId, Op, RegId, RomId, eval};

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
        let wiring = match &op {
            Op::Slice { of, low } => Some(self.slice(*of, *low, format.width())),
            Op::Concat(parts) => Some(self.concat(parts)),
            _ => None,
        };
        let op = wiring.map_or(op, Op::Relabel);
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

    /// Bits of a value, looked up where they come from: what was shifted out of a register leaves no trace.
    fn slice(&mut self, of: NetId, low: u32, width: u32) -> NetId {
        let whole = self.width(of);
        if width == whole {
            return of;
        }
        match self.value(of).node.clone() {
            Node::Constant(bits) => self.constant(bits >> low, unsigned(width)),
            Node::Op(Op::Slice { of, low: inner }) => self.slice(of, inner + low, width),
            Node::Op(Op::Relabel(of)) => self.slice(of, low, width),
            Node::Op(Op::Extend(of)) if low + width <= self.width(of) => self.slice(of, low, width),
            Node::Op(Op::Concat(parts)) => {
                let mut above = whole;
                let mut pieces = Vec::new();
                for part in parts {
                    let top = above;
                    above -= self.width(part);
                    let (from, to) = (above.max(low), top.min(low + width));
                    if from < to {
                        pieces.push(self.slice(part, from - above, to - from));
                    }
                }
                self.concat(&pieces)
            }
            _ => self.make(Node::Op(Op::Slice { of, low }), unsigned(width)),
        }
    }

    /// Values side by side; neighbouring bits of one value and neighbouring constants become one.
    fn concat(&mut self, parts: &[NetId]) -> NetId {
        let mut flat: Vec<NetId> = Vec::new();
        for part in parts {
            let inner = match &self.value(*part).node {
                Node::Op(Op::Concat(inner)) => inner.clone(),
                _ => vec![*part],
            };
            for piece in inner {
                let joined = flat.last().and_then(|above| self.joined(*above, piece));
                match joined {
                    Some(joined) => *flat.last_mut().expect("a piece above") = joined,
                    None => flat.push(piece),
                }
            }
        }
        let width: u32 = flat.iter().map(|piece| self.width(*piece)).sum();
        match flat[..] {
            [only] => only,
            _ => self.make(Node::Op(Op::Concat(flat)), unsigned(width)),
        }
    }

    fn joined(&mut self, above: NetId, below: NetId) -> Option<NetId> {
        let (high, low) = (self.value(above), self.value(below));
        let (high_width, low_width) = (high.format.width(), low.format.width());
        match (&high.node, &low.node) {
            (Node::Constant(high), Node::Constant(low)) => {
                let bits = high << low_width | low;
                Some(self.constant(bits, unsigned(high_width + low_width)))
            }
            (
                &Node::Op(Op::Slice { of, low: at }),
                &Node::Op(Op::Slice { of: same, low: below }),
            ) if of == same && at == below + low_width => {
                Some(self.slice(of, below, high_width + low_width))
            }
            _ => None,
        }
    }

    /// The operand that an operation only passes on.
    fn alias(&mut self, op: &Op, format: Format) -> Option<NetId> {
        let zeros = |graph: &Self, id: &NetId| graph.constant_of(*id) == Some(0);
        let ones =
            |graph: &Self, id: &NetId| graph.constant_of(*id) == Some(mask(graph.width(*id)));
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
        let (operands, bits) = (op.operands(), bits.as_chunks::<1>().0);
        let of = |id: NetId| &bits[operands.iter().position(|it| *it == id).unwrap_or_default()];
        eval::cell(op, format.width(), &|id| self.value(id).format, &of)[0]
    }
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
    /// The values of all nets of a design in a clock, by net.
    ///
    /// # Errors
    /// A loop; a net without a driver.
    pub fn clock(
        &mut self,
        design: &Design,
        order: &[NetId],
        state: &State,
        input: impl Fn(&mut Self, NetId) -> NetId,
    ) -> Result<Vec<NetId>> {
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
        Ok(nets)
    }

    /// What stands in registers and behind synchronous ROMs after the clock.
    ///
    /// # Errors
    /// A register that takes nothing.
    pub fn after(&mut self, design: &Design, state: &State, nets: &[NetId]) -> Result<State> {
        let mut after = state.clone();
        for (at, register) in design.registers.iter().enumerate() {
            let Some(data) = register.data else {
                anyhow::bail!("`{}` takes nothing", design.net(register.q).name);
            };
            let (data, old) = (nets[data.index()], state.registers[at]);
            let net = design.net(register.q);
            let new = match register.enable {
                None => data,
                Some(enable) => {
                    let select = nets[enable.index()];
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
                let read = self.read(design, RomId(at as u32), nets[rom.address.index()]);
                self.name(read, &design.net(rom.data).name, true);
                after.reads[at] = read;
            }
        }
        Ok(after)
    }

    fn read(&mut self, design: &Design, rom: RomId, address: NetId) -> NetId {
        let (words, format) = (&design.rom(rom).words, design.net(design.rom(rom).data).format);
        match self.constant_of(address) {
            Some(at) => self.constant(words.get(at as usize).copied().unwrap_or(0), format),
            None => self.make(Node::Rom(rom, address), format),
        }
    }

    /// Which values those in `wanted` need, themselves among them.
    pub fn needed(&self, wanted: &[NetId]) -> Vec<bool> {
        let operands = |at| self.operands(NetId(at as u32)).into_iter().map(NetId::index);
        cone::needed(self.values.len(), wanted.iter().map(|id| id.index()), operands)
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

fn unsigned(width: u32) -> Format {
    Format::unsigned(width as i32, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_shifted_out_leaves_no_trace() {
        let mut graph = Graph::default();
        let old = graph.make(Node::State(RegId(0)), unsigned(2));
        let bits: Vec<NetId> =
            (0..2).map(|at| graph.make(Node::Input(NetId(at)), unsigned(1))).collect();
        let mut register = old;
        for bit in &bits {
            let kept = graph.op(Op::Slice { of: register, low: 0 }, unsigned(1)).unwrap();
            register = graph.op(Op::Concat(vec![kept, *bit]), unsigned(2)).unwrap();
        }
        let expected = graph.op(Op::Concat(bits), unsigned(2)).unwrap();
        assert_eq!(register, expected);
        assert!(!graph.needed(&[register])[old.index()]);
    }

    #[test]
    fn neighbours_become_one() {
        let mut graph = Graph::default();
        let whole = graph.make(Node::Input(NetId(0)), unsigned(8));
        let high = graph.op(Op::Slice { of: whole, low: 3 }, unsigned(5)).unwrap();
        let low = graph.op(Op::Slice { of: whole, low: 0 }, unsigned(3)).unwrap();
        assert_eq!(graph.op(Op::Concat(vec![high, low]), unsigned(8)).unwrap(), whole);
    }

    #[test]
    fn constants_are_folded_with_their_signs() {
        let mut graph = Graph::default();
        let signed = |width: i32| Format::signed(width - 1, 0);
        let (a, b) = (graph.constant(0b1101, signed(4)), graph.constant(0b0110, signed(4)));
        let product = graph.op(Op::Mul(a, b), signed(8)).unwrap();
        assert_eq!(graph.constant_of(product), Some(0b1110_1110), "-3 * 6");
        let less = graph.op(Op::Less(a, b), Format::BIT).unwrap();
        assert_eq!(graph.constant_of(less), Some(1));
        let wider = graph.op(Op::Extend(a), signed(6)).unwrap();
        assert_eq!(graph.constant_of(wider), Some(0b11_1101));
    }
}

//! Decides how each net appears in the Verilog; most nets are declared.
//!
//! Constants that are no ports, and wiring (slices, extensions, concatenations) without a name from the description's author,
//! are written as [`Bits`] wherever they are used. Any other cell without such a name is written into the expression that uses
//! it. This must be a single use of the whole net in the same module, and the expression must stay short. In a pipeline, some
//! named wiring and cells are treated likewise. Cells without a name that no written part reads are left out, and so are
//! products and registers inside multipliers and delay lines.

use std::collections::{BTreeMap, HashSet};

use anyhow::{Result, ensure};

use super::bits::{BitRun, Bits};
use super::naming::remark;
use crate::netlist::{
    DelayLine, Design, Driver, NetId, Op, Partition, RegId, Role, RomId, WritePort,
};
use glint_base::diagnostic::Diagnostics;
use glint_base::fixed::mask;

/// How a net appears in the Verilog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetForm {
    /// The net's [`Bits`] are written wherever the net is used.
    Wiring,
    /// As a `wire`, `reg` or port.
    Declared,
    /// Within the one expression that uses the net.
    Inline,
    /// Not at all: the product inside a multiplier with an output register.
    Inside,
}

/// A part of the Verilog that reads nets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reader {
    /// The right-hand side of this net, a cell or a field of the control word.
    Cell(NetId),
    /// Reads its data and its enable.
    Register(RegId),
    /// Reads its address and its write port.
    Rom(RomId),
}

/// How each net of a design appears in the Verilog.
pub struct Plan<'a> {
    pub design: &'a Design,
    pub forms: Vec<NetForm>,
    /// For each net, the bits that the Verilog writes where it is used, such as `a[5:2]` for an unnamed slice of `a`.
    pub bits: Vec<Bits>,
    /// For each net, the origin of its bits, traced through declared wiring too: cells, registers, ROMs, inputs and constants.
    pub roots: Vec<Bits>,
    /// The nets whose cells the Verilog writes, operands before their readers.
    pub live: Vec<NetId>,
    /// For each net and each module, a mask of the bits that the module reads.
    pub reads: BTreeMap<(Partition, NetId), u64>,
    /// The reset input, if a register has a reset.
    pub reset: Option<NetId>,
    pub delays: Vec<DelayLine>,
    /// The nets that repeat the value of an earlier net, with names that differ only in the stage. Only the first declaration of
    /// a value gets the comment.
    repeats: HashSet<NetId>,
}

impl<'a> Plan<'a> {
    /// Decides the form of each net. Fails with the mistakes of [`Design::verify_structure`].
    pub fn new(design: &'a Design) -> Result<Self> {
        let mistakes = design.verify_structure();
        ensure!(mistakes.is_empty(), Diagnostics(mistakes));
        let order = design.levelise().unwrap_or_default();
        let resets = design.registers.iter().any(|register| register.reset.is_some());
        let reset = match design.port(|role| role == Role::Reset) {
            Some(port) if resets => Some(port.net),
            _ => None,
        };
        let mut plan = Self {
            design,
            forms: vec![NetForm::Declared; design.nets.len()],
            bits: vec![Bits::default(); design.nets.len()],
            roots: vec![Bits::default(); design.nets.len()],
            live: Vec::new(),
            reads: BTreeMap::new(),
            reset,
            delays: design.delay_lines(),
            repeats: HashSet::new(),
        };
        plan.resolve_wiring(&order);
        plan.find_live(&order);
        plan.place_expressions();
        plan.count_reads();
        plan.find_repeats();
        Ok(plan)
    }

    /// Returns the module that declares a net. Fields of the control word belong to the control unit, whatever they control.
    pub fn partition(&self, net: NetId) -> Partition {
        match self.design.net(net).driver {
            Driver::Field(_) => Partition::Control,
            _ => self.design.net(net).partition,
        }
    }

    pub fn is_port(&self, net: NetId) -> bool {
        self.design.ports.iter().any(|port| port.net == net)
    }

    pub fn is_input(&self, net: NetId) -> bool {
        self.design.net(net).driver == Driver::Input
    }

    /// Returns whether a register is the last of a delay line in memory, from which the value is read; `None` outside such lines.
    pub fn delayed(&self, register: RegId) -> Option<bool> {
        let mut values = self.delays.iter().flat_map(|line| &line.values);
        let value = values.find(|it| it.registers.contains(&register))?;
        Some(value.last() == register)
    }

    /// Returns the module that contains a reader.
    pub fn home(&self, reader: Reader) -> Partition {
        match reader {
            Reader::Cell(net) => self.partition(net),
            Reader::Register(register) => self.partition(self.design.register(register).q),
            Reader::Rom(rom) => self.partition(self.design.rom(rom).data),
        }
    }

    /// Returns the nets that a reader reads, without the read enable of a ROM, which only a pipeline has.
    pub fn operands(&self, reader: Reader) -> Vec<NetId> {
        match reader {
            Reader::Cell(net) => match &self.design.net(net).driver {
                Driver::Op(Op::Less(a, b)) if self.constant_comparison(*a, *b).is_some() => {
                    Vec::new()
                }
                Driver::Op(op) => op.operands(),
                Driver::Field(_) => vec![self.design.rom(self.design.control.rom).data],
                _ => Vec::new(),
            },
            Reader::Register(register) => {
                let mut operands = Vec::new();
                match self.design.multiplier(register) {
                    Some(multiplier) => operands.extend(multiplier.factors),
                    None => operands.extend(self.design.register(register).data),
                }
                operands.extend(self.design.register(register).enable);
                operands
            }
            Reader::Rom(rom) => {
                let rom = self.design.rom(rom);
                let mut operands = vec![rom.address];
                operands.extend(rom.write.iter().flat_map(WritePort::nets));
                operands
            }
        }
    }

    /// Returns the bits of `operand` that a reader uses: all, except for a slice, a field of the control word or the address of a
    /// ROM.
    pub fn operand_bits(&self, reader: Reader, operand: NetId) -> Bits {
        let bits = &self.bits[operand.index()];
        match reader {
            Reader::Cell(net) => match &self.design.net(net).driver {
                Driver::Field(field) => {
                    let low = self.design.field_positions()[field.index()];
                    bits.slice(low, self.design.width(net))
                }
                Driver::Op(Op::Slice { low, .. }) => bits.slice(*low, self.design.width(net)),
                _ => bits.clone(),
            },
            Reader::Rom(rom) => {
                let rom = self.design.rom(rom);
                let is_address = operand == rom.address
                    || rom.write.as_ref().is_some_and(|write| operand == write.address);
                let width = if is_address { address_width(rom.words.len()) } else { bits.width() };
                bits.slice(0, width.min(bits.width()))
            }
            Reader::Register(_) => bits.clone(),
        }
    }

    /// Returns the value of the comparison `a < b` (1 or 0) if constants or the range of the format decide it. Linters reject
    /// such comparisons. For example, `a < 0` is 0 for an unsigned `a`.
    pub fn constant_comparison(&self, a: NetId, b: NetId) -> Option<u64> {
        let format = self.design.net(a).format;
        let constants = [a, b].map(|id| match self.roots[id.index()].single() {
            Some(BitRun::Constant { value, .. }) => Some(format.raw(value)),
            _ => None,
        });
        match (constants[0], constants[1]) {
            (Some(a), Some(b)) => Some(u64::from(a < b)),
            (Some(a), None) if a == format.max_raw() => Some(0),
            (None, Some(b)) if b == format.min_raw() => Some(0),
            _ => None,
        }
    }

    pub fn readers(&self) -> Vec<Reader> {
        let mut readers = Vec::new();
        for &net in &self.live {
            if matches!(self.design.net(net).driver, Driver::Op(_) | Driver::Field(_)) {
                readers.push(Reader::Cell(net));
            }
        }
        for at in 0..self.design.registers.len() {
            readers.push(Reader::Register(RegId(at as u32)));
        }
        for at in 0..self.design.roms.len() {
            readers.push(Reader::Rom(RomId(at as u32)));
        }
        readers
    }

    /// Returns the bits that form a net if it is wiring. `known` has the bits of each net.
    fn wired(&self, id: NetId, known: &[Bits]) -> Option<Bits> {
        let width = self.design.width(id);
        let of = |operand: &NetId| &known[operand.index()];
        match &self.design.net(id).driver {
            Driver::Constant(value) => Some(Bits::constant(value & mask(width), width)),
            Driver::Op(Op::Relabel(a)) => Some(of(a).clone()),
            Driver::Op(Op::Extend(a)) => {
                Some(of(a).extend(width, self.design.net(*a).format.signed))
            }
            Driver::Op(Op::Slice { of: a, low }) => Some(of(a).slice(*low, width)),
            Driver::Op(Op::Concat(parts)) => {
                let mut all = Bits::default();
                for part in parts {
                    all = all.followed_by(of(part));
                }
                Some(all)
            }
            _ => None,
        }
    }

    /// Returns the bits that form a net if it is wiring.
    pub fn wiring(&self, id: NetId) -> Option<Bits> {
        self.wired(id, &self.bits)
    }

    fn resolve_wiring(&mut self, order: &[NetId]) {
        for &id in order {
            let whole = Bits::net(id, self.design.width(id));
            // A named constant becomes a localparam if it is used as a whole; where its bits are used, they are literals.
            let net = self.design.net(id);
            let constant = matches!(net.driver, Driver::Constant(_)) && !self.is_port(id);
            let transparent = constant || !(net.named || self.is_port(id));
            self.roots[id.index()] = self.wired(id, &self.roots).unwrap_or_else(|| whole.clone());
            self.bits[id.index()] = match self.wiring(id) {
                Some(bits) if transparent || self.is_plain(id, &bits) => {
                    self.forms[id.index()] = NetForm::Wiring;
                    bits
                }
                _ => whole,
            };
        }
        for at in 0..self.design.registers.len() {
            if let Some(multiplier) = self.design.multiplier(RegId(at as u32)) {
                self.forms[multiplier.product.index()] = NetForm::Inside;
            }
        }
    }

    /// Finds the cells that the Verilog writes. Unnamed cells that no written cell, register or ROM reads are left out.
    fn find_live(&mut self, order: &[NetId]) {
        let mut live = vec![false; self.design.nets.len()];
        // The search starts from registers and ROMs, since no cell is known to be written yet.
        let mut pending = self.readers();
        for (id, net) in self.design.iter() {
            if self.forms[id.index()] == NetForm::Declared && (net.named || self.is_port(id)) {
                live[id.index()] = true;
                pending.push(Reader::Cell(id));
            }
        }
        while let Some(reader) = pending.pop() {
            for operand in self.operands(reader) {
                for piece in self.operand_bits(reader, operand).pieces() {
                    let (BitRun::Net { net, .. } | BitRun::Copies { net, .. }) = *piece else {
                        continue;
                    };
                    if !std::mem::replace(&mut live[net.index()], true) {
                        pending.push(Reader::Cell(net));
                    }
                }
            }
        }
        for (id, net) in self.design.iter() {
            if matches!(net.driver, Driver::Input | Driver::Register(_) | Driver::Rom(_)) {
                live[id.index()] = true;
            }
        }
        self.live = order.iter().copied().filter(|net| live[net.index()]).collect();
    }

    /// Finds the cells that are written inside the one expression that uses them, if this expression stays short.
    fn place_expressions(&mut self) {
        let mut uses: BTreeMap<NetId, Vec<(Reader, bool)>> = BTreeMap::new();
        for reader in self.readers() {
            for operand in self.operands(reader) {
                let bits = self.operand_bits(reader, operand);
                for piece in bits.pieces() {
                    if let BitRun::Net { net, width, .. }
                    | BitRun::Copies { net, count: width, .. } = *piece
                    {
                        let whole = bits.single().is_some() && width == self.design.width(net);
                        uses.entry(net).or_default().push((reader, whole));
                    }
                }
            }
        }
        // The number of declared nets and constants in an expression.
        let mut size = vec![1usize; self.design.nets.len()];
        for &id in &self.live {
            let net = self.design.net(id);
            let Driver::Op(op) = &net.driver else {
                continue;
            };
            let [(reader, true)] = uses.get(&id).map_or(&[][..], Vec::as_slice) else {
                continue;
            };
            let carried = match reader {
                Reader::Register(register) if !matches!(op, Op::Mux { inputs, .. } if inputs.len() > 2) => {
                    self.is_carried(id, *register)
                }
                _ => false,
            };
            if (net.named && !carried) || self.is_port(id) {
                continue;
            }
            let mut mentioned = 0;
            for operand in op.operands() {
                mentioned += self.mentioned(operand, &size);
            }
            let short = carried || self.reads_well(op, *reader, mentioned);
            if self.home(*reader) == self.partition(id) && short {
                self.forms[id.index()] = NetForm::Inline;
                size[id.index()] = mentioned;
            }
        }
    }

    /// Returns whether a pipeline's net is wiring of at most three pieces that need not be declared. The net must have no
    /// comment, unless the register behind it carries the same value and shows the comment.
    fn is_plain(&self, id: NetId, bits: &Bits) -> bool {
        const MOST_PIECES: usize = 3;
        if self.design.pipeline.is_none() || self.is_port(id) || bits.pieces().len() > MOST_PIECES {
            return false;
        }
        if self.design.net(id).doc.is_empty() {
            return true;
        }
        for (register, held) in (0..).map(RegId).zip(&self.design.registers) {
            if held.data == Some(id) && self.is_carried(id, register) {
                return true;
            }
        }
        false
    }

    /// Returns whether a register only carries the value of the net `id` to the next stage: both have the same name without the
    /// stage.
    fn is_carried(&self, id: NetId, register: RegId) -> bool {
        let Some(pipeline) = &self.design.pipeline else { return false };
        let q = self.design.register(register).q;
        pipeline.value_of[id.index()] == pipeline.value_of[q.index()]
            && self.delayed(register) != Some(false)
            && self.design.multiplier(register).is_none()
    }

    /// Finds the nets whose names differ from the name of an earlier net only in the stage.
    fn find_repeats(&mut self) {
        let Some(pipeline) = &self.design.pipeline else { return };
        let mut passed: HashSet<NetId> = HashSet::new();
        for value in self.delays.iter().flat_map(|line| &line.values) {
            for &register in value.passed() {
                passed.insert(self.design.register(register).q);
            }
        }
        let mut written: Vec<NetId> = Vec::new();
        for &id in &self.live {
            let is_declared = self.forms[id.index()] == NetForm::Declared;
            if is_declared && !passed.contains(&id) && !self.is_port(id) {
                written.push(id);
            }
        }
        written.sort_by_key(|id| pipeline.clock_of(*id));
        let mut seen: HashSet<&str> = HashSet::new();
        for port in &self.design.ports {
            seen.insert(&pipeline.value_of[port.net.index()]);
        }
        let mut repeats = HashSet::new();
        for id in written {
            if !seen.insert(&pipeline.value_of[id.index()]) {
                repeats.insert(id);
            }
        }
        self.repeats = repeats;
    }

    /// Returns the comment at the declaration of a net; none if the net only repeats a value of an earlier stage.
    pub fn remark(&self, id: NetId) -> String {
        if self.repeats.contains(&id) { String::new() } else { remark(self.design, id) }
    }

    fn mentioned(&self, operand: NetId, size: &[usize]) -> usize {
        let mut mentioned = 0;
        for piece in self.bits[operand.index()].pieces() {
            if let BitRun::Net { net, .. } = piece {
                mentioned += size[net.index()];
            }
        }
        mentioned.max(1)
    }

    /// Returns whether `op`, whose expression would have the size `mentioned`, may be written inside the expression of
    /// `reader`. A product may be only the whole right-hand side: in a larger expression Verilog would truncate the product to
    /// the width of its operands.
    fn reads_well(&self, op: &Op, reader: Reader, mentioned: usize) -> bool {
        const SMALL: usize = 3;
        let alone = match reader {
            Reader::Cell(net) => match &self.design.net(net).driver {
                Driver::Op(Op::Relabel(_)) => true,
                // Comparisons and products need declared operands, which show their signs. The select of a case statement is
                // clearer as a name.
                Driver::Op(Op::Mul(..) | Op::Less(..)) => return false,
                // Verilog can select bits of a net, not bits of an expression.
                Driver::Op(Op::Extend(_) | Op::Slice { .. } | Op::Concat(_)) => return false,
                Driver::Op(Op::Mux { inputs, .. }) if inputs.len() > 2 => return false,
                Driver::Op(_) => false,
                _ => return false,
            },
            // The factors of a multiplier are connections of an instance.
            Reader::Register(register) if self.design.multiplier(register).is_some() => {
                return false;
            }
            Reader::Register(register) => {
                // Registers with the same enable share an always block, so that an enable with several readers needs a name. This
                // one has only one reader.
                self.design.register(register).data.is_some() && mentioned <= SMALL
            }
            Reader::Rom(_) => return false,
        };
        match op {
            Op::Mul(..) => alone && matches!(reader, Reader::Cell(_)),
            Op::Mux { inputs, .. } => alone && inputs.len() == 2,
            _ => alone || mentioned <= SMALL,
        }
    }

    fn count_reads(&mut self) {
        let mut reads = BTreeMap::new();
        let mut read = |partition: Partition, net: NetId, bits: u64| {
            *reads.entry((partition, net)).or_insert(0) |= bits;
        };
        for reader in self.readers() {
            let partition = self.home(reader);
            for operand in self.operands(reader) {
                for piece in self.operand_bits(reader, operand).pieces() {
                    match *piece {
                        BitRun::Net { net, low, width } => read(partition, net, mask(width) << low),
                        BitRun::Copies { net, bit, .. } => read(partition, net, 1 << bit),
                        BitRun::Constant { .. } => {}
                    }
                }
            }
        }
        if let Some(reset) = self.reset {
            for register in &self.design.registers {
                if register.reset.is_some() {
                    read(self.partition(register.q), reset, 1);
                }
            }
        }
        self.reads = reads;
    }
}

/// Returns the number of address bits for `depth` words, at least 1: 584 words have 10.
pub fn address_width(depth: usize) -> u32 {
    depth.max(2).next_power_of_two().trailing_zeros()
}

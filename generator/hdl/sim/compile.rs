//! From [`Design`] to [`Program`].

use std::collections::{BTreeMap, HashMap, HashSet};

use anyhow::{Context, Result, anyhow, bail, ensure};

use crate::base::fixed::mask;
use crate::hdl::netlist::{Design, Driver, NetId, Role};
use crate::hdl::sim::banks;
use crate::hdl::sim::lower::drop_of;
use crate::hdl::sim::machine::execute;
use crate::hdl::sim::program::{
    InputPort, Instruction, Program, ReadEdge, RegisterEdge, Slot, Sources, Span,
};
use crate::hdl::sim::references;

/// Compiles a design. The errors are those of [`Program::new`].
pub(super) fn compile(design: &Design) -> Result<Program> {
    references::check(design)?;
    let mut compiler = Compiler::new(design)?;
    let order = design.levelise().map_err(|nets| {
        let names: Vec<_> = nets.iter().map(|net| design.net(*net).name.as_str()).collect();
        anyhow!("combinational loop through `{}`", names.join("`, `"))
    })?;
    for net in order {
        let slot = compiler.net(net).with_context(|| {
            let net = design.net(net);
            format!("net `{}` ({})", net.name, net.location)
        })?;
        compiler.of_net[net.index()] = slot;
    }
    compiler.finish()
}

/// Sources below this number change from outside settling and share numbers when they are many;
/// from here on each is a field of the control word, numbered in order of evaluation.
const FIRST_FIELD: u32 = 40;

/// An instruction and what orders it.
pub(super) struct Ordered {
    pub(super) sources: Sources,
    pub(super) to: Slot,
    /// All that it reads, the inputs of a mux too.
    pub(super) operands: Vec<Slot>,
    pub(super) instruction: Instruction,
}

/// To it there is one bank of slots, 64 bits wide; [`banks`] divides it.
pub(super) struct Compiler<'a> {
    pub(super) design: &'a Design,
    /// For each slot: the [`Sources`] it depends on within one clock; none for constants.
    pub(super) sources: Vec<Sources>,
    /// How many sources there are so far.
    numbered: u32,
    /// The next source for a field.
    next_field: u32,
    /// For each slot; the only lane is that of the folded constants.
    pub(super) initial: Vec<[u64; 1]>,
    constants: BTreeMap<u64, Slot>,
    /// Instructions already there, written to slot 0, and the slots that have their results.
    known: HashMap<Instruction, Slot>,
    /// The instruction that writes a slot, unless it is a field.
    made_by: HashMap<Slot, Instruction>,
    /// In an order of evaluation.
    pub(super) steps: Vec<Ordered>,
    pub(super) choices: Vec<Slot>,
    pub(super) words: Vec<u64>,
    roms: Vec<Span>,
    /// For each net; `Slot::MAX` until the net has been compiled.
    pub(super) of_net: Vec<Slot>,
    pub(super) inputs: Vec<InputPort>,
    /// For each field of the control word, the number of its lowest bit.
    fields: Vec<u32>,
}

impl<'a> Compiler<'a> {
    fn new(design: &'a Design) -> Result<Self> {
        let mut compiler = Self {
            design,
            sources: Vec::new(),
            numbered: 0,
            next_field: FIRST_FIELD,
            initial: Vec::new(),
            constants: BTreeMap::new(),
            known: HashMap::new(),
            made_by: HashMap::new(),
            steps: Vec::new(),
            choices: Vec::new(),
            words: Vec::new(),
            roms: Vec::new(),
            of_net: vec![Slot::MAX; design.nets.len()],
            inputs: Vec::new(),
            fields: Vec::new(),
        };
        for port in design.inputs() {
            let net = design.net(port.net);
            let new = compiler.of_net[port.net.index()] == Slot::MAX;
            ensure!(
                new && net.driver == Driver::Input,
                "`{}` ({}) is not an input port, or is one twice",
                net.name,
                net.location
            );
            let slot = compiler.source();
            compiler.of_net[port.net.index()] = slot;
            compiler.inputs.push(InputPort {
                at: compiler.inputs.len() as u32,
                slot,
                source: compiler.sources[slot as usize],
                mask: mask(design.width(port.net)),
            });
        }
        for rom in &design.roms {
            let mask = mask(design.width(rom.data));
            let start = u32::try_from(compiler.words.len()).context("the ROMs are too large")?;
            let len = u32::try_from(rom.words.len()).context("the ROMs are too large")?;
            compiler.roms.push(Span { start, len });
            compiler.words.extend(rom.words.iter().map(|word| word & mask));
        }
        if !design.control.fields.is_empty() {
            let fields = &design.control.fields;
            let wide: u32 = fields.iter().map(|field| design.width(field.net)).sum();
            let word = design.width(design.rom(design.control.rom).data);
            ensure!(wide <= word, "the fields take {wide} bits of a control word of {word}");
            compiler.fields = design.field_positions();
        }
        Ok(compiler)
    }

    fn fresh(&mut self, sources: Sources) -> Slot {
        self.sources.push(sources);
        self.initial.push([0]);
        (self.sources.len() - 1) as Slot
    }

    /// A slot that changes from outside settling.
    fn source(&mut self) -> Slot {
        let sources = 1 << (self.numbered % FIRST_FIELD);
        self.numbered += 1;
        self.fresh(sources)
    }

    /// A slot with a field of the control word. It is a source of its own, so that what depends on
    /// it is settled when the field changes, rather than whenever the address does.
    fn field(&mut self, word: NetId, low: u32, width: u32) -> Result<Slot> {
        let a = self.of_net[word.index()];
        if self.known_value(a).is_some() || self.next_field == Sources::BITS {
            return self.slice(word, low, width);
        }
        let (low, drop, source) = (low as u8, drop_of(width), self.next_field as u8);
        self.next_field += 1;
        let to = self.fresh(1 << source);
        let instruction = Instruction::Field { to, a, low, drop, source };
        self.push(to, &[a], instruction);
        Ok(to)
    }

    pub(super) fn constant(&mut self, bits: u64) -> Slot {
        if let Some(slot) = self.constants.get(&bits) {
            return *slot;
        }
        let slot = self.fresh(0);
        self.initial[slot as usize] = [bits];
        self.constants.insert(bits, slot);
        slot
    }

    /// The value of a slot that is known already.
    pub(super) fn known_value(&self, slot: Slot) -> Option<u64> {
        let constant = self.sources[slot as usize] == 0;
        constant.then(|| self.initial[slot as usize][0])
    }

    /// The slot with the result of an instruction, which `make` builds for a given destination.
    pub(super) fn emit(&mut self, operands: &[Slot], make: impl Fn(Slot) -> Instruction) -> Slot {
        if let Some(slot) = self.known.get(&make(0)) {
            return *slot;
        }
        let sources = self.sources_of(operands);
        let to = self.fresh(sources);
        if sources == 0 {
            execute(make(to), &self.choices, &self.words, &mut self.initial);
            let [bits] = self.initial.pop().unwrap_or_default();
            self.sources.pop();
            return self.constant(bits);
        }
        self.push(to, operands, make(to));
        self.known.insert(make(0), to);
        self.made_by.insert(to, make(to));
        to
    }

    fn push(&mut self, to: Slot, operands: &[Slot], instruction: Instruction) {
        self.steps.push(Ordered {
            sources: self.sources_of(operands),
            to,
            operands: operands.to_vec(),
            instruction,
        });
    }

    fn sources_of(&self, operands: &[Slot]) -> Sources {
        let sources = operands.iter().map(|slot| self.sources[*slot as usize]);
        sources.fold(0, |all, sources| all | sources)
    }

    /// The slot, the lowest bit and the width, as a `drop`, of which a slot is a slice; itself when
    /// it is none. Instructions that can cut use it, and the slice is often not needed then.
    pub(super) fn sliced(&self, slot: Slot) -> (Slot, u8, u8) {
        match self.made_by.get(&slot) {
            Some(Instruction::Slice { a, low, drop, .. }) => (*a, *low, *drop),
            _ => (slot, 0, 0),
        }
    }

    /// The slot, the lowest bit and the width, as a `drop`, of which a slot says whether any bit is 1.
    pub(super) fn any(&self, slot: Slot) -> Option<(Slot, u8, u8)> {
        match self.made_by.get(&slot) {
            Some(Instruction::Any { a, low, drop, .. }) => Some((*a, *low, *drop)),
            _ => None,
        }
    }

    /// What a slot is the placement of: base, slot, lowest bit, width as a `drop`, and shift. A slice is
    /// one on `zero`.
    pub(super) fn placed(&self, slot: Slot, zero: Slot) -> Option<(Slot, Slot, u8, u8, u8)> {
        match *self.made_by.get(&slot)? {
            Instruction::Place { base, a, low, drop, shift, .. } => {
                Some((base, a, low, drop, shift))
            }
            Instruction::Slice { a, low, drop, .. } => Some((zero, a, low, drop, 0)),
            _ => None,
        }
    }

    /// The slot of a net whose inputs have been compiled.
    fn net(&mut self, id: NetId) -> Result<Slot> {
        let design = self.design;
        let width = design.width(id);
        match &design.net(id).driver {
            Driver::Undriven => bail!("it has no driver"),
            Driver::Input => {
                let slot = self.of_net[id.index()];
                ensure!(slot != Slot::MAX, "it is an input, but not among the ports");
                Ok(slot)
            }
            Driver::Constant(bits) => Ok(self.constant(bits & mask(width))),
            Driver::Register(register) => {
                ensure!(design.register(*register).q == id, "its register drives another net");
                Ok(self.source())
            }
            Driver::Rom(rom) => {
                ensure!(design.rom(*rom).data == id, "its ROM drives another net");
                if design.rom(*rom).synchronous {
                    return Ok(self.source());
                }
                let address = self.of_net[design.rom(*rom).address.index()];
                let words = self.roms[rom.index()];
                let read = |to| Instruction::Read { to, address, words };
                Ok(self.emit(&[address], read))
            }
            Driver::Field(field) => {
                ensure!(
                    design.control.fields[field.index()].net == id,
                    "its field drives another net"
                );
                let word = design.rom(design.control.rom).data;
                self.field(word, self.fields[field.index()], width)
            }
            Driver::Op(op) => self.op(op, id),
        }
    }

    /// The clock edge, and everything together.
    fn finish(mut self) -> Result<Program> {
        let design = self.design;
        let one = self.constant(1);
        let reset = design.port(|role| role == Role::Reset);
        let mut written = Vec::new();
        let mut reads = Vec::new();
        for (at, rom) in design.roms.iter().enumerate() {
            if rom.synchronous {
                let to = self.of_net[rom.data.index()];
                let address = self.stable(self.of_net[rom.address.index()], &written);
                let enable = rom.enable.map_or(one, |net| self.of_net[net.index()]);
                let enable = self.stable(enable, &written);
                written.push(to);
                reads.push(ReadEdge {
                    to,
                    source: self.sources[to as usize],
                    address,
                    enable,
                    words: self.roms[at],
                });
            }
        }
        let mut registers = Vec::new();
        for register in &design.registers {
            let net = design.net(register.q);
            let what = || format!("register `{}` ({})", net.name, net.location);
            let q = self.of_net[register.q.index()];
            let data = register.data.context("it takes nothing").with_context(what)?;
            ensure!(
                design.width(data) == design.width(register.q),
                "{} takes data of another width",
                what()
            );
            let keep = match (register.reset, reset) {
                (None, _) => one,
                (Some(_), Some(port)) => self.of_net[port.net.index()],
                (Some(_), None) => bail!("{} is reset, but there is no reset port", what()),
            };
            let enable = register.enable.map_or(one, |net| self.of_net[net.index()]);
            let data = self.stable(self.of_net[data.index()], &written);
            let enable = self.stable(enable, &written);
            written.push(q);
            registers.push(RegisterEdge {
                q,
                source: self.sources[q as usize],
                data,
                enable,
                keep,
                reset: register.reset.unwrap_or(0) & mask(design.width(register.q)),
            });
        }
        self.drop_unneeded(&reads, &registers);
        // An operand depends on no source that the result does not depend on, so its set is the
        // smaller number; a field is the largest number among its own and those of its operands.
        // This remains an order of evaluation.
        self.steps.sort_by_key(|step| step.sources);
        Ok(banks::divide(&self, &reads, &registers))
    }

    /// Drops the instructions that neither the edge nor a named net or a port has a use for. What
    /// they would have computed has no slot then.
    fn drop_unneeded(&mut self, reads: &[ReadEdge], registers: &[RegisterEdge]) {
        let design = self.design;
        let mut needed = vec![false; self.sources.len()];
        let of_edge = reads
            .iter()
            .flat_map(|edge| [edge.address, edge.enable])
            .chain(registers.iter().flat_map(|edge| [edge.data, edge.enable, edge.keep]));
        let of_nets = design
            .iter()
            .filter(|(_, net)| net.named)
            .map(|(id, _)| id)
            .chain(design.ports.iter().map(|port| port.net))
            .map(|net| self.of_net[net.index()]);
        for slot in of_edge.chain(of_nets) {
            needed[slot as usize] = true;
        }
        let mut dropped = HashSet::new();
        for step in self.steps.iter().rev() {
            if needed[step.to as usize] {
                for slot in &step.operands {
                    needed[*slot as usize] = true;
                }
            } else {
                dropped.insert(step.to);
            }
        }
        self.steps.retain(|step| needed[step.to as usize]);
        for slot in &mut self.of_net {
            if dropped.contains(slot) {
                *slot = Slot::MAX;
            }
        }
    }

    /// A slot that holds the value of `a` until the edge is over, although the edge has written the
    /// slots `written` before: the edge happens everywhere at once.
    fn stable(&mut self, a: Slot, written: &[Slot]) -> Slot {
        if written.contains(&a) { self.emit(&[a], |to| Instruction::Copy { to, a }) } else { a }
    }
}

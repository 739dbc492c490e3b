//! The state of the simulator's compiler: slots, instructions, and facts about them.

use std::collections::{BTreeMap, HashMap};
use std::mem;

use crate::netlist::{Design, Driver, NetId};
use crate::sim::machine::execute;
use crate::sim::program::{InputPort, Instruction, Slot, Sources, Span};
use glint_base::fixed::mask;

/// The number of sources for input ports. Ports have the first numbers, because they change at another clock edge than
/// registers and ROMs.
const INPUTS: u32 = 16;

/// From this number on, each source is a field of the control word, numbered in the order of evaluation. Smaller numbers are
/// input ports, registers and ROM outputs; if there are more such sources than numbers, several share a number.
const FIRST_FIELD: u32 = 40;

/// An instruction, and the data by which the compiler orders instructions.
pub(super) struct Ordered {
    pub(super) sources: Sources,
    pub(super) to: Slot,
    /// All slots that the instruction reads, also the inputs of a mux.
    pub(super) operands: Vec<Slot>,
    pub(super) instruction: Instruction,
}

/// The compiler's state. All slots have 64 bits here; `banks` divides them later.
pub(super) struct Compiler<'a> {
    pub(super) design: &'a Design,
    /// For each slot, the [`Sources`] on which it depends within one clock; none for constants.
    pub(super) sources: Vec<Sources>,
    /// The number of sources that are input ports.
    input_sources: u32,
    /// The number of the source for the next value that a rising edge writes.
    next_source: u32,
    /// For each enable, the source of the values that a rising edge writes only if it is 1.
    enabled: HashMap<NetId, u32>,
    pub(super) next_field: u32,
    /// Each slot has one lane, in which constant instructions are evaluated.
    pub(super) initial: Vec<[u64; 1]>,
    constants: BTreeMap<u64, Slot>,
    /// The instructions so far, each with the slot of its result. In the key the result is slot 0, so that equal instructions are
    /// found.
    known: HashMap<Instruction, Slot>,
    /// The instruction that writes each slot. Fields of the control word, and slots that no instruction writes, have no entry.
    made_by: HashMap<Slot, Instruction>,
    /// Each instruction follows the instructions that compute its operands.
    pub(super) steps: Vec<Ordered>,
    pub(super) choices: Vec<Slot>,
    pub(super) words: Vec<u64>,
    pub(super) roms: Vec<Span>,
    /// For each net, its slot; `Slot::MAX` until the net has been compiled.
    pub(super) of_net: Vec<Slot>,
    pub(super) inputs: Vec<InputPort>,
    /// For each field of the control word, its lowest bit.
    pub(super) fields: Vec<u32>,
}

impl<'a> Compiler<'a> {
    /// Gives slots to the input ports and the contents of the ROMs.
    pub(super) fn new(design: &'a Design) -> Self {
        let input_sources = (design.inputs().count() as u32).clamp(1, INPUTS);
        let mut compiler = Self {
            design,
            sources: Vec::new(),
            input_sources,
            next_source: input_sources,
            enabled: HashMap::new(),
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
            fields: design.field_positions(),
        };
        for (at, port) in design.inputs().enumerate() {
            let slot = compiler.fresh(1 << (at as u32 % input_sources));
            compiler.of_net[port.net.index()] = slot;
            compiler.inputs.push(InputPort {
                at: at as u32,
                slot,
                source: compiler.sources[slot as usize],
                mask: mask(design.width(port.net)),
            });
        }
        for rom in &design.roms {
            let mask = mask(design.width(rom.data));
            let (start, len) = (compiler.words.len() as u32, rom.words.len() as u32);
            compiler.roms.push(Span { start, len });
            compiler.words.extend(rom.words.iter().map(|word| word & mask));
        }
        compiler
    }

    pub(super) fn fresh(&mut self, sources: Sources) -> Slot {
        self.sources.push(sources);
        self.initial.push([0]);
        (self.sources.len() - 1) as Slot
    }

    /// Returns a new slot for a value that the rising edge writes if `enable` is 1. All slots with the same enable share one
    /// source, because they change together. Fields of the control word are an exception, because a microinstruction seldom
    /// changes all the values that it loads.
    pub(super) fn source(&mut self, enable: Option<NetId>) -> Slot {
        let shared = enable.filter(|net| !matches!(self.design.net(*net).driver, Driver::Field(_)));
        if let Some(enable) = shared
            && let Some(&number) = self.enabled.get(&enable)
        {
            return self.fresh(1 << number);
        }
        let next = self.next_source + 1;
        let after = if next == FIRST_FIELD { self.input_sources } else { next };
        let number = mem::replace(&mut self.next_source, after);
        if let Some(enable) = shared {
            self.enabled.insert(enable, number);
        }
        self.fresh(1 << number)
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

    /// Returns the value of a slot, or `None` if the value is not constant. The compiler simplifies instructions with constant
    /// operands.
    pub(super) fn known_value(&self, slot: Slot) -> Option<u64> {
        let constant = self.sources[slot as usize] == 0;
        constant.then(|| self.initial[slot as usize][0])
    }

    /// Returns the slot with the result of an instruction, which `make` builds for a given result slot. An equal earlier
    /// instruction replaces it, or a constant if all operands are constant.
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

    pub(super) fn push(&mut self, to: Slot, operands: &[Slot], instruction: Instruction) {
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

    /// Returns the operand of the slice that makes `slot`, the lowest bit, and the width as a `drop`; without a slice, all bits
    /// of `slot`. An instruction that can take bits of its operand reads the operand directly, so that the slice may become
    /// unused.
    pub(super) fn sliced(&self, slot: Slot) -> (Slot, u8, u8) {
        match self.made_by.get(&slot) {
            Some(Instruction::Slice { a, low, drop, .. }) => (*a, *low, *drop),
            _ => (slot, 0, 0),
        }
    }

    /// Returns the bits that `slot` tests for any 1: their slot, the lowest bit, and the width as a `drop`. Returns `None` unless
    /// [`Instruction::Any`] makes it.
    pub(super) fn any(&self, slot: Slot) -> Option<(Slot, u8, u8)> {
        match self.made_by.get(&slot) {
            Some(Instruction::Any { a, low, drop, .. }) => Some((*a, *low, *drop)),
            _ => None,
        }
    }

    /// Returns the placement that makes `slot`: the base, the slot of the added bits, the lowest of them, their width as a
    /// `drop`, and the shift. A slice is a placement on the slot `zero`.
    pub(super) fn placed(&self, slot: Slot, zero: Slot) -> Option<(Slot, Slot, u8, u8, u8)> {
        match *self.made_by.get(&slot)? {
            Instruction::Place { base, a, low, drop, shift, .. } => {
                Some((base, a, low, drop, shift))
            }
            Instruction::Slice { a, low, drop, .. } => Some((zero, a, low, drop, 0)),
            _ => None,
        }
    }
}

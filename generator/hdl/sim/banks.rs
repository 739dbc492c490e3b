//! Distributes the values of a compiled design over two banks of memory with slots of 32 and of 64 bits. Most values fit into 32
//! bits, and a vector of the processor holds twice as many of them.

use crate::sim::compiler::{Compiler, Ordered};
use crate::sim::program::{
    Bank, CompiledDesign, InputPort, Instruction, ReadEdge, RegisterEdge, SettlingStep, Slot,
    Sources, StepGroup, ValueSlot,
};

const NARROW: u32 = u32::BITS;

/// Gives every value of the compiler, which has only slots of 64 bits, a slot in one of the two banks. Inserts conversions
/// before instructions that work on both banks. Within a bank, slots are numbered in the order in which they are computed.
pub(super) fn divide(
    compiler: &Compiler,
    reads: &[ReadEdge],
    registers: &[RegisterEdge],
) -> CompiledDesign {
    let mut is_wide: Vec<bool> = widths(compiler).iter().map(|&bits| bits > NARROW).collect();
    // A slot that loads a wide slot at the edge is itself wide, and so is a slot that loads this slot.
    let mut pairs: Vec<(Slot, Slot)> = Vec::new();
    pairs.extend(reads.iter().map(|edge| (edge.to, edge.address)));
    pairs.extend(registers.iter().map(|edge| (edge.q, edge.data)));
    while let Some((to, _)) =
        pairs.iter().find(|(to, from)| is_wide[*from as usize] && !is_wide[*to as usize])
    {
        is_wide[*to as usize] = true;
    }
    let mut divider = BankSplitter {
        compiler,
        is_wide,
        narrow: Bank::default(),
        wide: Bank::default(),
        narrow_of: vec![None; compiler.sources.len()],
        wide_of: vec![None; compiler.sources.len()],
        steps: Vec::new(),
        choices: Vec::new(),
    };
    divider.inputs();
    for step in &compiler.steps {
        divider.step(step);
    }
    divider.edge(reads, registers);
    divider.program()
}

/// Returns an upper limit of the width of the value in each slot. The nets that share a slot are zero extensions of the narrowest
/// of them.
fn widths(compiler: &Compiler) -> Vec<u32> {
    let mut widths = vec![u64::BITS + 1; compiler.sources.len()];
    for (net, &slot) in compiler.of_net.iter().enumerate() {
        if let Some(width) = widths.get_mut(slot as usize) {
            *width = (*width).min(compiler.design.nets[net].format.width());
        }
    }
    for (slot, width) in widths.iter_mut().enumerate() {
        if let Some(bits) = compiler.known_value(slot as Slot) {
            *width = u64::BITS - bits.leading_zeros();
        }
    }
    for step in &compiler.steps {
        let to = step.to as usize;
        if widths[to] <= u64::BITS {
            continue;
        }
        // A slot without a net is part of a concatenation, or a copy for the edge.
        widths[to] = match step.instruction {
            Instruction::Place { base, drop, shift, .. } => {
                widths[base as usize].max(u64::BITS - u32::from(drop) + u32::from(shift))
            }
            Instruction::Copy { a, .. } => widths[a as usize],
            _ => u64::BITS,
        };
    }
    widths
}

struct BankSplitter<'a> {
    compiler: &'a Compiler<'a>,
    /// For each slot of the compiler, whether its value is wider than 32 bits.
    is_wide: Vec<bool>,
    narrow: Bank,
    wide: Bank,
    /// For each slot of the compiler, its slot in the narrow bank, if it has one.
    narrow_of: Vec<Option<Slot>>,
    wide_of: Vec<Option<Slot>>,
    steps: Vec<(Sources, SettlingStep)>,
    choices: Vec<Slot>,
}

impl BankSplitter<'_> {
    fn fresh(&mut self, wide: bool, initial: u64) -> Slot {
        let bank = if wide { &mut self.wide } else { &mut self.narrow };
        bank.initial.push(initial);
        (bank.initial.len() - 1) as Slot
    }

    /// Adds a slot for the value in the compiler's slot `slot`, in the bank for its width.
    fn home(&mut self, slot: Slot) -> Slot {
        let wide = self.is_wide[slot as usize];
        let [initial] = self.compiler.initial[slot as usize];
        let home = self.fresh(wide, initial);
        let of = if wide { &mut self.wide_of } else { &mut self.narrow_of };
        of[slot as usize] = Some(home);
        home
    }

    fn inputs(&mut self) {
        for port in &self.compiler.inputs {
            let slot = self.home(port.slot);
            let wide = self.is_wide[port.slot as usize];
            self.bank(wide).inputs.push(InputPort { slot, ..*port });
        }
    }

    /// Returns the bank and the slot of the value in the compiler's slot `slot`, or `None` before the value has one.
    fn place(&self, slot: Slot) -> Option<ValueSlot> {
        let slot = slot as usize;
        if *self.is_wide.get(slot)? {
            self.wide_of[slot].map(ValueSlot::Wide)
        } else {
            self.narrow_of[slot].map(ValueSlot::Narrow)
        }
    }

    /// Returns the slot of the compiler's slot `slot` in the wide or the narrow bank. Constants, registers and ROMs get their
    /// slots at the first call. A necessary conversion to the wide bank becomes a step with these `sources`, whose result later
    /// calls use too. Panics if a wide value is requested in the narrow bank.
    fn operand(&mut self, slot: Slot, wide: bool, sources: Sources) -> Slot {
        let of = if wide { &self.wide_of } else { &self.narrow_of };
        if let Some(there) = of[slot as usize] {
            return there;
        }
        let a = match self.place(slot) {
            Some(ValueSlot::Narrow(home) | ValueSlot::Wide(home)) => home,
            None => self.home(slot),
        };
        if self.is_wide[slot as usize] == wide {
            return a;
        }
        assert!(wide, "what has a wide operand is done wide");
        let [initial] = self.compiler.initial[slot as usize];
        let to = self.fresh(true, initial);
        if self.compiler.known_value(slot).is_none() {
            self.steps.push((sources, SettlingStep::Widen { to, a }));
        }
        self.wide_of[slot as usize] = Some(to);
        to
    }

    /// Adds a narrow slot with 64 − `drop` bits of a wide value, from bit `low` up.
    fn cut(&mut self, slot: Slot, low: u8, drop: u8, sources: Sources) -> Slot {
        let a = self.operand(slot, true, sources);
        let to = self.fresh(false, 0);
        self.steps.push((sources, SettlingStep::Cut { to, a, low, drop }));
        to
    }

    fn step(&mut self, step: &Ordered) {
        use Instruction as I;
        let sources = step.sources;
        let is_wide = |slot: Slot| self.is_wide[slot as usize];
        let fits = |drop: u8| u64::BITS - u32::from(drop) <= NARROW;
        match step.instruction {
            I::Slice { to, a, low, drop } if is_wide(a) && !is_wide(to) => {
                let cut = self.cut(a, low, drop, sources);
                self.narrow_of[to as usize] = Some(cut);
            }
            // These instructions take bits of their operand. If a step takes them beforehand, the rest of the work is narrow.
            I::Field { a, low, drop, source, .. } if is_wide(a) => {
                let a = self.cut(a, low, drop, sources);
                let to = self.home(step.to);
                let field = I::Field { to, a, low: 0, drop, source };
                self.steps.push((sources, SettlingStep::Narrow(field)));
            }
            I::ChooseAny { of, low, drop, a, b, .. }
                if is_wide(of) && !is_wide(step.to) && fits(drop) =>
            {
                let of = self.cut(of, low, drop, sources);
                let [a, b] = [a, b].map(|slot| self.operand(slot, false, sources));
                let to = self.home(step.to);
                let choose = I::ChooseAny { to, of, low: 0, drop, a, b };
                self.steps.push((sources, SettlingStep::Narrow(choose)));
            }
            I::Any { a, low, drop, .. } if is_wide(a) && fits(drop) => {
                let a = self.cut(a, low, drop, sources);
                let to = self.home(step.to);
                let any = I::Any { to, a, low: 0, drop };
                self.steps.push((sources, SettlingStep::Narrow(any)));
            }
            I::Place { to, base, a, low, drop, shift } if is_wide(a) && !is_wide(to) => {
                let a = self.cut(a, low, drop, sources);
                let base = self.operand(base, false, sources);
                let to = self.home(step.to);
                let place = I::Place { to, base, a, low: 0, drop, shift };
                self.steps.push((sources, SettlingStep::Narrow(place)));
            }
            I::MulUnsigned { to, a, b } if is_wide(to) && !is_wide(a) && !is_wide(b) => {
                let (a, b) = (self.operand(a, false, sources), self.operand(b, false, sources));
                let to = self.home(to);
                self.steps.push((sources, SettlingStep::Product { to, a, b }));
            }
            I::MulSigned { to, a, b, drop_a, drop_b, drop }
                if is_wide(to) && fits(drop_a) && fits(drop_b) =>
            {
                let (a, b) = (self.operand(a, false, sources), self.operand(b, false, sources));
                let to = self.home(to);
                let product = SettlingStep::SignedProduct { to, a, b, drop_a, drop_b, drop };
                self.steps.push((sources, product));
            }
            instruction => self.within_a_bank(step, instruction),
        }
    }

    /// Adds an instruction without change, in the wide bank if any of its slots is wide.
    fn within_a_bank(&mut self, step: &Ordered, mut instruction: Instruction) {
        let sources = step.sources;
        let result_wide = self.is_wide[step.to as usize];
        let wide = result_wide || step.operands.iter().any(|&slot| self.is_wide[slot as usize]);
        if let Instruction::Mux { first, last, .. } = &mut instruction {
            let inputs = *first as usize..=*last as usize;
            *first = self.choices.len() as u32;
            for &input in &self.compiler.choices[inputs] {
                let input = self.operand(input, wide, sources);
                self.choices.push(input);
            }
            *last = self.choices.len() as u32 - 1;
        }
        let mut slots = instruction.slots_mut().into_iter();
        let to = slots.next();
        for slot in slots {
            *slot = self.operand(*slot, wide, sources);
        }
        // The result gets its number last, so that it comes after its operands.
        let result = if wide == result_wide { self.home(step.to) } else { self.fresh(wide, 0) };
        if let Some(to) = to {
            *to = result;
        }
        let of_bank = if wide { SettlingStep::Wide } else { SettlingStep::Narrow };
        self.steps.push((sources, of_bank(instruction)));
        if wide != result_wide {
            let (to, a) = (self.home(step.to), result);
            let (low, drop) = (0, NARROW as u8);
            self.steps.push((sources, SettlingStep::Cut { to, a, low, drop }));
        }
    }

    /// Adds the ROM reads and register loads of the clock edge, each to the bank of the slot that it writes. If that slot is wide
    /// and a source is narrow, a settling step widens the source, so that the edge uses the value from before the edge.
    fn edge(&mut self, reads: &[ReadEdge], registers: &[RegisterEdge]) {
        for edge in reads {
            let wide = self.is_wide[edge.to as usize];
            let mut slot = |slot: Slot| self.settled(slot, wide);
            let edge = ReadEdge {
                to: slot(edge.to),
                address: slot(edge.address),
                enable: edge.enable.map(&mut slot),
                ..*edge
            };
            self.bank(wide).reads.push(edge);
        }
        for edge in registers {
            let wide = self.is_wide[edge.q as usize];
            let mut slot = |slot: Slot| self.settled(slot, wide);
            let edge = RegisterEdge {
                q: slot(edge.q),
                data: slot(edge.data),
                enable: edge.enable.map(&mut slot),
                reset: edge.reset.map(|(rst_n, bits)| (slot(rst_n), bits)),
                ..*edge
            };
            self.bank(wide).registers.push(edge);
        }
    }

    /// Returns the slot of the compiler's slot `slot` after settling.
    fn settled(&mut self, slot: Slot, wide: bool) -> Slot {
        self.operand(slot, wide, self.compiler.sources[slot as usize])
    }

    fn bank(&mut self, wide: bool) -> &mut Bank {
        if wide { &mut self.wide } else { &mut self.narrow }
    }

    fn program(mut self) -> CompiledDesign {
        let of_net = &self.compiler.of_net;
        for &slot in of_net.iter().filter(|&&slot| slot != Slot::MAX) {
            if self.place(slot).is_none() {
                self.home(slot);
            }
        }
        let places = of_net.iter().map(|&slot| self.place(slot)).collect();
        let mut segments = Vec::new();
        for group in self.steps.chunk_by(|(a, _), (b, _)| a == b) {
            segments.push(StepGroup { sources: group[0].0, len: group.len() as u32 });
        }
        CompiledDesign {
            steps: self.steps.into_iter().map(|(_, step)| step).collect(),
            segments,
            narrow: self.narrow,
            wide: self.wide,
            choices: self.choices,
            words: self.compiler.words.clone(),
            writes: self.compiler.writes(),
            places,
        }
    }
}

//! Executes compiled designs. One pass over the instructions advances many independent instances of a design, called lanes.

use std::hint::select_unpredictable;
use std::mem;
use std::sync::Arc;

use crate::netlist::{NetId, joined};
use crate::sim::program::{
    Bank, CompiledDesign, Instruction, SettlingStep, Slot, Sources, Span, ValueSlot,
};
use crate::sim::slots::Slots;
use crate::sim::word::LaneWord;

/// The state of `LANES` independent instances of a design.
///
/// On x86-64 the pass is compiled three times: for any processor, for AVX2 and for AVX-512. The machine chooses one of them at
/// run time; all three compute the same values.
#[derive(Clone, Debug)]
pub struct Machine<const LANES: usize = 1> {
    program: Arc<CompiledDesign>,
    narrow: Slots<u32, LANES>,
    wide: Slots<u64, LANES>,
    /// The sources that have changed since all nets were last evaluated.
    changed: Sources,
}

impl<const LANES: usize> Machine<LANES> {
    /// Makes a machine after power-up: registers, outputs of synchronous ROMs and inputs are 0, and all nets are up to date.
    pub fn new(program: Arc<CompiledDesign>) -> Self {
        let mut machine = Self {
            narrow: power_up(&program.narrow),
            wide: power_up(&program.wide),
            program,
            changed: Sources::MAX,
        };
        machine.update(false, None);
        machine
    }

    /// Inverts the bits of a ROM word that are 1 in `bits`, which models a fault; a second call restores the word. Words are
    /// numbered through all ROMs, in the order of the design. Panics if `word` is too large.
    pub fn invert(&mut self, word: usize, bits: u64) {
        Arc::make_mut(&mut self.program).words[word] ^= bits;
        self.changed = Sources::MAX;
    }

    /// Performs a rising edge if `edge` is true, then applies `inputs` if there are any, and then evaluates all nets. Returns
    /// whether the value of any source (input, register or ROM output) has changed, or a ROM word has been inverted.
    ///
    /// `inputs` must have the bit pattern of each input port, in order of declaration; bits beyond the width of a port are
    /// ignored.
    pub fn update(&mut self, edge: bool, inputs: Option<&[[u64; LANES]]>) -> bool {
        let written = if edge { self.written_words() } else { Vec::new() };
        let changed = self.update_at_level(edge, inputs);
        if written.is_empty() {
            return changed;
        }
        let words = &mut Arc::make_mut(&mut self.program).words;
        for (at, word) in written {
            words[at] = word;
        }
        self.changed = Sources::MAX;
        self.update_at_level(false, None)
    }

    /// Returns the words that the write ports store at this edge, with their indices among the words of all ROMs.
    ///
    /// # Panics
    /// Panics if the lanes, which share the words, write differently.
    fn written_words(&self) -> Vec<(usize, u64)> {
        let mut written = Vec::new();
        for write in &self.program.writes {
            let common = |net: NetId| {
                let values = self.lanes(net);
                assert!(values.iter().all(|value| *value == values[0]), "lanes write differently");
                values[0]
            };
            if common(write.enable) == 0 {
                continue;
            }
            let address = common(write.address);
            let word = joined(write.parts.iter().map(|&(part, width)| (common(part), width)));
            if address < u64::from(write.words.len) {
                written.push((write.words.start as usize + address as usize, word));
            }
        }
        written
    }

    /// Does the work of [`Machine::update`] with the widest vectors of this processor, without writes to memories.
    fn update_at_level(&mut self, edge: bool, inputs: Option<&[[u64; LANES]]>) -> bool {
        #[cfg(target_arch = "x86_64")]
        match VectorLevel::here() {
            // SAFETY: this processor has AVX-512.
            VectorLevel::Avx512 => return unsafe { self.update_avx512(edge, inputs) },
            // SAFETY: this processor has AVX2.
            VectorLevel::Avx2 => return unsafe { self.update_avx2(edge, inputs) },
            VectorLevel::Base => {}
        }
        self.update_here(edge, inputs)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    fn update_avx512(&mut self, edge: bool, inputs: Option<&[[u64; LANES]]>) -> bool {
        self.update_here(edge, inputs)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn update_avx2(&mut self, edge: bool, inputs: Option<&[[u64; LANES]]>) -> bool {
        self.update_here(edge, inputs)
    }

    #[inline(always)]
    fn update_here(&mut self, edge: bool, inputs: Option<&[[u64; LANES]]>) -> bool {
        let CompiledDesign { narrow, wide, words, .. } = &*self.program;
        if edge {
            self.changed = clock(narrow, words, &mut self.narrow, self.changed);
            self.changed = clock(wide, words, &mut self.wide, self.changed);
        }
        if let Some(inputs) = inputs {
            self.changed = take_inputs(narrow, inputs, &mut self.narrow, self.changed);
            self.changed = take_inputs(wide, inputs, &mut self.wide, self.changed);
        }
        let changed = self.changed != 0;
        if changed {
            self.settle();
        }
        changed
    }

    #[inline(always)]
    fn settle(&mut self) {
        let CompiledDesign { steps, segments, choices, words, .. } = &*self.program;
        let (narrow, wide) = (&mut *self.narrow, &mut *self.wide);
        let mut changed = mem::take(&mut self.changed);
        let mut rest = steps.as_slice();
        for segment in segments {
            let (here, after) = rest.split_at(segment.len as usize);
            rest = after;
            if changed & segment.sources == 0 {
                continue;
            }
            for step in here {
                match *step {
                    SettlingStep::Narrow(instruction) => {
                        changed |= execute(instruction, choices, words, narrow);
                    }
                    SettlingStep::Wide(instruction) => {
                        changed |= execute(instruction, choices, words, wide);
                    }
                    SettlingStep::Widen { to, a } => {
                        map(&mut wide[to as usize], &narrow[a as usize], u64::from);
                    }
                    SettlingStep::Cut { to, a, low, drop } => {
                        let cut = |a: u64| (a >> low & u64::MAX >> drop) as u32;
                        map(&mut narrow[to as usize], &wide[a as usize], cut);
                    }
                    SettlingStep::Product { to, a, b } => {
                        let [a, b] = [a, b].map(|slot| &narrow[slot as usize]);
                        let product = |a, b| u64::from(a) * u64::from(b);
                        map2(&mut wide[to as usize], a, b, product);
                    }
                    SettlingStep::SignedProduct { to, a, b, drop_a, drop_b, drop } => {
                        let [a, b] = [a, b].map(|slot| &narrow[slot as usize]);
                        let signed = |bits: u32, drop| i64::from(sign_extended(bits, drop) as i32);
                        let product = |a, b| {
                            (signed(a, drop_a) * signed(b, drop_b)) as u64 & u64::MAX >> drop
                        };
                        map2(&mut wide[to as usize], a, b, product);
                    }
                }
            }
        }
    }

    /// Returns for each lane a bit pattern that is 0 exactly if every net has its value in `expected`. Only the bits that are 1
    /// in `known`, if given, are compared.
    ///
    /// # Panics
    /// Panics if the compiler has optimised a net away, which it may do only if the net has no name.
    pub fn differences(
        &self,
        nets: &[NetId],
        expected: &[[u64; LANES]],
        known: Option<&[[u64; LANES]]>,
    ) -> [u64; LANES] {
        #[cfg(target_arch = "x86_64")]
        if VectorLevel::here() != VectorLevel::Base {
            // SAFETY: this processor has AVX2.
            return unsafe { self.differences_avx2(nets, expected, known) };
        }
        self.differences_here(nets, expected, known)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn differences_avx2(
        &self,
        nets: &[NetId],
        expected: &[[u64; LANES]],
        known: Option<&[[u64; LANES]]>,
    ) -> [u64; LANES] {
        self.differences_here(nets, expected, known)
    }

    #[inline(always)]
    fn differences_here(
        &self,
        nets: &[NetId],
        expected: &[[u64; LANES]],
        known: Option<&[[u64; LANES]]>,
    ) -> [u64; LANES] {
        let all = [u64::MAX; LANES];
        let mut differences = [0; LANES];
        let (narrow, wide) = (&*self.narrow, &*self.wide);
        for (at, (net, expected)) in nets.iter().zip(expected).enumerate() {
            let known = known.map_or(&all, |known| &known[at]);
            match self.program.place(*net) {
                ValueSlot::Narrow(slot) => {
                    let bits = &narrow[slot as usize];
                    for lane in 0..LANES {
                        differences[lane] |= (u64::from(bits[lane]) ^ expected[lane]) & known[lane];
                    }
                }
                ValueSlot::Wide(slot) => {
                    let bits = &wide[slot as usize];
                    for lane in 0..LANES {
                        differences[lane] |= (bits[lane] ^ expected[lane]) & known[lane];
                    }
                }
            }
        }
        differences
    }

    /// Returns the bit pattern of a net in each lane. Panics for an unnamed net that the compiler has optimised away.
    pub fn lanes(&self, net: NetId) -> [u64; LANES] {
        match self.program.place(net) {
            ValueSlot::Narrow(slot) => self.narrow[slot as usize].map(u64::from),
            ValueSlot::Wide(slot) => self.wide[slot as usize],
        }
    }

    /// Returns the bit pattern of a net in one lane. Panics if `lane` is not less than `LANES`, or for an unnamed net that the
    /// compiler has optimised away.
    pub fn lane(&self, net: NetId, lane: usize) -> u64 {
        match self.program.place(net) {
            ValueSlot::Narrow(slot) => self.narrow[slot as usize][lane].into(),
            ValueSlot::Wide(slot) => self.wide[slot as usize][lane],
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, PartialEq, Eq)]
enum VectorLevel {
    Base,
    Avx2,
    /// AVX-512 instructions; the processor then has AVX2 too.
    Avx512,
}

#[cfg(target_arch = "x86_64")]
impl VectorLevel {
    #[inline]
    fn here() -> Self {
        if !is_x86_feature_detected!("avx2") {
            Self::Base
        } else if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            Self::Avx512
        } else {
            Self::Avx2
        }
    }
}

fn power_up<W: LaneWord, const LANES: usize>(bank: &Bank) -> Slots<W, LANES> {
    Slots::new(bank.initial.iter().map(|&bits| [W::low(bits); LANES]))
}

/// Stores the inputs. Returns `news`, the sources that have already changed, with the input ports that change in any lane.
#[inline(always)]
fn take_inputs<W: LaneWord, const LANES: usize>(
    bank: &Bank,
    inputs: &[[u64; LANES]],
    slots: &mut [[W; LANES]],
    mut news: Sources,
) -> Sources {
    for port in &bank.inputs {
        let mut bits = [W::ZERO; LANES];
        map(&mut bits, &inputs[port.at as usize], |bits| W::low(bits & port.mask));
        news |= store(&mut slots[port.slot as usize], &bits, port.source, news);
    }
    news
}

/// Performs the rising edge in one bank. Returns `news`, the sources that have already changed, with the sources that change in
/// any lane.
#[inline(always)]
fn clock<W: LaneWord, const LANES: usize>(
    bank: &Bank,
    words: &[u64],
    slots: &mut [[W; LANES]],
    mut news: Sources,
) -> Sources {
    for edge in &bank.reads {
        let mut word = [W::ZERO; LANES];
        map(&mut word, &slots[edge.address as usize], |address| {
            W::low(read(words, edge.words, address.into()))
        });
        let word = enabled(slots, edge.to, word, edge.enable);
        news |= store(&mut slots[edge.to as usize], &word, edge.source, news);
    }
    for edge in &bank.registers {
        let slot = |slot: Slot| slot as usize;
        let disjoint = match (edge.enable, edge.reset) {
            (Some(enable), None) => {
                slots.get_disjoint_mut([slot(edge.q), slot(edge.data), slot(enable)]).ok()
            }
            _ => None,
        };
        // Most registers of a pipeline have an enable and no reset, and can be loaded in place.
        if let Some([q, data, enable]) = disjoint {
            news |= load(q, data, enable, edge.source, news);
            continue;
        }
        let mut next = enabled(slots, edge.q, slots[edge.data as usize], edge.enable);
        if let Some((rst_n, reset)) = edge.reset {
            let (rst_n, reset) = (&slots[rst_n as usize], W::low(reset));
            for lane in 0..LANES {
                next[lane] = select_unpredictable(rst_n[lane] == W::ZERO, reset, next[lane]);
            }
        }
        news |= store(&mut slots[edge.q as usize], &next, edge.source, news);
    }
    news
}

/// Loads a register in the lanes whose `enable` is 1. Returns the result of [`changed`].
#[inline(always)]
fn load<W: LaneWord, const LANES: usize>(
    q: &mut [W; LANES],
    data: &[W; LANES],
    enable: &[W; LANES],
    source: Sources,
    news: Sources,
) -> Sources {
    let changed = changed::<W, LANES>(source, news, |lane| {
        select_unpredictable(enable[lane] == W::ZERO, W::ZERO, q[lane] ^ data[lane])
    });
    for lane in 0..LANES {
        q[lane] = select_unpredictable(enable[lane] == W::ZERO, q[lane], data[lane]);
    }
    changed
}

/// Returns `new` in the lanes whose enable is 1, and the old value in all others. Without an enable, all lanes are `new`.
#[inline(always)]
fn enabled<W: LaneWord, const LANES: usize>(
    slots: &[[W; LANES]],
    slot: Slot,
    mut new: [W; LANES],
    enable: Option<Slot>,
) -> [W; LANES] {
    if let Some(enable) = enable {
        let (old, enable) = (&slots[slot as usize], &slots[enable as usize]);
        for lane in 0..LANES {
            new[lane] = select_unpredictable(enable[lane] == W::ZERO, old[lane], new[lane]);
        }
    }
    new
}

/// Stores a value. Returns the result of [`changed`].
#[inline(always)]
fn store<W: LaneWord, const LANES: usize>(
    slot: &mut [W; LANES],
    new: &[W; LANES],
    source: Sources,
    news: Sources,
) -> Sources {
    let changed = changed::<W, LANES>(source, news, |lane| slot[lane] ^ new[lane]);
    *slot = *new;
    changed
}

/// Returns `source` if `difference` is not 0 in any lane, unless `source` is already in `news`; and otherwise 0.
#[inline(always)]
fn changed<W: LaneWord, const LANES: usize>(
    source: Sources,
    news: Sources,
    difference: impl Fn(usize) -> W,
) -> Sources {
    if news & source != 0 {
        return 0;
    }
    let mut differences = W::ZERO;
    for lane in 0..LANES {
        differences = differences | difference(lane);
    }
    if differences == W::ZERO { 0 } else { source }
}

/// Executes one instruction in all lanes. Returns the source of an [`Instruction::Field`] that has changed, or 0.
#[inline(always)]
pub(super) fn execute<W: LaneWord, const LANES: usize>(
    instruction: Instruction,
    choices: &[Slot],
    words: &[u64],
    slots: &mut [[W; LANES]],
) -> Sources {
    use Instruction as I;
    let mask = |drop: u8| W::low(u64::MAX >> drop);
    match instruction {
        I::Copy { to, a } => unary(slots, to, a, |a| a),
        I::Field { to, a, low, drop, source } => {
            let mut field = [W::ZERO; LANES];
            map(&mut field, &slots[a as usize], |a| a >> low & mask(drop));
            return store(&mut slots[to as usize], &field, 1 << source, 0);
        }
        I::Slice { to, a, low, drop } => unary(slots, to, a, |a| a >> low & mask(drop)),
        I::Place { to, base, a, low, drop, shift } => {
            binary(slots, to, base, a, |base, a| base | (a >> low & mask(drop)) << shift)
        }
        I::SignExtend { to, a, from, drop } => {
            unary(slots, to, a, |a| sign_extended(a, from) & mask(drop));
        }
        I::And { to, a, b } => binary(slots, to, a, b, |a, b| a & b),
        I::Or { to, a, b } => binary(slots, to, a, b, |a, b| a | b),
        I::Xor { to, a, b } => binary(slots, to, a, b, |a, b| a ^ b),
        I::Add { to, a, b, drop } => {
            binary(slots, to, a, b, |a, b| a.wrapping_add(b) & mask(drop));
        }
        I::AddSlices { to, a, b, low_a, drop_a, low_b, drop_b, drop } => {
            binary(slots, to, a, b, |a, b| {
                let (a, b) = (a >> low_a & mask(drop_a), b >> low_b & mask(drop_b));
                a.wrapping_add(b) & mask(drop)
            })
        }
        I::AddCarry { to, a, b, carry, drop } => {
            ternary(slots, to, [a, b, carry], |a, b, carry| {
                a.wrapping_add(b).wrapping_add(carry) & mask(drop)
            })
        }
        I::Sub { to, a, b, drop } => {
            binary(slots, to, a, b, |a, b| a.wrapping_sub(b) & mask(drop));
        }
        I::MulUnsigned { to, a, b } => binary(slots, to, a, b, W::wrapping_mul),
        I::MulSigned { to, a, b, drop_a, drop_b, drop } => binary(slots, to, a, b, |a, b| {
            sign_extended(a, drop_a).wrapping_mul(sign_extended(b, drop_b)) & mask(drop)
        }),
        I::Equal { to, a, b } => binary(slots, to, a, b, |a, b| W::from(a == b)),
        I::Any { to, a, low, drop } => {
            unary(slots, to, a, |a| W::from(a >> low & mask(drop) != W::ZERO));
        }
        I::LessUnsigned { to, a, b } => binary(slots, to, a, b, |a, b| W::from(a < b)),
        // With inverted sign bits, signed numbers have the same order as unsigned ones.
        I::LessSigned { to, a, b, drop } => {
            binary(slots, to, a, b, |a, b| W::from(a ^ sign::<W>(drop) < b ^ sign::<W>(drop)))
        }
        I::Choose { to, select, a, b } => ternary(slots, to, [select, a, b], |select, a, b| {
            select_unpredictable(select == W::ZERO, a, b)
        }),
        I::ChooseAny { to, of, low, drop, a, b } => ternary(slots, to, [of, a, b], |of, a, b| {
            select_unpredictable(of >> low & mask(drop) == W::ZERO, a, b)
        }),
        I::ChoosePlace { to, of, low, drop, a, base, place_low, place_drop, shift } => {
            ternary(slots, to, [of, a, base], |of, a, base| {
                let placed = base | (of >> place_low & mask(place_drop)) << shift;
                select_unpredictable(of >> low & mask(drop) == W::ZERO, a, placed)
            })
        }
        I::Mux { to, select, first, last } => {
            let choices = &choices[first as usize..=last as usize];
            mux(slots, to, select, choices);
        }
        I::Read { to, address, words: span } => {
            unary(slots, to, address, |address| W::low(read(words, span, address.into())))
        }
    }
    0
}

/// Returns a word in which only the sign bit is 1. `drop` is 64 less the width of the value.
#[inline(always)]
fn sign<W: LaneWord>(drop: u8) -> W {
    W::low(1 << 63 >> drop)
}

/// Extends a two's complement number of the width given by `drop` to the whole word.
#[inline(always)]
fn sign_extended<W: LaneWord>(bits: W, drop: u8) -> W {
    (bits ^ sign(drop)).wrapping_sub(sign(drop))
}

/// Returns a word, or 0 behind the last one.
#[inline(always)]
fn read(words: &[u64], span: Span, address: u64) -> u64 {
    if address < u64::from(span.len) { words[span.start as usize + address as usize] } else { 0 }
}

/// Stores the chosen slot's value in each lane of `to`. A number in `select` beyond the last choice selects the last choice.
#[inline(always)]
fn mux<W: LaneWord, const LANES: usize>(
    slots: &mut [[W; LANES]],
    to: Slot,
    select: Slot,
    choices: &[Slot],
) {
    let (slots, after) = slots.split_at_mut(to as usize);
    let (to, select) = (&mut after[0], &slots[select as usize]);
    let last = choices.len() - 1;
    if LANES < VECTOR || choices.len() > COMPARED {
        for (lane, (to, number)) in to.iter_mut().zip(select).enumerate() {
            let number: u64 = (*number).into();
            *to = slots[choices[(number as usize).min(last)] as usize][lane];
        }
        return;
    }
    *to = slots[choices[last] as usize];
    for (number, &choice) in choices[..last].iter().enumerate() {
        let number = W::low(number as u64);
        let choice = &slots[choice as usize];
        for lane in 0..LANES {
            to[lane] = select_unpredictable(select[lane] == number, choice[lane], to[lane]);
        }
    }
}

/// From this number of lanes on, a mux compares the select in all lanes with each input number. With fewer lanes, a look-up in
/// each lane is faster.
const VECTOR: usize = 8;

/// A mux with more inputs looks up each lane's input, however many lanes there are.
const COMPARED: usize = 16;

#[inline(always)]
fn unary<W: LaneWord, const LANES: usize>(
    slots: &mut [[W; LANES]],
    to: Slot,
    a: Slot,
    f: impl Fn(W) -> W,
) {
    let (slots, after) = slots.split_at_mut(to as usize);
    map(&mut after[0], &slots[a as usize], f);
}

#[inline(always)]
fn binary<W: LaneWord, const LANES: usize>(
    slots: &mut [[W; LANES]],
    to: Slot,
    a: Slot,
    b: Slot,
    f: impl Fn(W, W) -> W,
) {
    let (slots, after) = slots.split_at_mut(to as usize);
    map2(&mut after[0], &slots[a as usize], &slots[b as usize], f);
}

#[inline(always)]
fn ternary<W: LaneWord, const LANES: usize>(
    slots: &mut [[W; LANES]],
    to: Slot,
    operands: [Slot; 3],
    f: impl Fn(W, W, W) -> W,
) {
    let (slots, after) = slots.split_at_mut(to as usize);
    let [a, b, c] = operands.map(|slot| &slots[slot as usize]);
    map3(&mut after[0], [a, b, c], f);
}

#[inline(always)]
fn map<A: Copy, T, const LANES: usize>(to: &mut [T; LANES], a: &[A; LANES], f: impl Fn(A) -> T) {
    for lane in 0..LANES {
        to[lane] = f(a[lane]);
    }
}

#[inline(always)]
fn map2<A: Copy, T, const LANES: usize>(
    to: &mut [T; LANES],
    a: &[A; LANES],
    b: &[A; LANES],
    f: impl Fn(A, A) -> T,
) {
    for lane in 0..LANES {
        to[lane] = f(a[lane], b[lane]);
    }
}

#[inline(always)]
fn map3<A: Copy, T, const LANES: usize>(
    to: &mut [T; LANES],
    [a, b, c]: [&[A; LANES]; 3],
    f: impl Fn(A, A, A) -> T,
) {
    for lane in 0..LANES {
        to[lane] = f(a[lane], b[lane], c[lane]);
    }
}

//! The clock model that every device has: reset, `start`, strobes, the sequence of microinstructions, `busy`,
//! `valid`, `done`.
//!
//! A device names its operands, registers and outputs once, in a [`Frame`], and gets a [`Slot`] for each. It
//! says what each microinstruction does to them ([`step`]) and what its outputs show ([`Datapath`]); the
//! order of the microinstructions numbers them. [`Frame::model`] makes a [`Model`] of that.
//!
//! ```
//! use glint::fixed::Format;
//! use glint::golden::Model;
//! use glint::golden::frame::{Datapath, Frame, Slot, State, idle, step};
//!
//! /// It doubles its operand.
//! struct Double {
//!     operand: Slot,
//!     doubled: Slot,
//!     output: Slot,
//! }
//!
//! impl Datapath for Double {
//!     fn outputs(&self, state: &mut State) {
//!         state[self.output] = state[self.doubled];
//!     }
//! }
//!
//! let mut frame = Frame::default();
//! let device = Double {
//!     operand: frame.operand("x", Format::unsigned(4, 0)),
//!     doubled: frame.register("doubled", Format::unsigned(5, 0)),
//!     output: frame.output("x_out", Format::unsigned(5, 0)),
//! };
//! let mut model = frame.model(
//!     device,
//!     [idle(), step(|it: &Double, s| s[it.doubled] = 2 * s[it.operand]), idle().valid().end()],
//! );
//! // rst_n, start, x, x_write.
//! model.clock(&[1, 1, 5, 1]);
//! model.clock(&[1, 0, 0, 0]);
//! model.clock(&[1, 0, 0, 0]);
//! assert_eq!(["valid", "x_out"].map(|name| model.value(name)), [Some(1), Some(10)]);
//! ```

use std::ops::{Index, IndexMut};
use std::sync::Arc;

use super::Model;
use super::handshake::{After, Handshake};
use crate::base::fixed::{Format, mask};

/// A place in the [`State`] of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot(usize);

/// The raw values of operands, registers and outputs.
#[derive(Clone, Debug)]
pub struct State(Box<[i64]>);

impl Index<Slot> for State {
    type Output = i64;

    #[inline]
    fn index(&self, slot: Slot) -> &i64 {
        &self.0[slot.0]
    }
}

impl IndexMut<Slot> for State {
    #[inline]
    fn index_mut(&mut self, slot: Slot) -> &mut i64 {
        &mut self.0[slot.0]
    }
}

/// What a device computes beside its microinstructions.
pub trait Datapath: Send + Sync + 'static {
    /// What every rising edge does, whatever microinstruction is in force: a synchronous ROM reads. It comes
    /// before the microinstruction, and sees the values before the edge.
    #[inline]
    fn edge(&self, state: &mut State) {
        let _ = state;
    }

    /// What the outputs show: combinational functions of operands and registers.
    fn outputs(&self, state: &mut State);
}

type Does<D> = fn(&D, &mut State);
type Condition<D> = fn(&D, &State) -> bool;

/// What follows a microinstruction.
enum Next<D> {
    Following,
    RepeatWhile(Condition<D>),
    SkipIf(u32, Condition<D>),
    End,
}

/// One microinstruction.
pub struct Microinstruction<D> {
    does: Does<D>,
    next: Next<D>,
    valid: bool,
    asserts: Vec<Slot>,
}

/// A microinstruction that changes no register.
pub fn idle<D>() -> Microinstruction<D> {
    step(|_, _| ())
}

/// A microinstruction by what its rising edge does to the registers.
pub fn step<D>(does: fn(&D, &mut State)) -> Microinstruction<D> {
    Microinstruction { does, next: Next::Following, valid: false, asserts: Vec::new() }
}

impl<D> Microinstruction<D> {
    /// The results are on the outputs.
    pub fn valid(self) -> Self {
        Self { valid: true, ..self }
    }

    /// The program ends here.
    pub fn end(self) -> Self {
        Self { next: Next::End, ..self }
    }

    /// It is in force once more while this holds of the values before the edge.
    pub fn repeat_while(self, condition: fn(&D, &State) -> bool) -> Self {
        Self { next: Next::RepeatWhile(condition), ..self }
    }

    /// It passes over so many microinstructions if this holds of the values before the edge.
    pub fn skip_if(self, count: u32, condition: fn(&D, &State) -> bool) -> Self {
        Self { next: Next::SkipIf(count, condition), ..self }
    }

    /// A flag that is 1 in this microinstruction.
    pub fn asserts(mut self, flag: Slot) -> Self {
        self.asserts.push(flag);
        self
    }
}

/// An operand register with its write strobe. It ignores writes while the device is busy, and does not know
/// the reset.
struct Operand {
    slot: Slot,
    format: Format,
    min: i64,
    max: i64,
}

/// What is predicted, with the bits that its net has.
struct Shown {
    name: String,
    output: bool,
    slot: Slot,
    mask: u64,
}

/// What a device's state is made of.
#[derive(Default)]
pub struct Frame {
    inputs: Vec<String>,
    operands: Vec<Operand>,
    shown: Vec<Shown>,
    slots: usize,
    flags: Vec<Slot>,
    valid_delay: u32,
}

/// The handshake's own, which stand before the device's.
const HANDSHAKE: [&str; 5] = ["valid", "busy", "done", "run", "word_address"];

impl Frame {
    /// State that no signal of the design shows.
    pub fn hidden(&mut self) -> Slot {
        self.slots += 1;
        Slot(self.slots - 1)
    }

    fn shown(&mut self, name: String, format: Format, output: bool) -> Slot {
        let slot = self.hidden();
        self.shown.push(Shown { name, output, slot, mask: mask(format.width()) });
        slot
    }

    /// A register, of which the low bits that `format` has are shown.
    pub fn register(&mut self, name: &str, format: Format) -> Slot {
        self.shown(name.to_owned(), format, false)
    }

    /// An output, which [`Datapath::outputs`] sets.
    pub fn output(&mut self, name: &str, format: Format) -> Slot {
        self.shown(name.to_owned(), format, true)
    }

    /// An output of one bit that is 1 in the microinstructions that assert it.
    pub fn flag(&mut self, name: &str) -> Slot {
        let slot = self.output(name, Format::BIT);
        self.flags.push(slot);
        slot
    }

    /// The same for the device alone.
    pub fn hidden_flag(&mut self) -> Slot {
        let slot = self.hidden();
        self.flags.push(slot);
        slot
    }

    /// An operand with its register, which holds whatever `format` can denote.
    pub fn operand(&mut self, name: &str, format: Format) -> Slot {
        self.clamped(name, format, format.min_raw() as i64, format.max_raw() as i64)
    }

    /// An operand whose register moves what it loads into `min ..= max`, raw.
    pub fn clamped(&mut self, name: &str, format: Format, min: i64, max: i64) -> Slot {
        self.inputs.extend([name.to_owned(), format!("{name}_write")]);
        let slot = self.shown(format!("{name}_reg"), format, false);
        self.operands.push(Operand { slot, format, min, max });
        slot
    }

    /// `valid` comes so many clocks after the microinstructions that say it, through registers that a reset
    /// clears.
    pub fn delay_valid(&mut self, clocks: u32) {
        self.valid_delay = clocks;
    }

    /// The model at power-up. The first microinstruction is the one in which the device idles, the last ends
    /// the program.
    ///
    /// # Panics
    /// If there is no microinstruction.
    pub fn model<D: Datapath>(
        mut self,
        datapath: D,
        program: impl IntoIterator<Item = Microinstruction<D>>,
    ) -> Clocked<D> {
        let program: Vec<_> = program.into_iter().collect();
        assert!(!program.is_empty(), "a device idles in its first microinstruction");
        // Of signals that differ in one clock the first is reported: one that a user of the device sees.
        self.shown.sort_by_key(|shown| !shown.output);
        let signals = self.shown.iter().map(|shown| shown.name.clone()).collect();
        let names = |first: &[&str], then: Vec<String>| {
            first.iter().map(|&name| name.to_owned()).chain(then).collect::<Vec<_>>()
        };
        let mut model = Clocked {
            handshake: Handshake::default(),
            pulses: 0,
            state: State(vec![0; self.slots].into()),
            values: vec![0; HANDSHAKE.len() + self.shown.len()].into(),
            fixed: Arc::new(Fixed {
                inputs: names(&["rst_n", "start"], self.inputs),
                signals: names(&HANDSHAKE, signals),
                operands: self.operands,
                shown: self.shown.into_iter().map(|shown| (shown.slot, shown.mask)).collect(),
                flags: self.flags,
                valid_delay: self.valid_delay,
                datapath,
                program,
            }),
        };
        model.settle();
        model
    }
}

/// What does not change.
struct Fixed<D> {
    datapath: D,
    program: Vec<Microinstruction<D>>,
    operands: Vec<Operand>,
    shown: Vec<(Slot, u64)>,
    flags: Vec<Slot>,
    valid_delay: u32,
    inputs: Vec<String>,
    signals: Vec<String>,
}

/// A device, clock by clock.
pub struct Clocked<D> {
    fixed: Arc<Fixed<D>>,
    handshake: Handshake,
    /// Whether the microinstructions of the latest clocks said `valid`, the latest in bit 0.
    pulses: u64,
    state: State,
    values: Box<[u64]>,
}

impl<D> Clone for Clocked<D> {
    fn clone(&self) -> Self {
        Self {
            fixed: self.fixed.clone(),
            handshake: self.handshake,
            pulses: self.pulses,
            state: self.state.clone(),
            values: self.values.clone(),
        }
    }
}

impl<D: Datapath> Clocked<D> {
    /// What the outputs show of the state.
    #[inline]
    fn settle(&mut self) {
        let it = &*self.fixed;
        let Handshake { run, word } = self.handshake;
        let here = &it.program[word as usize];
        for &flag in &it.flags {
            self.state[flag] = 0;
        }
        for &flag in &here.asserts {
            self.state[flag] = 1;
        }
        it.datapath.outputs(&mut self.state);
        let valid = match it.valid_delay {
            0 => here.valid,
            clocks => self.pulses >> (clocks - 1) & 1 == 1,
        };
        let done = run && matches!(here.next, Next::End);
        let handshake = [valid.into(), run.into(), done.into(), run.into(), word.into()];
        let (first, then) = self.values.split_at_mut(HANDSHAKE.len());
        first.copy_from_slice(&handshake);
        for (value, &(slot, mask)) in then.iter_mut().zip(&it.shown) {
            *value = self.state[slot] as u64 & mask;
        }
    }
}

impl<D: Datapath> Model for Clocked<D> {
    fn inputs(&self) -> &[String] {
        &self.fixed.inputs
    }

    fn signals(&self) -> &[String] {
        &self.fixed.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let it = &*self.fixed;
        let (rst_n, start) = (inputs[0] & 1 == 1, inputs[1] & 1 == 1);
        let here = &it.program[self.handshake.word as usize];
        it.datapath.edge(&mut self.state);
        let after = match here.next {
            Next::Following => After::Next,
            Next::RepeatWhile(condition) if condition(&it.datapath, &self.state) => After::Again,
            Next::SkipIf(count, condition) if condition(&it.datapath, &self.state) => {
                After::To(self.handshake.word + 1 + count)
            }
            Next::RepeatWhile(_) | Next::SkipIf(..) => After::Next,
            Next::End => After::End,
        };
        (here.does)(&it.datapath, &mut self.state);
        if !self.handshake.run {
            for (operand, ports) in it.operands.iter().zip(inputs[2..].chunks_exact(2)) {
                if ports[1] & 1 == 1 {
                    let raw = operand.format.raw(ports[0]) as i64;
                    self.state[operand.slot] = raw.clamp(operand.min, operand.max);
                }
            }
        }
        self.pulses = if rst_n { self.pulses << 1 | u64::from(here.valid) } else { 0 };
        self.handshake.clock(rst_n, start, after);
        self.settle();
    }

    fn values(&self) -> &[u64] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An operand that counts down by ones, or not at all where it is 0 (s1.2, clamped to 0 … 1.0).
    struct Countdown {
        from: Slot,
        count: Slot,
        twice: Slot,
    }

    impl Datapath for Countdown {
        fn outputs(&self, state: &mut State) {
            state[self.twice] = -2 * state[self.count];
        }
    }

    fn model(valid_delay: u32) -> Clocked<Countdown> {
        let mut frame = Frame::default();
        let device = Countdown {
            from: frame.clamped("from", Format::signed(1, 2), 0, 4),
            count: frame.register("count", Format::unsigned(3, 0)),
            twice: frame.output("twice", Format::signed(4, 0)),
        };
        let counts = frame.flag("counts");
        frame.delay_valid(valid_delay);
        let load = step(|it: &Countdown, s| s[it.count] = s[it.from]);
        let count = step(|it: &Countdown, s| s[it.count] -= 1);
        frame.model(
            device,
            [
                idle(),
                load.skip_if(1, |it, s| s[it.from] == 0),
                count.repeat_while(|it, s| s[it.count] > 1).asserts(counts),
                idle().valid().end(),
            ],
        )
    }

    const NAMES: [&str; 7] = ["run", "word_address", "count", "twice", "counts", "valid", "done"];

    #[track_caller]
    fn assert_course(mut model: Clocked<Countdown>, from: u64, expected: &[[u64; 7]]) {
        model.clock(&[1, 1, from, 1]);
        for row in expected {
            assert_eq!(NAMES.map(|name| model.value(name).unwrap()), *row);
            // Writes and starts while busy change nothing.
            model.clock(&[1, row[0], 1, row[0]]);
        }
    }

    #[test]
    fn a_loop_runs_from_idle_to_the_end() {
        let course = [
            [1, 0, 0, 0, 0, 0, 0],
            [1, 1, 0, 0, 0, 0, 0],
            [1, 2, 2, 28, 1, 0, 0],
            [1, 2, 1, 30, 1, 0, 0],
            [1, 3, 0, 0, 0, 1, 1],
            [0, 0, 0, 0, 0, 0, 0],
        ];
        assert_course(model(0), 2, &course);
    }

    #[test]
    fn a_microinstruction_is_passed_over() {
        // 1111 is −1/4, which the register takes for 0.
        let course = [
            [1, 0, 0, 0, 0, 0, 0],
            [1, 1, 0, 0, 0, 0, 0],
            [1, 3, 0, 0, 0, 1, 1],
            [0, 0, 0, 0, 0, 0, 0],
        ];
        assert_course(model(0), 15, &course);
    }

    #[test]
    fn valid_comes_later_and_a_reset_forgets_it() {
        let course = [
            [1, 0, 0, 0, 0, 0, 0],
            [1, 1, 0, 0, 0, 0, 0],
            [1, 3, 0, 0, 0, 0, 1],
            [0, 0, 0, 0, 0, 0, 0],
            [0, 0, 0, 0, 0, 1, 0],
        ];
        assert_course(model(2), 0, &course);
        let mut reset = model(2);
        for row in [[1, 1, 0, 1], [1, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]] {
            reset.clock(&row);
            assert_eq!(reset.value("valid"), Some(0));
        }
        reset.clock(&[1, 0, 0, 0]);
        assert_eq!(reset.value("valid"), Some(0));
    }

    #[test]
    fn an_operand_clamps_and_is_written_by_its_strobe() {
        let mut model = model(0);
        // 7/4 is beyond 1.0; without a strobe nothing is taken; −1/4 is 0.
        for (row, held) in [([1, 0, 7, 1], 4), ([1, 0, 1, 0], 4), ([1, 0, 15, 1], 0)] {
            model.clock(&row);
            assert_eq!(model.value("from_reg"), Some(held));
        }
        assert_eq!(model.inputs(), ["rst_n", "start", "from", "from_write"]);
        assert_eq!(model.value("nothing"), None);
    }
}

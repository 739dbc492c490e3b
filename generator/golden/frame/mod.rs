//! Builds golden models that run clock by clock. A golden model predicts the architectural registers and outputs of a device.
//!
//! The author of a device declares its operands, registers and outputs in a [`Frame`] and gets a [`Slot`] for each. The author
//! then states the operation of each microinstruction with [`step`], in the order of execution. [`Frame::model`] adds the
//! behaviour that all devices share: reset, `start`, the strobes that write operands, `busy`, `valid` and `done`. For example,
//! this device doubles its operand:
//!
//! ```
//! use glint_base::fixed::Format;
//! use glint_golden::Model;
//! use glint_golden::frame::{Frame, idle, step};
//!
//! // It doubles its operand.
//! let mut frame = Frame::default();
//! let x = frame.operand("x", Format::unsigned(4, 0));
//! let doubled = frame.register("doubled", Format::unsigned(5, 0));
//! frame.output("x_out", Format::unsigned(5, 0), move |s| s[doubled]);
//! let double = step(move |s| s[doubled] = 2 * s[x]);
//! let mut model = frame.model([idle(), double, idle().valid().end()]);
//! // rst_n, start, x, x_write.
//! model.clock(&[1, 1, 5, 1]);
//! model.clock(&[1, 0, 0, 0]);
//! model.clock(&[1, 0, 0, 0]);
//! assert_eq!(["valid", "x_out"].map(|name| model.value(name)), [Some(1), Some(10)]);
//! ```

mod clocked;
mod part;

#[cfg(test)]
mod tests;

use std::ops::{Index, IndexMut};
use std::sync::Arc;

pub use clocked::ClockedModel;
pub use part::Part;

use glint_base::fixed::Format;

/// The position of a value in the [`State`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot(usize);

/// The raw values of all operands, registers and outputs of a golden model. A part's values are adjacent, in the order of the
/// part's own golden model.
pub type State = [i64];

impl Slot {
    /// Converts a slot of a part whose state begins at `base` to a slot of the whole device.
    fn after(self, base: usize) -> Self {
        Self(base + self.0)
    }
}

impl Index<Slot> for State {
    type Output = i64;

    #[inline]
    fn index(&self, slot: Slot) -> &i64 {
        &self[slot.0]
    }
}

impl IndexMut<Slot> for State {
    #[inline]
    fn index_mut(&mut self, slot: Slot) -> &mut i64 {
        &mut self[slot.0]
    }
}

type Does = Arc<dyn Fn(&mut State) + Send + Sync>;
type Value = Arc<dyn Fn(&State) -> i64 + Send + Sync>;
type Condition = Arc<dyn Fn(&State) -> bool + Send + Sync>;

#[derive(Clone)]
enum Next {
    Following,
    RepeatWhile(Condition),
    SkipIf(u32, Condition),
    /// The value of a slot selects the number of the next microinstruction.
    Dispatch(Slot, Arc<[usize]>),
    End,
}

/// A microinstruction: the operation on the registers, the flags that it sets, and the next microinstruction.
#[derive(Clone)]
pub struct FrameStep {
    does: Option<Does>,
    next: Next,
    valid: bool,
    asserts: Vec<Slot>,
    /// Whether the output registers load the results in this microinstruction.
    takes_results: bool,
}

/// Returns a microinstruction that changes no register. Operations of `Frame::every_edge` run nevertheless.
pub fn idle() -> FrameStep {
    FrameStep {
        does: None,
        next: Next::Following,
        valid: false,
        asserts: Vec::new(),
        takes_results: false,
    }
}

/// Returns a microinstruction that applies `does` to the registers, at the rising edge that ends it.
pub fn step(does: impl Fn(&mut State) + Send + Sync + 'static) -> FrameStep {
    FrameStep { does: Some(Arc::new(does)), ..idle() }
}

/// Returns a microinstruction like [`step`], but `does` also gets `arithmetic`: data that several microinstructions share, such
/// as the device's tables.
pub fn step_by<A: Send + Sync + 'static>(
    arithmetic: &Arc<A>,
    does: impl Fn(&A, &mut State) + Send + Sync + 'static,
) -> FrameStep {
    let shared = arithmetic.clone();
    step(move |state| does(&shared, state))
}

impl FrameStep {
    /// Raises `valid` during the microinstruction: the outputs have a result.
    pub fn valid(self) -> Self {
        Self { valid: true, ..self }
    }

    /// Ends the program: the device is idle afterwards.
    pub fn end(self) -> Self {
        Self { next: Next::End, ..self }
    }

    /// Repeats the microinstruction as long as `holds` is true of the values before its rising edge.
    pub fn repeat_while(self, holds: impl Fn(&State) -> bool + Send + Sync + 'static) -> Self {
        Self { next: Next::RepeatWhile(Arc::new(holds)), ..self }
    }

    /// Skips the next `count` microinstructions if `holds` is true of the values before the rising edge.
    pub fn skip_if(
        self,
        count: u32,
        holds: impl Fn(&State) -> bool + Send + Sync + 'static,
    ) -> Self {
        Self { next: Next::SkipIf(count, Arc::new(holds)), ..self }
    }

    /// Continues with microinstruction number `to[value]`, where `value` is the value of `selector` before the rising edge.
    pub fn dispatch(self, selector: Slot, to: &[usize]) -> Self {
        Self { next: Next::Dispatch(selector, to.into()), ..self }
    }

    /// Sets `flag`, which [`Frame::flag`] declared, to 1 during the microinstruction.
    pub fn asserts(mut self, flag: Slot) -> Self {
        self.asserts.push(flag);
        self
    }
}

/// An operand register. It ignores writes while the device is busy, and a reset does not change it.
#[derive(Clone)]
struct FrameOperand {
    name: String,
    slot: Slot,
    format: Format,
    min: i64,
    max: i64,
}

impl FrameOperand {
    /// Returns the raw value that the register loads from the port, limited to `min ..= max`.
    fn held(&self, bits: u64) -> i64 {
        (self.format.raw(bits) as i64).clamp(self.min, self.max)
    }
}

struct FrameSignal {
    name: String,
    output: bool,
    slot: Slot,
    format: Format,
}

/// Declares the operands, registers, outputs and operations of a golden model.
#[derive(Default)]
pub struct Frame {
    operands: Vec<FrameOperand>,
    shown: Vec<FrameSignal>,
    slots: usize,
    flags: Vec<Slot>,
    logic: Vec<(Slot, Value)>,
    edges: Vec<Does>,
    valid_delay: u32,
    has_write_port: bool,
    /// The microinstructions of the parts, in the order of execution.
    pub(super) parts: Vec<FrameStep>,
}

impl Frame {
    /// Adds a value to the state that corresponds to no signal of the hardware. For example, it is the word that a ROM read at
    /// the latest edge.
    pub fn hidden(&mut self) -> Slot {
        self.slots += 1;
        Slot(self.slots - 1)
    }

    fn shown(&mut self, name: String, format: Format, output: bool) -> Slot {
        let slot = self.hidden();
        self.shown.push(FrameSignal { name, output, slot, format });
        slot
    }

    /// Adds a register. Checks compare only as many low bits of its value as `format` has.
    pub fn register(&mut self, name: &str, format: Format) -> Slot {
        self.shown(name.to_owned(), format, false)
    }

    /// Adds an output that is combinational logic: a function of operands and registers.
    pub fn output(
        &mut self,
        name: &str,
        format: Format,
        value: impl Fn(&State) -> i64 + Send + Sync + 'static,
    ) {
        let slot = self.shown(name.to_owned(), format, true);
        self.logic.push((slot, Arc::new(value)));
    }

    /// Adds an output that has a register's value. Panics if `register` was not returned by `Frame::register` or another method
    /// that adds a signal. An output that is logic must use [`Frame::output`].
    pub fn shows(&mut self, name: &str, register: Slot) {
        let of = self.shown.iter().find(|shown| shown.slot == register);
        let format = of.expect("a register that is shown").format;
        self.shown.push(FrameSignal {
            name: name.to_owned(),
            output: true,
            slot: register,
            format,
        });
    }

    /// Adds an output of one bit that is 1 during every microinstruction that asserts it with [`FrameStep::asserts`].
    pub fn flag(&mut self, name: &str) -> Slot {
        let slot = self.shown(name.to_owned(), Format::BIT, true);
        self.flags.push(slot);
        slot
    }

    /// Adds an operand whose register can have every value of `format`. Returns the register's slot.
    pub fn operand(&mut self, name: &str, format: Format) -> Slot {
        self.clamped(name, format, format.min_raw() as i64, format.max_raw() as i64)
    }

    /// Adds an operand whose register limits each loaded value to the raw values `min ..= max`.
    pub fn clamped(&mut self, name: &str, format: Format, min: i64, max: i64) -> Slot {
        let slot = self.shown(format!("{name}_reg"), format, false);
        self.operands.push(FrameOperand { name: name.to_owned(), slot, format, min, max });
        slot
    }

    /// Adds an operation that runs at every rising edge, such as the read of a synchronous ROM. It runs before the
    /// microinstruction's operation, and after the operations that earlier calls added. It sees the values before the edge,
    /// except in slots that an earlier operation wrote at the same edge.
    pub fn every_edge(&mut self, does: impl Fn(&mut State) + Send + Sync + 'static) {
        self.edges.push(Arc::new(does));
    }

    /// Returns the name, the format, and the smallest and largest raw value of each operand, in the order of declaration.
    pub fn operands(&self) -> impl Iterator<Item = (&str, Format, (i64, i64))> {
        self.operands.iter().map(|it| (it.name.as_str(), it.format, (it.min, it.max)))
    }

    /// Returns the name and the format of every output that is not a flag.
    pub fn results(&self) -> impl Iterator<Item = (&str, Format)> {
        let results = self.shown.iter().filter(|it| it.output && !self.flags.contains(&it.slot));
        results.map(|it| (it.name.as_str(), it.format))
    }

    /// Delays `valid` by `clocks` clocks after the microinstructions that raise it. A reset clears the registers of this delay.
    pub fn delay_valid(&mut self, clocks: u32) {
        self.valid_delay = clocks;
    }

    /// Adds the output `table_ready` of a device whose tables can be written: it is 1 while no computation runs. The model itself
    /// never writes a table.
    pub fn write_port(&mut self) {
        self.has_write_port = true;
    }
}

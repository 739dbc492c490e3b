//! Builds the golden model of a device that contains other devices as parts, from the golden models of the parts.
//!
//! The parts run one after the other in one microprogram, and each works on its own registers. The microinstruction before the
//! first one of a part loads the operand registers of the part. The results of the part remain in registers. For example, this
//! device uses two copies of a doubler:
//!
//! ```
//! use glint_base::fixed::Format;
//! use glint_golden::Model;
//! use glint_golden::frame::{Frame, State, idle, step};
//!
//! let byte = Format::unsigned(8, 0);
//! let mut doubler = Frame::default();
//! let (x, doubled) = (doubler.operand("x", byte), doubler.register("doubled", byte));
//! doubler.shows("x_out", doubled);
//! let doubler = doubler.model([idle(), step(move |s| s[doubled] = 2 * s[x]), idle().valid().end()]);
//!
//! let mut frame = Frame::default();
//! let y = frame.operand("y", byte);
//! let twice = frame.part("twice", &doubler, [("x", move |s: &State| s[y])]).out("x_out");
//! let again = frame.part("again", &doubler, [("x", move |s: &State| s[twice])]).out("x_out");
//! frame.output("y_out", byte, move |s| s[again] + s[y]);
//! let mut model = frame.dataflow().model();
//! model.clock(&[1, 1, 5, 1]);
//! while model.value("valid") == Some(0) {
//!     model.clock(&[1, 0, 0, 0]);
//! }
//! assert_eq!(["twice_doubled", "y_out"].map(|it| model.value(it)), [Some(10), Some(25)]);
//! ```

use std::sync::Arc;

use super::{Condition, Does, Frame, FrameSignal, FrameStep, Next, Slot, State, idle};
use crate::Model;
use glint_base::fixed::Format;

/// A part's outputs, as slots of the whole device.
pub struct Part {
    name: String,
    outputs: Vec<(String, Slot)>,
}

impl Part {
    /// Returns the slot of the part's output `name`. Panics if the part has no such output.
    pub fn out(&self, name: &str) -> Slot {
        let found = self.outputs.iter().find(|(output, _)| output == name);
        found.unwrap_or_else(|| panic!("`{}` has no output `{name}`", self.name)).1
    }
}

impl Frame {
    /// Adds a part. `operands` pairs the name of each operand of the part with a function that computes its value from values
    /// that are already known. `name` becomes the prefix of the part's registers, for example `twice_doubled`.
    ///
    /// # Panics
    /// Panics if a [`Frame`] did not make `model`, if `model` delays `valid`, or if [`Model::with_output_registers`] returns
    /// `None` for it. Panics if the part has no operand with one of the names in `operands`.
    pub fn part<V>(
        &mut self,
        name: &str,
        model: &dyn Model,
        operands: impl IntoIterator<Item = (&'static str, V)>,
    ) -> Part
    where
        V: Fn(&State) -> i64 + Send + Sync + 'static,
    {
        let registered = model.clocked().and_then(|it| it.registered());
        let part = match registered {
            Some(part) if part.fixed.valid_delay == 0 => part,
            _ => panic!("`{name}` cannot be a part: its model has no frame"),
        };
        let (it, base) = (&*part.fixed, self.slots);
        self.slots += part.state.len();
        let mut outputs = Vec::new();
        let shown_signals = &part.signals()[part.signals().len() - it.shown.len()..];
        for (at, (signal, &(slot, mask))) in shown_signals.iter().zip(&it.shown).enumerate() {
            let own = slot.after(base);
            if at < it.outputs {
                outputs.push((signal.clone(), own));
                continue;
            }
            let name = format!("{name}_{signal}");
            let format = Format::unsigned(mask.count_ones() as i32, 0);
            self.shown.push(FrameSignal { name, output: false, slot: own, format });
        }
        for (slot, value) in &it.logic {
            let of_part = value.clone();
            self.logic.push((slot.after(base), Arc::new(move |s| of_part(&s[base..]))));
        }
        self.edges.extend(it.edges.iter().map(|does| within(base, does)));

        let mut loads = Vec::new();
        for (operand, value) in operands {
            let Some(found) = it.operands.iter().find(|it| it.name == operand) else {
                panic!("`{name}` has no operand `{operand}`");
            };
            loads.push((found.slot.after(base), (found.min, found.max), value));
        }
        let load: Does = Arc::new(move |s| {
            for (slot, (min, max), value) in &loads {
                s[*slot] = value(s).clamp(*min, *max);
            }
        });
        if self.parts.is_empty() {
            // The device waits for `start` in the first microinstruction, and loads operands in the second.
            self.parts = vec![idle(), idle()];
        }
        let before = self.parts.pop().unwrap_or_else(idle);
        self.parts.push(FrameStep { does: Some(then(load, before.does.clone())), ..before });
        let first = self.parts.len();
        for here in &it.program {
            let own = here.does.as_ref().map(|does| within(base, does));
            let does = match here.takes_results {
                true => Some(then(takes_results(base, &it.taken), own)),
                false => own,
            };
            let next = match &here.next {
                Next::RepeatWhile(holds) => Next::RepeatWhile(condition_within(base, holds)),
                Next::SkipIf(count, holds) => Next::SkipIf(*count, condition_within(base, holds)),
                Next::Dispatch(selector, to) => {
                    let to = to.iter().map(|at| first + at).collect();
                    Next::Dispatch(selector.after(base), to)
                }
                Next::Following | Next::End => Next::Following,
            };
            self.parts.push(FrameStep { does, next, ..idle() });
        }
        Part { name: name.to_owned(), outputs }
    }
}

/// Converts an operation on a part's state, which begins at `base`, to one on the whole device's state.
fn within(base: usize, does: &Does) -> Does {
    let of_part = does.clone();
    Arc::new(move |s| of_part(&mut s[base..]))
}

/// Converts a condition on a part's state, which begins at `base`, to a condition on the whole device's state.
fn condition_within(base: usize, holds: &Condition) -> Condition {
    let of_part = holds.clone();
    Arc::new(move |s| of_part(&s[base..]))
}

/// Loads a part's results, whose state begins at `base`, into output registers. `taken` has the slot of each result and of its
/// register.
fn takes_results(base: usize, taken: &[(Slot, Slot)]) -> Does {
    let mut pairs = Vec::new();
    for (result, register) in taken {
        pairs.push((result.after(base), register.after(base)));
    }
    Arc::new(move |s| {
        for &(result, register) in &pairs {
            s[register] = s[result];
        }
    })
}

/// Returns an operation that does `first` and then `second`. Neither may read a slot that the second one writes.
fn then(first: Does, second: Option<Does>) -> Does {
    let Some(second) = second else { return first };
    Arc::new(move |s| {
        first(s);
        second(s);
    })
}

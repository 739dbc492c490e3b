//! Builds the golden model of a device that contains other devices as parts, from the golden models of the parts.
//!
//! The parts run one after the other in one microprogram, and each works on its own registers. The device loads the operand
//! registers of a part in the microinstruction before the part's first one. The results of a part remain in registers after its
//! last microinstruction. For example, here a device uses two copies of a doubler:
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

/// The outputs of a part, as slots in the state of the whole device.
pub struct Part {
    name: String,
    outputs: Vec<(String, Slot)>,
}

impl Part {
    /// Returns the slot of the part's output with this name.
    ///
    /// # Panics
    /// Panics if the part has no such output.
    pub fn out(&self, name: &str) -> Slot {
        let found = self.outputs.iter().find(|(output, _)| output == name);
        found.unwrap_or_else(|| panic!("`{}` has no output `{name}`", self.name)).1
    }
}

impl Frame {
    /// Adds a part, and returns its outputs. `operands` pairs the name of each operand of the part with a function that computes
    /// its value from values that are already known. `name` becomes the prefix of the part's registers, for example
    /// `twice_doubled`.
    ///
    /// # Panics
    /// Panics if a [`Frame`] did not make the model. Panics if the model gives several results, or has no operand of one of the
    /// names.
    pub fn part<V>(
        &mut self,
        name: &str,
        model: &dyn Model,
        operands: impl IntoIterator<Item = (&'static str, V)>,
    ) -> Part
    where
        V: Fn(&State) -> i64 + Send + Sync + 'static,
    {
        let part = model.clocked().and_then(|it| it.registered());
        let part = part.filter(|it| it.fixed.valid_delay == 0);
        let part = part.unwrap_or_else(|| panic!("`{name}` is no part: it has no frame"));
        let (it, base) = (&*part.fixed, self.slots);
        self.slots += part.state.len();
        let own = |slot: Slot| Slot(base + slot.0);
        let signals = part.signals()[part.signals().len() - it.shown.len()..].iter();
        let shown: Vec<_> = signals.zip(&it.shown).collect();
        let (outputs, registers) = shown.split_at(it.outputs);
        self.shown.extend(registers.iter().map(|(signal, (slot, mask))| FrameSignal {
            name: format!("{name}_{signal}"),
            output: false,
            slot: own(*slot),
            format: Format::unsigned(mask.count_ones() as i32, 0),
        }));
        for (slot, value) in &it.logic {
            let value = value.clone();
            self.logic.push((own(*slot), Arc::new(move |s| value(&s[base..]))));
        }
        self.edges.extend(it.edges.iter().map(|does| within(base, does)));

        let operands = operands.into_iter().map(|(operand, value)| {
            let found = it.operands.iter().find(|it| it.name == operand);
            let found = found.unwrap_or_else(|| panic!("`{name}` has no operand `{operand}`"));
            (own(found.slot), (found.min, found.max), value)
        });
        let operands: Vec<_> = operands.collect();
        let load: Does = Arc::new(move |s| {
            for (slot, (min, max), value) in &operands {
                s[*slot] = value(s).clamp(*min, *max);
            }
        });
        if self.parts.is_empty() {
            // The device waits for `start` in the first, and loads in the second.
            self.parts = vec![idle(), idle()];
        }
        let before = self.parts.pop().unwrap_or_else(idle);
        self.parts.push(FrameStep { does: Some(then(load, before.does.clone())), ..before });
        self.parts.extend(it.program.iter().map(|here| {
            let taken: Vec<_> = it.taken.iter().map(|&(from, to)| (own(from), own(to))).collect();
            let takes: Option<Does> = here.takes_results.then(|| -> Does {
                Arc::new(move |s| taken.iter().for_each(|&(from, to)| s[to] = s[from]))
            });
            let does = here.does.as_ref().map(|does| within(base, does));
            let inside = |holds: &Condition| -> Condition {
                let holds = holds.clone();
                Arc::new(move |s| holds(&s[base..]))
            };
            FrameStep {
                does: takes.map(|takes| then(takes, does.clone())).or(does),
                next: match &here.next {
                    Next::RepeatWhile(holds) => Next::RepeatWhile(inside(holds)),
                    Next::SkipIf(count, holds) => Next::SkipIf(*count, inside(holds)),
                    Next::Following | Next::End => Next::Following,
                },
                ..idle()
            }
        }));
        let outputs = outputs.iter().map(|(name, (slot, _))| ((*name).clone(), own(*slot)));
        Part { name: name.to_owned(), outputs: outputs.collect() }
    }
}

/// Returns the operation of a part whose state begins at `base`.
fn within(base: usize, does: &Does) -> Does {
    let does = does.clone();
    Arc::new(move |s| does(&mut s[base..]))
}

/// Returns an operation that does `first` and then `second`. Neither may read a slot that the other writes.
fn then(first: Does, second: Option<Does>) -> Does {
    let Some(second) = second else { return first };
    Arc::new(move |s| {
        first(s);
        second(s);
    })
}

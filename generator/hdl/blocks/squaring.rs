//! Writes the microinstructions that raise a register to a power of two by repeated squaring, for `lyon` and `cosine-power`.
//!
//! The first squaring has its own microinstruction, since its operand is the base and not the register. Another microinstruction,
//! which a counter repeats, squares the register itself. The device provides the multiplier, and the muxes in front of it.

use crate::dsl::{Counter, Designer, Mux, Register, Signal, Step, StepSetting, loop_while, step};
use glint_base::fixed::Format;

/// The squarings that raise a base to a power of two. If there are several squarings, the counter `remaining` has the number of
/// squarings that follow.
pub struct Squarings<'d> {
    designer: &'d Designer,
    counter: Option<Counter<'d>>,
    /// The mux for the start value of the counter, and its input for the squarings. The field is `None` if the counter counts
    /// only squarings, or if there is only one squaring.
    start: Option<(Mux<'d>, Signal<'d>)>,
}

impl<'d> Squarings<'d> {
    /// Makes 1 to 4 squarings: 3 give the eighth power.
    #[track_caller]
    pub fn new(designer: &'d Designer, count: u32) -> Self {
        let counter = (count > 1).then(|| {
            designer.down_counter("remaining", start(designer, count)).doc("squarings that remain")
        });
        Self { designer, counter, start: None }
    }

    /// Makes 1 to 4 squarings whose counter also counts an earlier loop. `other` is the start value for that loop; the returned
    /// settings load `other`.
    #[track_caller]
    pub fn sharing(
        designer: &'d Designer,
        count: u32,
        other: Signal<'d>,
    ) -> (Self, Counter<'d>, Vec<StepSetting>) {
        let mux = (count > 1).then(|| {
            let squarings = start(designer, count);
            let mux = designer.mux("remaining_start", [squarings, other]).doc("the count");
            (mux, squarings)
        });
        let from = mux.map_or(other, |(mux, _)| mux.out());
        let counter = designer.down_counter("remaining", from);
        let load_other =
            mux.map(|(mux, _)| mux.pick(other)).into_iter().chain([counter.load()]).collect();
        let squarings = Self { designer, counter: mux.map(|_| counter), start: mux };
        (squarings, counter, load_other)
    }

    /// Returns the settings that load the number of squarings after the first one into the counter, for a microinstruction
    /// before the second squaring.
    #[track_caller]
    pub fn load(&self) -> Vec<StepSetting> {
        let pick = self.start.map(|(mux, squarings)| mux.pick(squarings));
        let load = self.counter.map(|counter| counter.load());
        pick.into_iter().chain(load).collect()
    }

    /// Returns one or two microinstructions: `register` loads the square of the base, and then its own square until all squarings
    /// are done. The settings `first` must bring the square of the base to the input of `register`, and `again` the square of
    /// `register`.
    #[track_caller]
    pub fn steps(
        &self,
        register: Register<'d>,
        first: impl IntoIterator<Item = StepSetting>,
        again: impl IntoIterator<Item = StepSetting>,
    ) -> Vec<Step> {
        let name = register.q().name();
        let of_base = first.into_iter().chain([register.load()]);
        let mut steps = vec![step(&format!("{name} <- base^2"), of_base)];
        if let Some(remaining) = self.counter {
            let one = self.designer.raw_constant("one_left", 1, remaining.q().format());
            let more = self
                .designer
                .less("more", one, remaining.q())
                .doc("1 if this is not the last squaring");
            let square = format!("{name} <- {name}^2");
            let settings = again.into_iter().chain([
                register.load(),
                remaining.count(),
                loop_while(more, &square),
            ]);
            steps.push(step(&square, settings));
        }
        steps
    }
}

/// Returns the number of squarings after the first one.
#[track_caller]
fn start(designer: &Designer, count: u32) -> Signal<'_> {
    designer.raw_constant("squarings", i128::from(count) - 1, Format::unsigned(2, 0))
}

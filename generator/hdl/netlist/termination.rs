//! Computes an upper limit of the clocks that a computation can take, from its microprogram alone.
//!
//! A loop is accepted only if it consists of one microinstruction and its condition depends on one register alone, a counter. The
//! module does not check that the counter counts down; the formal proof does.

use crate::netlist::{Design, Driver, NetId, RegId, Sequence};
use glint_base::cone;

/// An upper limit of the clocks until `done` is high, such as 3 clocks plus the value of the counter `remaining`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Left {
    /// The part that does not depend on a counter, in clocks.
    pub clocks: u64,
    /// The register whose current value is added, because it determines how often the microinstruction repeats itself.
    pub counter: Option<RegId>,
}

/// Returns for each microinstruction an upper limit of the clocks from its execution to the clock with `done`. The caller must
/// know that the register of each loop's condition counts down by one in each iteration.
///
/// Returns `None` if a microinstruction waits for `start`, or if the last microinstruction does not end the computation.
/// Returns `None` also for a loop with several microinstructions, or with a condition that depends on anything but one
/// register. A jump forward has no such restriction.
pub fn remaining(design: &Design) -> Option<Vec<Left>> {
    let microprogram = &design.control.microprogram;
    let mut left: Vec<Left> = Vec::with_capacity(microprogram.len());
    // The successors must be known, so the list begins with the last microinstruction.
    for (at, microinstruction) in microprogram.iter().enumerate().rev() {
        let entering = |to: usize| -> Option<u64> {
            let Left { clocks, counter } = *left.get((microprogram.len() - 1).checked_sub(to)?)?;
            let most = counter.map_or(0, |counter| largest(design, counter));
            Some(1 + clocks + most)
        };
        let (clocks, counter) = match &microinstruction.sequence {
            Sequence::End => (0, None),
            Sequence::Next => (entering(at + 1)?, None),
            Sequence::LoopWhile { to, condition } if *to == at => {
                (entering(at + 1)?, Some(decides(design, *condition)?))
            }
            Sequence::LoopWhile { to, .. } if *to > at => {
                (entering(at + 1)?.max(entering(*to)?), None)
            }
            Sequence::Dispatch { to, .. } => {
                let mut most = 0;
                for &target in to {
                    most = most.max(entering(target)?);
                }
                (most, None)
            }
            Sequence::LoopWhile { .. } | Sequence::WaitStart => return None,
        };
        left.push(Left { clocks, counter });
    }
    left.reverse();
    Some(left)
}

/// Returns the latest clock in which `done` can be high, if each loop's counter counts down by one in each iteration. Clock 0
/// accepts `start`. Returns `None` if [`remaining`] finds no limit, or if the design has no microprogram.
pub fn latest_done(design: &Design) -> Option<u32> {
    // Microinstruction 0 is executed in clock 1.
    let first = *remaining(design)?.first()?;
    let most = first.counter.map_or(0, |counter| largest(design, counter));
    u32::try_from(1 + first.clocks + most).ok()
}

/// Returns the clock in which `done` is high if the operand by which the microprogram dispatches has the value `selected`. Clock 0
/// accepts `start`. Returns `None` if another condition influences the clock, or if the design has no microprogram.
pub fn done_after_dispatch(design: &Design, selected: usize) -> Option<u32> {
    let mut address = 0;
    let mut clock = 1;
    loop {
        address = match &design.control.microprogram.get(address)?.sequence {
            Sequence::End => return Some(clock),
            Sequence::Next => address + 1,
            Sequence::Dispatch { to, .. } => *to.get(selected)?,
            Sequence::LoopWhile { .. } | Sequence::WaitStart => return None,
        };
        clock += 1;
    }
}

/// Returns the largest value of the register's width.
fn largest(design: &Design, register: RegId) -> u64 {
    glint_base::fixed::mask(design.width(design.register(register).q))
}

/// Returns the one register that alone determines `net` within one clock, if there is one.
fn decides(design: &Design, net: NetId) -> Option<RegId> {
    let mut found = None;
    for net in cone::reached([net], |net| design.combinational_inputs(net)) {
        match design.net(net).driver {
            Driver::Constant(_) | Driver::Op(_) => {}
            Driver::Register(register) if found.is_none() => found = Some(register),
            _ => return None,
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsl::fixture::design;
    use crate::dsl::{Designer, Signal, dispatch, loop_while, step};
    use glint_base::fixed::Format;

    type Condition = for<'d> fn(&'d Designer, Signal<'d>, Signal<'d>) -> Signal<'d>;

    /// A counter of three bits counts from the operand down to 0 in microinstruction 2.
    fn counted(condition: Condition) -> Design {
        design(|d| {
            let x = d.operand("x", Format::unsigned(3, 0));
            let iterations = d.down_counter("iterations", x.q());
            let more = condition(d, iterations.q(), x.q());
            d.output("iterations_out", iterations.q());
            let count = [iterations.count(), loop_while(more, "count")];
            vec![step("load", [iterations.load()]), step("count", count)]
        })
    }

    #[test]
    fn a_counter_bounds_its_loop() {
        let design = counted(|d, iterations, _| d.any("more", iterations));
        let left = remaining(&design).expect("a bound");
        let clocks: Vec<u64> = left.iter().map(|left| left.clocks).collect();
        // The result; up to seven iterations more and the result; from the first of eight iterations; the load.
        assert_eq!(clocks, [10, 9, 1, 0]);
        let counted: Vec<bool> = left.iter().map(|left| left.counter.is_some()).collect();
        assert_eq!(counted, [false, false, true, false]);
        // Words 0 and 1 in clocks 1 and 2, eight iterations, the result.
        assert_eq!(latest_done(&design), Some(11));
    }

    #[test]
    fn each_value_of_a_selector_has_its_own_clock() {
        let design = design(|d| {
            let x = d.operand("x", Format::unsigned(1, 0));
            let result = d.register("result", Format::unsigned(1, 0));
            result.takes(x.q());
            d.output("result_out", result.q());
            vec![
                step("choose", [dispatch(x.q(), &["load", "wait"])]),
                step("wait", []),
                step("wait more", []),
                step("load", [result.load()]),
            ]
        });
        // Idle, choose, load and the result; the other value waits for two clocks.
        assert_eq!([0, 1].map(|value| done_after_dispatch(&design, value)), [Some(4), Some(6)]);
        assert_eq!(latest_done(&design), Some(6));
        let looped = counted(|d, iterations, _| d.any("more", iterations));
        assert_eq!(done_after_dispatch(&looped, 0), None);
    }

    #[test]
    fn what_else_decides_about_a_loop_bounds_nothing() {
        let design =
            counted(|d, iterations, x| d.or("more", d.any("some", iterations), d.any("none", x)));
        assert_eq!(remaining(&design), None);
        assert_eq!(latest_done(&design), None);
    }
}

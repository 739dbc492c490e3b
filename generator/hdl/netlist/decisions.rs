//! Finds the microinstructions whose successor depends on an operand, and the delay from the control word to `valid`.
//!
//! Up to the first such microinstruction, every computation executes the same microinstructions in the same clocks, whatever the
//! operands are. The module assumes that a computation loads a register before the register affects a successor. For example,
//! the operand `shift` of `lyon` determines how often a loop runs.

use std::collections::HashSet;

use super::{Design, Driver, NetId, Role, Sequence};
use glint_base::cone;

/// Returns the addresses of the dispatches, and of the loops and jumps whose condition an operand or an undriven net may
/// affect, in ascending order.
pub fn decided_by_data(design: &Design) -> Vec<usize> {
    let microprogram = design.control.microprogram.iter().enumerate();
    let decided = microprogram.filter(|(_, microinstruction)| match &microinstruction.sequence {
        Sequence::LoopWhile { condition, .. } => {
            registers_from_control(design, *condition).is_none()
        }
        Sequence::Dispatch { .. } => true,
        Sequence::Next | Sequence::WaitStart | Sequence::End => false,
    });
    decided.map(|(at, _)| at).collect()
}

/// Returns the smallest number of registers on a path from the control word to the output `valid`. Returns `None` if an operand
/// affects `valid`, or if the design has no `valid`.
pub fn delay_of_valid(design: &Design) -> Option<u32> {
    let valid = design.port(|role| role == Role::Valid)?;
    registers_from_control(design, valid.net)
}

fn is_control(design: &Design, net: NetId) -> bool {
    match design.net(net).driver {
        Driver::Field(_) => true,
        Driver::Rom(rom) => rom == design.control.rom,
        _ => false,
    }
}

/// Returns the smallest number of registers on a path from the control word to `net`. Without such a path, returns a larger
/// number than any path has. Returns `None` if an operand or an undriven net affects `net`.
fn registers_from_control(design: &Design, net: NetId) -> Option<u32> {
    let inputs = |net| match is_control(design, net) {
        true => Vec::new(),
        false => design.combinational_inputs(net),
    };
    let (mut seen, mut front) = (HashSet::new(), vec![net]);
    let (mut delay, mut shortest) = (0, None);
    while !front.is_empty() {
        // The nets in front of the registers that this round meets.
        let mut behind = Vec::new();
        for net in cone::reached(front, inputs) {
            seen.insert(net);
            match &design.net(net).driver {
                _ if is_control(design, net) => {
                    shortest.get_or_insert(delay);
                }
                Driver::Register(register) => {
                    let register = design.register(*register);
                    behind.extend(register.data.into_iter().chain(register.enable));
                }
                Driver::Rom(rom) if design.rom(*rom).synchronous => {
                    behind.push(design.rom(*rom).address);
                }
                Driver::Input => {
                    let role = design.ports.iter().find(|port| port.net == net);
                    if !role.is_some_and(|port| is_handshake(port.role)) {
                        return None;
                    }
                }
                Driver::Undriven => return None,
                Driver::Constant(_) | Driver::Op(_) | Driver::Rom(_) | Driver::Field(_) => {}
            }
        }
        behind.retain(|net| !seen.contains(net));
        front = behind;
        delay += 1;
    }
    Some(shortest.unwrap_or(delay))
}

fn is_handshake(role: Role) -> bool {
    matches!(role, Role::Start | Role::Reset | Role::InValid | Role::OutReady)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsl::{Designer, Signal, end, loop_while, step};
    use glint_base::fixed::Format;

    /// A counter of three bits begins at `start`. The result is loaded after the last iteration of a loop, and `valid` comes two
    /// clocks after that load.
    fn counted(start: for<'d> fn(&'d Designer, Signal<'d>) -> Signal<'d>) -> Design {
        let d = Designer::new("counted");
        let x = d.operand("x", Format::unsigned(3, 0));
        let iterations = d.down_counter("iterations", start(&d, x.q()));
        let more = d.any("more", iterations.q());
        let result = d.register("result", Format::unsigned(3, 0));
        result.takes(iterations.q());
        d.output("result_out", result.q());
        d.output("x_out", x.q());
        d.valid_after(result.loading(), 2);
        d.microprogram([
            step("idle", []),
            step("load", [iterations.load()]),
            step("count", [iterations.count(), loop_while(more, "count")]),
            step("result", [result.load()]),
            step("wait", []),
            step("shown", [end()]),
        ]);
        d.finish().unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_loop_is_the_datas_where_its_counter_starts_from_an_operand() {
        let from_data = counted(|_, x| x);
        assert_eq!(decided_by_data(&from_data), [2]);
        assert_eq!(delay_of_valid(&from_data), Some(2));
        let constant = counted(|d, _| d.raw_constant("five", 5, Format::unsigned(3, 0)));
        assert_eq!(decided_by_data(&constant), Vec::<usize>::new());
        assert_eq!(delay_of_valid(&constant), Some(2));
    }
}

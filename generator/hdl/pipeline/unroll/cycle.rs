//! Executes one arbitrary clock of a running design symbolically. This serves designs whose computations have any number of
//! results, because every clock of such a computation is an instance of this clock.

use super::clock::Clock;
use super::{Executor, Iterations, Unrolled};
use crate::netlist::{Design, NetId};
use crate::pipeline::graph::NodeId;
use glint_base::fixed::Format;

/// A graph that computes outputs and next register contents from unknown register contents.
#[derive(Debug)]
pub struct Cycle {
    /// The values of an arbitrary clock, and of the clock that accepts `start`. The results are all outputs in the arbitrary
    /// clock.
    pub unrolled: Unrolled,
    /// Each register and then each synchronous ROM.
    pub held: Vec<StateValues>,
}

/// The output of a register or a synchronous ROM before and after a clock.
#[derive(Clone, Copy, Debug)]
pub struct StateValues {
    /// The net that the register or ROM drives.
    pub net: NetId,
    /// For a register, its value after a reset and then one clock that accepts `start` and all operands. For a ROM, the unknown
    /// word at power-up, which no result shows.
    pub first: NodeId,
    /// The value before an arbitrary clock.
    pub before: NodeId,
    /// The value after that clock, as a function of the values `before` it.
    pub after: NodeId,
}

/// Executes one clock of a busy design with no undriven net. Any microinstruction may be executed, because all registers except
/// the run flag are unknown.
pub fn any_cycle(design: &Design) -> Cycle {
    let mut executor = Executor::new(design, Iterations::OneByOne);
    let mut running = executor.power_up();
    let mut reset = running.clone();
    for (register, held) in design.registers.iter().zip(&mut reset.registers) {
        if let Some(bits) = register.reset {
            let net = design.net(register.q);
            *held = executor.unrolled.graph.constant(bits, net.format, &super::label(net));
        }
    }
    let first = Clock::new(&mut executor, &reset, None, true).edge();
    let run = design.control.run;
    let label = super::label(design.net(design.register(run).q));
    running.registers[run.index()] = executor.unrolled.graph.constant(1, Format::BIT, &label);
    let mut clock = Clock::new(&mut executor, &running, None, false);
    let outputs = design.outputs().map(|port| (port.net, clock.value(port.net))).collect();
    let after = clock.edge();
    executor.unrolled.results = outputs;
    let mut held = Vec::new();
    for (at, register) in design.registers.iter().enumerate() {
        held.push(StateValues {
            net: register.q,
            first: first.registers[at],
            before: running.registers[at],
            after: after.registers[at],
        });
    }
    for (at, rom) in design.roms.iter().enumerate() {
        if rom.synchronous {
            held.push(StateValues {
                net: rom.data,
                first: running.roms[at],
                before: running.roms[at],
                after: after.roms[at],
            });
        }
    }
    Cycle { unrolled: executor.unrolled, held }
}

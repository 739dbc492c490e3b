//! Executes one arbitrary clock of a running design symbolically, with unknown register contents. The result describes designs
//! whose computations have any number of results, because every clock of such a computation is an instance of this clock.

use super::clock::Clock;
use super::{Executor, Iterations, Unrolled};
use crate::netlist::{Design, NetId};
use crate::pipeline::graph::NodeId;
use glint_base::fixed::Format;

/// One arbitrary clock of a running design, executed symbolically: a graph that computes outputs and next register contents from
/// unknown register contents.
#[derive(Debug)]
pub struct Cycle {
    /// The graph with the values of an arbitrary clock, and of the clock that accepts `start`. Its results are all outputs of the
    /// design in the arbitrary clock.
    pub unrolled: Unrolled,
    /// For each register and then each synchronous ROM of the design, its output value before and after the clock.
    pub held: Vec<StateValues>,
}

/// The output value of a register or a synchronous ROM before and after a clock, as nodes of the graph in [`Cycle::unrolled`].
#[derive(Clone, Copy, Debug)]
pub struct StateValues {
    /// The net that the register or ROM drives.
    pub net: NetId,
    /// For a register, its value after a reset and then one clock that accepts `start` and all operands. For a ROM, the unknown
    /// word at power-up, which no result shows.
    pub first: NodeId,
    /// The output value before an arbitrary clock.
    pub before: NodeId,
    /// The output value after that clock, as a function of the values `before` it.
    pub after: NodeId,
}

/// Executes one clock of a busy design symbolically. Any microinstruction may be executed in it, because the contents of all
/// registers except the run flag are unknown. The design must have no undriven net.
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

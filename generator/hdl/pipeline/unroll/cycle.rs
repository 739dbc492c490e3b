//! Executes one arbitrary clock of a computation symbolically, with unknown register contents. A computation with any number of
//! results repeats such a clock.

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
    /// design.
    pub unrolled: Unrolled,
    /// For each register and synchronous ROM of the design, its output value before and after the clock.
    pub held: Vec<StateValues>,
}

/// The output value of a register or a synchronous ROM before and after a clock, as nodes of the graph in [`Cycle::unrolled`].
#[derive(Clone, Copy, Debug)]
pub struct StateValues {
    /// The net that the register or ROM drives.
    pub net: NetId,
    /// The register's value after the clock that accepts `start` and all operands. For a ROM it is the word before any clock, which
    /// no result shows.
    pub first: NodeId,
    /// The output value before an arbitrary clock.
    pub before: NodeId,
    /// The output value after that clock, as a function of the values `before` it.
    pub after: NodeId,
}

/// Executes one clock of a design symbolically. Any microinstruction may be executed in it, because the register contents are
/// unknown.
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

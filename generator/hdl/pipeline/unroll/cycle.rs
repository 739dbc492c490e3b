//! Executes one arbitrary clock of a computation symbolically, with unknown register contents. A computation with any number of
//! results repeats such a clock.

use super::clock::Clock;
use super::{Executor, Iterations, Unrolled};
use crate::netlist::{Design, NetId};
use crate::pipeline::graph::NodeId;
use glint_base::fixed::Format;

/// One clock of a running design, as a graph of values.
#[derive(Debug)]
pub struct Cycle {
    /// The values of an arbitrary clock, and of the clock that accepts `start`. The results are all outputs.
    pub unrolled: Unrolled,
    /// The contents of the registers and of the synchronous ROMs.
    pub held: Vec<StateValues>,
}

/// The content of a register or a synchronous ROM before and after a clock, as nodes.
#[derive(Clone, Copy, Debug)]
pub struct StateValues {
    /// The net that the register or ROM drives.
    pub net: NetId,
    /// The content after the clock that accepts `start` and all operands. For a ROM it is the word before any clock, which no
    /// result shows.
    pub first: NodeId,
    /// The content before an arbitrary clock.
    pub before: NodeId,
    /// The content after that clock, as a function of the contents `before` it.
    pub after: NodeId,
}

/// Executes a clock in which any microinstruction may be executed.
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

//! Compares the built-in simulator with an interpreter that evaluates random netlists net by net, as the module `netlist`
//! documents the cells.

use glint::hdl::netlist::{Interpreter, Role};
use glint::hdl::sim::Simulator;

use crate::common::random_netlist::{Random, SMALL, Size, design};

/// Nets as wide as there are; more registers and fields than the simulator tells apart.
const WIDE: Size = Size { widest: 64, ..SMALL };
const BIG: Size = Size { widest: 64, registers: 50, fields: 20 };

const CLOCKS: u64 = 12;

#[test]
fn random_netlists_behave_as_documented() {
    for seed in 0..300 {
        let design = design(seed, [SMALL, WIDE, WIDE, BIG][seed as usize % 4]);
        let mut random = Random::new(!seed);
        let mut simulator: Simulator = Simulator::new(&design).expect("a simulator");
        let mut reference = Interpreter::new(&design).expect("no loop");
        let mut inputs = vec![0; design.inputs().count()];
        for clock in 0..CLOCKS {
            for (at, port) in design.inputs().enumerate() {
                inputs[at] = random.bits(design.width(port.net));
                // Some clocks of work between resets.
                inputs[at] |= u64::from(port.role == Role::Reset && clock % 5 > 0);
                simulator.set(at, inputs[at]);
            }
            simulator.clock().expect("it settles");
            reference.settle(&inputs);
            reference.edge();
            reference.settle(&inputs);
            for (id, net) in design.iter().filter(|(_, net)| net.named) {
                let (shown, right) = (simulator.value(id), reference.value(id));
                assert_eq!(shown, right, "clock {clock}, net `{}` of\n{design}", net.name);
            }
        }
    }
}

#[test]
fn lanes_are_independent() {
    for seed in 0..20 {
        let design = design(seed, if seed % 4 == 3 { BIG } else { WIDE });
        let mut random = Random::new(!seed);
        let mut together = Simulator::<5>::new(&design).expect("a simulator");
        let mut alone: [Simulator; 5] = [(); 5].map(|()| Simulator::new(&design).expect("it"));
        for _ in 0..CLOCKS {
            for (at, port) in design.inputs().enumerate() {
                let lanes = [(); 5].map(|()| random.bits(design.width(port.net)));
                together.set_lanes(at, lanes);
                alone.iter_mut().zip(lanes).for_each(|(it, bits)| it.set(at, bits));
            }
            together.clock().expect("it settles");
            alone.iter_mut().for_each(|it| it.clock().expect("it settles"));
            for (id, _) in design.iter().filter(|(_, net)| net.named) {
                let expected = [0, 1, 2, 3, 4].map(|lane| alone[lane].value(id));
                assert_eq!(together.lanes(id), expected, "seed {seed}");
            }
        }
    }
}

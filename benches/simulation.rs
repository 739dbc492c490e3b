//! Clocks per second of the built-in simulator on the devices of the catalogue: one point after the
//! other, golden comparison off.

use std::hint::black_box;

use anyhow::{Context, Result, anyhow};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glint::hdl::netlist::{Design, NetId, Role};
use glint::hdl::sim::Simulator;
use glint::registry::Registry;

/// A device under a stream of random points.
struct Stream<const LANES: usize> {
    simulator: Simulator<LANES>,
    start: usize,
    /// Positions of the operand ports and of their strobes.
    operands: Vec<(usize, usize)>,
    done: NetId,
    random: u64,
}

impl<const LANES: usize> Stream<LANES> {
    fn new(design: &Design) -> Result<Self> {
        let mut simulator = Simulator::new(design)?;
        let position = |net: NetId| {
            let at = design.inputs().position(|port| port.net == net);
            at.context("an input port")
        };
        let role = |wanted| {
            let port = design.port(|role| role == wanted);
            port.map(|port| port.net).context("a port of each role")
        };
        let operands = design
            .inputs()
            .filter_map(|port| match port.role {
                Role::Operand { strobe } => Some((port.net, strobe)),
                _ => None,
            })
            .map(|(data, strobe)| Ok((position(data)?, position(strobe)?)))
            .collect::<Result<_>>()?;
        let reset = position(role(Role::Reset)?)?;
        simulator.clock()?;
        simulator.set_lanes(reset, [1; LANES]);
        Ok(Self {
            simulator,
            start: position(role(Role::Start)?)?,
            operands,
            done: role(Role::Done)?,
            random: 1,
        })
    }

    /// Computes one point and returns the number of clocks.
    fn point(&mut self) -> Result<u64> {
        for (data, strobe) in &self.operands {
            let bits = [(); LANES].map(|()| {
                // The constants of Knuth's MMIX generator; the upper bits are the random ones.
                self.random = self.random.wrapping_mul(6_364_136_223_846_793_005);
                self.random = self.random.wrapping_add(1_442_695_040_888_963_407);
                self.random >> 43
            });
            self.simulator.set_lanes(*data, bits);
            self.simulator.set_lanes(*strobe, [1; LANES]);
        }
        self.simulator.set_lanes(self.start, [1; LANES]);
        self.simulator.clock()?;
        for (_, strobe) in &self.operands {
            self.simulator.set_lanes(*strobe, [0; LANES]);
        }
        self.simulator.set_lanes(self.start, [0; LANES]);
        let mut clocks = 1;
        while self.simulator.lanes(self.done)[0] == 0 {
            self.simulator.clock()?;
            clocks += 1;
        }
        self.simulator.clock()?;
        Ok(clocks + 1)
    }
}

fn measure<const LANES: usize>(criterion: &mut Criterion, design: &Design) -> Result<()> {
    let mut stream = Stream::<LANES>::new(design)?;
    let clocks = stream.point()?;
    let mut group = criterion.benchmark_group(&design.name);
    group.throughput(Throughput::Elements(100 * clocks * LANES as u64));
    group.bench_function(format!("clocks, lanes: {LANES}"), |bencher| {
        bencher.iter(|| {
            for _ in 0..100 {
                black_box(stream.point().expect("it has simulated a point before"));
            }
        });
    });
    group.finish();
    Ok(())
}

fn all(criterion: &mut Criterion) {
    for device in Registry::catalogue().devices() {
        let config = device.defaults();
        let measured =
            device.design(&config).map_err(|problems| anyhow!("{problems:?}")).and_then(|design| {
                measure::<1>(criterion, &design)?;
                measure::<16>(criterion, &design)
            });
        measured.expect("a device of the catalogue");
    }
}

criterion_group!(benches, all);
criterion_main!(benches);

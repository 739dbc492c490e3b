//! Simulates a few points in a pipeline, and records chosen nets at every clock, for example for a timing
//! diagram.

use anyhow::{Result, bail};

use super::instances::Instances;
use glint_golden::Contract;
use glint_rtl::netlist::{Design, NetId, Role};

/// Simulates the given points in a pipeline, and returns the bit patterns of `nets` in each clock, just before its rising
/// edge. Points are raw operands in the order of `Contract::operands`, offered one after another until the pipeline takes
/// them. Before the last point, one clock has no point. The first result waits for `pause` clocks, if the pipeline has an
/// `out_ready`. The recording ends with the clock of the last result.
///
/// # Errors
/// Fails if the design cannot be simulated, or if not all results appear within `limit` clocks.
pub(super) fn record(
    design: &Design,
    contract: &dyn Contract,
    (points, pause): (&[Vec<i64>], usize),
    nets: &[NetId],
    limit: u32,
) -> Result<Vec<Vec<u64>>> {
    let mut instance = Instances::<1>::new(design, contract)?;
    let (out_ready, valid) = (instance.ports.out_ready, instance.ports.valid);
    let in_ready = design.port(|role| role == Role::InReady).map(|port| port.net);
    let mut waiting = points;
    let mut paused = if out_ready.is_some() { pause } else { 0 };
    let (mut bubble, mut taken) = (true, 0);
    let mut clocks = Vec::new();
    for _ in 0..limit {
        let gap = waiting.len() == 1 && std::mem::take(&mut bubble);
        let point = if gap { None } else { waiting.first() };
        match point {
            Some(point) => instance.offer([Some(point)]),
            None => instance.release(),
        }
        let shows = instance.simulator.value(valid) == 1;
        let waits = shows && paused > 0;
        paused -= usize::from(waits);
        if let Some(port) = out_ready {
            instance.simulator.set(port, u64::from(!waits));
        }
        instance.simulator.settle()?;
        clocks.push(nets.iter().map(|&net| instance.simulator.value(net)).collect());
        taken += usize::from(shows && !waits);
        if taken == points.len() {
            return Ok(clocks);
        }
        if point.is_some() && in_ready.is_none_or(|it| instance.simulator.value(it) == 1) {
            waiting = &waiting[1..];
        }
        instance.simulator.clock()?;
    }
    bail!("`{}` shows no result within {limit} clocks", design.name)
}

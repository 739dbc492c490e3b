//! Sends points through a pipeline in the built-in simulator, and records what its nets carry.

use anyhow::{Result, bail};

use super::instances::Instances;
use glint_golden::Contract;
use glint_rtl::netlist::{Design, NetId, Role};

/// Simulates points in a pipeline, and returns what `nets` carry in each clock, just before its rising edge: the points
/// are offered one a clock, but for a bubble before the last; the first result waits for `pause` clocks, where it can.
/// The recording ends with the last result.
///
/// # Errors
/// A design that cannot be simulated, or shows no result within `limit` clocks.
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

//! Points through a pipeline in the built-in simulator: one alone for its latency and its results, and some with a bubble
//! and a pause, as a recording.

use anyhow::{Context, Result};

use crate::golden::Contract;
use crate::hdl::netlist::{Design, NetId, Role};
use crate::hdl::sim::Simulator;

/// A pipeline in the simulator, after its reset, with nothing on its way.
pub(super) struct Through<'a> {
    design: &'a Design,
    contract: &'a dyn Contract,
    simulator: Simulator,
    in_valid: usize,
    out_ready: Option<usize>,
    operands: Vec<usize>,
    out_valid: NetId,
}

impl<'a> Through<'a> {
    /// # Errors
    /// A design that is no pipeline, or that cannot be simulated.
    pub(super) fn new(design: &'a Design, contract: &'a dyn Contract) -> Result<Self> {
        let of_role = |role: Role| design.inputs().position(|port| port.role == role);
        let operand = |name: &String| {
            let at = design.inputs().position(|port| design.net(port.net).name == *name);
            at.with_context(|| format!("no input `{name}`"))
        };
        let operands = contract.operands().iter().map(|it| operand(&it.name));
        let mut simulator: Simulator = Simulator::new(design)?;
        simulator.clock()?;
        simulator.set(of_role(Role::Reset).context("no reset")?, 1);
        Ok(Self {
            design,
            contract,
            simulator,
            in_valid: of_role(Role::InValid).context("no input `in_valid`")?,
            out_ready: of_role(Role::OutReady),
            operands: operands.collect::<Result<_>>()?,
            out_valid: design.port(|it| it == Role::Valid).context("no output `out_valid`")?.net,
        })
    }

    /// Offers a point, or none.
    fn offer(&mut self, operands: Option<&[i64]>) {
        self.simulator.set(self.in_valid, u64::from(operands.is_some()));
        for (at, &raw) in operands.into_iter().flatten().enumerate() {
            let format = self.contract.operands()[at].format;
            self.simulator.set(self.operands[at], format.bits(i128::from(raw)));
        }
    }

    fn take(&mut self, ready: bool) {
        if let Some(port) = self.out_ready {
            self.simulator.set(port, u64::from(ready));
        }
    }

    /// One point: the clock with its results, counted from the one that takes it, and the values of `results` then.
    ///
    /// # Errors
    /// A pipeline without results in `limit` clocks.
    pub(super) fn one(
        mut self,
        operands: &[i64],
        results: &[NetId],
        limit: u32,
    ) -> Result<(u32, Vec<u64>)> {
        self.take(true);
        self.offer(Some(operands));
        for clock in 0..limit {
            if self.simulator.value(self.out_valid) == 1 {
                let values = results.iter().map(|&net| self.simulator.value(net)).collect();
                return Ok((clock, values));
            }
            self.simulator.clock()?;
            self.offer(None);
        }
        anyhow::bail!("`{}` shows no result within {limit} clocks", self.design.name)
    }

    /// Records `nets` in each clock, just before its rising edge: the points are offered one a clock, but for a bubble
    /// before the last; the first result waits for `pause` clocks. The recording ends with the last result.
    ///
    /// # Errors
    /// A circuit that does not settle.
    pub(super) fn record(
        mut self,
        points: &[Vec<i64>],
        pause: usize,
        nets: &[NetId],
        limit: u32,
    ) -> Result<Vec<Vec<u64>>> {
        let mut waiting = points.iter().collect::<std::collections::VecDeque<_>>();
        let mut paused = if self.out_ready.is_some() { pause } else { 0 };
        let (mut bubble, mut taken) = (true, 0);
        let mut clocks = Vec::new();
        for _ in 0..limit {
            let gap = waiting.len() == 1 && std::mem::take(&mut bubble);
            let point = if gap { None } else { waiting.front() };
            self.offer(point.map(|point| point.as_slice()));
            let shows = self.simulator.value(self.out_valid) == 1;
            let waits = shows && paused > 0;
            paused -= usize::from(waits);
            self.take(!waits);
            self.simulator.settle()?;
            clocks.push(nets.iter().map(|&net| self.simulator.value(net)).collect());
            taken += usize::from(shows && !waits);
            if taken == points.len() {
                return Ok(clocks);
            }
            if point.is_some() && !waits {
                waiting.pop_front();
            }
            self.simulator.clock()?;
        }
        anyhow::bail!("`{}` shows no result within {limit} clocks", self.design.name)
    }
}

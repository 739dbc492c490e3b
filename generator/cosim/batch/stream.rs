//! Points through the built-in simulator of a pipeline, many instances at a time, a point a clock each.

use std::collections::VecDeque;
use std::ops::Range;

use anyhow::{Context, Result, ensure};

use super::{LANES, Points};
use crate::base::fixed::Format;
use crate::golden::Contract;
use crate::hdl::netlist::{Design, NetId, Pipeline, Role};
use crate::hdl::sim::Simulator;

/// A simulator of several instances with the places of its ports.
pub(super) struct Stream {
    simulator: Simulator<LANES>,
    in_valid: usize,
    /// For each operand of the contract: its port and format.
    operands: Vec<(usize, Format)>,
    results: Vec<(NetId, Format)>,
    valid: NetId,
    latency: usize,
}

impl Stream {
    pub(super) fn new(
        design: &Design,
        pipeline: &Pipeline,
        contract: &dyn Contract,
    ) -> Result<Self> {
        let mut simulator = Simulator::<LANES>::new(design)?;
        let input = |name: &str| super::input(&simulator, design, name);
        let operands = contract
            .operands()
            .iter()
            .map(|operand| Ok((input(&operand.name)?, operand.format)))
            .collect::<Result<_>>()?;
        let results = super::results(design, contract)?;
        let (reset, in_valid) = (input("rst_n")?, input("in_valid")?);
        let ready = design.inputs().position(|port| port.role == Role::OutReady);
        let valid = design.port(|role| role == Role::Valid).context("no output `out_valid`")?.net;
        simulator.clock()?;
        simulator.set_lanes(reset, [1; LANES]);
        if let Some(ready) = ready {
            simulator.set_lanes(ready, [1; LANES]);
        }
        let latency = pipeline.stages.len();
        Ok(Self { simulator, in_valid, operands, results, valid, latency })
    }

    /// Every instance takes a point every clock, as long as there are some.
    pub(super) fn compute(&mut self, points: &Points, range: Range<usize>) -> Result<Vec<i64>> {
        let (width, first) = (self.results.len(), range.start);
        let mut out = vec![0; range.len() * width];
        let mut stages: VecDeque<[Option<usize>; LANES]> =
            std::iter::repeat_n([None; LANES], self.latency).collect();
        let (mut waiting, mut left) = (range.clone(), range.len());
        while left > 0 {
            let offered: [Option<usize>; LANES] = std::array::from_fn(|_| waiting.next());
            self.offer(points, &offered);
            self.simulator.clock()?;
            stages.push_front(offered);
            stages.pop_back();
            let shown = stages.back().copied().unwrap_or([None; LANES]);
            let valid = self.simulator.lanes(self.valid);
            for (lane, point) in shown.into_iter().enumerate() {
                ensure!(
                    (valid[lane] == 1) == point.is_some(),
                    "out_valid is {} where {} comes out",
                    valid[lane],
                    if point.is_some() { "a point" } else { "no point" }
                );
                let Some(point) = point else { continue };
                ensure!(points.results(point) == 1, "a pipeline has one result for a point");
                let to = (point - first) * width;
                for (out, &(net, format)) in out[to..].iter_mut().zip(&self.results) {
                    *out = format.raw(self.simulator.lanes(net)[lane]) as i64;
                }
                left -= 1;
            }
        }
        Ok(out)
    }

    fn offer(&mut self, points: &Points, offered: &[Option<usize>; LANES]) {
        self.simulator.set_lanes(self.in_valid, offered.map(|point| u64::from(point.is_some())));
        for (at, &(port, format)) in self.operands.iter().enumerate() {
            let bits = |point| format.bits(i128::from(points.operands(point)[at]));
            self.simulator.set_lanes(port, offered.map(|point| point.map_or(0, bits)));
        }
    }
}

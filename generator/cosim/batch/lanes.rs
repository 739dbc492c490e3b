//! Points through the built-in simulator, many instances at a time.

use std::ops::Range;

use anyhow::{Result, ensure};
use rayon::prelude::*;

use super::stream::Stream;
use super::{Engine, LANES, Points};
use crate::base::fixed::Format;
use crate::golden::Contract;
use crate::hdl::netlist::{Design, Handshake, NetId};
use crate::hdl::sim::Simulator;

/// More clocks than any computation takes.
const LIMIT: u32 = 1 << 16;

/// rust_hdl: as many simulators as there are threads, each of many instances of the design.
pub struct RustHdl {
    teams: Vec<Instances>,
}

/// The instances of one thread.
enum Instances {
    Cores(Team),
    Pipelines(Stream),
}

impl RustHdl {
    /// Simulators of a design, at power-up and reset.
    ///
    /// # Errors
    /// As of [`Simulator::new`], and a contract that speaks of ports that the design does not have.
    pub fn new(design: &Design, contract: &dyn Contract) -> Result<Self> {
        let teams = (0..rayon::current_num_threads())
            .map(|_| match &design.pipeline {
                None => Ok(Instances::Cores(Team::new(design, contract)?)),
                Some(pipeline) => {
                    Ok(Instances::Pipelines(Stream::new(design, pipeline, contract)?))
                }
            })
            .collect::<Result<_>>()?;
        Ok(Self { teams })
    }
}

impl Engine for RustHdl {
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>> {
        let count = self.teams.len();
        let share = |at: usize| points.len() * at / count..points.len() * (at + 1) / count;
        let parts: Vec<Vec<i64>> = self
            .teams
            .par_iter_mut()
            .enumerate()
            .map(|(at, team)| match team {
                Instances::Cores(team) => team.compute(points, share(at)),
                Instances::Pipelines(stream) => stream.compute(points, share(at)),
            })
            .collect::<Result<_>>()?;
        Ok(parts.concat())
    }
}

/// A simulator of several instances with the places of its ports.
struct Team {
    simulator: Simulator<LANES>,
    start: usize,
    /// For each operand of the contract: data port, strobe port, format.
    operands: Vec<(usize, usize, Format)>,
    results: Vec<(NetId, Format)>,
    valid: NetId,
    busy: NetId,
}

/// The task of an instance.
#[derive(Clone, Copy, Default)]
struct Task {
    point: usize,
    /// Results so far.
    shown: usize,
    clocks: u32,
}

impl Team {
    fn new(design: &Design, contract: &dyn Contract) -> Result<Self> {
        let mut simulator = Simulator::<LANES>::new(design)?;
        let input = |name: &str| super::input(&simulator, design, name);
        let operands = contract
            .operands()
            .iter()
            .map(|operand| {
                let strobe = input(&format!("{}_write", operand.name))?;
                Ok((input(&operand.name)?, strobe, operand.format))
            })
            .collect::<Result<_>>()?;
        let results = super::results(design, contract)?;
        let (reset, start) = (input("rst_n")?, input("start")?);
        let Handshake { valid, busy, .. } = design.handshake()?;
        simulator.clock()?;
        simulator.set_lanes(reset, [1; LANES]);
        Ok(Self { simulator, start, operands, results, valid, busy })
    }

    /// Every instance takes the next point as soon as it is free.
    fn compute(&mut self, points: &Points, range: Range<usize>) -> Result<Vec<i64>> {
        let width = self.results.len();
        let base = points.results[range.start];
        let mut out = vec![0; (points.results[range.end] - base) * width];
        let mut tasks: [Option<Task>; LANES] = [None; LANES];
        let mut waiting = range;
        loop {
            let starting = self.load(points, &mut tasks, &mut waiting);
            if tasks.iter().all(Option::is_none) {
                return Ok(out);
            }
            self.simulator.clock()?;
            if starting {
                self.release();
            }
            let valid = self.simulator.lanes(self.valid);
            let busy = self.simulator.lanes(self.busy);
            for (lane, slot) in tasks.iter_mut().enumerate() {
                let Some(task) = slot else { continue };
                let results = points.results(task.point);
                if valid[lane] == 1 {
                    ensure!(task.shown < results, "there are more than {results} results");
                    let to = (points.results[task.point] - base + task.shown) * width;
                    for (out, &(net, format)) in out[to..].iter_mut().zip(&self.results) {
                        *out = format.raw(self.simulator.lanes(net)[lane]) as i64;
                    }
                    task.shown += 1;
                }
                task.clocks += 1;
                ensure!(task.clocks < LIMIT, "the device does not end");
                if busy[lane] == 0 {
                    let shown = task.shown;
                    ensure!(shown == results, "there are {shown} results, not {results}");
                    *slot = None;
                }
            }
        }
    }

    /// Gives points to the instances that have none; whether there was one.
    fn load(
        &mut self,
        points: &Points,
        tasks: &mut [Option<Task>; LANES],
        waiting: &mut Range<usize>,
    ) -> bool {
        let mut starting = [0; LANES];
        let free = tasks.iter_mut().zip(&mut starting);
        for ((task, start), point) in free.filter(|(task, _)| task.is_none()).zip(waiting) {
            *task = Some(Task { point, ..Task::default() });
            *start = 1;
        }
        if starting == [0; LANES] {
            return false;
        }
        for (at, &(data, strobe, format)) in self.operands.iter().enumerate() {
            // The data of those that do not start do not matter: their strobe is low.
            let bits = tasks.map(|task| {
                task.map_or(0, |task| format.bits(i128::from(points.operands(task.point)[at])))
            });
            self.simulator.set_lanes(data, bits);
            self.simulator.set_lanes(strobe, starting);
        }
        self.simulator.set_lanes(self.start, starting);
        true
    }

    /// Lowers `start` and the strobes.
    fn release(&mut self) {
        self.simulator.set_lanes(self.start, [0; LANES]);
        for &(_, strobe, _) in &self.operands {
            self.simulator.set_lanes(strobe, [0; LANES]);
        }
    }
}

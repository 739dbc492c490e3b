//! Computes many points with the built-in simulator.
//!
//! [`RustHdl`] has one simulator for each thread. Each of the 32 lanes of a simulator runs an instance of the design, which
//! computes a point of its own.

use std::array;
use std::collections::VecDeque;
use std::mem;
use std::ops::Range;

use anyhow::{Result, ensure};
use rayon::prelude::*;

use super::{Engine, LANES, Points};
use crate::cosim::instances::Instances;
use glint_golden::Contract;
use glint_rtl::netlist::{Design, NetId, Role};

/// A computation that takes more clocks counts as endless.
const LIMIT: u64 = 1 << 16;

/// An [`Engine`] that simulates the design with rust_hdl.
pub struct RustHdl {
    teams: Vec<Team>,
}

impl RustHdl {
    /// Makes one simulator for each thread of rayon's pool, and resets the design in all of them.
    ///
    /// # Errors
    /// Fails if the design has mistakes in its structure, or if design and contract do not have the same operands and outputs.
    pub fn new(design: &Design, contract: &dyn Contract) -> Result<Self> {
        let latency = design.pipeline.as_ref().map(|pipeline| pipeline.stages.len() as u64);
        let in_ready = design.port(|role| role == Role::InReady).map(|port| port.net);
        let mut teams = Vec::new();
        for _ in 0..rayon::current_num_threads() {
            teams.push(Team { instances: Instances::new(design, contract)?, latency, in_ready });
        }
        Ok(Self { teams })
    }

    /// Writes words into the writable table of all instances, through its write port. For each address, `words` has one raw
    /// value for each data port of the write port.
    ///
    /// # Errors
    /// Fails if the design has no write port, if a word has another number of parts, or if the core is not ready to load a word.
    pub fn load_table(&mut self, design: &Design, words: &[Vec<i64>]) -> Result<()> {
        for team in &mut self.teams {
            team.instances.load_table(design, words)?;
        }
        Ok(())
    }
}

impl Engine for RustHdl {
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>> {
        let count = self.teams.len();
        let shares = self.teams.par_iter_mut().enumerate().map(|(at, team)| {
            let share = points.len() * at / count..points.len() * (at + 1) / count;
            team.compute(points, share)
        });
        let parts: Vec<Vec<i64>> = shares.collect::<Result<_>>()?;
        Ok(parts.concat())
    }
}

struct Team {
    instances: Instances<LANES>,
    /// The number of clocks from a point to its result, if the design is a pipeline; otherwise `None`.
    latency: Option<u64>,
    /// The output `in_ready` of a pipeline, which is 1 if the pipeline takes a point. The output is the same in all instances.
    in_ready: Option<NetId>,
}

struct LaneTask {
    point: usize,
    shown: usize,
    /// The clock in which the instance took the point.
    taken: u64,
}

impl Team {
    /// Returns the raw outputs of the points in `range`, in their order. Every instance takes the next point as soon as it
    /// can: a core when it is free, and a pipeline when it is ready.
    fn compute(&mut self, points: &Points, range: Range<usize>) -> Result<Vec<i64>> {
        let Self { instances, latency, in_ready } = self;
        let width = instances.ports.results.len();
        let base = points.results[range.start];
        let mut out = vec![0; (points.results[range.end] - base) * width];
        // For each lane, its unfinished computations, oldest first.
        let mut tasks: [VecDeque<LaneTask>; LANES] = array::from_fn(|_| VecDeque::new());
        let (mut left, mut waiting) = (range.len(), range);
        let mut offering = false;
        for clock in 1.. {
            if left == 0 {
                break;
            }
            let ready = in_ready.is_none_or(|net| instances.simulator.lane(net, 0) == 1);
            let mut offered: [Option<&[i64]>; LANES] = [None; LANES];
            for (tasks, offered) in tasks.iter_mut().zip(&mut offered) {
                let takes = if latency.is_some() { ready } else { tasks.is_empty() };
                if takes && let Some(point) = waiting.next() {
                    tasks.push_back(LaneTask { point, shown: 0, taken: clock });
                    *offered = Some(points.operands(point));
                }
            }
            let was_offering = mem::replace(&mut offering, offered.iter().any(Option::is_some));
            if offering {
                instances.offer(offered);
            } else if was_offering {
                instances.release();
            }
            instances.simulator.clock()?;
            let valid = instances.simulator.lanes(instances.ports.valid);
            let busy = instances.ports.busy.map(|busy| instances.simulator.lanes(busy));
            for (lane, tasks) in tasks.iter_mut().enumerate() {
                let Some(task) = tasks.front_mut() else { continue };
                let clocks = clock + 1 - task.taken;
                let results = points.results(task.point);
                let shows = valid[lane] == 1;
                if let Some(latency) = latency {
                    let due = clocks == *latency;
                    ensure!(
                        shows == due,
                        "after {clocks} clocks, the point shows results: {shows}, which differs from the \
                         latency"
                    );
                }
                if shows {
                    ensure!(
                        task.shown < results,
                        "the device shows more than {results} results for a point"
                    );
                    let to = (points.results[task.point] - base + task.shown) * width;
                    for (place, raw) in out[to..to + width].iter_mut().zip(instances.results(lane))
                    {
                        *place = raw;
                    }
                    task.shown += 1;
                }
                ensure!(clocks < LIMIT, "the computation of the device does not end");
                if busy.map_or(shows, |busy| busy[lane] == 0) {
                    let shown = task.shown;
                    ensure!(
                        shown == results,
                        "the device shows {shown} results for a point, not {results}"
                    );
                    tasks.pop_front();
                    left -= 1;
                }
            }
        }
        Ok(out)
    }
}

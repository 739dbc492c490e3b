//! Finds the interval and the schedule of the pipeline that a configuration asks for.
//!
//! An unreachable clock or number of stages is reported as a diagnostic on its key, with the nearest reachable value.

use super::graph::NodeId;
use super::interval;
use super::schedule::{self, Schedule, ScheduleProblem, ScheduleRefusal, Unreachable};
use super::unroll::Unrolled;
use super::{Goal, Options};
use crate::netlist::{Design, decided_by_data, latest_done};
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, Diagnostics};

/// A computation, and the pipeline that is requested for it.
pub struct Request<'a> {
    sequential: &'a Design,
    unrolled: &'a Unrolled,
    options: &'a Options,
    results: Vec<NodeId>,
}

/// Turns the reasons against unrolling into errors of the key that asks for it, `architecture`.
pub fn sequentially(found: Diagnostics) -> Diagnostics {
    let remedy = || "set architecture = \"sequential\"".to_owned();
    Diagnostics(found.0.into_iter().map(|it| it.of_key("architecture", remedy())).collect())
}

impl<'a> Request<'a> {
    /// Asks for a pipeline of a computation.
    pub fn new(sequential: &'a Design, unrolled: &'a Unrolled, options: &'a Options) -> Self {
        let results = unrolled.results.iter().map(|&(_, value)| value).collect();
        Self { sequential, unrolled, options, results }
    }

    /// Poses the problem of a schedule, products with registers of their own or without.
    pub fn problems(&self, registered: bool, interval: usize) -> ScheduleProblem<'_> {
        let target = self.options.target;
        let registered = target.registered.filter(|_| registered);
        ScheduleProblem::new(&self.unrolled.graph, target, registered, interval, &self.results)
    }

    /// Returns the clocks from a point to the next.
    ///
    /// # Errors
    /// Fails if [`interval::clocks`] fails.
    pub fn interval(&self) -> Result<usize, Diagnostics> {
        // With the clock of `start`, in which the operands are written. Iterations that operands decide on are counted at
        // their most.
        let steps = self.unrolled.steps.len();
        let decided = !decided_by_data(self.sequential).is_empty();
        let most = latest_done(self.sequential).filter(|_| decided);
        let clocks = most.map_or(steps, |it| steps.max(it as usize)) + 1;
        let problems = |interval| self.problems(self.options.registered, interval);
        interval::clocks(&self.sequential.name, self.options, clocks, problems)
            .map_err(|it| self.wrong(it.key, it.message, it.remedy, None))
    }

    /// Returns the schedule that reaches the goal.
    ///
    /// # Errors
    /// Fails if a clock or a number of stages cannot be reached. The error has the nearest value that can.
    pub fn schedule(
        &self,
        problems: &ScheduleProblem<'_>,
        interval: usize,
    ) -> Result<Schedule, Diagnostics> {
        match self.options.goal {
            Goal::ClockMhz(clock) => {
                let schedule = problems.for_period(1000.0 / clock);
                schedule.map_err(|refusal| match refusal {
                    ScheduleRefusal::Unreachable(limit) => self.too_fast(clock, interval, &limit),
                    ScheduleRefusal::Unsolved(why, at) => self.unsolved(&why, at),
                })
            }
            Goal::Stages(stages) => self.in_stages(problems, stages),
        }
    }

    fn in_stages(
        &self,
        problems: &ScheduleProblem<'_>,
        stages: usize,
    ) -> Result<Schedule, Diagnostics> {
        let (name, target) = (&self.sequential.name, self.options.target.name);
        let most = problems.most_stages();
        if stages > most {
            let message = format!(
                "`{name}` has no use for {stages} stages: more than {most} make it no faster on {target}"
            );
            let limiting = problems.fastest().map(|it| it.limiting);
            return Err(self.wrong_stages(message, format!("{most} or less"), limiting));
        }
        let schedule = problems.for_stages(stages).map_err(|refusal| match refusal {
            ScheduleRefusal::Unsolved(why, at) => self.unsolved(&why, at),
            ScheduleRefusal::Unreachable(it) => {
                self.unsolved("no clock is slow enough", Some(it.limiting))
            }
        })?;
        let least = schedule.latency;
        if least > stages {
            let plural = if stages == 1 { "" } else { "s" };
            let message = format!(
                "`{name}` cannot have {stages} stage{plural}: its registered memories and multipliers need {least} on {target}"
            );
            return Err(self.wrong_stages(message, format!("{least} or more"), None));
        }
        Ok(schedule)
    }

    fn wrong_stages(&self, message: String, wanted: String, at: Option<NodeId>) -> Diagnostics {
        self.wrong("pipeline.stages", message, format!("set pipeline.stages to {wanted}"), at)
    }

    /// Returns the diagnostic of a clock for which one operation alone is too slow.
    fn too_fast(&self, clock: f64, interval: usize, limit: &Unreachable) -> Diagnostics {
        let Unreachable { limiting, period } = *limit;
        let nearest = schedule::megahertz(period);
        let message = format!(
            "`{}` cannot run at {clock} MHz: `{}` alone takes {period:.2} ns on {}, which allows {nearest} MHz at \
             most",
            self.sequential.name,
            self.unrolled.graph.node(limiting).label.name,
            self.options.target.name
        );
        let registered = (!self.options.registered).then(|| self.problems(true, interval));
        let faster = registered.and_then(|problems| problems.fastest());
        let faster = faster.is_some_and(|it| it.period * clock <= 1000.0);
        let faster = if faster { ", or pipeline.multipliers = \"registered\"" } else { "" };
        let remedy = format!("set pipeline.clock_mhz to {nearest} or less{faster}");
        let mut wrong = self.wrong("pipeline.clock_mhz", message, remedy, Some(limiting));
        wrong.0.iter_mut().for_each(|it| it.nearest = Some(nearest));
        wrong
    }

    /// Returns the diagnostic of a problem without a solution, which there always is.
    fn unsolved(&self, why: &str, at: Option<NodeId>) -> Diagnostics {
        let name = &self.sequential.name;
        let message = format!("`{name}` has no schedule: {why}; this is a mistake of Glint's");
        let remedy = "ask for another pipeline.clock_mhz or pipeline.stages";
        self.wrong("pipeline.clock_mhz", message, remedy.to_owned(), at)
    }

    fn wrong(
        &self,
        key: &'static str,
        message: String,
        remedy: String,
        at: Option<NodeId>,
    ) -> Diagnostics {
        let first = self.sequential.nets[0].location;
        let place = at.map_or(first, |at| self.unrolled.graph.node(at).label.location);
        let found = Diagnostic::new(codes::SCHEDULE, message, place);
        Diagnostics(vec![found.of_key(key, remedy)])
    }
}

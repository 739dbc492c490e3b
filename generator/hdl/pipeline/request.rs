//! Finds the interval and the schedule for the pipeline that a user requests.
//!
//! If a clock frequency or a number of stages cannot be reached, the error states the nearest possible value.

use super::error::{PipelineError, PipelineErrorKind};
use super::graph::NodeId;
use super::interval;
use super::schedule::{self, Schedule, ScheduleProblem, ScheduleRefusal, Unreachable};
use super::unroll::Unrolled;
use super::{Goal, Options};
use crate::netlist::{Design, decided_by_data, latest_done};

pub struct Request<'a> {
    sequential: &'a Design,
    unrolled: &'a Unrolled,
    options: &'a Options,
    results: Vec<NodeId>,
}

impl<'a> Request<'a> {
    /// `unrolled` must be the computation of `sequential`.
    pub fn new(sequential: &'a Design, unrolled: &'a Unrolled, options: &'a Options) -> Self {
        let results = unrolled.results.iter().map(|&(_, value)| value).collect();
        Self { sequential, unrolled, options, results }
    }

    /// Returns the scheduling problem for an `interval` in clocks. With `registered`, products use the output registers of
    /// multipliers, provided that the target states a delay for them.
    pub fn problems(&self, registered: bool, interval: usize) -> ScheduleProblem<'_> {
        let target = self.options.target;
        let registered = target.registered.filter(|_| registered);
        ScheduleProblem::new(&self.unrolled.graph, target, registered, interval, &self.results)
    }

    /// Returns the interval, as [`interval::clocks`] chooses it.
    pub fn interval(&self) -> Result<usize, PipelineError> {
        // The sequential core takes one clock for each microinstruction, plus the clock of `start`, which writes the operands. If
        // operands decide the number of iterations, the largest number counts.
        let steps = self.unrolled.steps.len();
        let decided = !decided_by_data(self.sequential).is_empty();
        let mut most = steps;
        if decided && let Some(latest) = latest_done(self.sequential) {
            most = steps.max(latest as usize);
        }
        interval::clocks(self.sequential, self.options, most + 1, |interval| {
            self.problems(self.options.registered, interval)
        })
    }

    /// Returns the schedule that reaches the requested clock frequency or number of stages.
    ///
    /// # Errors
    /// Fails if one operation takes longer than the clock period. Also fails if the requested number of stages is more than
    /// useful, or fewer than memories and multipliers need. These errors have the nearest value that can be reached. Fails if the
    /// solver finds no schedule.
    pub fn schedule(
        &self,
        problems: &ScheduleProblem<'_>,
        interval: usize,
    ) -> Result<Schedule, PipelineError> {
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

    /// Returns the schedule with exactly `stages` stages, for [`Request::schedule`].
    fn in_stages(
        &self,
        problems: &ScheduleProblem<'_>,
        stages: usize,
    ) -> Result<Schedule, PipelineError> {
        let (name, target) = (&self.sequential.name, self.options.target.name);
        let most = problems.most_stages();
        if stages > most {
            let message = format!(
                "`{name}` cannot use {stages} stages: more than {most} stages do not make the pipeline \
                 faster on {target}"
            );
            let limiting = problems.fastest().map(|it| it.limiting);
            return Err(self.error(PipelineErrorKind::TooManyStages { most }, message, limiting));
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
                "`{name}` cannot have {stages} stage{plural}: its registered memories and multipliers need \
                 at least {least} on {target}"
            );
            return Err(self.error(PipelineErrorKind::TooFewStages { least }, message, None));
        }
        Ok(schedule)
    }

    /// Returns the error for a clock frequency (`clock`, in MHz) at which the operation in `limit` takes longer than a period.
    fn too_fast(&self, clock: f64, interval: usize, limit: &Unreachable) -> PipelineError {
        let Unreachable { limiting, period } = *limit;
        let nearest = schedule::megahertz(period);
        let message = format!(
            "`{}` cannot run at {clock} MHz: `{}` alone takes {period:.2} ns on {}, which allows at most \
             {nearest} MHz",
            self.sequential.name,
            self.unrolled.graph.node(limiting).label.name,
            self.options.target.name
        );
        let registered = self.registered_clock(interval).filter(|&higher| higher > nearest);
        let kind = PipelineErrorKind::Clock { nearest, registered };
        self.error(kind, message, Some(limiting))
    }

    /// Returns the highest clock frequency, in MHz, if products use the output registers of multipliers. Returns `None` if
    /// products use them already, or if the target states no delay for them.
    fn registered_clock(&self, interval: usize) -> Option<f64> {
        if self.options.registered || self.options.target.registered.is_none() {
            return None;
        }
        self.problems(true, interval).fastest().map(|limit| schedule::megahertz(limit.period))
    }

    /// Returns the error that the solver found no schedule, although one always exists. `at` is the node at which the solver's
    /// result is wrong, if known.
    fn unsolved(&self, why: &str, at: Option<NodeId>) -> PipelineError {
        let name = &self.sequential.name;
        let message = format!("`{name}` has no schedule: {why}; this is a bug in Glint");
        self.error(PipelineErrorKind::Unsolved, message, at)
    }

    /// Returns an error with the source line of `node`, or of the design's first net.
    fn error(
        &self,
        kind: PipelineErrorKind,
        message: String,
        node: Option<NodeId>,
    ) -> PipelineError {
        match node {
            None => PipelineError::of_design(self.sequential, kind, message),
            Some(node) => {
                let location = self.unrolled.graph.node(node).label.location;
                PipelineError::at(location, kind, message)
            }
        }
    }
}

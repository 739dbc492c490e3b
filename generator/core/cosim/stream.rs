//! Makes the inputs of one simulated instance, clock by clock from power-up on, and predicts its signals with the golden model.
//!
//! The inputs are random, or go through combinations of operands, or come from a recording. The module does not simulate. The
//! caller gives the inputs to the simulator, and then calls `compare`, which records the first signal that differs from the
//! prediction.

use anyhow::Result;

use super::binding::{Binding, Host};
use super::combinations::{Combinations, Space};
use super::offers::Offers;
use super::outcome::{Course, Mismatch, StreamRecord};
use super::recorded::RecordedInputs;
use super::stimulus::Stimulus;
use glint_rtl::netlist::NetId;

enum Source {
    /// Random inputs for a core.
    Stimulus(Stimulus),
    /// Random inputs for a pipeline.
    Offers(Offers),
    Combinations(Combinations),
    Recorded(RecordedInputs),
}

impl Source {
    #[inline]
    fn inputs(&self) -> &[u64] {
        match self {
            Self::Stimulus(stimulus) => stimulus.inputs(),
            Self::Offers(offers) => offers.inputs(),
            Self::Combinations(combinations) => combinations.inputs(),
            Self::Recorded(recorded) => recorded.inputs(),
        }
    }

    /// Returns whether the source will start no further computation.
    fn is_over(&self) -> bool {
        match self {
            Self::Combinations(combinations) => combinations.all_started(),
            Self::Offers(offers) => offers.is_over(),
            Self::Stimulus(_) | Self::Recorded(_) => false,
        }
    }

    /// Returns the place of the combination that started last.
    fn place(&self) -> Option<u64> {
        match self {
            Self::Combinations(combinations) => Some(combinations.place()),
            _ => None,
        }
    }
}

/// A stream: the inputs of one simulated instance, and the predictions of its signals.
pub(super) struct Stream {
    pub(super) seen: StreamRecord,
    /// The kind of the inputs, and their seed or number, from which the same stream can be made again.
    pub(super) course: Course,
    source: Source,
    host: Host,
    /// In a stream of combinations, the number of clocks from the `start` of the computation that differs to the difference.
    pub(super) since_start: u64,
}

impl Stream {
    /// `busy` is the value of the device's output `busy` at power-up.
    pub(super) fn new(binding: &Binding, course: Course, busy: bool) -> Self {
        let mut host = binding.host.clone();
        if let Host::Core(core) = &mut host {
            core.deaf = busy;
        }
        let source = match &course {
            Course::Random { seed, .. } if binding.is_pipeline() => {
                Source::Offers(Offers::new(&binding.ports, *seed))
            }
            Course::Random { seed, .. } => Source::Stimulus(Stimulus::new(&binding.ports, *seed)),
            Course::Combinations { first, count } => {
                Source::Combinations(Combinations::new(binding.space.clone(), *first, *count))
            }
            Course::Recorded { recording, .. } => Source::Recorded(RecordedInputs::new(recording)),
        };
        Self { seen: StreamRecord::default(), course, source, host, since_start: 0 }
    }

    /// Returns whether the course is complete or a signal differs. A pipeline goes on after a difference until the
    /// combinations that it took earlier are finished, because an earlier combination may differ too.
    pub(super) fn ended(&self) -> bool {
        match (&self.course, &self.seen.mismatch) {
            (Course::Combinations { .. }, Some(found)) => {
                !matches!(&self.host, Host::Pipe(pipe) if pipe.has_before(found.seed))
            }
            (_, Some(_)) => true,
            (Course::Random { points, .. }, _) => self.seen.points >= *points,
            (Course::Combinations { .. }, _) => {
                let idle = match &self.host {
                    Host::Core(core) => !core.deaf,
                    Host::Pipe(pipe) => !pipe.has_before(u64::MAX),
                };
                idle && self.source.is_over()
            }
            (Course::Recorded { clocks, .. }, _) => self.seen.clocks >= *clocks,
        }
    }

    /// Continues the stream, from the present state of the device, with the given computations: raw operands in the order of
    /// `Contract::operands`.
    pub(super) fn follow(&mut self, binding: &Binding, computations: &[Vec<i64>]) {
        let count = computations.len() as u64;
        self.course = Course::Combinations { first: 0, count };
        if let Source::Offers(offers) = &mut self.source {
            offers.follow(computations);
        } else {
            let space = Space::listed(&binding.ports, computations);
            self.source = Source::Combinations(Combinations::new(space.into(), 0, count));
        }
    }

    #[inline]
    pub(super) fn clock(&mut self, binding: &Binding) -> Result<()> {
        let (deaf, taken) = match &self.host {
            Host::Core(core) => (core.deaf, !core.deaf),
            Host::Pipe(pipe) => (false, pipe.taken),
        };
        let inputs = match &mut self.source {
            Source::Stimulus(stimulus) => stimulus.next(deaf, &binding.points),
            Source::Offers(offers) => offers.next(taken, &binding.points),
            Source::Combinations(combinations) => combinations.next(match &self.host {
                Host::Core(core) => !core.deaf,
                Host::Pipe(pipe) => pipe.is_ready(),
            }),
            Source::Recorded(recorded) => recorded.next(),
        };
        self.seen.clocks += 1;
        match &mut self.host {
            Host::Core(core) => core.clock(inputs),
            Host::Pipe(pipe) => {
                let inputs = self.source.inputs();
                let drawn = matches!(self.source, Source::Offers(_));
                let measure = drawn.then_some(&binding.measure);
                let place = self.source.place().unwrap_or(0);
                pipe.clock(&binding.ports, inputs, place, measure, &mut self.seen)?;
            }
        }
        Ok(())
    }

    #[inline]
    pub(super) fn inputs(&self) -> &[u64] {
        self.source.inputs()
    }

    /// Returns whether the latest inputs are known to neither start, write nor reset anything.
    #[inline]
    pub(super) fn is_idle(&self) -> bool {
        matches!(&self.source, Source::Stimulus(stimulus) if stimulus.is_idle())
    }

    /// Writes the predictions after the latest clock into lane `lane` of `expected`, in the order of the compared signals. For
    /// a pipeline, the function also writes into `known`: all ones for a signal that is predicted, and otherwise 0.
    #[inline]
    pub(super) fn predict<const L: usize>(
        &self,
        expected: &mut [[u64; L]],
        known: &mut [[u64; L]],
        lane: usize,
    ) {
        match &self.host {
            Host::Core(core) => {
                for (column, &bits) in expected.iter_mut().zip(core.predicted()) {
                    column[lane] = bits;
                }
            }
            Host::Pipe(pipe) => {
                for (at, (expected, known)) in expected.iter_mut().zip(known).enumerate() {
                    let predicted = pipe.expected(at);
                    expected[lane] = predicted.unwrap_or(0);
                    known[lane] = if predicted.is_some() { u64::MAX } else { 0 };
                }
            }
        }
    }

    /// Records the first signal on which simulation and model differ after the latest clock. `simulated` returns the bit
    /// pattern of a net. The microinstruction at `address` was executed at the clock edge.
    pub(super) fn compare(
        &mut self,
        binding: &Binding,
        address: u64,
        simulated: impl Fn(NetId) -> u64,
    ) {
        let place = match &self.course {
            Course::Random { seed, .. } => *seed,
            _ => self.source.place().unwrap_or(0),
        };
        let since = match &self.source {
            Source::Combinations(combinations) => combinations.since_start(),
            _ => 0,
        };
        let differences = binding.compared.iter().enumerate().filter_map(|(at, &net)| {
            let (golden, from) = match &self.host {
                Host::Core(core) => (core.predicted()[at], None),
                Host::Pipe(pipe) => (pipe.expected(at)?, pipe.point(at)),
            };
            if simulated(net) == golden {
                return None;
            }
            let start = match from {
                Some((place, taken)) if self.source.place().is_some() => {
                    (place, self.seen.clocks - taken)
                }
                _ => (place, since),
            };
            Some((at, golden, start))
        });
        // If several points in a pipeline differ, the point that was taken first is reported.
        let Some((at, golden, (seed, since))) = differences.min_by_key(|(.., (seed, _))| *seed)
        else {
            return;
        };
        if self.seen.mismatch.as_ref().is_some_and(|found| found.seed <= seed) {
            return;
        }
        let net = binding.compared[at];
        let during = match &binding.design.pipeline {
            Some(pipeline) => format!("stage {}", pipeline.stage_of[net.index()]),
            None => {
                let microprogram = &binding.design.control.microprogram;
                let executed = usize::try_from(address).ok().and_then(|at| microprogram.get(at));
                executed.map_or_else(String::new, |it| format!("microinstruction `{}`", it.name))
            }
        };
        self.since_start = since;
        self.seen.mismatch = Some(Mismatch {
            seed,
            clock: self.seen.clocks,
            signal: binding.design.net(net).name.clone(),
            golden,
            simulated: simulated(net),
            during,
        });
    }

    /// Counts the result that the model of a core predicts after the latest clock, and measures its error. A pipeline counts
    /// its results in `Pipe::clock`.
    #[inline]
    pub(super) fn note(&mut self, binding: &Binding) {
        if let Host::Core(core) = &mut self.host {
            let accepted = match &self.source {
                Source::Stimulus(stimulus) => Some(stimulus.accepted()),
                _ => None,
            };
            core.note(&binding.measure, &mut self.seen, accepted);
        }
    }
}

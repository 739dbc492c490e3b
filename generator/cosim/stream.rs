//! A stream: inputs from power-up on, and the golden model under them.

use std::mem;

use super::binding::Binding;
use super::combinations::Combinations;
use super::outcome::{Course, Mismatch, Seen};
use super::recorded::Recorded;
use super::stimulus::Stimulus;
use crate::golden::Model;
use crate::hdl::netlist::NetId;

/// The source of the inputs.
enum Source {
    Random { stimulus: Stimulus, seed: u64, points: u64 },
    Combinations(Combinations),
    Recorded(Recorded),
}

/// A stream. What the simulated hardware makes of it is for others to say.
pub(super) struct Stream {
    pub(super) seen: Seen,
    source: Source,
    model: Box<dyn Model>,
    /// Whether it does not hear `start`.
    deaf: bool,
    /// Results since the latest start.
    index: u64,
    /// The model's inputs, where it has an order of its own.
    reordered: Vec<u64>,
    /// The operands of the computation that shows results, and whether they are in the domain.
    operands: Vec<i64>,
    inside: bool,
}

impl Stream {
    /// At power-up, when the device shows `busy`.
    pub(super) fn new(binding: &Binding, course: Course, busy: bool) -> Self {
        let source = match course {
            Course::Random { seed, points } => {
                Source::Random { stimulus: binding.stimulus.clone().seeded(seed), seed, points }
            }
            Course::Combinations { first, count } => {
                Source::Combinations(binding.combinations(first, count))
            }
            Course::Recorded { recording, clocks } => {
                Source::Recorded(Recorded::new(recording, clocks))
            }
        };
        Self {
            seen: Seen::default(),
            source,
            model: binding.model.boxed_clone(),
            deaf: busy,
            index: 0,
            reordered: Vec::new(),
            operands: Vec::new(),
            inside: false,
        }
    }

    pub(super) fn ended(&self) -> bool {
        self.seen.mismatch.is_some()
            || match &self.source {
                Source::Random { points, .. } => self.seen.points >= *points,
                Source::Combinations(combinations) => !self.deaf && combinations.all_started(),
                Source::Recorded(recorded) => self.seen.clocks >= recorded.clocks,
            }
    }

    /// Goes on with combinations, as the device stands.
    pub(super) fn follow(&mut self, combinations: Combinations) {
        self.source = Source::Combinations(combinations);
    }

    /// Returns the course of the stream, for another to go the same way.
    pub(super) fn course(&self) -> Course {
        match &self.source {
            &Source::Random { seed, points, .. } => Course::Random { seed, points },
            Source::Combinations(combinations) => combinations.course(),
            Source::Recorded(Recorded { recording, clocks, .. }) => {
                Course::Recorded { recording: recording.clone(), clocks: *clocks }
            }
        }
    }

    /// Returns the number from which the inputs can be made again: the seed, or the place of the combination that runs; 0 for recorded ones.
    pub(super) fn seed(&self) -> u64 {
        match &self.source {
            Source::Random { seed, .. } => *seed,
            Source::Combinations(combinations) => combinations.place(),
            Source::Recorded(_) => 0,
        }
    }

    /// Clocks since the latest start, where combinations are gone through: 0 for the one that takes it.
    pub(super) fn since_start(&self) -> u64 {
        match &self.source {
            Source::Combinations(combinations) => combinations.since_start(),
            Source::Random { .. } | Source::Recorded(_) => 0,
        }
    }

    /// Clocks the model.
    #[inline]
    pub(super) fn clock(&mut self, binding: &Binding) {
        let inputs = match &mut self.source {
            Source::Random { stimulus, .. } => stimulus.next(self.deaf, &binding.points),
            Source::Combinations(combinations) => combinations.next(self.deaf),
            Source::Recorded(recorded) => recorded.next(),
        };
        match &binding.order {
            None => self.model.clock(inputs),
            Some(order) => {
                self.reordered.clear();
                self.reordered.extend(order.iter().map(|&at| inputs[at]));
                self.model.clock(&self.reordered);
            }
        }
        self.seen.clocks += 1;
    }

    /// The inputs of the latest clock.
    #[inline]
    pub(super) fn inputs(&self) -> &[u64] {
        match &self.source {
            Source::Random { stimulus, .. } => stimulus.inputs(),
            Source::Combinations(combinations) => combinations.inputs(),
            Source::Recorded(recorded) => recorded.inputs(),
        }
    }

    /// Whether the latest inputs are those of any clock in which the stream drives nothing.
    #[inline]
    pub(super) fn is_idle(&self) -> bool {
        match &self.source {
            Source::Random { stimulus, .. } => stimulus.is_idle(),
            Source::Combinations(_) | Source::Recorded(_) => false,
        }
    }

    /// Returns the model's predictions after the latest clock.
    #[inline]
    pub(super) fn predicted(&self) -> &[u64] {
        self.model.values()
    }

    /// The first signal on which simulation and model differ after the latest clock if they
    /// do. The microinstruction at `address` was executed at the edge.
    pub(super) fn mismatch(
        &self,
        binding: &Binding,
        address: u64,
        simulated: impl Fn(NetId) -> u64,
    ) -> Option<Mismatch> {
        let pairs = binding.compared.iter().zip(self.predicted());
        let differs = |(&net, &golden): (&NetId, &u64)| simulated(net) != golden;
        let at = pairs.clone().position(differs)?;
        let microprogram = &binding.design.control.microprogram;
        let executed = usize::try_from(address).ok().and_then(|at| microprogram.get(at));
        Some(Mismatch {
            seed: self.seed(),
            clock: self.seen.clocks,
            signal: binding.model.signals()[at].clone(),
            golden: self.predicted()[at],
            simulated: simulated(binding.compared[at]),
            during: executed
                .map_or_else(String::new, |it| format!("microinstruction `{}`", it.name)),
        })
    }

    /// Takes note of a result, if there is one, as predicted.
    #[inline]
    pub(super) fn note(&mut self, binding: &Binding) {
        let values = self.model.values();
        let was_deaf = mem::replace(&mut self.deaf, binding.is_deaf(values));
        if self.deaf && !was_deaf {
            self.index = 0;
        }
        if values[binding.valid] != 1 {
            return;
        }
        self.seen.points += 1;
        // All combinations against the formula: that is the proof of the contract. Of recorded inputs nobody says which
        // operands a result is of.
        let Source::Random { stimulus, .. } = &self.source else {
            return;
        };
        if self.index == 0 {
            self.operands.clear();
            self.operands.extend(stimulus.accepted());
            self.inside = binding.measure.inside(&self.operands);
        }
        if self.inside {
            binding.measure.note(&mut self.seen, &self.operands, self.index, values);
        } else {
            self.seen.histogram.add_outside();
        }
        self.index += 1;
    }
}

//! Streams side by side in the lanes of one simulator.

use std::mem;

use anyhow::Result;

use super::alone::Alone;
use super::binding::Binding;
use super::outcome::{Course, Seen};
use super::stream::Stream;
use crate::hdl::sim::Simulator;

/// Clocks for which each stream in turn is ahead of the simulator. Its model and stimulus then stay in
/// the processor's cache and their branches are foreseen, and what they leave for the simulator still
/// fits in.
const AHEAD: usize = 4;

/// As many streams as there are lanes, or fewer.
///
/// A stream reacts to `busy` as its model predicts it. That is what the simulation does, unless they
/// differ; and a stream in which anything differs is gone through once more, alone.
pub(super) struct Together<'a, const LANES: usize> {
    binding: &'a Binding<'a>,
    simulator: Simulator<LANES>,
    /// The first are in the first lanes.
    streams: Vec<Stream>,
    /// The lanes in which something differs.
    differ: [bool; LANES],
    /// The clocks to come.
    ahead: Vec<Clock<LANES>>,
}

/// The inputs of a clock and what is predicted after it, for each lane.
struct Clock<const LANES: usize> {
    inputs: Vec<[u64; LANES]>,
    /// Lanes whose inputs are those of a clock in which nothing is driven.
    idle: [bool; LANES],
    predicted: Vec<[u64; LANES]>,
    /// Streams that have ended before are not compared: all ones where one has not.
    compared: [u64; LANES],
}

impl<'a, const LANES: usize> Together<'a, LANES> {
    /// Streams at power-up.
    ///
    /// # Errors
    /// A design that cannot be simulated.
    pub(super) fn new(
        binding: &'a Binding<'a>,
        courses: impl IntoIterator<Item = Course>,
    ) -> Result<Self> {
        let simulator = Simulator::new(binding.design)?;
        let busy = simulator.lane(binding.compared[binding.busy], 0) == 1;
        let stream = |course| Stream::new(binding, course, busy);
        let clock = || Clock {
            inputs: vec![[0; LANES]; simulator.inputs().len()],
            idle: [false; LANES],
            predicted: vec![[0; LANES]; binding.compared.len()],
            compared: [0; LANES],
        };
        Ok(Self {
            binding,
            streams: courses.into_iter().take(LANES).map(stream).collect(),
            differ: [false; LANES],
            ahead: std::iter::repeat_with(clock).take(AHEAD).collect(),
            simulator,
        })
    }

    /// Whether every stream has ended that comes before the first that differs.
    pub(super) fn ended(&self) -> bool {
        let before = self.streams.iter().zip(self.differ);
        let mut before = before.take_while(|(_, differs)| !differs);
        before.all(|(stream, _)| stream.ended())
    }

    /// The first stream in which something differs.
    pub(super) fn first_that_differs(&self) -> Option<usize> {
        self.differ.iter().position(|&differs| differs)
    }

    /// Some clocks of all streams that have not ended. The results seen in them.
    ///
    /// # Errors
    /// A simulation that does not settle.
    pub(super) fn run(&mut self) -> Result<u64> {
        let mut points = 0;
        for (lane, stream) in (0..LANES).zip(&mut self.streams) {
            let before = stream.seen.points;
            for clock in &mut self.ahead {
                if self.differ[lane] || stream.ended() {
                    clock.compared[lane] = 0;
                    continue;
                }
                clock.compared[lane] = u64::MAX;
                stream.clock(self.binding);
                let was_idle = mem::replace(&mut clock.idle[lane], stream.is_idle());
                // Most of the time nothing is driven, and stands there already.
                if !(was_idle && clock.idle[lane]) {
                    for (input, &bits) in clock.inputs.iter_mut().zip(stream.inputs()) {
                        input[lane] = bits;
                    }
                }
                for (column, &bits) in clock.predicted.iter_mut().zip(stream.predicted()) {
                    column[lane] = bits;
                }
                stream.note(self.binding);
            }
            points += stream.seen.points - before;
        }
        for clock in &mut self.ahead {
            self.simulator.clock_with(&mut clock.inputs)?;
            let nets = &self.binding.compared;
            let differences = self.simulator.differences(nets, &clock.predicted, None);
            let lanes = differences.iter().zip(&clock.compared);
            for (differ, (differences, compared)) in self.differ.iter_mut().zip(lanes) {
                *differ |= differences & compared != 0;
            }
        }
        Ok(points)
    }

    /// Returns the record of each lane, up to the first that differs.
    ///
    /// # Errors
    /// A simulation that does not settle.
    pub(super) fn into_seen(self) -> Result<Vec<Seen>> {
        let mut all = Vec::new();
        for (stream, differs) in self.streams.into_iter().zip(self.differ) {
            if differs {
                let alone = Alone::new(self.binding, stream.course())?;
                all.push(alone.run(&|_| ())?);
                break;
            }
            all.push(stream.seen);
        }
        Ok(all)
    }
}

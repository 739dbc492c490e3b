//! Runs several streams in the lanes of one simulator, and compares every signal that the golden model predicts with the
//! simulated signal at every clock. A stream is a sequence of inputs from power-up on.

use std::io::Write;
use std::mem;

use anyhow::Result;

use super::binding::Binding;
use super::outcome::{Course, StreamRecord};
use super::stream::Stream;
use glint_rtl::sim::Simulator;

/// The number of clocks that are computed for each stream of a core before the simulator runs them. The model and the random
/// inputs of one stream then stay in the processor's cache, together with the inputs and predictions of these clocks.
const AHEAD: usize = 4;

/// Runs at most `LANES` streams.
///
/// The random inputs of a stream react to the `busy` that its model predicts. The simulated `busy` is the same, unless model
/// and hardware differ. If a stream whose clocks were computed ahead differs, it runs once more, alone, to find the first
/// difference.
pub(super) struct Runner<'a, const LANES: usize> {
    binding: &'a Binding<'a>,
    pub(super) simulator: Simulator<LANES>,
    streams: Vec<Stream>,
    /// For each lane, whether something differed in a stream whose clocks were computed ahead.
    differ: [bool; LANES],
    /// The clocks that are computed together: one or [`AHEAD`].
    ahead: Vec<PredictedClock<LANES>>,
}

/// The inputs of a clock and the values predicted after it, for each signal and lane.
#[derive(Clone)]
struct PredictedClock<const LANES: usize> {
    /// Empty if only a single clock is prepared, because its inputs are written to the simulator directly.
    inputs: Vec<[u64; LANES]>,
    /// The lanes whose inputs are all 0 in this clock, except for `rst_n`.
    idle: [bool; LANES],
    predicted: Vec<[u64; LANES]>,
    /// A mask for each signal and lane: all ones if the value is predicted. Empty for a core, where every value is predicted.
    known: Vec<[u64; LANES]>,
    /// A mask for each lane: all ones if its stream is compared in this clock, 0 if it has ended.
    compared: [u64; LANES],
}

impl<'a, const LANES: usize> Runner<'a, LANES> {
    /// Makes a stream for each course, beginning at power-up. Courses after the first `LANES` are ignored.
    pub(super) fn new(
        binding: &'a Binding<'a>,
        courses: impl IntoIterator<Item = Course>,
    ) -> Result<Self> {
        let simulator = Simulator::new(binding.design)?;
        let busy = binding.ports.busy.is_some_and(|busy| simulator.lane(busy, 0) == 1);
        let streams =
            courses.into_iter().take(LANES).map(|course| Stream::new(binding, course, busy));
        let pipeline = binding.is_pipeline();
        let ahead = if pipeline || LANES == 1 { 1 } else { AHEAD };
        let compared = binding.compared.len();
        let clock = PredictedClock {
            inputs: vec![[0; LANES]; if ahead == 1 { 0 } else { binding.ports.inputs }],
            idle: [false; LANES],
            predicted: vec![[0; LANES]; compared],
            known: vec![[0; LANES]; if pipeline { compared } else { 0 }],
            compared: [0; LANES],
        };
        Ok(Self {
            binding,
            streams: streams.collect(),
            differ: [false; LANES],
            ahead: vec![clock; ahead],
            simulator,
        })
    }

    /// Returns whether all streams have ended, or all streams up to the first stream that differs.
    pub(super) fn ended(&self) -> bool {
        for (stream, differs) in self.streams.iter().zip(self.differ) {
            if differs || !stream.ended() || stream.seen.mismatch.is_some() {
                return differs || stream.ended();
            }
        }
        true
    }

    pub(super) fn first_that_differs(&self) -> Option<usize> {
        let mut streams = self.streams.iter().zip(self.differ);
        streams.position(|(stream, differs)| differs || stream.seen.mismatch.is_some())
    }

    pub(super) fn first(&mut self) -> &mut Stream {
        &mut self.streams[0]
    }

    /// Runs the next one or [`AHEAD`] clocks of all streams that have not ended. Returns the number of results in these clocks.
    pub(super) fn run(&mut self) -> Result<u64> {
        let before = self.points();
        self.prepare()?;
        self.simulate()?;
        Ok(self.points() - before)
    }

    fn points(&self) -> u64 {
        self.streams.iter().map(|stream| stream.seen.points).sum()
    }

    pub(super) fn prepare(&mut self) -> Result<()> {
        let single = self.ahead.len() == 1;
        for (lane, stream) in (0..LANES).zip(&mut self.streams) {
            for clock in &mut self.ahead {
                if self.differ[lane] || stream.ended() {
                    clock.compared[lane] = 0;
                    continue;
                }
                clock.compared[lane] = u64::MAX;
                stream.clock(self.binding)?;
                let was_idle = mem::replace(&mut clock.idle[lane], stream.is_idle());
                // Most of the time the inputs are all 0 except for `rst_n`, and are already in place.
                if !(was_idle && clock.idle[lane]) {
                    let inputs =
                        if single { self.simulator.inputs_mut() } else { &mut clock.inputs[..] };
                    for (input, &bits) in inputs.iter_mut().zip(stream.inputs()) {
                        input[lane] = bits;
                    }
                }
                stream.predict(&mut clock.predicted, &mut clock.known, lane);
                if !single {
                    stream.note(self.binding);
                }
            }
        }
        Ok(())
    }

    pub(super) fn simulate(&mut self) -> Result<()> {
        let single = self.ahead.len() == 1;
        let address = match self.binding.address {
            Some(net) if single => self.simulator.lanes(net),
            _ => [0; LANES],
        };
        for clock in &mut self.ahead {
            if single {
                self.simulator.clock()?;
            } else {
                self.simulator.clock_with(&mut clock.inputs)?;
            }
            let (nets, known) = (&self.binding.compared, &clock.known);
            let known = (!known.is_empty()).then_some(known.as_slice());
            let differences = self.simulator.differences(nets, &clock.predicted, known);
            for (lane, stream) in self.streams.iter_mut().enumerate() {
                let differs = differences[lane] & clock.compared[lane] != 0;
                if !single {
                    self.differ[lane] |= differs;
                } else if differs {
                    let simulated = |net| self.simulator.lane(net, lane);
                    stream.compare(self.binding, address[lane], simulated);
                } else if clock.compared[lane] != 0 {
                    stream.note(self.binding);
                }
            }
        }
        Ok(())
    }

    /// Returns the records of the streams, up to and including the first stream that differs.
    pub(super) fn into_seen(self) -> Result<Vec<StreamRecord>> {
        let mut all = Vec::new();
        for (stream, differs) in self.streams.into_iter().zip(self.differ) {
            if differs {
                let mut alone = Runner::<1>::new(self.binding, [stream.course])?;
                alone.go_on(u64::MAX)?;
                all.extend(alone.into_seen()?);
                break;
            }
            all.push(stream.seen);
        }
        Ok(all)
    }
}

impl Runner<'_, 1> {
    /// Runs until the stream has ended, or until it has run `clocks` clocks since power-up.
    pub(super) fn go_on(&mut self, clocks: u64) -> Result<()> {
        while !self.ended() && self.first().seen.clocks < clocks {
            self.run()?;
        }
        Ok(())
    }

    /// Runs to the end, and writes the waveform from clock `from` on into `file`, in the VCD format.
    pub(super) fn trace(&mut self, from: u64, file: impl Write + Send + 'static) -> Result<()> {
        self.go_on(from)?;
        self.simulator.trace(file)?;
        self.go_on(u64::MAX)?;
        self.simulator.end_trace()
    }
}

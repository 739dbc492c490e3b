//! One stream, clock by clock: what can be recorded, traced, and told the first difference of.

use anyhow::Result;

use super::binding::Binding;
use super::combinations::Combinations;
use super::outcome::{Course, Seen};
use super::stream::Stream;
use crate::hdl::sim::Simulator;

/// One stream in a simulator of its own.
pub(super) struct Alone<'a> {
    binding: &'a Binding<'a>,
    pub(super) simulator: Simulator,
    stream: Stream,
}

impl<'a> Alone<'a> {
    /// At power-up.
    ///
    /// # Errors
    /// A design that cannot be simulated.
    pub(super) fn new(binding: &'a Binding<'a>, course: Course) -> Result<Self> {
        let simulator: Simulator = Simulator::new(binding.design)?;
        let busy = simulator.value(binding.compared[binding.busy]) == 1;
        Ok(Self { stream: Stream::new(binding, course, busy), simulator, binding })
    }

    /// Whether it has all its points, or something differs.
    pub(super) fn ended(&self) -> bool {
        self.stream.ended()
    }

    /// Goes on with combinations, as the device stands.
    pub(super) fn follow(&mut self, combinations: Combinations) {
        self.stream.follow(combinations);
    }

    /// Returns the record of the stream so far.
    pub(super) fn seen(&self) -> &Seen {
        &self.stream.seen
    }

    /// Clocks since the latest start, where combinations are gone through.
    pub(super) fn since_start(&self) -> u64 {
        self.stream.since_start()
    }

    /// One clock. Its inputs.
    ///
    /// # Errors
    /// A simulation that does not settle, or a VCD that cannot be written.
    pub(super) fn clock(&mut self) -> Result<Vec<u64>> {
        let address = self.simulator.value(self.binding.address);
        self.stream.clock(self.binding);
        let inputs = self.stream.inputs().to_vec();
        for (at, &bits) in inputs.iter().enumerate() {
            self.simulator.set(at, bits);
        }
        self.simulator.clock()?;
        let simulated = |net| self.simulator.value(net);
        let mismatch = self.stream.mismatch(self.binding, address, simulated);
        if mismatch.is_some() {
            self.stream.seen.mismatch = mismatch;
        } else {
            self.stream.note(self.binding);
        }
        Ok(inputs)
    }

    /// All of it; `progress` is called now and then with the number of points since its last call.
    ///
    /// # Errors
    /// As of [`Alone::clock`].
    pub(super) fn run(mut self, progress: &dyn Fn(u64)) -> Result<Seen> {
        let mut told = 0;
        while !self.ended() {
            self.clock()?;
            let points = self.seen().points;
            if points - told >= 1024 {
                progress(points - told);
                told = points;
            }
        }
        progress(self.seen().points - told);
        Ok(self.stream.seen)
    }
}

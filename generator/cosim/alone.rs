//! One stream, clock by clock: what can be recorded, traced, and told the first difference of.

use anyhow::Result;

use super::combinations::Combinations;
use super::outcome::{Course, Seen};
use super::pairing::Pairing;
use super::stream::Stream;
use crate::hdl::sim::Simulator;

/// One stream in a simulator of its own.
pub(super) struct Alone<'a> {
    pairing: &'a Pairing<'a>,
    pub(super) simulator: Simulator,
    stream: Stream,
}

impl<'a> Alone<'a> {
    /// At power-up.
    ///
    /// # Errors
    /// A design that cannot be simulated.
    pub(super) fn new(pairing: &'a Pairing<'a>, course: Course) -> Result<Self> {
        let simulator: Simulator = Simulator::new(pairing.design)?;
        let busy = simulator.value(pairing.compared[pairing.busy]) == 1;
        Ok(Self { stream: Stream::new(pairing, course, busy), simulator, pairing })
    }

    /// Whether it has all its points, or something differs.
    pub(super) fn ended(&self) -> bool {
        self.stream.ended()
    }

    /// Goes on with combinations, as the device stands.
    pub(super) fn follow(&mut self, combinations: Combinations) {
        self.stream.follow(combinations);
    }

    /// What it has shown so far.
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
        let address = self.simulator.value(self.pairing.address);
        let inputs = self.stream.clock(self.pairing).to_vec();
        for (at, &bits) in inputs.iter().enumerate() {
            self.simulator.set(at, bits);
        }
        self.simulator.clock()?;
        let simulated = |net| self.simulator.value(net);
        let mismatch = self.stream.mismatch(self.pairing, address, simulated);
        if mismatch.is_some() {
            self.stream.seen.mismatch = mismatch;
        } else {
            self.stream.note(self.pairing);
        }
        Ok(inputs)
    }

    /// All of it; `progress` is told now and then how many points there are more.
    ///
    /// # Errors
    /// Those of [`Alone::clock`].
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

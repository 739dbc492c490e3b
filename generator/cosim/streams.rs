//! Streams side by side: each has its stimulus and its golden model, and a lane of one simulator.

use std::mem;

use anyhow::Result;

use super::lockstep::{Mismatch, Worst};
use super::pairing::Pairing;
use super::stimulus::Stimulus;
use crate::golden::Model;
use crate::sim::Simulator;

/// What a stream showed.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    pub(super) points: u64,
    pub(super) clocks: u64,
    pub(super) worst: Option<Worst>,
    pub(super) mismatch: Option<Mismatch>,
}

/// A stimulus from power-up on, with the golden model.
struct Stream {
    seed: u64,
    /// It ends after so many points.
    points: u64,
    stimulus: Stimulus,
    model: Box<dyn Model>,
    busy: bool,
    /// Results since the latest start.
    index: u64,
    /// The word that is executed at the coming edge.
    word: u64,
    seen: Seen,
}

impl Stream {
    fn ended(&self) -> bool {
        self.seen.mismatch.is_some() || self.seen.points >= self.points
    }
}

/// As many streams as there are lanes, or fewer.
pub(super) struct Streams<'a, const LANES: usize> {
    pairing: &'a Pairing<'a>,
    pub(super) simulator: Simulator<LANES>,
    /// The first are in the first lanes.
    streams: Vec<Stream>,
    /// What the golden models say of each compared signal.
    golden: Vec<[u64; LANES]>,
    /// Those of a model, where it has an order of its own; reused.
    inputs: Vec<u64>,
}

impl<'a, const LANES: usize> Streams<'a, LANES> {
    /// Streams at power-up, each given by its seed and its number of points.
    ///
    /// # Errors
    /// A design that cannot be simulated.
    pub(super) fn new(
        pairing: &'a Pairing<'a>,
        streams: impl IntoIterator<Item = (u64, u64)>,
    ) -> Result<Self> {
        let simulator = Simulator::new(pairing.design)?;
        let busy = simulator.lane(pairing.busy, 0) == 1;
        let word = simulator.lane(pairing.address, 0);
        let stream = |(seed, points)| Stream {
            seed,
            points,
            stimulus: pairing.stimulus(seed),
            model: pairing.model.boxed_clone(),
            busy,
            index: 0,
            word,
            seen: Seen::default(),
        };
        Ok(Self {
            pairing,
            simulator,
            streams: streams.into_iter().take(LANES).map(stream).collect(),
            golden: vec![[0; LANES]; pairing.compared.len()],
            inputs: vec![0; pairing.model.inputs().len()],
        })
    }

    /// Whether every stream has ended that comes before the first mismatch.
    pub(super) fn ended(&self) -> bool {
        for stream in &self.streams {
            if !stream.ended() {
                return false;
            }
            if stream.seen.mismatch.is_some() {
                break;
            }
        }
        true
    }

    /// What each showed.
    pub(super) fn into_seen(self) -> Vec<Seen> {
        self.streams.into_iter().map(|stream| stream.seen).collect()
    }

    /// What a stream has shown so far.
    ///
    /// # Panics
    /// When there is none in this lane.
    pub(super) fn seen(&self, lane: usize) -> &Seen {
        &self.streams[lane].seen
    }

    /// One clock of all streams that have not ended. The results seen in it.
    ///
    /// # Errors
    /// A simulation that does not settle, or a VCD that cannot be written.
    pub(super) fn clock(&mut self) -> Result<u64> {
        self.drive();
        self.simulator.clock()?;
        let differences = self
            .simulator
            .differences(&self.pairing.compared, &self.golden);
        let simulator = &self.simulator;
        let busy = simulator.lanes(self.pairing.busy);
        let valid = simulator.lanes(self.pairing.valid);
        let word = simulator.lanes(self.pairing.address);
        let mut points = 0;
        for (lane, stream) in self.streams.iter_mut().enumerate() {
            if stream.ended() {
                continue;
            }
            let value = |net| simulator.lane(net, lane);
            stream.seen.clocks += 1;
            if differences[lane] != 0 {
                let (clock, golden) = (stream.seen.clocks, stream.model.values());
                let mismatch = self.pairing.mismatch(clock, stream.word, value, golden);
                stream.seen.mismatch = mismatch.map(|mismatch| Mismatch {
                    seed: stream.seed,
                    ..mismatch
                });
                continue;
            }
            stream.word = word[lane];
            let was_busy = mem::replace(&mut stream.busy, busy[lane] == 1);
            if stream.busy && !was_busy {
                stream.index = 0;
            }
            if valid[lane] == 1 {
                stream.seen.points += 1;
                points += 1;
                let worst = &mut stream.seen.worst;
                let units = worst.as_ref().map_or(-1.0, |worst| worst.units);
                let stimulus = &stream.stimulus;
                if let Some(worse) = self.pairing.worse(units, stream.index, stimulus, value) {
                    *worst = Some(worse);
                }
                stream.index += 1;
            }
        }
        Ok(points)
    }

    /// The next inputs, to the simulator and to the models, which then stand behind the coming edge.
    fn drive(&mut self) {
        let lanes = self.simulator.inputs_mut();
        for (lane, stream) in self.streams.iter_mut().enumerate() {
            if stream.ended() {
                continue;
            }
            let inputs = stream.stimulus.next(stream.busy);
            for (input, &bits) in lanes.iter_mut().zip(inputs) {
                input[lane] = bits;
            }
            match &self.pairing.order {
                None => stream.model.clock(inputs),
                Some(order) => {
                    for (to, &from) in self.inputs.iter_mut().zip(order) {
                        *to = inputs[from];
                    }
                    stream.model.clock(&self.inputs);
                }
            }
            for (column, &bits) in self.golden.iter_mut().zip(stream.model.values()) {
                column[lane] = bits;
            }
        }
    }
}

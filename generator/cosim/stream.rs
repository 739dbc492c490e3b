//! A stream: a stimulus from power-up on, and the golden model under it.

use std::mem;

use super::lockstep::{Mismatch, Worst};
use super::pairing::Pairing;
use super::stimulus::Stimulus;
use crate::golden::Model;

/// What a stream showed.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    pub(super) points: u64,
    pub(super) clocks: u64,
    pub(super) worst: Option<Worst>,
    pub(super) mismatch: Option<Mismatch>,
}

/// A stream. What the simulated hardware makes of it is for others to say.
pub(super) struct Stream {
    pub(super) seed: u64,
    /// It ends after so many points.
    pub(super) points: u64,
    pub(super) seen: Seen,
    stimulus: Stimulus,
    model: Box<dyn Model>,
    busy: bool,
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
    pub(super) fn new(pairing: &Pairing, seed: u64, points: u64, busy: bool) -> Self {
        Self {
            seed,
            points,
            seen: Seen::default(),
            stimulus: pairing.stimulus(seed),
            model: pairing.model.boxed_clone(),
            busy,
            index: 0,
            reordered: Vec::new(),
            operands: Vec::new(),
            inside: false,
        }
    }

    pub(super) fn ended(&self) -> bool {
        self.seen.mismatch.is_some() || self.seen.points >= self.points
    }

    /// Clocks the model, and returns the inputs with which that was done.
    #[inline]
    pub(super) fn clock(&mut self, pairing: &Pairing) -> &[u64] {
        let inputs = self.stimulus.next(self.busy);
        match &pairing.order {
            None => self.model.clock(inputs),
            Some(order) => {
                self.reordered.clear();
                self.reordered.extend(order.iter().map(|&at| inputs[at]));
                self.model.clock(&self.reordered);
            }
        }
        self.seen.clocks += 1;
        self.stimulus.inputs()
    }

    /// What the model predicts after the latest clock.
    #[inline]
    pub(super) fn predicted(&self) -> &[u64] {
        self.model.values()
    }

    /// Takes note of a result, if there is one, as predicted.
    #[inline]
    pub(super) fn note(&mut self, pairing: &Pairing) {
        let values = self.model.values();
        let was_busy = mem::replace(&mut self.busy, values[pairing.busy] == 1);
        if self.busy && !was_busy {
            self.index = 0;
        }
        if values[pairing.valid] != 1 {
            return;
        }
        self.seen.points += 1;
        if self.index == 0 {
            self.inside = pairing.operands(&self.stimulus, &mut self.operands);
        }
        if self.inside {
            let worst = &mut self.seen.worst;
            let units = worst.as_ref().map_or(-1.0, |worst| worst.units);
            let worse = pairing.worse(units, &self.operands, self.index, values);
            if worse.is_some() {
                *worst = worse;
            }
        }
        self.index += 1;
    }
}

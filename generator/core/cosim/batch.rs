//! Computes many points at once, with the golden model, the built-in simulator or the emitted Verilog.
//!
//! The three engines take the same [`Points`] and give the same results. The rest of Glint proves that they do, so any of
//! them may compute a picture.

mod lanes;

use anyhow::{Result, ensure};
use rayon::prelude::*;

pub use lanes::RustHdl;

use glint_golden::Contract;

/// Instances that one thread clocks together.
const LANES: usize = 32;

/// Points that are computed as one piece of work.
const PIECE: usize = 4096;

/// The operands of many computations.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Points {
    operands: usize,
    values: Vec<i64>,
    /// For each computation the number of results before it; one entry more than there are computations.
    results: Vec<usize>,
}

impl Points {
    /// Makes an empty list of points. Each point must have `operands` operands, in the order of the [`Contract`].
    pub fn new(operands: usize) -> Self {
        Self { operands, values: Vec::new(), results: vec![0] }
    }

    /// Adds a computation with its raw operands and the number of its results.
    ///
    /// # Panics
    /// Panics unless there are as many operands as [`Points::new`] said.
    pub fn push(&mut self, operands: impl IntoIterator<Item = i64>, results: usize) {
        self.values.extend(operands);
        self.results.push(self.result_count() + results);
        assert_eq!(self.values.len(), self.operands * self.len(), "operands");
    }

    /// Adds the computations of another list, which must have as many operands.
    pub fn append(&mut self, other: &Self) {
        let before = self.result_count();
        self.values.extend(&other.values);
        self.results.extend(other.results[1..].iter().map(|count| before + count));
    }

    /// Returns the number of computations.
    pub fn len(&self) -> usize {
        self.results.len() - 1
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number of results of all computations.
    pub fn result_count(&self) -> usize {
        self.results.last().copied().unwrap_or(0)
    }

    /// Returns the raw operands of computation number `at`.
    pub fn operands(&self, at: usize) -> &[i64] {
        &self.values[at * self.operands..(at + 1) * self.operands]
    }

    /// Returns the number of results of all computations before computation number `at`.
    pub fn results_before(&self, at: usize) -> usize {
        self.results[at]
    }

    /// Returns the number of results of computation number `at`.
    pub fn results(&self, at: usize) -> usize {
        self.results[at + 1] - self.results[at]
    }
}

/// An engine that computes points.
pub trait Engine {
    /// Returns the raw outputs, in the order of the [`Contract`], result after result.
    ///
    /// # Errors
    /// Fails if the device does not end, if it shows more or fewer results than expected, or if an outside tool fails.
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>>;
}

/// The golden model's arithmetic, as the contract states it.
pub struct Golden<'a>(pub &'a dyn Contract);

impl Engine for Golden<'_> {
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>> {
        let contract = self.0;
        let operands = contract.operands();
        ensure!(operands.len() == points.operands, "operands of another device");
        let pieces: Vec<Vec<i64>> = (0..points.len().div_ceil(PIECE))
            .into_par_iter()
            .map(|piece| {
                let mut out = Vec::with_capacity(PIECE * contract.outputs().len());
                for at in piece * PIECE..points.len().min((piece + 1) * PIECE) {
                    for index in 0..points.results(at) {
                        contract.results(points.operands(at), index as u64, &mut out);
                    }
                }
                out
            })
            .collect();
        Ok(pieces.concat())
    }
}

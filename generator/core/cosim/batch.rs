//! Defines the interface of the engines that compute many points (sets of operands) at once.
//!
//! An [`Engine`] takes the operands of many computations as [`Points`], and returns their results. There are three engines: the
//! golden model ([`Golden`]), the built-in simulator (`RustHdl`) and the emitted Verilog under an outside simulator. All three
//! return the same results, so a caller such as `glint render` may take any of them.

mod lanes;

use anyhow::{Result, ensure};
use rayon::prelude::*;

pub use lanes::RustHdl;

use glint_golden::Contract;

/// Instances that one thread clocks together.
const LANES: usize = 32;

/// Points that are computed as one piece of work.
const PIECE: usize = 4096;

/// The operands of many computations, and the number of results of each.
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

    /// Adds a computation: its raw operands, and the number of results that it gives.
    ///
    /// # Panics
    /// Panics unless there are as many operands as [`Points::new`] said.
    pub fn push(&mut self, operands: impl IntoIterator<Item = i64>, results: usize) {
        self.values.extend(operands);
        self.results.push(self.result_count() + results);
        assert_eq!(self.values.len(), self.operands * self.len(), "operands");
    }

    /// Adds the computations of another list, which must have the same number of operands per computation.
    pub fn append(&mut self, other: &Self) {
        let before = self.result_count();
        self.values.extend(&other.values);
        self.results.extend(other.results[1..].iter().map(|count| before + count));
    }

    /// Returns the number of computations in the list.
    pub fn len(&self) -> usize {
        self.results.len() - 1
    }

    /// Returns whether the list has no computations.
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

    /// Returns the index of the first result of computation number `at`, in a list of the results of all computations.
    pub fn results_before(&self, at: usize) -> usize {
        self.results[at]
    }

    /// Returns the number of results of computation number `at`.
    pub fn results(&self, at: usize) -> usize {
        self.results[at + 1] - self.results[at]
    }
}

/// An engine that computes the results of many points (sets of operands). There are three: the golden model, the built-in simulator
/// and the emitted Verilog.
pub trait Engine {
    /// Returns the raw outputs, in the order of the [`Contract`], result after result.
    ///
    /// # Errors
    /// Fails if the device does not finish a computation, if it shows more or fewer results than expected, or if an outside tool
    /// fails.
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>>;
}

/// An [`Engine`] that evaluates the golden model's arithmetic through the contract, without clocks.
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

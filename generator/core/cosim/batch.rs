//! Defines the interface of the engines that compute many points at once.
//!
//! There are three engines: the golden model ([`Golden`]), the built-in simulator ([`RustHdl`]), and the emitted Verilog under
//! an outside simulator. For a core without mistakes all three return the same results, so a caller such as `glint render` may
//! take any of them.

mod lanes;

use anyhow::{Result, ensure};
use rayon::prelude::*;

pub use lanes::RustHdl;

use glint_golden::Contract;

/// The number of instances that one thread simulates together.
const LANES: usize = 32;

/// The number of points that a thread computes as one piece of work.
const PIECE: usize = 4096;

/// The raw operands of many computations, and the number of results of each. Only a device that computes lines gives several
/// results for one `start`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Points {
    operands: usize,
    values: Vec<i64>,
    /// Entry i is the number of results of all computations before computation i. The last entry is the number of all results.
    results: Vec<usize>,
}

impl Points {
    /// Makes an empty list. Each point that is added must have `operands` operands, in the order of the [`Contract`].
    pub fn new(operands: usize) -> Self {
        Self { operands, values: Vec::new(), results: vec![0] }
    }

    /// Adds a computation: its raw operands, in the order of the [`Contract`], and the number of results that it gives.
    ///
    /// # Panics
    /// Panics if the number of operands is not the number that was given to [`Points::new`].
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

    pub fn len(&self) -> usize {
        self.results.len() - 1
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn result_count(&self) -> usize {
        self.results.last().copied().unwrap_or(0)
    }

    /// Returns the raw operands of computation `at`, in the order of the [`Contract`].
    pub fn operands(&self, at: usize) -> &[i64] {
        &self.values[at * self.operands..(at + 1) * self.operands]
    }

    /// Returns the index of the first result of computation `at` in a list of the results of all computations.
    pub fn results_before(&self, at: usize) -> usize {
        self.results[at]
    }

    pub fn results(&self, at: usize) -> usize {
        self.results[at + 1] - self.results[at]
    }
}

/// Computes the results of many points.
pub trait Engine {
    /// Returns the raw outputs of all computations, one after another. Each result has one value for each output, in the order
    /// of the [`Contract`]. A computation with several results has them in the order of their index.
    ///
    /// # Errors
    /// Fails if a device does not finish a computation, if it gives more or fewer results than `points` expects, if a pipeline
    /// shows results in another clock than its latency states, or if a simulator or an outside tool fails. [`Golden`] also
    /// fails if a computation has more or fewer operands than the contract.
    ///
    /// # Panics
    /// Engines other than [`Golden`] panic if a computation lacks an operand of the design.
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>>;
}

/// An [`Engine`] that computes the results with the arithmetic of the golden model, through its contract. This engine simulates
/// no clocks.
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

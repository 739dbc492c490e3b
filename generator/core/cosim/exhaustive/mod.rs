//! Checks the error bound of a contract for all operands, instead of a random sample.
//!
//! A highlight device multiplies each colour by a reflectance `f`, so the check has two parts. The first measures the error of
//! `f` for every operand combination in the contract's sweep. The second measures the rounding of every possible word `f` times
//! every colour. The sum of both largest errors bounds the error of an output, and is compared with the contract. For a device
//! with few operand bits, [`Clocks`] also compares model and hardware clock by clock.
//!
//! All combinations are numbered and cut into blocks. Any machine may check any blocks in any order; the joined result is the
//! same.

pub mod axis;
mod backing;
mod clocks;
mod job;
pub mod kept;
mod places;
mod record;

#[cfg(test)]
mod tests;

pub use axis::AxisValues;
pub use backing::{Backing, Certificate};
pub use clocks::{Clocks, Difference, MOST_BITS, Steps};
pub use job::{Job, MOST_SHARDS, Progress, Shard, ShardState};
pub use places::{Peak, Places};
pub use record::Record;

use super::outcome::ROUNDING_OF_F64;
use glint_golden::{Contract, Sweep};

/// The default directory of the records of exhaustive checks.
pub const PROOFS: &str = "records/proofs";

/// The result of an exhaustive check of the error bound.
#[derive(Clone, Debug)]
pub struct Proof {
    /// Whether the sweep measures the f of a highlight, and not the outputs themselves.
    of_f: bool,
    /// The largest error of `f`. For a device that is no highlight, the largest error of an output, in units.
    pub f: Peak,
    /// The error of f in output units, for the largest colour.
    pub f_units: f64,
    /// The largest rounding error of a product of `f` with a colour, in output units.
    pub colours: Peak,
    /// Sentences about the errors that exceed the contract's bound; empty if the bound holds.
    pub failures: Vec<String>,
}

impl Proof {
    /// Compares the largest error of `f` and the largest rounding error of the products with colours with the contract's bound.
    pub fn new(contract: &dyn Contract, f: Peak, colours: Peak) -> Self {
        let colour = contract.operands().iter().find(|operand| operand.colour);
        let largest = colour.map_or(1.0, |operand| operand.domain.1 as f64);
        let bound = contract.bound();
        let of_f = contract.highlight().is_some();
        let mut proof = Self { of_f, f, f_units: f.error * largest, colours, failures: Vec::new() };
        if f.error.is_infinite() {
            proof.failures.push(format!(
                "the formula has no finite value at {} (raw)",
                Places::of_f(contract).words(f.place)
            ));
            return proof;
        }
        if f.error > bound.f + ROUNDING_OF_F64 / largest {
            let what = if of_f { "f is" } else { "an output is, in units," };
            proof.failures.push(format!(
                "{what} off by {:e}, beyond the stated bound of {:e}",
                f.error, bound.f
            ));
        }
        if proof.together() > bound.units + ROUNDING_OF_F64 {
            proof.failures.push(format!(
                "an output may be off by {:.4} units, beyond the stated bound of {:.4}",
                proof.together(),
                bound.units
            ));
        }
        proof
    }

    /// Returns the verdict of the check in a word. It is "proved" only if the sweep left out no operand that determines `f`, and if
    /// the bound keeps the contract.
    pub fn verdict(&self, contract: &dyn Contract, sweep: &Sweep) -> &'static str {
        if !self.failures.is_empty() {
            "FAILS"
        } else if !contract.bound().is_stated() {
            "no bound is stated"
        } else if !contract.bound().keeps() {
            "within its bound, outside the contract"
        } else if sweep.omits.is_empty() {
            "proved"
        } else {
            "passed, not proved"
        }
    }

    /// Returns a phrase with the largest errors. The text `at`, such as the operands of the first error, is inserted after it.
    pub fn words(&self, at: &str) -> String {
        if !self.of_f {
            return format!("an output is off by {:.3} units at most{at}", self.together());
        }
        format!(
            "f is off by {:.3e} at most, {:.3} units{at}; a colour multiplier by {:.3}; together {:.3}",
            self.f.error,
            self.f_units,
            self.colours.error,
            self.together()
        )
    }

    /// Returns an upper bound of the error of an output in units: the largest error of `f`, plus the largest rounding error of a
    /// product with a colour.
    pub fn together(&self) -> f64 {
        self.f_units + self.colours.error
    }
}

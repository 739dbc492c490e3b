//! Checks the error bound of a contract for every operand combination that the contract lists for this check (its *sweep*).
//!
//! For a highlight, the check measures the error of the reflectance `f` for every combination of the sweep, and the rounding of
//! every possible word `f` times every colour. The sum of both largest errors bounds the error of an output, and is compared
//! with the contract. For any other device, the check measures the errors of the outputs themselves. [`Clocks`] also compares
//! model and hardware clock by clock, if the operands have at most 26 bits in all.

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

/// The default directory of the records, relative to the working directory.
pub const PROOFS: &str = "records/proofs";

#[derive(Clone, Debug)]
pub struct Proof {
    /// Whether the check measures the error of the reflectance `f`, not of the outputs themselves.
    of_f: bool,
    /// The largest error of `f` as an absolute number; otherwise of an output, in units of the output's last bit.
    pub f: Peak,
    /// The same error in output units: for `f`, the error times the largest colour operand.
    pub f_units: f64,
    /// The largest rounding error of a product of `f` with a colour, in output units; 0 for a device that is no highlight.
    pub colours: Peak,
    /// Sentences about the errors that exceed the contract's bound. Empty if the bound holds.
    pub failures: Vec<String>,
}

impl Proof {
    /// Compares two largest errors with the contract's bound: the error of `f`, and the rounding error of the products with
    /// colours, in output units.
    pub fn new(contract: &dyn Contract, f: Peak, colours: Peak) -> Self {
        let colour = contract.operands().iter().find(|operand| operand.colour);
        let largest = colour.map_or(1.0, |operand| operand.domain.1 as f64);
        let bounds = contract.bounds();
        let most = bounds.governing_units();
        let of_f = contract.highlight().is_some();
        let mut proof = Self { of_f, f, f_units: f.error * largest, colours, failures: Vec::new() };
        if f.error.is_infinite() {
            proof.failures.push(format!(
                "the formula has no finite value at the raw operands {}",
                Places::of_f(contract).words(f.place)
            ));
            return proof;
        }
        if f.error > bounds.f + ROUNDING_OF_F64 / largest {
            let what =
                if of_f { "the error of f is" } else { "the error of an output, in units, is" };
            proof
                .failures
                .push(format!("{what} {:e}, above the stated bound of {:e}", f.error, bounds.f));
        }
        if proof.together() > most + ROUNDING_OF_F64 {
            proof.failures.push(format!(
                "the error of an output can be {:.4} units, above the stated bound of {:.4}",
                proof.together(),
                most
            ));
        }
        proof
    }

    /// Returns the verdict of the check in words. "proved" means that the errors are within the bound, that the bound keeps
    /// the accuracy contract, and that `sweep` leaves out no operand that determines `f`, and none of its values.
    pub fn verdict(&self, contract: &dyn Contract, sweep: &Sweep) -> &'static str {
        if !self.failures.is_empty() {
            "FAILS"
        } else if !contract.bounds().are_stated() {
            "no bound is stated"
        } else if !contract.bounds().keep() {
            "within its bound, outside the contract"
        } else if sweep.omits.is_empty() {
            "proved"
        } else {
            "passed, not proved"
        }
    }

    /// States the largest errors. The text `at`, for example the operands of the largest error, follows this error.
    pub fn words(&self, at: &str) -> String {
        if !self.of_f {
            return format!("the error of an output is at most {:.3} units{at}", self.together());
        }
        format!(
            "the error of f is at most {:.3e}, {:.3} units{at}; the error of a colour multiplier {:.3}; \
             together {:.3}",
            self.f.error,
            self.f_units,
            self.colours.error,
            self.together()
        )
    }

    /// Returns an upper bound of the error of an output over the checked combinations, in units. For a highlight, it is the
    /// largest error of `f` times the largest colour, plus the largest rounding error of a product.
    pub fn together(&self) -> f64 {
        self.f_units + self.colours.error
    }
}

//! Reads the records of exhaustive checks, which `glint cosim --exhaustive --json` writes.
//!
//! The digest of the contract in a record tells to which configuration the record belongs. Glint does not simply trust a
//! record: [`Record::proves`] computes the recorded largest error again, at the recorded operands, and compares.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Deserialize;

use super::{Peak, Places, Proof};
use glint_base::input;
use glint_base::program::Program;
use glint_golden::{Axis, Contract, Sweep, Values};

/// The largest difference between a recorded figure and the same figure when Glint computes it again.
const SAME: f64 = 1e-9;

#[derive(Clone, Debug, Deserialize)]
pub struct Record {
    axes: Vec<RecordedAxis>,
    /// The number of combinations at which the check computed `f`, or the outputs of a device that is no highlight.
    pub evaluations: u64,
    /// The number of products of a word `f` with a colour that the check computed; 0 for a device that is no highlight.
    pub colour_products: u64,
    /// The largest error of `f`. For a device that is no highlight, the largest error of an output, in units.
    pub f: RecordedPeak,
    /// The largest error of a colour multiplier, in output units.
    colour_units: f64,
    /// The upper bound of the error of an output, in output units. The bound is the error of `f` for the largest colour plus
    /// the largest rounding error of a product with a colour.
    pub together: f64,
    /// Whether the errors at all recorded operands were within the contract's bound.
    pub holds: bool,
    #[serde(skip)]
    pub path: PathBuf,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub struct RecordedPeak {
    /// The absolute error of `f`. For a device that is no highlight, the error of an output in units.
    pub error: f64,
    /// The error of `f` in output units, for the largest colour.
    pub units: f64,
    place: u64,
}

#[derive(Clone, Debug, Deserialize)]
struct RecordedAxis {
    name: String,
    from: Option<i64>,
    to: Option<i64>,
    #[serde(default)]
    values: Vec<i64>,
}

impl RecordedAxis {
    /// Returns whether the recorded check visited every value of `axis`. A recorded list may have further values; a range must
    /// be the same.
    fn covers(&self, axis: &Axis) -> bool {
        self.name == axis.name
            && match &axis.values {
                Values::Range(low, high) => (self.from, self.to) == (Some(*low), Some(*high)),
                Values::List(values) => values.iter().all(|value| self.values.contains(value)),
            }
    }

    fn axis(&self) -> Axis {
        let values = match (self.from, self.to) {
            (Some(low), Some(high)) => Values::Range(low, high),
            _ => Values::List(self.values.clone()),
        };
        Axis { name: self.name.clone(), values }
    }
}

#[derive(Deserialize)]
struct Report {
    /// The results by configuration. The entry `configuration` of a result is a [`crate::core::Core::contract_digest`].
    configurations: Vec<serde_json::Value>,
}

impl Record {
    /// Returns the record for the contract with this digest, from the JSON files in `directory`. Files that are no records are
    /// ignored.
    ///
    /// # Errors
    /// Fails if the directory or a file in it cannot be read, if a record is damaged, or if the record leaves out a part of the
    /// contract's sweep.
    pub fn find(directory: &Path, digest: &str, contract: &dyn Contract) -> Result<Option<Self>> {
        for (path, report) in input::records::<Report>(directory)? {
            let found = report.configurations.into_iter().find(|it| it["configuration"] == digest);
            if let Some(found) = found {
                let found: Self =
                    serde_json::from_value(found).with_context(|| input::damaged(&path))?;
                let found = Self { path, ..found };
                found.is_of(contract)?;
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// Returns the operand values that the recorded check visited, at least the values of the contract's own sweep.
    pub fn sweep(&self, contract: &dyn Contract) -> Sweep {
        let axes = self.axes.iter().map(RecordedAxis::axis).collect();
        Sweep { axes, omits: contract.sweep().omits }
    }

    /// Fails if the record leaves out a part of the contract's sweep. The error names the file and the command that makes a
    /// new record. [`Record::proves`] compares the errors with the contract's present bound.
    fn is_of(&self, contract: &dyn Contract) -> Result<()> {
        let sweep = contract.sweep();
        let same_axes = self.axes.len() == sweep.axes.len()
            && self.axes.iter().zip(&sweep.axes).all(|(found, axis)| found.covers(axis));
        anyhow::ensure!(
            same_axes,
            "the record `{}` has another sweep, because another version of Glint wrote it; write a new \
             record with `{Program} cosim --exhaustive --json`",
            self.path.display()
        );
        Ok(())
    }

    /// Returns whether the record proves the contract's bound. The recorded check must have visited every combination of
    /// operands, and its errors must be within the bound that the contract states today. The largest error of `f`, computed
    /// again, must equal the recorded error up to 1e-9.
    pub fn proves(&self, contract: &dyn Contract) -> bool {
        let sweep = self.sweep(contract);
        let is_whole = sweep.omits.is_empty();
        let places = Places::of_sweep(contract, sweep);
        let place = self.f.place;
        let is_same = place < places.count() && (places.error(place) - self.f.error).abs() <= SAME;
        is_whole && is_same && self.holds && self.proof(contract).failures.is_empty()
    }

    fn proof(&self, contract: &dyn Contract) -> Proof {
        let f = Peak { error: self.f.error, place: self.f.place };
        Proof::new(contract, f, Peak { error: self.colour_units, place: 0 })
    }

    pub fn words(&self, contract: &dyn Contract) -> String {
        self.proof(contract).words("")
    }

    /// Returns the number of evaluations that [`Record::recheck`] reports for the same `places`, which must not be 0.
    pub fn steps(&self, contract: &dyn Contract, places: u64) -> u64 {
        let f = Places::of_sweep(contract, self.sweep(contract));
        let colours = Places::of_colours(contract);
        f.visits(part(&f, places).into_iter()) + colours.count()
    }

    /// Computes a part of the recorded check again. The part has about `places` (not 0) evenly spread operand combinations,
    /// the combination with the largest error, and all products with colours. Returns the number of combinations at which the
    /// function computed `f`. The second result has a sentence for each difference from the record, and for each error above
    /// the contract's bound. Calls `progress` with the number of evaluations in each finished block.
    pub fn recheck(
        &self,
        contract: &dyn Contract,
        places: u64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> (u64, Vec<String>) {
        let f = Places::of_sweep(contract, self.sweep(contract));
        let colours = Places::of_colours(contract);
        let mut failures = Vec::new();
        let path = self.path.display();
        let mut differs = |what: &str, found: f64, recorded: f64| {
            failures.push(format!("{what} is {found:e}, but {recorded:e} in the record `{path}`"));
        };
        let at_peak = if self.f.place < f.count() { f.error(self.f.place) } else { 0.0 };
        if (at_peak - self.f.error).abs() > SAME {
            differs("the error of f at its recorded place", at_peak, self.f.error);
        }
        let blocks = part(&f, places);
        let visits = f.visits(blocks.iter().copied());
        let again = f.check(blocks, progress);
        if again.error > self.f.error + SAME {
            differs("the error of f at a place that was checked again", again.error, self.f.error);
        }
        let colour = colours.check(0..colours.blocks(), progress);
        if (colour.error - self.colour_units).abs() > SAME {
            differs("the error of a colour multiplier", colour.error, self.colour_units);
        }
        let peak = Peak { error: self.f.error, place: self.f.place };
        failures.extend(Proof::new(contract, peak, colour).failures);
        if !self.holds {
            failures.push(format!("the record `{path}` says that the bound does not hold"));
        }
        (visits + 1, failures)
    }
}

/// Returns the numbers of evenly spread blocks that together have about `count` places, at least one block.
fn part(places: &Places<'_>, count: u64) -> Vec<u64> {
    let stride = (places.count() / count).max(1);
    (0..places.blocks()).step_by(stride as usize).collect()
}

//! Numbers the combinations of operands that an exhaustive check visits, and finds the largest error among them, block by block.
//!
//! The number of a combination is its *place*; the last operand changes fastest. For example, with operands of 2 and of 3 values,
//! place 4 has the second value of each.

use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize};

use glint_golden::{Axis, Contract, Sweep, Values};

/// The number of operand combinations in a block. A block takes some milliseconds.
pub const BLOCK: u64 = 1 << 17;

/// The number of places that are timed, and the smallest number of places of [`Places::glimpse`], unless there are fewer.
const SAMPLE: u64 = 4096;

/// The largest error among some operand combinations, and the first combination with this error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// The absolute error; infinite if the formula has no value for the operands.
    #[serde(deserialize_with = "or_infinite")]
    pub error: f64,
    pub place: u64,
}

/// Reads `null` as infinity, because JSON has no infinite number.
fn or_infinite<'de, D: Deserializer<'de>>(number: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(number)?.unwrap_or(f64::INFINITY))
}

impl Peak {
    /// The start of a search, before any combination was visited. [`Peak::join`] with any visited combination replaces it.
    pub const NONE: Self = Self { error: 0.0, place: u64::MAX };

    /// Returns the larger of two peaks; if their errors are equal, the peak with the smaller place.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let later = self.place > other.place;
        if other.error > self.error || (other.error == self.error && later) { other } else { self }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PlaceMeasure {
    /// The error that [`Contract::sweep_error`] returns: for a highlight, the error of `f`.
    F,
    /// The error that a colour multiplier adds, in output units.
    Colour,
}

/// The operand combinations that a check of the error bound visits; see the head of this module.
pub struct Places<'a> {
    contract: &'a dyn Contract,
    measure: PlaceMeasure,
    sweep: Sweep,
}

impl<'a> Places<'a> {
    /// Numbers the operand combinations of the contract's own sweep, at which the error of `f` is measured.
    pub fn of_f(contract: &'a dyn Contract) -> Self {
        Self::of_sweep(contract, contract.sweep())
    }

    pub fn of_sweep(contract: &'a dyn Contract, sweep: Sweep) -> Self {
        Self { contract, measure: PlaceMeasure::F, sweep }
    }

    /// Numbers the combinations of every word `f` with every value of a colour operand. One colour operand represents all,
    /// because they are alike. A device without colours has no combinations.
    pub fn of_colours(contract: &'a dyn Contract) -> Self {
        let colour = contract.operands().iter().find(|operand| operand.colour);
        let values = match contract.highlight().zip(colour) {
            Some((highlight, colour)) => {
                let f = highlight.f_format();
                vec![
                    ("f", Values::Range(f.min_raw() as i64, f.max_raw() as i64)),
                    ("colour", Values::Range(colour.domain.0, colour.domain.1)),
                ]
            }
            // Without colours there is no product, and no place.
            None => vec![("f", Values::List(Vec::new()))],
        };
        let mut axes = Vec::new();
        for (name, values) in values {
            axes.push(Axis { name: name.to_owned(), values });
        }
        Self {
            contract,
            measure: PlaceMeasure::Colour,
            sweep: Sweep { axes, omits: String::new() },
        }
    }

    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// Returns the number of operand combinations, or the largest number of 64 bits if there are more. For example, four
    /// operands of 16 bits have 2^64 combinations; a count that wraps to 0 would prove a bound without a single evaluation.
    pub fn count(&self) -> u64 {
        self.sweep.axes.iter().map(|axis| axis.values.count()).fold(1, u64::saturating_mul)
    }

    pub fn blocks(&self) -> u64 {
        self.count().div_ceil(BLOCK)
    }

    /// Returns the raw operand values of combination `number`.
    pub fn place(&self, mut number: u64) -> Vec<i64> {
        let mut values: Vec<i64> = self
            .sweep
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let count = axis.values.count();
                let value = axis.values.value(number % count);
                number /= count;
                value
            })
            .collect();
        values.reverse();
        values
    }

    /// Returns the operands of combination `number` as text: `cos_gamma = 1044480, exponent = 20`.
    pub fn words(&self, number: u64) -> String {
        let pairs = self.sweep.axes.iter().zip(self.place(number));
        let words: Vec<String> =
            pairs.map(|(axis, raw)| format!("{} = {raw}", axis.name)).collect();
        words.join(", ")
    }

    /// Returns the error for combination `number`: the absolute error of `f`, the error of an output in units, or the rounding
    /// error of a product. The error is infinite if the formula has no value for the operands.
    pub fn error(&self, number: u64) -> f64 {
        self.error_at(&self.place(number))
    }

    /// Returns the errors for 4096 to 8191 evenly spread combinations, or for all if there are fewer. Callers use these errors
    /// as a fingerprint of the golden model.
    pub fn glimpse(&self) -> Vec<f64> {
        let step = (self.count() / SAMPLE).max(1);
        (0..self.count()).step_by(step as usize).map(|place| self.error(place)).collect()
    }

    #[inline]
    fn error_at(&self, place: &[i64]) -> f64 {
        let error = match self.measure {
            PlaceMeasure::F => self.contract.sweep_error(place),
            PlaceMeasure::Colour => self.contract.highlight().map_or(0.0, |highlight| {
                let exact = (place[0] * place[1]) as f64 * highlight.f_format().to_f64(1);
                (highlight.colour(place[0], place[1]) as f64 - exact).abs()
            }),
        };
        if error.is_nan() { f64::INFINITY } else { error }
    }

    pub(super) fn block_of(place: u64) -> u64 {
        place / BLOCK
    }

    fn of_block(&self, block: u64) -> Range<u64> {
        block * BLOCK..((block + 1) * BLOCK).min(self.count())
    }

    pub(super) fn visits(&self, blocks: impl Iterator<Item = u64>) -> u64 {
        blocks.map(|block| self.of_block(block)).map(|places| places.end - places.start).sum()
    }

    pub(super) fn pace(&self) -> Duration {
        let count = self.count().min(SAMPLE);
        let first = (self.count() - count) / 2;
        let begin = Instant::now();
        self.peak(first..first + count);
        begin.elapsed() / count.max(1) as u32
    }

    /// Returns the first place with the largest error.
    fn peak(&self, places: Range<u64>) -> Peak {
        let mut peak = Peak::NONE;
        let Some(inner) = self.sweep.axes.last() else {
            return peak;
        };
        let count = inner.values.count();
        let mut number = places.start;
        while number < places.end {
            // Consecutive places differ only in the value of the last axis, until that axis begins again.
            let mut place = self.place(number);
            let last = place.len() - 1;
            let at = number % count;
            let steps = (count - at).min(places.end - number);
            for step in 0..steps {
                place[last] = inner.values.value(at + step);
                let error = self.error_at(&place);
                if error > peak.error || peak == Peak::NONE {
                    peak = Peak { error, place: number + step };
                }
            }
            number += steps;
        }
        peak
    }

    /// Returns the largest error in the given blocks, or [`Peak::NONE`] without blocks, by all threads of rayon's pool. The
    /// function calls `progress` with the number of combinations in each finished block.
    pub fn check(
        &self,
        blocks: impl IntoParallelIterator<Item = u64>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Peak {
        blocks
            .into_par_iter()
            .map(|block| {
                let places = self.of_block(block);
                let peak = self.peak(places.clone());
                progress(places.end - places.start);
                peak
            })
            .reduce(|| Peak::NONE, Peak::join)
    }
}

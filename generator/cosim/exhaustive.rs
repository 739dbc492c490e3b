//! The factored proof of an accuracy contract: every place of its sweep for `f`, every word `f` with every
//! colour, and what both give together.
//!
//! Places are numbered, the last axis fastest, and cut into blocks; any set of blocks can be checked
//! anywhere, in any order, and the outcomes joined: the result does not depend on how the work was divided.

use std::ops::Range;

use rayon::prelude::*;

use crate::golden::{Contract, Sweep};

/// Places of a block: some milliseconds of work.
const BLOCK: u64 = 1 << 17;

/// What f64 itself may add to an error in units.
const F64: f64 = 1e-6;

/// The largest error of some places, and the first of them at which it occurs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Of `f`, absolute.
    pub error: f64,
    /// The number of the place.
    pub place: u64,
}

impl Peak {
    /// Of two sets of places together.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let later = self.place > other.place;
        if other.error > self.error || (other.error == self.error && later) {
            other
        } else {
            self
        }
    }
}

/// The places of a contract, by number.
pub struct Places<'a> {
    contract: &'a dyn Contract,
    sweep: Sweep,
}

impl<'a> Places<'a> {
    /// Those of the contract's sweep.
    pub fn new(contract: &'a dyn Contract) -> Self {
        Self {
            contract,
            sweep: contract.sweep(),
        }
    }

    /// Axes, and what they leave out.
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// How many places there are.
    pub fn count(&self) -> u64 {
        self.sweep
            .axes
            .iter()
            .map(|axis| axis.values.count())
            .product()
    }

    /// How many blocks they are cut into.
    pub fn blocks(&self) -> u64 {
        self.count().div_ceil(BLOCK)
    }

    /// The value on each axis of place `number`.
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

    /// The error at place `number`.
    pub fn error(&self, number: u64) -> f64 {
        self.contract.sweep_error(&self.place(number))
    }

    /// The peak of one block.
    fn block(&self, block: u64) -> Peak {
        let (first, end) = (block * BLOCK, ((block + 1) * BLOCK).min(self.count()));
        let mut peak = Peak {
            error: 0.0,
            place: first,
        };
        let Some(inner) = self.sweep.axes.last() else {
            return peak;
        };
        let count = inner.values.count();
        let mut number = first;
        while number < end {
            // Along the last axis only its own value moves.
            let mut place = self.place(number);
            let last = place.len() - 1;
            let at = number % count;
            for step in 0..(count - at).min(end - number) {
                place[last] = inner.values.value(at + step);
                let error = self.contract.sweep_error(&place);
                if error > peak.error {
                    peak = Peak {
                        error,
                        place: number + step,
                    };
                }
            }
            number += (count - at).min(end - number);
        }
        peak
    }

    /// The peak of some blocks, on all cores; `progress` is told the places of each block that is done.
    pub fn check(&self, blocks: Range<u64>, progress: &(dyn Fn(u64) + Sync)) -> Peak {
        self.check_every(1, blocks, progress)
    }

    /// As [`Places::check`], of every `stride`-th of the blocks.
    pub fn check_every(
        &self,
        stride: u64,
        blocks: Range<u64>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Peak {
        let count = (blocks.end - blocks.start).div_ceil(stride);
        (0..count)
            .into_par_iter()
            .map(|at| {
                let block = blocks.start + at * stride;
                let peak = self.block(block);
                progress(BLOCK.min(self.count() - block * BLOCK));
                peak
            })
            .reduce(
                || Peak {
                    error: 0.0,
                    place: u64::MAX,
                },
                Peak::join,
            )
    }
}

/// The largest error that a colour multiplier adds, in output units, over every word `f` and every colour.
pub fn colour_error(contract: &dyn Contract, progress: &(dyn Fn(u64) + Sync)) -> f64 {
    let Some((low, high)) = colours(contract) else {
        return 0.0;
    };
    let format = contract.f_format();
    let ulp = format.to_f64(1);
    let last = format.max_raw() as u64;
    (0..=last)
        .into_par_iter()
        .map(|f| {
            let f = f as i64;
            let errors = (low..=high).map(|colour| {
                (contract.colour(f, colour) as f64 - (f * colour) as f64 * ulp).abs()
            });
            let worst = errors.fold(0.0, f64::max);
            progress(low.abs_diff(high) + 1);
            worst
        })
        .reduce(|| 0.0, f64::max)
}

/// How many products [`colour_error`] looks at.
pub fn colour_products(contract: &dyn Contract) -> u64 {
    colours(contract).map_or(0, |(low, high)| {
        (contract.f_format().max_raw() as u64 + 1) * (low.abs_diff(high) + 1)
    })
}

/// The domain of the colour operands, which are all alike.
fn colours(contract: &dyn Contract) -> Option<(i64, i64)> {
    let colour = contract.operands().iter().find(|operand| operand.colour)?;
    Some(colour.domain)
}

/// What the proof found.
#[derive(Clone, Debug)]
pub struct Proof {
    /// The largest error of `f`.
    pub f: Peak,
    /// The same in output units, for the largest colour.
    pub f_units: f64,
    /// The largest error of a colour multiplier, in output units.
    pub colour_units: f64,
    /// What is not within the stated bound, or not below one unit though the bound is.
    pub faults: Vec<String>,
}

impl Proof {
    /// Weighs the peaks against the contract's bound.
    pub fn new(contract: &dyn Contract, f: Peak, colour_units: f64) -> Self {
        let largest = colours(contract).map_or(1.0, |domain| domain.1 as f64);
        let bound = contract.bound();
        let mut proof = Self {
            f,
            f_units: f.error * largest,
            colour_units,
            faults: Vec::new(),
        };
        if f.error > bound.f + F64 / largest {
            proof.faults.push(format!(
                "f is off by {:e}, beyond the stated bound of {:e}",
                f.error, bound.f
            ));
        }
        if proof.together() > bound.units + F64 {
            proof.faults.push(format!(
                "an output may be off by {:.4} units, beyond the stated bound of {:.4}",
                proof.together(),
                bound.units
            ));
        }
        proof
    }

    /// The most by which an output can be off, in its units.
    pub fn together(&self) -> f64 {
        self.f_units + self.colour_units
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Format;
    use crate::golden::{Axis, Bound, Operand, Values};

    /// f = 0; the "error" numbers the places 0, 1, 2, …, and repeats its largest value.
    struct Counting;

    impl Contract for Counting {
        fn operands(&self) -> &[Operand] {
            &[]
        }
        fn outputs(&self) -> &[String] {
            &[]
        }
        fn f_format(&self) -> Format {
            Format::unsigned(0, 4)
        }
        fn f(&self, _: &[i64]) -> i64 {
            0
        }
        fn colour(&self, _: i64, _: i64) -> i64 {
            0
        }
        fn reference(&self, _: &[i64]) -> f64 {
            0.0
        }
        fn bound(&self) -> Bound {
            Bound {
                f: 1.0,
                units: 1.0,
                terms: Vec::new(),
            }
        }
        fn sweep(&self) -> Sweep {
            let axis = |values| Axis {
                name: String::new(),
                values,
            };
            Sweep {
                axes: vec![
                    axis(Values::List(vec![7, 3])),
                    axis(Values::Range(-5, 149_994)),
                    axis(Values::Range(0, 2)),
                ],
                omits: String::new(),
            }
        }
        fn sweep_error(&self, place: &[i64]) -> f64 {
            let major = if place[0] == 3 { 450_000 } else { 0 };
            ((major + (place[1] + 5) * 3 + place[2]) as f64).min(700_000.5)
        }
    }

    #[test]
    fn places_are_numbered_last_axis_fastest() {
        let places = Places::new(&Counting);
        assert_eq!(places.count(), 900_000);
        assert_eq!(places.place(0), [7, -5, 0]);
        assert_eq!(places.place(4), [7, -4, 1]);
        assert_eq!(places.place(899_999), [3, 149_994, 2]);
        assert_eq!(places.error(451_234), 451_234.0);
    }

    #[test]
    fn the_peak_is_the_first_of_the_largest_however_the_work_is_divided() {
        let places = Places::new(&Counting);
        let whole = places.check(0..places.blocks(), &|_| ());
        assert_eq!((whole.error, whole.place), (700_000.5, 700_001));
        let parts = (0..places.blocks())
            .rev()
            .map(|block| places.check(block..block + 1, &|_| ()))
            .reduce(Peak::join);
        assert_eq!(parts, Some(whole));
        assert_eq!(
            places.check(0..2, &|_| ()).error,
            f64::from(2 * (1 << 17) - 1)
        );
    }
}

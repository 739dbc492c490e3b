//! Counts the verdicts on a run's faults, and decides whether the run passes.
//!
//! [`Score`] counts faults in the netlist; it passes if at most 1 % of them are undecided. [`TextScore`] counts faults in the
//! emitted Verilog.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::kind::FaultKind;
use super::verdict::{Detector, FaultResult, How, MutantVerdict};
use super::verilog::{ShippedBench, TextFault, TextFaultResult, TextMutantVerdict};

/// The largest share of undecided faults with which a configuration passes.
pub const TOLERATED: f64 = 0.01;

/// The goal for the faults in the Verilog: the share that the shipped bench notices, among the faults that it or a longer bench
/// notices.
pub const GOAL_TEXT: f64 = 0.98;

/// The goal for inverted bits in the upper half of table words: the share that the shipped bench notices, among the inversions
/// that some check notices.
pub const GOAL_MEMORY: f64 = 0.95;

/// A share of faults, for example "98 of 100 noticed".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    pub noticed: usize,
    pub of: usize,
}

impl Share {
    /// Returns the share as a number from 0 to 1. For example, 3 of 4 give 0.75, and 0 of 0 give 1.
    pub fn value(self) -> f64 {
        if self.of == 0 { 1.0 } else { self.noticed as f64 / self.of as f64 }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    pub planted: usize,
    /// The number of faults that each check noticed first.
    pub caught: BTreeMap<Detector, usize>,
    pub equivalent: BTreeMap<How, usize>,
    pub undecided: usize,
    pub shipped: usize,
    /// The number of faults that the shipped bench does not notice although another check does.
    pub missed: usize,
}

impl Tally {
    fn add(&mut self, found: &FaultResult) {
        self.planted += 1;
        self.shipped += usize::from(found.shipped);
        self.missed += usize::from(found.is_missed());
        match &found.verdict {
            MutantVerdict::Caught(check, _) => *self.caught.entry(*check).or_default() += 1,
            MutantVerdict::Equivalent(how) => *self.equivalent.entry(*how).or_default() += 1,
            MutantVerdict::Undecided => self.undecided += 1,
        }
    }

    pub fn all_caught(&self) -> usize {
        self.caught.values().sum()
    }

    pub fn all_equivalent(&self) -> usize {
        self.equivalent.values().sum()
    }

    /// Returns the share of undecided faults, from 0 to 1. For example, 76 undecided faults of 10 457 give 0.0073, which
    /// [`TOLERATED`] allows.
    pub fn share_undecided(&self) -> f64 {
        if self.planted == 0 { 0.0 } else { self.undecided as f64 / self.planted as f64 }
    }

    /// Returns the share that the shipped bench notices, among the faults that any check notices.
    pub fn of_shipped(&self) -> Share {
        Share { noticed: self.shipped, of: self.shipped + self.missed }
    }
}

/// The numbers of faults in the netlist of one configuration, or of one part of it, by verdict and by kind.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Score {
    pub all: Tally,
    pub kinds: BTreeMap<FaultKind, Tally>,
    pub undecided: Vec<String>,
}

impl Score {
    pub fn of(found: &[FaultResult]) -> Self {
        let mut score = Self::default();
        for one in found {
            let FaultResult { fault, verdict, .. } = one;
            score.all.add(one);
            score.kinds.entry(fault.kind).or_default().add(one);
            if *verdict == MutantVerdict::Undecided {
                score.undecided.push(fault.id.clone());
            }
        }
        score
    }

    pub fn holds(&self) -> bool {
        self.all.share_undecided() <= TOLERATED
    }

    /// Returns the share of inverted bits in the upper half of ROM words that the shipped bench notices, among the inversions
    /// that any check notices. Returns `None` for a design without ROMs.
    pub fn of_memory(&self) -> Option<Share> {
        self.kinds.get(&FaultKind::RomHighBit).map(Tally::of_shipped)
    }
}

/// The numbers of faults in the emitted Verilog of one configuration, by verdict.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextScore {
    pub planted: usize,
    /// The number of faults that a compiler or linter refuses or warns of.
    pub lint: usize,
    /// The number of faults that a test bench notices, without those in `lint`.
    pub bench: usize,
    pub equivalent: usize,
    pub undecided: Vec<String>,
    /// The share that the shipped bench notices, among the faults that it or a longer bench notices.
    pub shipped: Share,
    /// The ids of the faults that a longer bench notices, but the shipped bench does not.
    pub missed: Vec<String>,
}

impl TextScore {
    /// Counts the verdicts `found`, which are in the order of `faults`.
    pub fn of(faults: &[TextFault], found: &[TextFaultResult]) -> Self {
        let mut score = Self::default();
        for (fault, found) in faults.iter().zip(found) {
            let id = || fault.id.clone();
            score.planted += 1;
            match found.verdict {
                TextMutantVerdict::Lint => score.lint += 1,
                TextMutantVerdict::Bench => score.bench += 1,
                TextMutantVerdict::Equivalent => score.equivalent += 1,
                TextMutantVerdict::Undecided => score.undecided.push(id()),
            }
            match found.shipped {
                ShippedBench::Refused | ShippedBench::Silent => continue,
                ShippedBench::Noticed => score.shipped.noticed += 1,
                ShippedBench::Missed => score.missed.push(id()),
            }
            score.shipped.of += 1;
        }
        score
    }
}

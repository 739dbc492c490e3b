//! Counts the verdicts of a run: its score, in numbers and names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::kind::FaultKind;
use super::verdict::{Detector, FaultResult, How, MutantVerdict};
use super::verilog::{ShippedBench, TextFault, TextFaultResult, TextMutantVerdict};

/// The largest share of the faults that may be undecided.
pub const TOLERATED: f64 = 0.01;

/// The share of the faults in the Verilog that the shipped bench should notice by itself, among the faults that it or
/// a longer bench notices.
pub const GOAL_TEXT: f64 = 0.98;

/// The share of the bits in the upper half of the words of tables whose inversion the shipped bench should notice, among
/// the bits whose inversion some check notices. Words that are never read are not counted.
pub const GOAL_MEMORY: f64 = 0.95;

/// Some of the faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    /// The faults that are noticed.
    pub noticed: usize,
    /// All that could be.
    pub of: usize,
}

impl Share {
    /// Returns the share as a number. For example, 3 noticed of 4 give 0.75, and 0 of 0 give 1.
    pub fn value(self) -> f64 {
        if self.of == 0 { 1.0 } else { self.noticed as f64 / self.of as f64 }
    }
}

/// Faults by their verdicts.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// How many were planted.
    pub planted: usize,
    /// How many each check noticed first.
    pub caught: BTreeMap<Detector, usize>,
    /// How many were proved equivalent, by proof.
    pub equivalent: BTreeMap<How, usize>,
    /// How many are neither.
    pub undecided: usize,
    /// How many the shipped bench notices by itself, and how many it does not though a check does.
    pub shipped: usize,
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

    /// Returns how many some check noticed.
    pub fn all_caught(&self) -> usize {
        self.caught.values().sum()
    }

    /// Returns how many were proved equivalent.
    pub fn all_equivalent(&self) -> usize {
        self.equivalent.values().sum()
    }

    /// Returns the share that is undecided. For example, 76 undecided faults of 10 457 are a share of 0.0073, which
    /// [`TOLERATED`] allows.
    pub fn share_undecided(&self) -> f64 {
        if self.planted == 0 { 0.0 } else { self.undecided as f64 / self.planted as f64 }
    }

    /// Returns the shipped bench's share of the faults that anything notices.
    pub fn of_shipped(&self) -> Share {
        Share { noticed: self.shipped, of: self.shipped + self.missed }
    }
}

/// The faults of one configuration, or of one place of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Score {
    /// All together.
    pub all: Tally,
    /// By kind.
    pub kinds: BTreeMap<FaultKind, Tally>,
    /// The ids of the undecided faults.
    pub undecided: Vec<String>,
}

impl Score {
    /// Adds up.
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

    /// Returns whether no more than is tolerated is undecided.
    pub fn holds(&self) -> bool {
        self.all.share_undecided() <= TOLERATED
    }

    /// Returns the shipped bench's share of the bits in the upper half of the words of tables; nothing without tables.
    pub fn of_memory(&self) -> Option<Share> {
        self.kinds.get(&FaultKind::RomHighBit).map(Tally::of_shipped)
    }
}

/// The faults of the Verilog of one configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextScore {
    /// How many were planted.
    pub planted: usize,
    /// How many a compiler or lint refuses or warns of.
    pub lint: usize,
    /// How many of the others a bench notices.
    pub bench: usize,
    /// How many are proved equivalent.
    pub equivalent: usize,
    /// The ids of the others.
    pub undecided: Vec<String>,
    /// The shipped bench's share of the faults that it or a longer one notices.
    pub shipped: Share,
    /// The ids of the faults that the shipped bench does not notice.
    pub missed: Vec<String>,
}

impl TextScore {
    /// Adds up the findings about `faults`, which `found` gives in the same order.
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

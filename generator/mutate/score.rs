//! What a run found, in numbers and names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::kind::Kind;
use super::verdict::{Found, How, Leg, Verdict};
use super::verilog::{TextFault, TextVerdict};

/// At most so much of the faults may be open, as a share.
pub const TOLERATED: f64 = 0.01;

/// Faults by what became of them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// How many were planted.
    pub planted: usize,
    /// How many each leg noticed first.
    pub caught: BTreeMap<Leg, usize>,
    /// How many were proved equivalent, by proof.
    pub equivalent: BTreeMap<How, usize>,
    /// How many are neither.
    pub open: usize,
}

impl Tally {
    fn add(&mut self, verdict: &Verdict) {
        self.planted += 1;
        match verdict {
            Verdict::Caught(leg, _) => *self.caught.entry(*leg).or_default() += 1,
            Verdict::Equivalent(how) => *self.equivalent.entry(*how).or_default() += 1,
            Verdict::Open => self.open += 1,
        }
    }

    /// How many some leg noticed.
    pub fn all_caught(&self) -> usize {
        self.caught.values().sum()
    }

    /// How many were proved equivalent.
    pub fn all_equivalent(&self) -> usize {
        self.equivalent.values().sum()
    }

    /// The share that is open.
    pub fn share_open(&self) -> f64 {
        if self.planted == 0 { 0.0 } else { self.open as f64 / self.planted as f64 }
    }
}

/// The faults of one configuration, or of one place of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Score {
    /// All together.
    pub all: Tally,
    /// By kind.
    pub kinds: BTreeMap<Kind, Tally>,
    /// The ids of those that are open.
    pub open: Vec<String>,
    /// The ids of those that the default test misses and stimulus that is aimed at them does not.
    pub aimed: Vec<String>,
    /// The ids of those that were proved equivalent.
    pub equivalent: BTreeMap<How, Vec<String>>,
}

impl Score {
    /// Adds up.
    pub fn of(found: &[Found]) -> Self {
        let mut score = Self::default();
        for Found { fault, verdict } in found {
            score.all.add(verdict);
            score.kinds.entry(fault.kind).or_default().add(verdict);
            match verdict {
                Verdict::Open => score.open.push(fault.id.clone()),
                Verdict::Caught(Leg::Aimed, _) => score.aimed.push(fault.id.clone()),
                Verdict::Caught(..) => {}
                Verdict::Equivalent(how) => {
                    score.equivalent.entry(*how).or_default().push(fault.id.clone());
                }
            }
        }
        score
    }

    /// Whether no more than is tolerated is open.
    pub fn holds(&self) -> bool {
        self.all.share_open() <= TOLERATED
    }
}

/// The faults of the Verilog of one configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextScore {
    /// How many were planted.
    pub planted: usize,
    /// How many a compiler or lint refuses or warns of.
    pub lint: usize,
    /// How many the bench notices.
    pub bench: usize,
    /// The ids of those that are proved equivalent.
    pub equivalent: Vec<String>,
    /// The ids of the others.
    pub open: Vec<String>,
}

impl TextScore {
    /// Adds up the verdicts on faults, given in the same order.
    pub fn of(faults: &[TextFault], verdicts: &[TextVerdict]) -> Self {
        let mut score = Self::default();
        for (fault, verdict) in faults.iter().zip(verdicts) {
            score.planted += 1;
            match verdict {
                TextVerdict::Lint => score.lint += 1,
                TextVerdict::Bench => score.bench += 1,
                TextVerdict::Equivalent => score.equivalent.push(fault.id.clone()),
                TextVerdict::Open => score.open.push(fault.id.clone()),
            }
        }
        score
    }
}

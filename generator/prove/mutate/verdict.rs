//! Defines the verdicts on faults in a netlist: caught by a check, proved equivalent, or undecided. A verdict also names the
//! check or the proof that decided.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::fault::NetlistFault;
use glint_core::cosim::Mismatch;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detector {
    /// The default test, which compares golden model and simulated hardware for random operands.
    Cosim,
    /// A directed test, which fixes operands at a point that a search found, or at values with which the hardware reads faulty
    /// ROM words.
    Directed,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum How {
    /// Induction over the microprogram.
    Induction,
    /// Every combination of values on the nets around the fault was tried.
    Exhaustion,
    /// For a fault in words of a ROM, every combination of the operands that read the words was tried.
    Operands,
}

impl fmt::Display for Detector {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Cosim => "co-simulation",
            Self::Directed => "directed stimulus",
        })
    }
}

impl fmt::Display for How {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Induction => "by induction over the microprogram",
            Self::Exhaustion => "by every combination of the values around it",
            Self::Operands => "by every combination of the operands that are used with the word",
        })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct SignalDifference {
    /// The operands that the stimulus fixed, each by name with its raw value ([`glint_core::cosim::Lockstep::holding`]).
    pub held: Vec<(String, i64)>,
    pub mismatch: Mismatch,
}

#[derive(Clone, Debug, PartialEq)]
pub enum MutantVerdict {
    /// A check noticed the fault, by this difference.
    Caught(Detector, SignalDifference),
    /// A proof shows that the fault changes nothing that the checks compare.
    Equivalent(How),
    Undecided,
}

#[derive(Clone, Debug, PartialEq)]
pub struct FaultResult {
    pub fault: NetlistFault,
    pub verdict: MutantVerdict,
    /// Whether the shipped bench notices the fault at the outputs.
    pub shipped: bool,
}

impl FaultResult {
    pub fn is_missed(&self) -> bool {
        matches!(self.verdict, MutantVerdict::Caught(..)) && !self.shipped
    }
}

//! Defines the verdicts on faults in a netlist: caught by a check, proved equivalent, or undecided. A verdict also names the
//! check or the proof that decided.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::fault::NetlistFault;
use glint_core::cosim::Mismatch;

/// The check that noticed a fault in the netlist first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detector {
    /// The default test noticed the fault: it compares golden model and simulated hardware for random operands.
    Cosim,
    /// A directed test noticed the fault: it fixes operands at values with which the hardware reads faulty ROM words, or at a
    /// point that a search has found.
    Directed,
}

/// The method by which a fault was proved equivalent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum How {
    /// The fault was proved equivalent by induction over the microprogram.
    Induction,
    /// The fault was proved equivalent by trying every combination of values on the nets around it.
    Exhaustion,
    /// The fault, in words of a ROM, was proved equivalent by trying every combination of the operands with which the hardware
    /// reads the words.
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

/// The difference between mutant and golden model that a check found.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalDifference {
    /// The operands that the stimulus fixed, each by name with its raw value ([`glint_core::cosim::Lockstep::holding`]). For
    /// example, `exponent` at 5.
    pub held: Vec<(String, i64)>,
    /// The signal that differs, and the clock in which it differs.
    pub mismatch: Mismatch,
}

/// The verdict on a mutant: caught by a check, proved equivalent, or undecided.
#[derive(Clone, Debug, PartialEq)]
pub enum MutantVerdict {
    /// A check noticed the fault, by this difference.
    Caught(Detector, SignalDifference),
    /// The fault is proved to change nothing that the checks compare.
    Equivalent(How),
    /// No check noticed the fault, and no proof shows it to be equivalent.
    Undecided,
}

/// A planted fault, with the verdict of the checks on it.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultResult {
    /// The fault that was planted.
    pub fault: NetlistFault,
    /// The verdict of the checks and proofs on the fault.
    pub verdict: MutantVerdict,
    /// Whether the shipped bench notices the fault at the outputs.
    pub shipped: bool,
}

impl FaultResult {
    /// Returns whether a check catches the fault but the shipped bench does not.
    pub fn is_missed(&self) -> bool {
        matches!(self.verdict, MutantVerdict::Caught(..)) && !self.shipped
    }
}

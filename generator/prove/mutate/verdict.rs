//! Defines the verdicts on faults: caught by a check, proved equivalent, or undecided.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::fault::NetlistFault;
use glint_core::cosim::Mismatch;

/// The check that noticed a fault first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detector {
    /// The default test: golden model against built-in simulator.
    Cosim,
    /// Operands held at values that read the words at fault.
    Directed,
}

/// The way in which a fault was proved equivalent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum How {
    /// By induction over the microprogram.
    Induction,
    /// By every combination of the values around it.
    Exhaustion,
    /// By every combination of the operands that are used with the word at fault.
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
    /// Operands that the stimulus held, by name, at raw values ([`glint_core::cosim::Lockstep::holding`]). For example,
    /// `exponent` at 5.
    pub held: Vec<(String, i64)>,
    /// The signal that differs, and the clock.
    pub mismatch: Mismatch,
}

/// The verdict on a mutant.
#[derive(Clone, Debug, PartialEq)]
pub enum MutantVerdict {
    /// A check differs, at this place.
    Caught(Detector, SignalDifference),
    /// Proved to change nothing that is compared.
    Equivalent(How),
    /// Neither caught nor proved equivalent.
    Undecided,
}

/// A fault and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultResult {
    /// The fault.
    pub fault: NetlistFault,
    /// The verdict.
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

//! Tests the tests of a core by mutation: plants faults, and finds out which faults the tests notice.
//!
//! Faults are planted one at a time, in the netlist ([`Faults`]) and in the emitted Verilog ([`VerilogText`]). A design with a
//! fault is a *mutant*. Each mutant is *caught* by a test (in the Verilog also by lint), proved *equivalent* to the fault-free
//! design, or left *undecided*. A mutant that no test notices counts as equivalent only with a proof. Whether the shipped test
//! bench notices a mutant is counted separately.

mod coverage;
mod fault;
mod formal;
mod kind;
mod operators;
mod pinned_operands;
mod plant;
mod proof;
mod run;
mod score;
#[cfg(test)]
mod tests;
mod unreachable;
mod verdict;
mod verilog;
mod witness_search;

pub use fault::{BitChange, Faults, NetlistFault, Site};
pub use kind::FaultKind;
pub use run::run;
pub use score::{GOAL_MEMORY, GOAL_TEXT, Score, Share, TOLERATED, Tally, TextScore};
pub use unreachable::unreached;
pub use verdict::{Detector, FaultResult, How, MutantVerdict, SignalDifference};
pub use verilog::{ShippedBench, TextFault, TextFaultResult, TextMutantVerdict, VerilogText};

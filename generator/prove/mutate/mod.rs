//! Tests the tests by mutation: plants faults, and finds which of them the tests notice.
//!
//! Faults are planted one at a time, in the netlist ([`Faults`]) and in the emitted Verilog. The tests of the
//! configuration *catch* a mutant, or a proof shows that it is *equivalent*, or it is *undecided*. If no test notices
//! it, only a proof can make it equivalent. Separately, the bench that is shipped with the core runs on each mutant,
//! because the core's user has nothing else.

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
mod shipped;
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

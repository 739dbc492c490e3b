//! Tests the tests by mutation: plants faults, and finds which of them the tests notice.
//!
//! Faults are planted one at a time, in the netlist ([`Faults`]) and in the emitted Verilog, and what a
//! configuration is tested with is run on each mutant. A mutant is *caught*, or *equivalent*, which is
//! proved, or *undecided*. What the test does not notice is never called equivalent for that reason. Apart from that,
//! and on its own, the bench that is shipped with the core runs on each: that is all that its user has.

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

pub use fault::{Bit, Fault, Faults, Site};
pub use kind::FaultKind;
pub use run::run;
pub use score::{GOAL_MEMORY, GOAL_TEXT, Score, Share, TOLERATED, Tally, TextScore};
pub use unreachable::unreached;
pub use verdict::{Detector, Difference, Found, How, Verdict};
pub use verilog::{ShippedBench, Text, TextFault, TextFound, TextVerdict};

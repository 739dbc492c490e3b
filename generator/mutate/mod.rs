//! Mutation: do the tests notice faults?
//!
//! Faults are planted one at a time, in the netlist ([`Faults`]) and in the emitted Verilog, and what a
//! configuration is tested with is run on each mutant. A mutant is *caught*, or *equivalent*, which is
//! proved, or *open*. What the test does not notice is never called equivalent for that reason.

mod aim;
mod coverage;
mod fault;
mod formal;
mod kind;
mod operators;
mod plant;
mod proof;
mod reach;
mod run;
mod score;
mod shipped;
#[cfg(test)]
mod tests;
mod verdict;
mod verilog;

pub use fault::{Bit, Fault, Faults, Site};
pub use kind::Kind;
pub use reach::unreached;
pub use run::run;
pub use score::{Score, TOLERATED, Tally, TextScore};
pub use shipped::notices;
pub use verdict::{Difference, Found, How, Leg, Verdict};
pub use verilog::{POINTS as BENCH_POINTS, Text, TextFault, TextVerdict};

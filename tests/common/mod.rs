//! What several tests share.

pub mod bench;
pub mod netlist;
pub mod tools;
pub mod units;

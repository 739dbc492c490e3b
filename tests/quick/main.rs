//! The quick tests, which need no tool but Glint. CONTRIBUTING.md says how long they take.
//!
//! Tests with simulators, synthesis, provers or Python are in `tests/tools`.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod blocks;
mod by_hand;
mod cli;
mod clocks;
mod combinations;
mod config_device;
mod config_follow;
mod config_fuzz;
mod config_problems;
mod config_text;
mod datasheet;
mod devices;
mod diagnostics;
mod divider;
mod emission;
mod expressions;
mod keys;
mod kinds;
mod lines;
mod multipliers;
mod operand_buffers;
mod output_registers;
mod pages;
mod pipelines;
mod proofs;
mod registers;
mod rooms;
mod rough_microprogram;
mod shared_products;
mod simulator;
mod software;
mod spread;
mod streams;
mod tables;
mod tune;
mod units;
mod words;
mod worst;

use cli::{refusals, workspace};

/// Shows in every run without the outside tools which tests are missing.
#[test]
#[cfg_attr(
    not(feature = "outside-tools"),
    ignore = "LEFT OUT: tests with simulators, synthesis, provers and Python; `bash tools/test` installs the tools and runs all tests"
)]
fn tests_with_outside_tools_run_too() {
    let has_tools = cfg!(feature = "outside-tools");
    assert!(has_tools);
}

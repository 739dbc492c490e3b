//! Tests the DSL with random descriptions: it returns a design that can be simulated and emitted, or diagnostics with a message
//! and a source line.
//!
//! Verilator, Icarus Verilog and Yosys must accept the emitted Verilog of a sample of right descriptions.

mod build;

use std::panic::Location;

use crate::common::Sure;
use crate::common::cores::{Files, write};
use crate::common::tools::{assert_lint_clean, yosys};
use build::{Call, build, calls};
use glint::hdl::netlist::Design;
use glint::hdl::sim::Simulator;
use glint::package::{EmitInputs, FileKind, emit};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Designs that outside tools see.
const OUTSIDE: usize = 40;

/// Emits and simulates a design for some clocks.
fn answer(design: &Design) -> Result<Files, TestCaseError> {
    let files = emit(design, &EmitInputs::default());
    let files = files.map_err(|error| TestCaseError::fail(format!("{error:?}\n{design}")))?;
    let simulator = Simulator::<1>::new(design);
    let mut simulator =
        simulator.map_err(|error| TestCaseError::fail(format!("{error:?}\n{design}")))?;
    for clock in 0..8 {
        for input in 0..simulator.inputs().len() {
            simulator.set(input, u64::from(clock > 0));
        }
        let settles = simulator.clock();
        prop_assert!(settles.is_ok(), "{design}");
    }
    Ok(files.sources(FileKind::DESIGN_SOURCES))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: crate::common::cases(3000),
        failure_persistence: None,
        rng_seed: crate::common::sample::fuzz_seed(),
        ..ProptestConfig::default()
    })]

    #[test]
    fn whatever_is_described_is_answered(calls in calls(true)) {
        match build(&calls) {
            Ok(design) => {
                answer(&design)?;
            }
            Err(diagnostics) => {
                let here = |dir: &Location| dir.file().starts_with("tests/");
                let placed = diagnostics.0.iter().any(|found| here(found.location));
                prop_assert!(placed, "{diagnostics}");
                for diagnostic in &diagnostics.0 {
                    prop_assert!(!diagnostic.message.is_empty());
                }
            }
        }
    }

    #[test]
    fn right_files_are_accepted(calls in calls(false)) {
        match build(&calls) {
            Ok(design) => {
                answer(&design)?;
            }
            Err(diagnostics) => prop_assert!(false, "{diagnostics}"),
        }
    }
}

#[test]
fn what_is_accepted_the_tools_accept() {
    let mut runner = TestRunner::deterministic();
    for _ in 0..OUTSIDE {
        let mut drawn: Vec<Call> = calls(false).new_tree(&mut runner).expect("calls").current();
        drawn.retain(|call| !call.may_be_known());
        let design = build(&drawn).sure();
        let files = answer(&design).sure();
        let dir = tempfile::tempdir().expect("a directory");
        write(dir.path(), &files);
        assert_lint_clean(dir.path(), &design.name);
        yosys(dir.path(), "read_verilog *.v; hierarchy -top fuzz -check; proc; check -assert");
    }
}

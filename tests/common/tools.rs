//! Outside tools in tests.
//!
//! A missing tool fails the test, with the remedy: a test that skips itself proves nothing.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::Sure;
use glint::tools::{BenchOutcome, Simulator, Tool, lint, run_bench};

/// The time limit of any tool.
pub const LIMIT: Duration = Duration::from_secs(1200);

/// Returns the tool of that name: from the Python environment that `tools/install` makes, or from `PATH`.
///
/// # Panics
/// It is in neither.
pub fn tool(name: &str) -> Tool {
    let venv = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/tools/venv/bin");
    let path = env::var_os("PATH").unwrap_or_default();
    let dirs = std::iter::once(venv).chain(env::split_paths(&path));
    let search: OsString = env::join_paths(dirs).expect("a search path");
    Tool::find_in(name, &search).sure()
}

/// Runs a tool, which is expected to succeed, and returns what it says.
///
/// # Panics
/// It does not.
pub fn ran<A: AsRef<OsStr>>(
    name: &str,
    arguments: impl IntoIterator<Item = A>,
    directory: &Path,
) -> String {
    tool(name).run_to_success(arguments, directory, LIMIT).sure()
}

/// Runs a bench that is expected to pass; returns what came of it.
///
/// # Panics
/// It cannot be built or run, warns under Icarus Verilog, or does not pass.
pub fn assert_bench_passes(
    simulator: Simulator,
    files: &[(String, String)],
    top: &str,
) -> BenchOutcome {
    let outcome = run_bench(simulator, files, top, LIMIT).sure();
    assert!(outcome.passed, "{top} under {simulator}:\n{}", outcome.transcript);
    if simulator == Simulator::Icarus {
        assert_eq!(outcome.build, "", "{top}: warnings of iverilog -Wall");
    }
    outcome
}

/// Checks that neither `verilator --lint-only -Wall` nor `iverilog -Wall` has anything to say about
/// the Verilog files in `directory`.
///
/// # Panics
/// One of them has.
pub fn assert_lint_clean(directory: &Path, top: &str) {
    let sources = verilog_files(directory);
    for tool in ["iverilog", "verilator"].map(tool) {
        let output = lint(&tool, directory, &sources, top, LIMIT)
            .unwrap_or_else(|error| panic!("{}: {error:#}", directory.display()));
        assert_eq!(output, "", "{tool} has remarks on {}", directory.display());
    }
}

/// A warning of Yosys 0.23 about its own model of a Xilinx block RAM; those of the outputs are given as
/// wide as the widest of its modes.
const YOSYS_ON_ITSELF: &str = r"Resizing cell port .*\.DO(P?)[AB]DO(P?) from";

/// Runs Yosys commands in `directory`, with warnings as errors, and returns the protocol.
///
/// # Panics
/// Yosys fails or warns.
pub fn yosys(directory: &Path, commands: &str) -> String {
    tool("yosys")
        .run_to_success(["-w", YOSYS_ON_ITSELF, "-e", ".*", "-p", commands], directory, LIMIT)
        .unwrap_or_else(|error| panic!("{}: {error:#}", directory.display()))
}

/// Returns the names of the Verilog files in `directory`, sorted.
///
/// # Panics
/// It cannot be read, or there are none.
pub fn verilog_files(directory: &Path) -> Vec<String> {
    let entries =
        directory.read_dir().unwrap_or_else(|error| panic!("{}: {error}", directory.display()));
    let paths = entries.map(|entry| entry.expect("a directory entry").path());
    let is_verilog = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "v");
    let mut names: Vec<String> = paths
        .filter(is_verilog)
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
        .collect();
    assert!(!names.is_empty(), "no Verilog in {}", directory.display());
    names.sort();
    names
}

//! Runs outside tools in tests. A missing tool fails the test with a remedy, because a test that skips itself proves nothing.

use std::env;
use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::Sure;
use super::cores::{Files, write};
use super::files::{paths, root};
use glint::core::Core;
use glint::tools::{BenchOutcome, Tool, VerilogSimulator, lint, run_bench};
use glint::verify::{CHECKS, CheckSubject, Effort, Finding};

/// The time limit of any tool.
pub const LIMIT: Duration = Duration::from_secs(1200);

/// Returns the tool of that name: from the Python environment that `tools/install` makes, or from `PATH`.
///
/// # Panics
/// It is in neither.
pub fn tool(name: &str) -> Tool {
    let path = env::var_os("PATH").unwrap_or_default();
    let dirs = std::iter::once(root().join("target/tools/venv/bin"));
    let search = env::join_paths(dirs.chain(env::split_paths(&path))).expect("a search path");
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

/// Runs a command, which is expected to succeed, and returns its standard output.
///
/// # Panics
/// It does not.
#[track_caller]
pub fn succeeded(command: &mut Command) -> String {
    let output = command.output().sure_of(format_args!("{command:?}"));
    let [text, errors] =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{command:?}: {text}{errors}");
    text
}

/// Runs a script of the examples, which is expected to succeed, with the program of these tests, and returns what it says.
///
/// # Panics
/// It does not.
pub fn example(script: &str, arguments: &[&OsStr]) -> String {
    let glint = format!("GLINT={}", env!("CARGO_BIN_EXE_glint"));
    let script = root().join("examples").join(script);
    let all = [glint.as_ref(), script.as_os_str()].into_iter().chain(arguments.iter().copied());
    ran("env", all, checkout())
}

/// Returns the directory of this checkout for a tool that runs in it. The path is relative, so that the tool keeps its temporary
/// files elsewhere.
pub fn checkout() -> &'static Path {
    Path::new(".")
}

/// Returns an example as a program that Cargo runs, to be given its arguments.
pub fn cargo_example(name: &str) -> Command {
    let mut cargo = Command::new(env!("CARGO"));
    // The features of the test, so that the library is not built once more.
    cargo.args(["run", "--quiet", "--features", "outside-tools", "--example", name]);
    cargo.arg("--manifest-path").arg(root().join("Cargo.toml"));
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    cargo.arg("--");
    cargo
}

/// The effort of a check that is not full.
pub const EFFORT: Effort = Effort { full: false, without_tools: false, time_limit: LIMIT };

/// Returns what a check of `glint verify` finds of a core.
///
/// # Panics
/// There is no such check.
pub fn finding(core: &Core, id: &str, effort: Effort) -> Finding {
    let check = CHECKS.iter().find(|check| check.id == id).expect("the check");
    let subject = CheckSubject::new("core.toml", core, effort, Path::new("records/proofs"));
    check.run(&subject, &|_| ()).finding
}

/// Runs a bench, and returns what came of it.
///
/// # Panics
/// It cannot be built or run.
#[track_caller]
pub fn benched(simulator: VerilogSimulator, files: &[(String, String)], top: &str) -> BenchOutcome {
    run_bench(simulator, files, top, LIMIT).sure_of(format_args!("{top} under {simulator}"))
}

/// Runs a bench that is expected to pass; returns what came of it.
///
/// # Panics
/// It cannot be built or run, warns under Icarus Verilog, or does not pass.
pub fn assert_bench_passes(
    simulator: VerilogSimulator,
    files: &[(String, String)],
    top: &str,
) -> BenchOutcome {
    let outcome = benched(simulator, files, top);
    assert!(outcome.passed, "{top} under {simulator}:\n{}", outcome.transcript);
    if simulator == VerilogSimulator::Icarus {
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
        let output = lint(&tool, directory, &sources, top, LIMIT).sure_of(directory.display());
        assert_eq!(output, "", "{tool} has remarks on {}", directory.display());
    }
}

/// Checks the same of files.
///
/// # Panics
/// A linter has something to say.
pub fn assert_files_are_clean(files: &Files, top: &str) {
    let directory = tempfile::tempdir().expect("a directory");
    write(directory.path(), files);
    assert_lint_clean(directory.path(), top);
}

/// A warning of Yosys 0.23 about its own model of a Xilinx block RAM; those of the outputs are given as
/// wide as the widest of its modes.
const YOSYS_ON_ITSELF: &str = r"Resizing cell port .*\.DO(P?)[AB]DO(P?) from";

/// Runs Yosys commands in `directory`, with warnings as errors, and returns the protocol.
///
/// # Panics
/// Yosys fails or warns.
pub fn yosys(directory: &Path, commands: &str) -> String {
    yosys_with(&tool("yosys"), directory, commands)
}

/// Runs commands of a certain Yosys in `directory`, with warnings as errors, and returns the protocol.
///
/// # Panics
/// Yosys fails or warns.
pub fn yosys_with(yosys: &Tool, directory: &Path, commands: &str) -> String {
    yosys
        .run_to_success(["-w", YOSYS_ON_ITSELF, "-e", ".*", "-p", commands], directory, LIMIT)
        .sure_of(directory.display())
}

/// Returns the names of the Verilog files in `directory`, sorted.
///
/// # Panics
/// It cannot be read, or there are none.
pub fn verilog_files(directory: &Path) -> Vec<String> {
    let paths = paths(directory, ".v").into_iter();
    paths.filter_map(|path| Some(Path::new(&path).file_name()?.to_str()?.to_owned())).collect()
}

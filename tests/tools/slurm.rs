//! Job arrays: an exhaustive check in parts, one of which is put back in its middle, joined to the record of one process.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// 18 operand bits: long enough that a task can be met in its middle, short enough for a test.
const CONFIG: &str = "device = \"cosine-power\"\ncosine.fraction = 8\nexponent.bits = 6\ncolour.bits = 1\nintensity.fraction = 8\n";

const PARTS: usize = 3;

const LIMIT: Duration = Duration::from_secs(300);

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a command to its good end; its output.
fn run(command: &mut Command) -> String {
    let output: Output =
        command.current_dir(root()).output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{command:?}: {}", text.concat());
    text[0].clone()
}

/// The configuration, written into a directory.
fn config(dir: &Path) -> String {
    let path = dir.join("core.toml");
    fs::create_dir_all(dir).expect("a directory");
    fs::write(&path, CONFIG).expect("a configuration");
    path.to_str().expect("a plain name").to_owned()
}

fn submit(dir: &Path) -> Command {
    let mut command = Command::new("bash");
    command.args([
        "tools/slurm/submit",
        "exhaustive",
        &config(dir),
        "-g",
        env!("CARGO_BIN_EXE_glint"),
        "-n",
    ]);
    command.arg(PARTS.to_string()).arg("-o").arg(dir);
    command
}

/// The record of one process, without an engine.
fn whole(dir: &Path) -> String {
    run(Command::new(env!("CARGO_BIN_EXE_glint")).args([
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
        run(Command::new("bash").args(["tools/slurm/loopback", "start"]).arg(&dir));
        Self(dir)
    }

    fn command(&self, name: &str) -> Command {
        let mut command = Command::new(name);
        command.env("SLURM_CONF", self.0.join("slurm.conf"));
        command
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

/// Waits until `done` is true.
fn wait(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < LIMIT, "{what}: not within {LIMIT:?}");
        sleep(Duration::from_millis(100));
    }
}

#[test]
fn a_job_array_with_a_requeued_task_gives_the_record_of_one_process() {
    let dir = tempfile::tempdir().expect("a directory");
    let slurm = Loopback::start(dir.path().join("slurm"));
    let results = dir.path().join("results");
    let mut command = submit(&results);
    let said = run(command.env("SLURM_CONF", slurm.0.join("slurm.conf")));
    let array = said.split("job array ").nth(1).and_then(|rest| rest.split(',').next());
    let array = array.unwrap_or_else(|| panic!("{said}")).to_owned();
    // The first task has begun: its state is there, and not complete.
    wait("the first part", || results.join("part-1.json").exists());
    run(slurm.command("scontrol").args(["requeue", &format!("{array}_1")]));
    let restarts = || run(slurm.command("scontrol").args(["show", "job", &format!("{array}_1")]));
    assert!(restarts().contains("Restarts=1"), "{}", restarts());
    wait("the joined record", || run(slurm.command("squeue").arg("-h")).trim().is_empty());
    let log = |name: &str| fs::read_to_string(results.join(name)).unwrap_or_default();
    let merged = fs::read_to_string(results.join("merged.json"))
        .unwrap_or_else(|error| panic!("{error}: {} {}", log("last.log"), log("task-1.log")));
    assert_eq!(merged, whole(&results));
}

#[test]
fn gnu_parallel_gives_the_record_of_one_process() {
    let dir = tempfile::tempdir().expect("a directory");
    run(submit(dir.path()).args(["-j", "2"]));
    let merged = || fs::read_to_string(dir.path().join("merged.json")).expect("a record");
    assert_eq!(merged(), whole(dir.path()));
    // Submitted again, nothing is left to do.
    let before =
        fs::metadata(dir.path().join("part-1.json")).and_then(|it| it.modified()).expect("a part");
    run(submit(dir.path()).args(["-j", "2"]));
    let after =
        fs::metadata(dir.path().join("part-1.json")).and_then(|it| it.modified()).expect("a part");
    assert_eq!(before, after);
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

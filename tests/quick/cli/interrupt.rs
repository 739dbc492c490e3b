//! Tests that Ctrl-C ends the commands that start tools or take long, and leaves neither a process nor a temporary file.
//!
//! The tests also cover a killed program, an ignored signal, and the saved state of an exhaustive check.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Run, Workspace};

/// The environment variable by which the processes of a run are known; its value is the directory.
const MARK: &str = "GLINT_TEST_PLACE";

const PATIENCE: Duration = Duration::from_secs(300);
const PAUSE: Duration = Duration::from_millis(20);

/// Returns the command with signals as a terminal has them: a shell lets what it starts in the background ignore Ctrl-C,
/// and the tests may be such.
fn signalled(command: &Command) -> Command {
    let mut signalled = Command::new("env");
    signalled.arg("--default-signal=INT,TERM,HUP").arg(command.get_program());
    signalled.args(command.get_args());
    command.get_current_dir().into_iter().for_each(|dir| {
        signalled.current_dir(dir);
    });
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => signalled.env(name, value),
            None => signalled.env_remove(name),
        };
    }
    signalled
}

/// The program in a directory with tools of its own, while it runs.
struct Running<'a> {
    dir: &'a Workspace,
    child: Child,
    before: BTreeMap<String, Vec<u8>>,
}

impl<'a> Running<'a> {
    /// Tools in `tools/` come before those of the system.
    fn start(dir: &'a Workspace, arguments: &[&str]) -> Self {
        fs::create_dir_all(dir.at("tmp")).expect("a directory");
        let search = std::env::var_os("PATH").unwrap_or_default();
        let search = std::iter::once(dir.at("tools")).chain(std::env::split_paths(&search));
        let before = dir.files();
        let child = signalled(&dir.command())
            .args(arguments)
            .env("PATH", std::env::join_paths(search).expect("a search path"))
            .env("TMPDIR", dir.at("tmp"))
            .env(MARK, dir.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        Self { dir, child, before }
    }

    /// Returns the names of all processes of the run.
    fn processes(&self) -> Vec<String> {
        let mark = format!("{MARK}={}", self.dir.path().display());
        let entries = fs::read_dir("/proc").expect("/proc");
        let names = entries.filter_map(|entry| {
            let path = entry.ok()?.path();
            let environment = fs::read(path.join("environ")).ok()?;
            let mut variables = environment.split(|&byte| byte == 0);
            let ours = variables.any(|variable| variable == mark.as_bytes());
            ours.then(|| fs::read_to_string(path.join("comm")).unwrap_or_default())
        });
        names.map(|name| name.trim().to_owned()).collect()
    }

    fn until(&mut self, what: &str, mut is: impl FnMut(&Self) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        while !is(self) {
            let ended = self.child.try_wait().expect("the program");
            assert!(ended.is_none() && Instant::now() < deadline, "no {what}: {ended:?}");
            thread::sleep(PAUSE);
        }
    }

    fn until_tools_sleep(&mut self) {
        self.until("two sleeping children", |run| {
            run.processes().iter().filter(|name| *name == "sleep").count() >= 3
        });
    }

    fn interrupted_by(self, signal: Signal) -> Run {
        let number = Pid::from_raw(self.child.id() as i32).expect("a process");
        kill_process(number, signal).expect("a signal");
        let begin = Instant::now();
        // Its output ends only when no process is left that has it.
        let run = Run::of(self.child.wait_with_output());
        assert!(begin.elapsed() < Duration::from_secs(30), "it took {:?}", begin.elapsed());
        assert!(run.err.contains("interrupted"), "{run:?}");
        run
    }

    /// Interrupts, and looks for what is left.
    fn end(self, signal: Signal, code: i32) {
        let (dir, before) = (self.dir, self.before.clone());
        let probe = Running { dir, child: dead(), before: BTreeMap::new() };
        let run = self.interrupted_by(signal);
        assert_eq!(run.code, code, "{run:?}");
        let left = probe.processes();
        assert!(left.is_empty(), "still there: {left:?}");
        assert_eq!(dir.files().keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>());
        let temporary: Vec<_> = fs::read_dir(dir.at("tmp")).expect("tmp").collect();
        assert!(temporary.is_empty(), "{temporary:?}");
        dir.assert_no_staging();
    }
}

/// Returns a process that has ended.
fn dead() -> Child {
    let mut child = std::process::Command::new("true").spawn().expect("true");
    child.wait().expect("its end");
    child
}

/// A tool that says its version, and otherwise never ends: neither itself, nor a child in its process group, nor
/// one in a session of its own, as the solver of yosys-smtbmc is.
const ENDLESS: &str = "case \"$1\" in --version|-V) echo 'Endless 1'; exit;; esac
echo 'left' > \"${TMPDIR:-/tmp}/left-by-a-tool\"
sleep 1000 & setsid sleep 1001 & sleep 1002";

fn with_endless(tools: &[&str]) -> Workspace {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    for tool in tools {
        dir.write(&format!("tools/{tool}"), "");
        dir.script(&format!("tools/{tool}"), ENDLESS);
    }
    dir
}

#[test]
#[cfg(feature = "outside-tools")]
fn the_compiler_of_verilator_ends() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let mut run = Running::start(&dir, &["cosim", "core.toml", "--simulator", "verilator"]);
    run.until("cc1plus", |run| run.processes().iter().any(|name| name == "cc1plus"));
    run.end(Signal::INT, 130);
}

#[test]
fn every_command_ends_with_its_tools() {
    let commands: [(&[&str], &str, Signal, i32); 7] = [
        (&["cosim", "core.toml", "--simulator", "icarus"], "iverilog", Signal::TERM, 143),
        (&["compare"], "yosys", Signal::HUP, 129),
        (&["certify", "core.toml"], "gappa", Signal::INT, 130),
        (&["synth", "core.toml"], "yosys", Signal::TERM, 143),
        (&["verify", "core.toml"], "verilator", Signal::INT, 130),
        (&["datasheet", "core.toml"], "yosys", Signal::INT, 130),
        (
            &["render", "core.toml", "--through", "verilator", "--out", "a.png"],
            "verilator",
            Signal::INT,
            130,
        ),
    ];
    for (arguments, tool, signal, code) in commands {
        let dir = with_endless(&[tool]);
        let mut run = Running::start(&dir, arguments);
        run.until_tools_sleep();
        run.end(signal, code);
    }
}

/// A device of few faults, so that those of the netlist are soon done, and those of the Verilog begin.
const NARROW: &str = "device = \"cosine-power\"
power = 2
cosine.fraction = 8
intensity.fraction = 6
exponent.bits = 2
colour.bits = 1
domain = { exponent_min = 2, exponent_max = 3 }
";

/// Nobody asks a process that is killed: its guard ends the tools, and the next run deletes what is left.
#[test]
fn a_killed_run_leaves_nothing_for_long() {
    let dir = with_endless(&["iverilog"]);
    let arguments = ["cosim", "core.toml", "--simulator", "icarus"];
    let temporary = || fs::read_dir(dir.at("tmp")).expect("tmp").count();
    let mut run = Running::start(&dir, &arguments);
    run.until_tools_sleep();
    // The guard learns of a child when it has started, which on a busy machine may be later than its sleep.
    thread::sleep(Duration::from_secs(2));
    run.child.kill().expect("a signal");
    run.child.wait().expect("its end");
    let begin = Instant::now();
    while !run.processes().is_empty() {
        assert!(begin.elapsed() < Duration::from_secs(30), "still there: {:?}", run.processes());
        thread::sleep(PAUSE);
    }
    assert_eq!(temporary(), 1, "there is nothing to delete");
    let mut next = Running::start(&dir, &arguments);
    next.until_tools_sleep();
    assert_eq!(temporary(), 1, "what the killed run has left is still there");
    next.interrupted_by(Signal::INT);
    assert_eq!(temporary(), 0);
}

#[test]
fn what_faults_of_the_verilog_are_shown_to_ends() {
    let dir = with_endless(&["iverilog", "vvp", "verilator", "yosys"]);
    dir.write("core.toml", NARROW);
    fs::create_dir_all(dir.at("records")).expect("a directory");
    let arguments = ["mutate", "core.toml", "--full", "--out", "records"];
    let mut run = Running::start(&dir, &arguments);
    run.until_tools_sleep();
    run.end(Signal::INT, 130);
}

#[test]
fn checks_without_tools_end_too() {
    let worst = ["worst", "core.toml", "--starts", "1e9", "--out", "records"];
    let commands = [&["mutate", "core.toml"][..], &["cosim", "core.toml", "--exhaustive"], &worst];
    for arguments in commands {
        let dir = Workspace::with("core.toml", COSINE_POWER);
        let run = Running::start(&dir, arguments);
        // The signals are listened to from the start of the program on.
        thread::sleep(Duration::from_millis(700));
        run.end(Signal::INT, 130);
    }
}

/// As `nohup` starts it, and as a shell starts what runs in the background.
#[test]
fn an_ignored_signal_stays_ignored() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let program = env!("CARGO_BIN_EXE_glint");
    let script = format!("trap '' HUP; (sleep 0.3; kill -HUP $$) & exec '{program}' \"$@\"");
    let mut shell = std::process::Command::new("sh");
    shell.current_dir(dir.path()).args(["-c", &script, "sh"]);
    shell.args(["cosim", "core.toml", "--points", "60000"]);
    Run::of(shell.output()).good();
}

#[test]
fn a_proof_keeps_what_is_done() {
    let config = "device = \"cosine-power\"\n[cosine]\nfraction = 18\n[exponent]\nbits = 8\n[domain]\nexponent_max = 255\n";
    let dir = Workspace::with("core.toml", config);
    let arguments = ["cosim", "core.toml", "--exhaustive", "--resume", "state.json"];
    let mut run = Running::start(&dir, &arguments);
    run.until("state", |run| run.dir.at("state.json").exists());
    thread::sleep(Duration::from_millis(300));
    let ended = run.interrupted_by(Signal::INT);
    ended.refused(130, &["evaluations remain", "state.json"]);
    dir.assert_no_staging();
    let state: serde_json::Value = dir.json("state.json");
    let done = state["state"]["f"]["done"].count();
    assert!(done > 0, "nothing was kept: {state}");

    let resumed = dir.done(arguments);
    let whole = dir.done(["cosim", "core.toml", "--exhaustive"]);
    let last = |text: &str| text.lines().last().expect("a line").to_owned();
    assert_eq!(last(&resumed), last(&whole));
}

/// Operands of 40 bits take days on any machine: 2^40 evaluations.
#[test]
fn a_long_proof_says_beforehand_how_long_it_takes() {
    let config = "device = \"expression\"\noperands.x = { bits = 16, fraction = 15 }\n\
                  operands.y = { bits = 16, fraction = 15 }\noperands.z = { bits = 8, fraction = 8 }\n\
                  results.s = { formula = \"x*y + z\", fraction = 15 }\n";
    let dir = Workspace::with("core.toml", config);
    let arguments = ["cosim", "core.toml", "--exhaustive", "--resume", "state.json"];
    let mut run = Running::start(&dir, &arguments);
    run.until("state", |run| run.dir.at("state.json").exists());
    let ended = run.interrupted_by(Signal::INT);
    for part in [
        "1 099 511 627 776 evaluations",
        "on 1 000 cores",
        "Ctrl-C stops the check; the same command continues it from `state.json`",
    ] {
        assert!(ended.out.contains(part), "{part}: {ended:?}");
    }
}

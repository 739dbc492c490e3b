//! Tests how tools are run. Shell scripts take the place of tools, and misbehave in every way in which a real tool might
//! misbehave.

use std::io::Write;
use std::path::PathBuf;

use super::bench::run_bench_in;
use super::*;

/// A directory of scripts that serves as `PATH`.
struct Fakes(tempfile::TempDir);

impl Fakes {
    fn new(scripts: &[(&str, &str)]) -> Self {
        let dir = tempfile::tempdir().unwrap();
        for (name, script) in scripts {
            // A shell writes the file: while this process had it open for writing, another test's
            // fork could inherit it, and then the file is busy and does not run.
            let mut shell = Command::new("/bin/sh")
                .args(["-c", "cat > \"$0\" && chmod +x \"$0\"", name])
                .current_dir(&dir)
                .stdin(Stdio::piped())
                .spawn()
                .unwrap();
            let mut input = shell.stdin.take().unwrap();
            write!(input, "#!/bin/sh\n{script}\n").unwrap();
            drop(input);
            assert!(shell.wait().unwrap().success());
        }
        Self(dir)
    }

    fn tool(&self, name: &str) -> Tool {
        Tool::find_in(name, self.0.path().as_os_str()).unwrap()
    }

    fn run(&self, name: &str, limit: Duration) -> Result<Run> {
        self.tool(name).run([] as [&str; 0], self.0.path(), limit)
    }

    fn bench(&self, simulator: VerilogSimulator) -> Result<BenchOutcome> {
        let files = [("tb.v", "module tb; endmodule\n"), ("rom.mem", "0\n")];
        run_bench_in(self.0.path().as_os_str(), simulator, &files, "tb", LIMIT)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

const LIMIT: Duration = Duration::from_secs(60);

fn message<T>(result: Result<T>) -> String {
    match result {
        Ok(_) => panic!("this should have failed"),
        Err(error) => format!("{error:#}"),
    }
}

#[test]
fn a_missing_tool_is_named_with_its_remedy() {
    let fakes = Fakes::new(&[]);
    std::fs::write(fakes.file("iverilog"), "not executable").unwrap();
    for simulator in [VerilogSimulator::Icarus, VerilogSimulator::Verilator] {
        let text = message(fakes.bench(simulator));
        let name = if simulator == VerilogSimulator::Icarus { "`iverilog`" } else { "`verilator`" };
        assert!(text.contains(name) && text.contains("bash tools/install"), "{text}");
    }
}

#[test]
fn a_file_that_is_no_program_does_not_start() {
    let fakes = Fakes::new(&[("tool", "")]);
    std::fs::write(fakes.file("tool"), [0x7f, b'E', b'L', b'F', 0, 0]).unwrap();
    let text = message(fakes.run("tool", LIMIT));
    assert!(text.contains("cannot start") && text.contains("tool"), "{text}");
}

#[test]
fn a_failing_tool_is_quoted_to_its_last_line() {
    let script = "seq 1 100\necho 'to standard error' >&2\nexit 3";
    let fakes = Fakes::new(&[("tool", script)]);
    let run = fakes.run("tool", LIMIT).unwrap();
    assert_eq!(run.status.code(), Some(3));
    let text = message(fakes.tool("tool").run_to_success([] as [&str; 0], fakes.0.path(), LIMIT));
    assert!(text.contains("`tool` failed (exit status: 3)"), "{text}");
    assert!(text.contains("\n    99\n    100\n    to standard error"), "{text}");
    assert!(!text.contains("    50\n"), "only the last lines: {text}");
}

#[test]
fn a_hanging_tool_is_killed_with_its_children() {
    let script = "sleep 600 &\necho $! > child\necho started\nwait";
    let fakes = Fakes::new(&[("tool", script)]);
    let before = Instant::now();
    let text = message(fakes.run("tool", Duration::from_secs(1)));
    assert!(before.elapsed() < Duration::from_secs(5), "{:?}", before.elapsed());
    assert!(text.contains("`tool` did not end within 1s"), "{text}");
    assert!(text.contains("\n    started"), "{text}");
    let child = std::fs::read_to_string(fakes.file("child")).unwrap();
    let alive = || {
        // A killed orphan may stay a zombie until its new parent collects it.
        std::fs::read_to_string(format!("/proc/{}/stat", child.trim()))
            .is_ok_and(|stat| !stat.contains(") Z "))
    };
    let deadline = Instant::now() + Duration::from_secs(5);
    while alive() && Instant::now() < deadline {
        thread::sleep(Duration::from_millis(10));
    }
    assert!(!alive(), "process {child} is still there");
}

#[test]
fn a_tool_that_closes_its_output_and_stays_is_killed_too() {
    let fakes = Fakes::new(&[("tool", "exec > /dev/null 2>&1\nsleep 600")]);
    let text = message(fakes.run("tool", Duration::from_millis(300)));
    assert!(text.contains("did not end within 300ms"), "{text}");
    assert!(text.contains("printed nothing"), "{text}");
}

#[test]
fn endless_output_ends_with_the_time_limit() {
    let fakes = Fakes::new(&[("tool", "exec yes endless")]);
    let text = message(fakes.run("tool", Duration::from_millis(500)));
    assert!(text.contains("did not end within 500ms"), "{text}");
    assert!(text.len() < 5000, "{} bytes", text.len());
}

#[test]
fn of_enormous_output_both_ends_are_kept() {
    let script = "echo beginning\nyes 0123456789 | head -c 50000000\necho\necho the end";
    let fakes = Fakes::new(&[("tool", script)]);
    let run = fakes.run("tool", LIMIT).unwrap();
    assert!(run.status.success());
    assert!(run.output.starts_with("beginning\n0123456789\n"));
    assert!(run.output.ends_with("\nthe end\n"));
    assert!(run.output.len() < 1_200_000, "{}", run.output.len());
    // Everything is either kept or counted: 10 + 50 000 000 + 1 + 8 bytes.
    let note = run.output.lines().find(|line| line.contains("left out")).unwrap();
    let left_out: usize = note.split(' ').nth(1).unwrap().parse().unwrap();
    assert_eq!(run.output.len() - note.len() - 2 + left_out, 50_000_019);
}

#[test]
fn garbage_is_kept_readable() {
    let script = "printf '\\377\\376\\033[31m\\000 garbage \\007\\n'\nexit 1";
    let fakes = Fakes::new(&[("iverilog", script), ("vvp", "")]);
    let text = message(fakes.bench(VerilogSimulator::Icarus));
    assert!(text.contains("Icarus Verilog cannot build the bench `tb`"), "{text}");
    assert!(text.contains(" garbage ") && text.contains('\u{fffd}'), "{text}");
    assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{text:?}");
}

#[test]
fn the_verdict_is_a_line_and_the_exit_status_counts() {
    let verdict =
        |vvp: &str| Fakes::new(&[("iverilog", ""), ("vvp", vvp)]).bench(VerilogSimulator::Icarus);
    for (script, passed) in [
        ("echo PASS", true),
        ("echo 'PASS: rough, 1000 clocks'; echo done", true),
        ("echo 'FAIL: clock 7'; exit 1", false),
        ("echo FAIL", false),
        ("echo PASS; echo FAIL", false),
    ] {
        let outcome = verdict(script).unwrap();
        assert_eq!(outcome.passed, passed, "{script}");
        assert!(outcome.transcript.contains(if passed { "PASS" } else { "FAIL" }));
        assert!(outcome.build.is_empty());
    }
    for (script, expected) in [
        ("echo PASS; exit 1", "printed PASS and then failed"),
        ("echo PASSED", "without a PASS or FAIL line"),
        ("echo 'no PASS here'", "without a PASS or FAIL line"),
        ("", "printed nothing"),
        ("kill -SEGV $$", "signal: 11"),
    ] {
        let text = message(verdict(script));
        assert!(text.contains(expected), "{script}: {text}");
    }
}

#[test]
fn verilator_s_program_is_run_and_its_verdict_read() {
    let build =
        "mkdir build\nprintf '#!/bin/sh\\necho PASS\\n' > build/bench\nchmod +x build/bench";
    let fakes = Fakes::new(&[("verilator", &format!("{build}\necho \"$@\""))]);
    let outcome = fakes.bench(VerilogSimulator::Verilator).unwrap();
    assert!(outcome.passed);
    assert!(outcome.build.ends_with(" tb.v\n"), "only sources are compiled: {}", outcome.build);
    let text = message(Fakes::new(&[("verilator", "")]).bench(VerilogSimulator::Verilator));
    assert!(text.contains("made no program of `tb`"), "{text}");
}

#[test]
fn only_plain_distinct_names_are_written() {
    let fakes = Fakes::new(&[("iverilog", ""), ("vvp", "echo PASS")]);
    let run = |names: &[&str]| {
        let files: Vec<_> = names.iter().map(|name| (name, "")).collect();
        run_bench_in(fakes.0.path().as_os_str(), VerilogSimulator::Icarus, &files, "tb", LIMIT)
    };
    assert!(run(&["a.v", "b.mem"]).is_ok());
    for names in [&["../a.v"][..], &["/tmp/a.v"], &["-o.v"], &[""], &[".."], &["a/b.v"]] {
        assert!(message(run(names)).contains("not a plain file name"), "{names:?}");
    }
    assert!(message(run(&["a.v", "a.v"])).contains("two files"));
    assert!(message(run(&["a.mem"])).contains("is a Verilog file"));
}

#[test]
fn the_version_is_the_first_line() {
    let fakes = Fakes::new(&[
        ("yosys", "[ \"$1\" = --version ] && printf '\\nYosys 0.23\\nmore\\n'"),
        ("iverilog", "[ \"$1\" = -V ] && echo 'Icarus Verilog version 11.0'"),
        ("silent", ""),
    ]);
    let version = |name| fakes.tool(name).version();
    assert_eq!(version("yosys").unwrap(), "Yosys 0.23");
    assert_eq!(version("iverilog").unwrap(), "Icarus Verilog version 11.0");
    assert!(message(version("silent")).contains("printed nothing"));
}

#[test]
fn the_first_difference_is_read() {
    let line = "clock 12, microinstruction 3 (say: 100% (result)): red_out is 1x, expected 20";
    let transcript = format!(
        "VCD info\n{line}\nclock 13, microinstruction unknown: busy is 0, expected 1\nFAIL x\n"
    );
    let found = BenchDifference::first(&transcript).unwrap();
    assert_eq!((found.clock, found.during.as_str()), (12, "microinstruction `say: 100% (result)`"));
    assert_eq!(
        (found.signal.as_str(), found.simulated.as_str(), found.expected.as_str()),
        ("red_out", "1x", "20")
    );
    let lost = BenchDifference::first("clock 13, microinstruction unknown: busy is 0, expected 1")
        .unwrap();
    assert_eq!((lost.during.as_str(), lost.signal.as_str()), ("", "busy"));
    let pipeline = BenchDifference::first("clock 14: out_valid is 1, expected 0").unwrap();
    assert_eq!((pipeline.clock, pipeline.during.as_str()), (14, ""));
    assert_eq!((pipeline.signal.as_str(), pipeline.expected.as_str()), ("out_valid", "0"));
    for text in ["", "PASS x: 3 clocks, no difference", "clock , x", "clock 1, a: b"] {
        assert_eq!(BenchDifference::first(text), None, "{text}");
    }
}

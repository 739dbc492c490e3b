//! Tests how the tests run Icarus Verilog, Verilator and Yosys, with a small bench that passes, that fails, or that never ends.

use std::fs;
use std::time::Duration;

use crate::common::Sure;
use crate::common::tools;
use glint::tools::{VerilogSimulator, run_bench};

const COUNTER: &str = include_str!("benches/counter.v");

/// Counts five clocks and compares with `expected`; `wait` may be a wait without end.
fn bench(expected: &str, wait: &str) -> Vec<(String, String)> {
    let bench = include_str!("benches/counts.v");
    let bench = bench.replace("WAIT", wait).replace("EXPECTED", expected);
    vec![("counter.v".into(), COUNTER.into()), ("tb.v".into(), bench)]
}

const BOTH: [VerilogSimulator; 2] = [VerilogSimulator::Icarus, VerilogSimulator::Verilator];

#[test]
fn a_right_bench_passes() {
    for simulator in BOTH {
        let outcome = tools::assert_bench_passes(simulator, &bench("4'd5", ""), "tb");
        assert!(outcome.transcript.starts_with("PASS: 5 clocks\n"), "{}", outcome.transcript);
    }
}

#[test]
fn a_wrong_bench_fails() {
    for simulator in BOTH {
        let outcome = run_bench(simulator, &bench("4'd6", ""), "tb", tools::LIMIT).unwrap();
        assert!(!outcome.passed);
        assert!(outcome.transcript.contains("FAIL: count is 5"), "{}", outcome.transcript);
    }
}

#[test]
fn an_endless_bench_is_killed() {
    let limit = Duration::from_secs(2);
    let endless = bench("4'd5", "forever @(negedge clk);");
    let error = run_bench(VerilogSimulator::Icarus, &endless, "tb", limit).unwrap_err();
    assert!(format!("{error:#}").contains("`vvp` did not end within"), "{error:#}");
}

#[test]
fn bad_verilog_is_quoted() {
    for simulator in BOTH {
        let error = run_bench(simulator, &bench("nothing", ""), "tb", tools::LIMIT).unwrap_err();
        let text = format!("{error:#}");
        assert!(text.contains("tb.v:11") && text.contains("nothing"), "{text}");
    }
}

#[test]
fn lint_tells_clean_from_dubious() {
    let dir = tempfile::tempdir().unwrap();
    let write = |text: &str| fs::write(dir.path().join("counter.v"), text).unwrap();
    write(COUNTER);
    tools::assert_lint_clean(dir.path(), "counter");
    write(&COUNTER.replace("4'd1", "5'd1"));
    let lint = || tools::assert_lint_clean(dir.path(), "counter");
    assert!(std::panic::catch_unwind(lint).is_err(), "a width mismatch went through");
}

#[test]
fn yosys_synthesises_and_refuses_latches() {
    let dir = tempfile::tempdir().unwrap();
    let write = |text: &str| fs::write(dir.path().join("counter.v"), text).unwrap();
    write(COUNTER);
    let protocol = tools::yosys(dir.path(), "read_verilog counter.v; synth_ice40 -top counter");
    assert!(protocol.contains("SB_DFF"), "{protocol}");
    let latch =
        COUNTER.replace("posedge clk", "*").replace("else        count <= count + 4'd1;", "");
    write(&latch);
    let commands = "read_verilog counter.v; proc; select -assert-none t:$dlatch";
    let check = || tools::yosys(dir.path(), commands);
    let panic = std::panic::catch_unwind(check).expect_err("a latch went through");
    let text = panic.downcast_ref::<String>().expect("a message");
    assert!(text.contains("t:$dlatch") && text.contains("count"), "{text}");
}

#[test]
fn every_tool_of_the_install_script_answers() {
    for name in ["iverilog", "vvp", "verilator", "yosys", "nextpnr-ice40", "fusesoc"] {
        let version = tools::tool(name).version().sure();
        assert!(version.contains(|c: char| c.is_ascii_digit()), "{name}: {version}");
    }
}

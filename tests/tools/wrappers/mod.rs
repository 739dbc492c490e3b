//! Wrappers around cores: clean Verilog, proved, and with the bus models of others.

use std::fs;
use std::path::Path;

use crate::common::cores::{Emitted, all_configurations, configuration_between, write};
use crate::common::tools::{LIMIT, assert_lint_clean, tool};
use glint::core::Core;
use glint::tools::prove;
use rayon::prelude::*;

/// Bits of tuser in these tests.
const STREAM: &str = "stream = true\nuser_bits = 9\n";

/// The same of a core whose operands have buffers.
const BUFFERED: &str = "stream = true\nuser_bits = 9\n[operands]\nbuffered = true\n";

/// Configurations of which the wrapper is proved: a core of each kind that a wrapper knows.
const PROVED: [(&str, &str); 5] = [
    ("cosine_power", STREAM),
    ("quad_cosine", STREAM),
    ("cosine_power_pipelined", STREAM),
    ("cosine_power", BUFFERED),
    ("quad_cosine", BUFFERED),
];

/// Every configuration with these keys in its table `interface`.
fn with_interface(keys: &str) -> Vec<(String, Core)> {
    let with = |(path, _): (String, Core)| {
        let core = configuration_between(&path, keys);
        (path, core)
    };
    all_configurations().into_iter().map(with).collect()
}

#[test]
fn streams_are_clean_verilog() {
    with_interface(STREAM).par_iter().for_each(|(path, core)| {
        let emitted = Emitted::new(core, 1, 1);
        let place = tempfile::tempdir().expect("a directory");
        write(place.path(), &emitted.rtl());
        assert_lint_clean(place.path(), &format!("{}_axis", emitted.name));
        for file in emitted.files.iter().filter(|file| file.path.contains("_axis")) {
            let long = file.contents.lines().find(|line| line.len() > 100);
            assert_eq!(long, None, "{path}: {}", file.path);
        }
    });
}

#[test]
fn streams_are_proved() {
    PROVED.par_iter().for_each(|(name, keys)| {
        let place = proof(name, keys);
        prove(place.path(), &format!("{name}_axis"), LIMIT)
            .unwrap_or_else(|error| panic!("{name}, {keys}: {error:#}"));
    });
}

/// A fault: of which configuration, what stands in the wrapper, and what stands there instead.
type Fault = (&'static str, &'static str, &'static str);

const FAULTS: [Fault; 16] = [
    // Taken without room, begun twice, never begun.
    ("cosine_power", "s_axis_tready <= ~still_waiting;", "s_axis_tready <= 1'b1;"),
    ("cosine_power", "waiting <= still_waiting;", "waiting <= accept | waiting;"),
    ("cosine_power", "wire start = waiting & ~busy & room;", "wire start = waiting & room;"),
    ("cosine_power", "assign room = ~held;", "assign room = 1'b1;"),
    // Offers that change, that vanish, and that overtake.
    ("cosine_power", "wire offer = m_axis_tready | ~m_axis_tvalid;", "wire offer = 1'b1;"),
    ("cosine_power", "m_axis_tvalid <= held | valid;", "m_axis_tvalid <= valid;"),
    ("cosine_power", "held ? held_results : results;", "results;"),
    // A side channel of another point, and one of a packet.
    ("cosine_power", "held ? held_user : user;", "user;"),
    ("cosine_power", "last <= operands_last;", "last <= s_axis_tlast;"),
    // Lines: one that has no room, points over others, a last point that is not.
    (
        "quad_cosine",
        "assign room = free > {1'b0, length};",
        "assign room = free >= {1'b0, length};",
    ),
    ("quad_cosine", "wire last = following == next_line;", "wire last = write_at == next_line;"),
    ("quad_cosine", "if (read) read_at <=", "if (offer) read_at <="),
    // Pipelines.
    ("cosine_power_pipelined", "wire ready = ~held;", "wire ready = m_axis_tready;"),
    (
        "cosine_power_pipelined",
        "if (!held) begin\n            held_results",
        "if (valid) begin\n            held_results",
    ),
    (
        "cosine_power_pipelined",
        "if (s_axis_tready) begin\n            side",
        "if (1'b1) begin\n            side",
    ),
    (
        "cosine_power_pipelined",
        ".in_valid(s_axis_tvalid)",
        ".in_valid(s_axis_tvalid & m_axis_tready)",
    ),
];

/// Of cores whose operands have buffers.
const BUFFERED_FAULTS: [Fault; 3] = [
    // Begun over a computation, and without room for a result that comes.
    ("cosine_power", "(~busy | done)", "(~busy | valid)"),
    ("quad_cosine", "(~busy | done)", "(~busy | valid)"),
    ("cosine_power", "~held & (offer | ~valid)", "~held"),
];

#[test]
fn faults_break_the_proofs() {
    let faults = |faults: &'static [Fault], keys| faults.iter().map(move |fault| (fault, keys));
    let faults: Vec<(&Fault, &str)> =
        faults(&FAULTS, STREAM).chain(faults(&BUFFERED_FAULTS, BUFFERED)).collect();
    faults.par_iter().for_each(|((name, right, wrong), keys)| {
        fault_breaks_the_proof(name, keys, "axis", right, wrong);
    });
}

fn fault_breaks_the_proof(name: &str, keys: &str, wrapper: &str, right: &str, wrong: &str) {
    let place = proof(name, keys);
    let path = place.path().join(format!("{name}_{wrapper}.v"));
    let text = fs::read_to_string(&path).expect("a file");
    assert!(text.contains(right), "`{right}` is not in {name}_{wrapper}.v");
    fs::write(&path, text.replace(right, wrong)).expect("written");
    let proof = prove(place.path(), &format!("{name}_{wrapper}"), LIMIT);
    assert!(proof.is_err(), "`{wrong}` in {name}_{wrapper}.v is proved");
}

/// The wrapper of a configuration, and what is proved of it, in a directory of their own.
fn proof(name: &str, keys: &str) -> tempfile::TempDir {
    let core = configuration_between(&format!("configs/{name}.toml"), keys);
    let place = tempfile::tempdir().expect("a directory");
    for file in Emitted::new(&core, 1, 1).files {
        fs::write(place.path().join(file.name()), &file.contents).expect("written");
    }
    place
}

/// Source and sink of cocotbext-axi.
#[test]
fn streams_carry_every_point() {
    with_interface(STREAM).par_iter().for_each(|(path, core)| {
        let place = emitted(core);
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/wrappers/stream.py");
        let run = tool("python").run([script, &core.config.name], place.path(), LIMIT);
        let run = run.unwrap_or_else(|error| panic!("{error:#}"));
        let says = format!("PASS {}: 6 tests, 0 failed", core.config.name);
        assert!(run.status.success() && run.output.contains(&says), "{path}:\n{}", run.output);
    });
}

/// The files of a configuration below a directory of their own.
fn emitted(core: &Core) -> tempfile::TempDir {
    let place = tempfile::tempdir().expect("a directory");
    for file in Emitted::new(core, 1, 1).files {
        let path: &Path = &place.path().join(&file.path);
        fs::create_dir_all(path.parent().expect("a directory")).expect("a directory");
        fs::write(path, &file.contents).expect("written");
    }
    place
}

/// Buses, each with the key and what its wrapper is called after.
const BUSES: [(&str, &str); 2] =
    [("registers = \"axi-lite\"\n", "axil"), ("registers = \"wishbone\"\n", "wb")];

/// Every default configuration of a core that computes a point at a time by a microprogram, on each bus.
fn on_buses() -> Vec<(String, Core, &'static str)> {
    let points = |core: &Core| core.design.pipeline.is_none() && core.contract.length().is_none();
    let paths: Vec<String> = all_configurations()
        .into_iter()
        .filter(|(path, core)| points(core) && !path.contains("studies"))
        .map(|(path, _)| path)
        .collect();
    let of_bus = |(keys, bus): (&str, &'static str)| {
        let of_path = |path: &String| (path.clone(), configuration_between(path, keys), bus);
        paths.iter().map(of_path).collect::<Vec<_>>()
    };
    BUSES.into_iter().flat_map(of_bus).collect()
}

#[test]
fn registers_are_clean_verilog() {
    on_buses().par_iter().for_each(|(path, core, bus)| {
        let emitted = Emitted::new(core, 1, 1);
        let place = tempfile::tempdir().expect("a directory");
        write(place.path(), &emitted.rtl());
        assert_lint_clean(place.path(), &format!("{}_{bus}", emitted.name));
        let of_registers = |path: &str| {
            ["_axil", "_wb", "_registers", ".rdl"].iter().any(|part| path.contains(part))
        };
        for file in emitted.files.iter().filter(|file| of_registers(&file.path)) {
            assert!(file.contents.is_ascii(), "{path}: {} is not ASCII", file.path);
            let long = file.contents.lines().find(|line| line.len() > 120);
            assert_eq!(long, None, "{path}: {}", file.path);
        }
    });
}

#[test]
fn registers_are_proved() {
    // Operands of more than 32 bits, and results that fill several registers, too.
    let proved = ["cosine_power", "lyon", "blinn", "rough"];
    proved.par_iter().for_each(|name| {
        for (keys, bus) in BUSES {
            let place = proof(name, keys);
            for wrapper in [bus, "registers"] {
                prove(place.path(), &format!("{name}_{wrapper}"), LIMIT)
                    .unwrap_or_else(|error| panic!("{name}_{wrapper}: {error:#}"));
            }
        }
    });
}

/// What stands in the registers, and what stands there instead.
const REGISTER_FAULTS: [(&str, &str); 15] = [
    // Starts without being asked, twice, or over a computation; waits for no reason.
    ("start <= write_answer & starts;", "start <= write_answer & starts | start & ~busy;"),
    ("start <= write_answer & starts;", "start <= write & starts;"),
    ("write & ~(starts & under_way)", "write"),
    ("write & ~(starts & under_way)", "write & ~under_way"),
    ("wire under_way = start | busy;", "wire under_way = busy;"),
    // Results of a computation that is under way.
    ("read & ~(read_result & under_way)", "read"),
    // A map with other places, and one without errors.
    ("assign read_error = ~readable;", "assign read_error = 1'b0;"),
    ("assign write_error = ~writable;", "assign write_error = 1'b0;"),
    ("(write_at == 4'd12);", "(write_at == 4'd12) | (write_at == 4'd13);"),
    // Another register than the one that was asked for.
    ("reads[9] <= read_at == 4'd9;", "reads[9] <= read_at == 4'd8;"),
    ("reads[9] <= read_at == 4'd9;", "reads[9] <= read & (read_at == 4'd9);"),
    // Bytes and registers that were not written.
    ("if (write_at == 4'd9 & write_bytes[1])", "if (write_at == 4'd9)"),
    ("if (write_at == 4'd9 & write_bytes[1])", "if (write_bytes[1])"),
    // An interrupt that gets lost, and one that stays.
    ("if (done) begin", "if (done & ~write_answer) begin"),
    (
        "write_bytes[0] & write_data[0]) begin\n                interrupt_pending",
        "1'b0) begin\n                interrupt_pending",
    ),
];

/// And on the buses.
const BUS_FAULTS: [(&str, &str, &str); 11] = [
    ("axil", "assign s_axil_awready = write_taken;", "assign s_axil_awready = 1'b1;"),
    ("axil", "write_taken | (s_axil_bvalid & ~s_axil_bready)", "write_taken"),
    ("axil", "write_taken | (s_axil_bvalid & ~s_axil_bready)", "write_taken | s_axil_bvalid"),
    ("axil", "s_axil_awvalid & s_axil_wvalid &", "s_axil_awvalid &"),
    ("axil", "& ~write_taken", ""),
    ("axil", "& (s_axil_rready | ~s_axil_rvalid)", ""),
    ("axil", "if (s_axil_arready) s_axil_rdata", "if (read_answer) s_axil_rdata"),
    ("axil", "if (write_answer) s_axil_bresp", "if (read_answer) s_axil_bresp"),
    ("wb", "& ~wb_ack_o & ~wb_err_o", ""),
    ("wb", "wire error = write ? write_error : read_error;", "wire error = write_error;"),
    ("wb", "wb_cyc_i & wb_stb_i &", "wb_stb_i &"),
];

#[test]
fn faults_break_the_proofs_of_registers() {
    REGISTER_FAULTS.par_iter().for_each(|(right, wrong)| {
        fault_breaks_the_proof("cosine_power", BUSES[0].0, "registers", right, wrong);
    });
    BUS_FAULTS.par_iter().for_each(|(bus, right, wrong)| {
        let (keys, _) = BUSES.into_iter().find(|(_, other)| other == bus).expect("a bus");
        fault_breaks_the_proof("cosine_power", keys, bus, right, wrong);
    });
}

/// The masters of cocotbext-axi and cocotbext-wishbone.
#[test]
fn registers_start_cores_and_give_their_results() {
    on_buses().par_iter().for_each(|(path, core, bus)| {
        let place = emitted(core);
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/wrappers/registers.py");
        let run = tool("python").run([script, &core.config.name, bus], place.path(), LIMIT);
        let run = run.unwrap_or_else(|error| panic!("{error:#}"));
        let says = format!("PASS {}: 8 tests, 0 failed", core.config.name);
        assert!(run.status.success() && run.output.contains(&says), "{path}:\n{}", run.output);
    });
}

/// What the header's conversions give, by hand: 1.0; a tie, upward; one below a tie; negative; too large.
const CONVERSIONS: &str = r#"
#include "cosine_power_registers.h"
int main(void)
{
    const uint32_t seen[] = {
        cosine_power_cos_gamma_from_fixed(INT64_C(1) << 30, 30),
        cosine_power_cos_gamma_from_fixed(3, 21),
        cosine_power_cos_gamma_from_fixed(5, 22),
        cosine_power_cos_gamma_from_fixed(-1, 2),
        cosine_power_cos_gamma_from_fixed(INT64_MAX, 0),
        cosine_power_exponent_from_fixed(INT64_C(1023) << 20, 20),
        cosine_power_exponent_from_fixed(INT64_C(1024) << 20, 20),
    };
    const uint32_t wanted[] = {1u << 20, 2, 1, 0, 0x1fffff, 1023, 1023};
    for (unsigned at = 0; at < sizeof seen / sizeof *seen; at++) {
        if (seen[at] != wanted[at]) {
            return (int)at + 1;
        }
    }
    return COSINE_POWER_REG_RESULTS == 0x34u && COSINE_POWER_RESULTS_BLUE_OUT_SHIFT == 16 ? 0 : 99;
}
"#;

/// The same in Rust.
const RUST_CONVERSIONS: &str = r#"
#[deny(warnings)]
#[allow(dead_code)]
#[path = "cosine_power_registers.rs"]
mod registers;
use registers::{cos_gamma_from_fixed, exponent_from_fixed};
fn main() {
    assert_eq!(cos_gamma_from_fixed(1 << 30, 30), 1 << 20);
    assert_eq!(cos_gamma_from_fixed(3, 21), 2);
    assert_eq!(cos_gamma_from_fixed(5, 22), 1);
    assert_eq!(cos_gamma_from_fixed(-1, 2), 0);
    assert_eq!(cos_gamma_from_fixed(i64::MAX, 0), 0x1fffff);
    assert_eq!(exponent_from_fixed(1024 << 20, 20), 1023);
    assert_eq!((registers::REG_RESULTS, registers::RESULTS_BLUE_OUT_SHIFT), (0x34, 16));
}
"#;

#[test]
fn registers_for_software() {
    let core = configuration_between("configs/cosine_power.toml", BUSES[1].0);
    let place = emitted(&core);
    let place = &place.path().join("software/cosine_power");
    fs::write(place.join("main.c"), CONVERSIONS).expect("written");
    fs::write(place.join("main.rs"), RUST_CONVERSIONS).expect("written");
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
    let sanitized = ["-fsanitize=undefined", "-fno-sanitize-recover", "main.c", "-o", "main_c"];
    let run = |name: &str, arguments: &[&str]| {
        tool(name)
            .run_to_success(arguments.iter().copied(), place, LIMIT)
            .unwrap_or_else(|error| panic!("{name}: {error:#}"))
    };
    run("cc", &[&strict[..], &sanitized].concat());
    run("rustc", &["--edition=2021", "main.rs", "-o", "main_rs"]);
    for program in ["./main_c", "./main_rs"] {
        run("sh", &["-c", program]);
    }
    // Nothing of `std` is used.
    let bare = "#![no_std]\n#[path = \"cosine_power_registers.rs\"]\npub mod registers;\n";
    fs::write(place.join("bare.rs"), bare).expect("written");
    run("rustc", &["--edition=2021", "--crate-type=lib", "--emit=metadata", "bare.rs"]);
    // PeakRDL puts every register where Glint does.
    let made = [("c-header", "peak.h"), ("ip-xact", "peak.xml"), ("html", "peak")];
    for (kind, to) in made {
        run("peakrdl", &[kind, "cosine_power.rdl", "-o", to]);
    }
    let xml = fs::read_to_string(place.join("peak.xml")).expect("IP-XACT");
    for (register, offset) in [("control", "'h14"), ("cos_gamma", "'h20"), ("results", "'h34")] {
        let says = format!("<ipxact:name>{register}</ipxact:name>");
        let at = xml.find(&says).unwrap_or_else(|| panic!("no {register} in {xml}"));
        let offset = format!("<ipxact:addressOffset>{offset}</ipxact:addressOffset>");
        assert!(xml[at..].contains(&offset), "{register}: {xml}");
    }
    assert!(place.join("peak/index.html").exists());
}

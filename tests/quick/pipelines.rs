//! Tests the structure of the shipped pipelines: all registers move together, and logic combines only values of its own stage.
//!
//! The first test leaves out pipelines with an interval above 1, whose registers load in different slots. Further tests cover
//! faults in a pipeline and delay lines.

use glint::hdl::netlist::{Driver, NetId, Op, Role};
use glint::mutate::{self, Faults, MutantVerdict, NetlistFault};
use glint::package::{self, EmitInputs};
use regex::Regex;

use crate::common::cores::{all_configurations, configuration_with, pipelines};
use crate::common::sample::sampled;

#[test]
fn values_of_a_stage_are_made_of_values_of_this_stage_and_all_registers_move_together() {
    for (path, unit) in pipelines() {
        let design = &unit.design;
        let pipeline = design.pipeline.as_ref().expect("a pipeline");
        // With a longer interval, registers load in one slot alone, and a value waits in its register.
        if pipeline.interval > 1 {
            continue;
        }
        let Driver::Register(first) = design.net(pipeline.valid[0]).driver else {
            panic!("{path}: stage 1 does not remember whether it has a point")
        };
        let advance = design.register(first).enable;
        assert_eq!(advance.is_some(), pipeline.stall, "{path}");
        let stage = |net: NetId| pipeline.clock_of(net);
        let constant = |net: &NetId| matches!(design.net(*net).driver, Driver::Constant(_));
        for (id, net) in design.iter() {
            let what = || format!("{path}: `{}`", net.name);
            let follows = |from: NetId| assert_eq!(stage(id), stage(from) + 1, "{}", what());
            match &net.driver {
                Driver::Op(_) if pipeline.handshake.contains(&id) => {}
                Driver::Op(op) => {
                    for from in op.operands().iter().filter(|it| !constant(it)) {
                        assert_eq!(stage(id), stage(*from), "{}", what());
                    }
                }
                Driver::Register(register) => {
                    let register = design.register(*register);
                    register.data.iter().for_each(|&data| follows(data));
                    assert_eq!(register.enable, advance, "{}", what());
                    assert_eq!(
                        register.reset.is_some(),
                        pipeline.valid.contains(&id),
                        "{}",
                        what()
                    );
                }
                Driver::Rom(rom) => {
                    let rom = design.rom(*rom);
                    if rom.synchronous {
                        follows(rom.address);
                        assert_eq!(rom.enable, advance, "{}", what());
                    } else {
                        assert_eq!(stage(id), stage(rom.address), "{}", what());
                    }
                }
                Driver::Input => assert_eq!(stage(id), 0, "{}", what()),
                Driver::Constant(_) => {}
                other => panic!("{}: {other:?}", what()),
            }
        }
        let outputs = design.outputs().filter(|port| port.role == Role::Result);
        for port in outputs {
            assert_eq!(stage(port.net), pipeline.stages.len(), "{path}");
        }
    }
}

/// In a narrow pipeline every fault that a point shows is caught, and of a sample of all faults most, the rest proved.
#[test]
fn faults_of_a_pipeline_are_noticed_or_proved() {
    let core =
        configuration_with("configs/reduced/cosine_power.toml", "architecture = \"pipelined\"\n");
    let faults = Faults::of(&core.design);
    let shows = ["valid_s1:no-reset", "valid_s2[0]:inverted", "red_out[0]:inverted"];
    let shows = shows.iter().filter_map(|id| faults.find(id)).collect::<Vec<&NetlistFault>>();
    assert!(shows.len() >= 2, "ids have changed");
    let sample = sampled("faults of a pipeline", faults.iter());
    let known = shows.len();
    let planted: Vec<&NetlistFault> = shows.into_iter().chain(sample).collect();
    let found = mutate::run(&core, planted, &|| ()).expect("they can be simulated");
    for found in &found[..known] {
        assert!(matches!(found.verdict, MutantVerdict::Caught(..)), "{}", found.fault.id);
    }
    let undecided = found.iter().filter(|it| it.verdict == MutantVerdict::Undecided);
    let undecided: Vec<&str> = undecided.map(|it| it.fault.id.as_str()).collect();
    assert!(undecided.len() * 50 < found.len(), "{undecided:?}");
    let caught = found.iter().filter(|it| matches!(it.verdict, MutantVerdict::Caught(..))).count();
    assert!(caught * 2 > found.len(), "{caught} of {}", found.len());
}

/// Registers that a memory replaces can be read by nothing but the register behind them, and it moves when they do.
#[test]
fn delay_lines_are_registers_that_nothing_reads_on_their_way() {
    let mut lines = 0;
    for (path, unit) in pipelines() {
        let design = &unit.design;
        let pipeline = design.pipeline.as_ref().expect("a pipeline");
        for line in design.delay_lines() {
            lines += 1;
            for value in &line.values {
                let mut from = value.data;
                assert_eq!(value.registers.len(), line.to - line.from, "{path}");
                for (at, &register) in value.registers.iter().enumerate() {
                    let register = design.register(register);
                    assert_eq!(register.data, Some(from), "{path}");
                    assert_eq!((register.enable, register.reset), (line.enable, None), "{path}");
                    let stage = pipeline.clock_of(register.q);
                    assert_eq!(stage, line.from + 1 + at, "{path}");
                    from = register.q;
                }
                for &passed in value.passed() {
                    let q = design.register(passed).q;
                    let reads = |op: &Op| op.operands().contains(&q);
                    let cells = design.iter().map(|(_, net)| &net.driver);
                    let cells = cells.filter(|it| matches!(it, Driver::Op(op) if reads(op)));
                    assert_eq!(cells.count(), 0, "{path}: `{}`", design.net(q).name);
                    let taken = design.registers.iter().filter(|it| it.data == Some(q)).count();
                    assert_eq!(taken, 1, "{path}: `{}`", design.net(q).name);
                    assert!(design.roms.iter().all(|rom| rom.address != q), "{path}");
                    assert!(design.ports.iter().all(|port| port.net != q), "{path}");
                }
            }
        }
    }
    assert!(lines >= 8, "{lines} delay lines");
}

/// The words of a memory, with the register behind it, are as many as the stages that a value goes through: names have
/// the stages, and an operand is in stage 0.
#[test]
fn memories_of_delay_lines_have_a_word_less_than_there_are_stages() {
    let lines = Regex::new(
        r"(?s)_delay #\([^;]*\.WORDS\((\d+)\)[^;]*\.entering\(\{?(.*?)\}?\),\s*\.leaving\(\{?(.*?)\}?\)\s*\);",
    );
    let (lines, name) = (lines.expect("a pattern"), Regex::new(r"^\w+$").expect("a pattern"));
    let number = |text: &str| text.parse::<usize>().expect("a number");
    let stage = |name: &str| name.rsplit_once("_s").map_or(0, |(_, stage)| number(stage));
    let mut seen = 0;
    for (path, unit) in all_configurations() {
        let files = package::emit(&unit.design, &EmitInputs::default()).expect("Verilog");
        for found in files.iter().flat_map(|file| lines.captures_iter(&file.contents)) {
            let [enter, leave] =
                [2, 3].map(|at| found[at].split(',').map(str::trim).collect::<Vec<_>>());
            for (enter, leave) in enter.iter().zip(&leave).filter(|(it, _)| name.is_match(it)) {
                let words = stage(leave) - stage(enter) - 1;
                assert_eq!(words, number(&found[1]), "{path}: {enter} to {leave}");
                seen += 1;
            }
        }
    }
    assert!(seen >= 8, "{seen} values");
}

/// Such a word comes late in its clock, and the way into a memory in look-up tables is longer than to a register.
#[test]
fn no_delay_line_in_memory_begins_with_a_word_of_a_block_memory() {
    let mut words = 0;
    for (path, unit) in all_configurations() {
        let design = &unit.design;
        words += design.roms.iter().filter(|rom| rom.synchronous).count();
        for value in design.delay_lines().iter().flat_map(|line| &line.values) {
            let mut from = value.data;
            while let Driver::Op(Op::Slice { of, .. } | Op::Relabel(of) | Op::Extend(of)) =
                design.net(from).driver
            {
                from = of;
            }
            let driver = &design.net(from).driver;
            assert!(
                !matches!(driver, Driver::Rom(rom) if design.roms[rom.index()].synchronous),
                "{path}: `{}`",
                design.net(value.data).name
            );
        }
    }
    assert!(words > 0, "no block memories");
}

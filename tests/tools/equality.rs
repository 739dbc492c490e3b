//! Tests the proofs by an SMT solver that a pipeline and its sequential core compute the same, and that the emitted Verilog and
//! the netlist do.
//!
//! The solver must prove the pipelines in `configs/` and `configs/studies/`, except `rough_up5k_pipelined`, which z3 does not
//! decide. The solver must not prove a pipeline with a fault. `tests/kinds.toml` says which pipelines
//! and faults a run takes.

use std::cell::Cell;
use std::time::Duration;

use glint::config::Value;
use glint::core::Core;
use glint::dsl::{Designer, end, step, valid};
use glint::equality::{Open, TextVerdict, Verdict, compare, compare_text};
use glint::fixed::Format;
use glint::hdl::netlist::{Design, Driver, NetId, Op};
use glint::hdl::pipeline::{Delays, Goal, IntervalGoal, Options, pipeline};
use glint::package::FileKind;
use glint::tools::elaborate;

use crate::common::Sure;
use crate::common::cores::{Files, configuration, configuration_with, pipelines};
use crate::common::sample::{sampled, sampled_by_name};
use crate::common::tools::tool;

/// A number that no test at random meets.
const NUMBER: u64 = 0x5_a5a5;

fn found(sequential: &Design, pipeline: &Design) -> anyhow::Result<Verdict> {
    compare(sequential, pipeline, &tool("z3"), Duration::from_secs(900))
}

fn verdict(sequential: &Design, pipeline: &Design) -> Verdict {
    found(sequential, pipeline).sure_of(&pipeline.name)
}

/// A pipeline whose products z3 does not decide: ECP5 splits its factors of 20 bits into 18 and 2, iCE40 into 16 and 4.
const UNDECIDED: &str = "configs/rough_up5k_pipelined.toml";

fn sequential(core: &Core) -> Design {
    core.opened.sequential().expect("a description")
}

#[test]
fn every_pipeline_is_proved_equal_to_its_sequential_core() {
    let decided = pipelines().into_iter().filter(|(path, _)| path != UNDECIDED);
    for (path, core) in sampled_by_name("equality", decided, |(path, _)| path.clone()) {
        match verdict(&sequential(&core), &core.design) {
            Verdict::Equal(proof) => {
                assert!(proof.outputs > 0 && proof.registers > 0 && proof.products > 0, "{path}");
            }
            other => panic!("{path}: {other:?}"),
        }
    }
}

/// Returns the pipeline of a configuration with another interval, at the clock that it reaches with this interval.
fn at_interval(path: &str, clocks: u64) -> Core {
    let mut opened = configuration(path).opened;
    opened.config.set("pipeline.interval", Value::Text(clocks.to_string()));
    Core::build_with_free_clock(opened).sure_of(path)
}

/// Returns the pipelines in `configs/` at intervals from 2 to 4 clocks, without the one that z3 does not decide.
fn at_longer_intervals() -> Vec<(String, Core)> {
    let mut all = Vec::new();
    for (path, _) in pipelines().into_iter().filter(|(path, _)| path != UNDECIDED) {
        for clocks in 2..=4 {
            all.push((format!("{path} every {clocks} clocks"), at_interval(&path, clocks)));
        }
    }
    all
}

#[test]
fn every_longer_interval_is_proved_equal_to_its_sequential_core() {
    let name_of = |(name, _): &(String, Core)| name.clone();
    let taken = sampled_by_name("equality of intervals", at_longer_intervals(), name_of);
    for (path, core) in taken {
        match verdict(&sequential(&core), &core.design) {
            Verdict::Equal(proof) => {
                assert!(proof.outputs > 0 && proof.registers > 0 && proof.products > 0, "{path}");
            }
            other => panic!("{path}: {other:?}"),
        }
    }
}

/// Returns every way to plant one kind of fault in a design.
fn faulty(design: &Design, plant: impl Fn(&mut Design, NetId) -> Option<()>) -> Vec<Design> {
    let planted = design.iter().filter_map(|(id, _)| {
        let mut faulty = design.clone();
        plant(&mut faulty, id).map(|()| faulty)
    });
    planted.collect()
}

fn op(design: &mut Design, id: NetId) -> Option<&mut Op> {
    match &mut design.nets[id.index()].driver {
        Driver::Op(op) => Some(op),
        _ => None,
    }
}

#[test]
fn a_fault_in_a_pipeline_is_refuted() {
    let core = configuration("configs/cosine_power_pipelined.toml");
    let own = sequential(&core);
    let stages = core.design.pipeline.as_ref().expect("a pipeline");
    // A register takes what the next of its stage and width should.
    let swapped = faulty(&core.design, |design, id| {
        let Driver::Register(register) = design.net(id).driver else { return None };
        let stage = stages.clock_of(id);
        let width = design.width(id);
        let other = design.registers.iter().skip(register.index() + 1).position(|it| {
            stages.clock_of(it.q) == stage && design.width(it.q) == width && it.reset.is_none()
        })?;
        let (one, other) = (register.index(), register.index() + 1 + other);
        let data = design.registers[one].data;
        design.registers[one].data = design.registers[other].data;
        design.registers[other].data = data;
        Some(())
    });
    // Bits are taken one place too low.
    let narrow = faulty(&core.design, |design, id| match op(design, id)? {
        Op::Slice { low, .. } if *low > 0 => {
            *low -= 1;
            Some(())
        }
        _ => None,
    });
    // A mux of two takes the other.
    let inverted = faulty(&core.design, |design, id| match op(design, id)? {
        Op::Mux { inputs, .. } if inputs.len() == 2 && inputs[0] != inputs[1] => {
            inputs.swap(0, 1);
            Some(())
        }
        _ => None,
    });
    for (kind, designs) in [("swapped", swapped), ("narrow", narrow), ("inverted", inverted)] {
        assert!(designs.len() > 3, "{kind}: {}", designs.len());
        let planted: Vec<&Design> = designs.iter().step_by(designs.len() / 4).collect();
        let mut refuted = 0;
        for faulty in &planted {
            // Of a fault in the handshake it is said that no result is shown.
            match found(&own, faulty) {
                Ok(Verdict::Different(_)) => refuted += 1,
                Err(error) if format!("{error}").contains("no result") => refuted += 1,
                // No point was found at which it shows.
                Ok(Verdict::Open(_)) => {}
                other => panic!("{kind}: {other:?}"),
            }
        }
        assert!(refuted + 1 >= planted.len(), "{kind}: {refuted} of {}", planted.len());
    }
}

/// Returns a square, or with a fault something else for one number.
fn square(faulty: bool) -> Design {
    let d = Designer::new("square");
    let x = d.operand("x", Format::unsigned(20, 0));
    let square = d.register("square", Format::unsigned(40, 0));
    let product = d.mul("x_squared", x.q(), x.q());
    let number = d.raw_constant("number", NUMBER.into(), x.q().format());
    let wrong = d.raw_constant(
        "wrong",
        if faulty { 7 } else { i128::from(NUMBER).pow(2) },
        product.format(),
    );
    square.takes(d.choose("chosen", d.equal("rare", x.q(), number), [product, wrong]));
    d.output("square_out", square.q());
    let squares = step("square", [square.load()]);
    d.microprogram([step("idle", []), squares, step("result", [valid(), end()])]);
    d.finish().sure()
}

/// No point at random meets the one that differs.
#[test]
fn the_solver_finds_the_point_that_differs() {
    let goal = Goal::ClockMhz(100.0);
    let options = Options {
        interval: IntervalGoal::Clocks(1),
        target: &glint::target::TIMINGS[0],
        goal,
        registered: false,
        stall: true,
        side: 0,
        delays: Delays::Registers,
    };
    let made_of = |design: &Design| pipeline(design, &options).expect("a pipeline");
    assert!(matches!(verdict(&square(false), &made_of(&square(false))), Verdict::Equal(_)));
    let Verdict::Different(difference) = verdict(&square(false), &made_of(&square(true))) else {
        panic!("the fault is not found")
    };
    assert_eq!(difference.operands, [("x".to_owned(), NUMBER)]);
    assert_eq!([difference.sequential, difference.pipeline], [NUMBER.pow(2), 7]);
}

/// z3 gives up of the first, and has too little time for the others.
#[test]
fn what_the_solver_leaves_open_is_unknown_or_a_limit() {
    let wide = "\n[difference]\nfraction = 27\n";
    let core = configuration_with("configs/quadratic_pipelined.toml", wide);
    assert_eq!(verdict(&sequential(&core), &core.design), Verdict::Open(Open::Unknown));
    let core = configuration(UNDECIDED);
    let limited = compare(&sequential(&core), &core.design, &tool("z3"), Duration::from_secs(10));
    assert_eq!(limited.expect("a verdict"), Verdict::Open(Open::Limit));
    let core = configuration("configs/cosine_power_pipelined.toml");
    let limited = compare(&sequential(&core), &core.design, &tool("z3"), Duration::from_millis(1));
    assert_eq!(limited.expect("a verdict"), Verdict::Open(Open::Limit));
}

/// Returns the verdict on the text of a pipeline, which is changed.
fn of_text(core: &Core, limit: u64, change: impl Fn(&str) -> String) -> TextVerdict {
    let [yosys, z3] = ["yosys", "z3"].map(tool);
    let limit = Duration::from_secs(limit);
    let mut files = Files::new();
    for file in core.core_files().expect("Verilog").of(FileKind::CORE_SOURCES) {
        let (name, text) = file.source();
        let text = if file.kind.is_verilog() { change(text) } else { text.to_owned() };
        files.push((name.to_owned(), text));
    }
    let text = elaborate(&yosys, &files, &core.config().name, &[], limit).expect("a netlist");
    compare_text(&core.design, &text, &z3, limit).expect("a verdict")
}

#[test]
fn the_text_of_every_pipeline_is_proved_equal_to_its_netlist() {
    let mut delays = 0;
    // The text of `rough` for iCE40 takes minutes; `glint verify` proves it.
    for (path, core) in pipelines().into_iter().filter(|(path, _)| path != UNDECIDED) {
        match of_text(&core, 900, str::to_owned) {
            TextVerdict::Equal(proof) => {
                assert!(proof.outputs > 0 && proof.registers > 0, "{path}: {proof:?}");
                delays += proof.delays.len();
            }
            other => panic!("{path}: {other:?}"),
        }
    }
    assert!(delays > 8, "{delays}");
}

#[test]
fn the_text_of_every_longer_interval_is_proved_equal_to_its_netlist() {
    let name_of = |(name, _): &(String, Core)| name.clone();
    for (path, core) in sampled_by_name("text of intervals", at_longer_intervals(), name_of) {
        match of_text(&core, 900, str::to_owned) {
            TextVerdict::Equal(proof) => {
                assert!(proof.outputs > 0 && proof.registers > 0, "{path}: {proof:?}");
            }
            other => panic!("{path}: {other:?}"),
        }
    }
}

/// In the counter of slots, in what it selects and enables, and in the memory of a delay line.
#[test]
fn a_fault_in_the_text_of_a_longer_interval_is_not_proved() {
    let core = at_interval("configs/cosine_power_pipelined.toml", 4);
    let faults = [
        ("slot <= slot + 2'd1;", "slot <= slot + 2'd3;"),
        ("slot <= 2'd0;", "slot <= 2'd1;"),
        ("assign in_ready = advance & (slot == 2'd0);", "assign in_ready = advance & slot[0];"),
        ("assign in_ready = advance & (slot == 2'd0);", "assign in_ready = advance;"),
        ("wire load_0 = advance & (slot == 2'd0);", "wire load_0 = advance & (slot == 2'd1);"),
        ("wire load_3 = advance & (slot == 2'd3);", "wire load_3 = slot == 2'd3;"),
        (".enable(load_0),", ".enable(advance),"),
        ("slot == LAST", "slot == LAST - 1'b1"),
        ("leaving <= words[slot]", "leaving <= words[0]"),
        ("words[slot] <= entering", "if (entering[0]) words[slot] <= entering"),
        ("2'd1: multiplier_1_a_next", "2'd2: multiplier_1_a_next"),
    ];
    for (was, is) in sampled("faults in the text of an interval", faults) {
        let planted = Cell::new(false);
        let verdict = of_text(&core, 20, |text| {
            planted.set(planted.get() || text.contains(was));
            text.replacen(was, is, 1)
        });
        assert!(planted.get(), "`{was}` is not in the text");
        assert!(!matches!(verdict, TextVerdict::Equal(_)), "{was} -> {is}");
    }
}

/// In operators, operands, choices, enables, bits, and in the memory of a delay line.
#[test]
fn a_fault_in_the_text_is_not_proved() {
    let core = configuration("configs/cosine_power_pipelined.toml");
    let (planted, mut faults) = (Cell::new(0), 0);
    let all = [
        ("COS_GAMMA_MOST - cos_gamma", "COS_GAMMA_MOST - cos_gamma - 1"),
        ("if (advance) begin", "if (in_valid) begin"),
        ("~accumulator", "accumulator"),
        (" : 16'd0", " : 16'h8000"),
        ("[31:16];", "[30:15];"),
        // Of a delay line.
        ("slot == LAST", "slot == LAST - 1'b1"),
        ("else if (enable) slot", "else slot"),
        ("words[slot] <= entering", "words[slot] <= ~entering"),
        ("leaving <= words[slot]", "leaving <= words[0]"),
    ];
    for (was, is) in sampled("faults in the text of a pipeline", all) {
        let verdict = of_text(&core, 20, |text| {
            planted.set(planted.get() + u32::from(text.contains(was)));
            text.replacen(was, is, 1)
        });
        // The others find nothing to replace.
        if planted.replace(0) > 0 {
            faults += 1;
            assert!(!matches!(verdict, TextVerdict::Equal(_)), "{was}");
        }
    }
    assert!(faults > 1, "{faults}");
}

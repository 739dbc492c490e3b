//! Tests `glint tune`: its answer keeps the error, and has at most 1.1 times the area that an exhaustive search finds.
//! `tests/kinds.toml` says which of the searched spaces a run takes.
//!
//! It also compares the estimates of area and frequency with the records of synthesis.

use std::path::Path;

use glint::base::input;
use glint::config::{Config, Value};
use glint::synth::{self, SynthesisRecord, Target};
use glint::tune::{Answer, Candidate, Cost, ErrorUnit, Objective, TuningGoal, exhaustive, tune};

use crate::common::cores::{configuration, device};
use crate::common::sample::sampled_by_name;

fn integers(range: std::ops::RangeInclusive<i64>) -> Vec<Value> {
    range.map(Value::Integer).collect()
}

fn roundings() -> Vec<Value> {
    ["truncate", "nearest"].map(|word| Value::Text(word.to_owned())).to_vec()
}

/// A key with the values that it takes.
type Values = (&'static str, Vec<Value>);

/// Spaces that can be gone through, an error that takes some of each, and what of them the search may not touch: a key
/// that is not in the space is fixed.
fn spaces() -> Vec<(&'static str, f64, Vec<Values>)> {
    let f = || ("intensity.fraction", integers(10..=20));
    vec![
        (
            "cosine-power",
            0.75,
            vec![f(), ("intensity.rounding", roundings()), ("output.rounding", roundings())],
        ),
        (
            "schlick",
            0.8,
            vec![("intensity.fraction", integers(6..=24)), ("output.rounding", roundings())],
        ),
        (
            "threshold",
            0.7,
            vec![f(), ("intensity.rounding", roundings()), ("output.rounding", roundings())],
        ),
        ("lyon", 0.9, vec![("distance.fraction", integers(14..=28)), f()]),
        ("quadratic", 0.9, vec![("difference.fraction", integers(12..=28)), f()]),
        ("rough", 1.2, vec![("product.fraction", integers(21..=25)), f()]),
    ]
}

fn goal(error: f64, target: Target) -> TuningGoal {
    TuningGoal {
        error,
        unit: ErrorUnit::Output,
        target,
        objective: Objective::Area,
        clock: None,
        rate: None,
        most_dsps: None,
    }
}

/// Returns the best of a device from its defaults on, of which every key is free.
fn tuned(name: &str, goal: &TuningGoal) -> anyhow::Result<Answer> {
    tune(&device(name), &device(name).defaults(), &[], goal, &|_| ())
}

#[test]
fn the_answer_is_within_a_tenth_of_the_best_there_is() {
    let taken = sampled_by_name("spaces of tune", spaces(), |(name, ..)| (*name).to_owned());
    for (name, error, values) in taken {
        let device = device(name);
        let base = device.defaults();
        let inside: Vec<&str> = values.iter().map(|(key, _)| *key).collect();
        let fixed: Vec<&str> =
            base.values().map(|(key, _)| key).filter(|key| !inside.contains(key)).collect();
        for target in [Target::Ice40, Target::Ecp5] {
            let goal = goal(error, target);
            let best = exhaustive(&device, &base, &values, &goal).expect("designs");
            let best = best.unwrap_or_else(|| panic!("{name}: nothing keeps {error}"));
            let answer = tune(&device, &base, &fixed, &goal, &|_| ()).expect("an answer").best;
            let area = |it: &Candidate| it.cost.area(target);
            assert!(area(&answer) <= 1.1 * area(&best), "{name}: {answer:?}, the best is {best:?}");
            assert!(answer.bounds.governing_units() <= error, "{name}: {answer:?}");
            // What was not free is as it was.
            for key in &fixed {
                assert_eq!(answer.config.value(key), base.value(key), "{name} {key}");
            }
        }
    }
}

/// An ulp by which the base of `cosine-power` is off is 16 ulp of its sixteenth power; what the four squarings truncate makes 8, 4, 2
/// and 1 of them: 31 ulp in all, so that half the error takes a bit more.
#[test]
fn half_the_error_takes_a_bit_more() {
    let bits = |error: f64| {
        let goal = TuningGoal { unit: ErrorUnit::F, ..goal(error, Target::Ecp5) };
        tuned("cosine-power", &goal).expect("an answer").best.config.integer("intensity.fraction")
    };
    // 31 · 2⁻¹⁶ = 0.000473.
    assert_eq!(bits(0.000_474), 16);
    assert_eq!(bits(0.000_237), 17);
    assert_eq!(bits(0.000_948), 15);
}

#[test]
fn ports_and_formula_stay() {
    let base = device("lyon").defaults();
    let answer = tuned("lyon", &goal(0.9, Target::Ecp5)).expect("an answer");
    for key in ["power", "scale", "vector.fraction", "colour.bits"] {
        assert!(!answer.free.contains(&key), "{key} is free");
        assert_eq!(answer.best.config.value(key), base.value(key), "{key}");
    }
    assert!(answer.free.contains(&"distance.fraction"), "{:?}", answer.free);
}

/// By hand, n = 20 and cos γ = 0.95: taylor's a(n) makes 0.05 of what minimax makes 0.46, and no grid of twelfths of the domain
/// has a point where either is above 0.
#[test]
fn the_formula_is_compared_where_it_lives() {
    let device = device("quadratic");
    let base = device.defaults();
    let answer = tuned("quadratic", &goal(0.85, Target::Ecp5)).expect("an answer");
    assert!(!answer.free.contains(&"coefficient.scheme"), "{:?}", answer.free);
    let reference = |config: &Config| {
        let contract = device.open(config.clone()).expect("keys that can be opened").contract();
        let raw = |name: &str, value: f64| {
            let operand =
                contract.operands().iter().find(|it| it.name == name).expect("an operand");
            operand.format.quantise(value) as i64
        };
        let highlight = contract.highlight().expect("a highlight");
        highlight.reference(&[raw("cos_gamma", 0.95), raw("exponent", 20.0)])
    };
    assert_eq!(reference(&answer.best.config), reference(&base));
    assert!((reference(&base) - 0.463).abs() < 0.001, "{}", reference(&base));
}

/// Bits of a ROM that fit the same block RAM, and of products that fit the same DSP blocks, cost nothing.
#[test]
fn of_equal_cost_the_least_error_is_taken() {
    let best = tuned("cosine-squared", &goal(0.82, Target::Ecp5)).expect("an answer").best;
    assert!(best.bounds.governing_units() < 0.711, "{best:?}");
}

/// An iCE40 UP5K has 8 DSP blocks: `lyon` takes 13 with a multiplier for each product, and fits with shared ones.
#[test]
fn configurations_that_fit_the_chip_are_preferred() {
    let best = tuned("lyon", &goal(0.9, Target::Ice40)).expect("an answer").best;
    assert!(best.cost.dsps <= 8 && best.cost.excess(Target::Ice40).is_empty(), "{best:?}");
    assert_eq!(best.config.choice("colour.multipliers"), "1");
}

#[test]
fn the_front_falls_and_has_the_answer() {
    let run = || tuned("cosine-power", &goal(0.75, Target::Ecp5)).expect("an answer");
    let (answer, again) = (run(), run());
    for pair in answer.front.windows(2) {
        assert!(
            pair[0].bounds.governing_units() <= pair[1].bounds.governing_units(),
            "{:?}",
            answer.front
        );
        assert!(pair[0].cost.area(Target::Ecp5) > pair[1].cost.area(Target::Ecp5));
    }
    assert!(answer.front.iter().any(|it| it.config == answer.best.config));
    let texts = |answer: &Answer| {
        answer.front.iter().map(|it| format!("{:?}", it.config)).collect::<Vec<_>>()
    };
    assert_eq!(texts(&answer), texts(&again));
}

#[test]
fn a_goal_out_of_reach_says_what_is_in_the_way() {
    let within = |error| goal(error, Target::Ecp5);
    let fast = TuningGoal { clock: Some(5000.0), ..within(0.9) };
    let many = TuningGoal { rate: Some(500.0), ..within(0.9) };
    for (goal, said) in [
        // Rounding to eight bits costs half a unit, whatever f is.
        (within(0.1), "no configuration has an error of at most 0.1 output units"),
        (within(0.1), "rounding of the colour outputs (`output.rounding`), 0.500000"),
        (fast, "5000.0 MHz are needed"),
        (many, "4000.0 MHz are needed for 500 million points a second at 8 clocks a point"),
    ] {
        let refused = tuned("cosine-power", &goal).expect_err("out of reach");
        assert!(format!("{refused:#}").contains(said), "{refused:#}");
    }
}

/// Clocks of a point as README.md has them: `cosine-power` takes 8, a pipeline 1; a rate is the clock divided by them.
#[test]
fn a_rate_asks_for_the_clock_that_the_clocks_of_a_point_need() {
    let slow = tuned("cosine-power", &goal(0.9, Target::Ecp5)).expect("an answer").best;
    assert_eq!(slow.clocks, Some(8.0));
    assert_eq!(slow.rate(), Some(slow.cost.mhz / 8.0));
    let wanted = slow.rate().expect("a rate") * 0.99;
    let kept = TuningGoal { rate: Some(wanted), ..goal(0.9, Target::Ecp5) };
    let kept = tuned("cosine-power", &kept).expect("an answer").best;
    assert!(kept.cost.mhz >= 8.0 * wanted, "{} MHz", kept.cost.mhz);
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 }
}

/// Eight products: 130 MHz and 30 million points a second leave four clocks a point and two multipliers, 5 million the eight clocks
/// of the sequential core and one.
#[test]
fn a_rate_chooses_architecture_and_interval() {
    let device = device("cosine-power");
    let mut pipelined = device.defaults();
    pipelined.set("architecture", Value::Text("pipelined".to_owned()));
    let plain = device.defaults();
    let architecture = ["architecture"];
    for (base, fixed, rate, interval, multipliers) in [
        (&plain, &[][..], 30.0, "4", 2),
        (&pipelined, &architecture[..], 30.0, "4", 2),
        (&plain, &[][..], 5.0, "8", 1),
    ] {
        let goal = TuningGoal { rate: Some(rate), ..goal(0.75, Target::Ecp5) };
        let best = tune(&device, base, fixed, &goal, &|_| ()).expect("an answer").best;
        assert_eq!(best.config.choice("architecture"), "pipelined", "{rate}");
        assert_eq!(best.config.choice("pipeline.interval"), interval, "{rate}");
        assert_eq!(best.cost.dsps, multipliers, "{rate}");
    }
    // No rate, and a single multiplier.
    let goal_of_one = TuningGoal { most_dsps: Some(1), ..goal(0.75, Target::Ecp5) };
    let one = tune(&device, &plain, &[], &goal_of_one, &|_| ()).expect("an answer").best;
    assert_eq!((one.cost.dsps, one.config.choice("pipeline.interval")), (1, "8"));
    let none = TuningGoal { most_dsps: Some(0), ..goal(0.75, Target::Ecp5) };
    let refused = tune(&device, &plain, &[], &none, &|_| ()).expect_err("there is none");
    assert!(format!("{refused:#}").contains("0 are allowed"), "{refused:#}");
    // A sequential core that somebody asks for stays one, and is too slow.
    let goal = TuningGoal { rate: Some(30.0), ..goal(0.75, Target::Ecp5) };
    assert!(tune(&device, &plain, &architecture, &goal, &|_| ()).is_err());
}

/// The errors of the look-up tables are at most these in the median and at most. The weights are fitted to expressions too, and the
/// files in `generator/base/target/` state the errors of all cores of the fit. Where there is a frequency the estimates are as often
/// above as below.
#[test]
fn estimates_are_as_near_to_synthesis_as_is_said() {
    let records = input::records::<SynthesisRecord>(Path::new(synth::DIRECTORY)).expect("records");
    let cores: Vec<_> =
        records.iter().map(|(_, record)| (configuration(&record.config), record)).collect();
    // An estimate of a function with few look-up tables may be further off.
    let cores: Vec<_> =
        cores.into_iter().filter(|(core, _)| core.contract.highlight().is_some()).collect();
    // The last number is for pipelines with a longer interval.
    let stated = [
        (Target::Ice40, 0.125, 0.32, 0.26),
        (Target::Ecp5, 0.1, 0.26, 0.27),
        (Target::Xilinx7, 0.19, 0.53, 0.39),
    ];
    for (target, usual, most, most_of_intervals) in stated {
        let (mut off, mut clocks) = (Vec::new(), Vec::new());
        for (core, record) in &cores {
            let Some(figures) = record.of(target) else { continue };
            let cost = Cost::new(&core.design, target);
            let usage = figures.area.usage().expect("an FPGA");
            // Only `quadratic` on ECP5 is one off.
            if core.design.pipeline.is_none() {
                let off = cost.dsps.abs_diff(usage.dsps);
                assert!(off <= 1, "{target}, {}: {} DSP blocks", record.name, cost.dsps);
            }
            let luts = usage.luts as f64;
            let luts_off = (cost.luts / luts - 1.0).abs();
            let interval = core.design.pipeline.as_ref().map_or(1, |pipeline| pipeline.interval);
            assert!(
                luts_off <= if interval > 1 { most_of_intervals } else { most },
                "{target}, {}: {} of {luts}",
                record.name,
                cost.luts
            );
            if interval > 1 {
                continue;
            }
            off.push(luts_off);
            if let Some(frequency) = &figures.frequency {
                clocks.push(cost.mhz / frequency.median);
            }
        }
        assert!(off.len() >= 20 && median(off.clone()) <= usual, "{target}: {off:?}");
        let middle = if clocks.is_empty() { 1.0 } else { median(clocks) };
        assert!((middle - 1.0).abs() <= 0.02, "{target}: estimated clocks are off by {middle}");
    }
}

//! Tests the statements about error bounds for Gappa: Gappa proves them for the tested configurations, and proves neither a
//! much smaller bound nor the bound of hardware with a planted fault.

#[allow(dead_code)]
#[path = "../../examples/smoothstep/main.rs"]
mod smoothstep;

use std::time::Duration;

use glint::certify::{self, ProofOutcome, Statement, prove, questions, statements};
use glint::config::Config;
use glint::core::Core;
use glint::golden::Contract;
use glint::hdl::netlist::{Design, Driver, Op};
use glint::registry::Device;
use rayon::prelude::*;

use crate::common::cores::{configuration, parsed};
use crate::common::files::{json, put};
use crate::common::tools::{cargo_example, succeeded, tool};
use crate::example::fresnel;

/// The time limit of a proof; Gappa takes a second where it finds one.
const LIMIT: Duration = Duration::from_secs(20);

/// Coq takes a hundred times as long.
const LIMIT_COQ: Duration = Duration::from_secs(60);

/// The configurations that are certified whole.
const CERTIFIED: [&str; 6] =
    ["cosine_power", "threshold", "quadratic", "schlick", "lyon", "cosine_squared"];

/// Coq has gone through those of the first of them.
const BY_COQ: usize = 5;

fn device(name: &str, keys: &str) -> (Design, Box<dyn Contract>) {
    let text = format!("device = \"{name}\"\nname = \"core\"\n{keys}");
    let Core { design, contract, .. } = parsed("core.toml", &text);
    (design, contract)
}

fn stated(name: &str, keys: &str) -> Vec<Statement> {
    let (design, contract) = device(name, keys);
    statements(&design, contract.as_ref(), Duration::MAX).expect("statements")
}

fn accepted(script: &str) -> bool {
    let gappa = tool("gappa");
    let dir = tempfile::tempdir().expect("a directory");
    put(dir.path().join("statement.g"), script);
    let run = gappa.run(["statement.g"], dir.path(), LIMIT);
    run.is_ok_and(|run| run.status.success() && !run.output.contains("trivially equal"))
}

fn all_accepted(statements: &[Statement]) -> bool {
    statements.iter().all(|statement| statement.scripts.iter().any(|script| accepted(script)))
}

/// Returns the script with a bound of half a unit, which the rounding of the outputs alone may take.
fn smaller(script: &str) -> String {
    let Some((before, after)) = script.split_once("| <= ") else { return script.to_owned() };
    let (_, after) = after.split_once(" }").expect("the end of the goal");
    format!("{before}| <= 0.5 }}{after}")
}

#[test]
fn bounds_are_proved_and_smaller_ones_are_not() {
    for (device, keys) in [
        ("cosine-power", "power = 2"),
        ("cosine-power", "power = 16"),
        ("threshold", ""),
        ("threshold", "visibility.levels = [50, 100, 200]"),
        ("quadratic", ""),
        ("quadratic", "cosine.signed = true"),
        (
            "quadratic",
            "coefficient.scheme = \"taylor\"\nexponent.bits = 5\ndomain.exponent_max = 20",
        ),
        ("schlick", ""),
        ("schlick", "intensity.fraction = 6\nexponent.bits = 6\ndomain.exponent_max = 60"),
        ("lyon", "power = 2"),
        ("lyon", "scale = \"multiplier\""),
        ("cosine-squared", "table.address = 5"),
        ("cosine-squared", "table.address = 5\nline.stages = 5"),
        ("cosine-squared", "table.address = 4\noutput.rounding = \"truncate\""),
    ] {
        let stated = stated(device, keys);
        assert!(all_accepted(&stated), "{device}: {keys}");
        let refused = stated.iter().any(|it| !it.scripts.iter().any(|it| accepted(&smaller(it))));
        assert!(refused, "{device}: {keys}");
    }
}

fn of_user(device: Device) -> (Design, Box<dyn Contract>) {
    let config = Config::defaults(&(device.schema)(), "core");
    let opened = device.open(config).expect("keys that can be opened");
    (opened.sequential().expect("a design"), opened.contract())
}

#[test]
fn a_device_without_records_is_certified() {
    let (design, contract) = of_user(fresnel::FRESNEL);
    let stated = statements(&design, contract.as_ref(), Duration::MAX).expect("statements");
    assert!(all_accepted(&stated));
    // Less than the rounding of the outputs takes.
    let asked = questions(&design, contract.as_ref(), Duration::MAX).expect("questions");
    let smaller: Vec<_> = asked.iter().map(|it| it.within(0.49)).collect();
    assert!(!all_accepted(&smaller));
}

/// Returns the bound that Gappa finds.
fn found(design: &Design, contract: &dyn Contract) -> (f64, Vec<Statement>) {
    let gappa = tool("gappa");
    let asked = questions(design, contract, Duration::MAX).expect("questions");
    (certify::bound(&gappa, &asked, LIMIT).expect("Gappa").expect("a bound"), asked)
}

#[test]
fn a_bound_is_found_where_none_is_stated() {
    let (design, contract) = of_user(smoothstep::SMOOTHSTEP);
    assert!(!contract.bounds().are_stated());
    let step = statements(&design, contract.as_ref(), Duration::MAX).expect_err("no bound");
    assert_eq!(step, "the contract states no bound");
    let (bound, asked) = found(&design, contract.as_ref());
    // The square is cut by a sixteenth of a unit at most, three times that is left of it, and half a unit is rounded.
    assert!(bound <= 0.5 + 3.0 / 16.0, "{bound}");
    let within = |bound: f64| asked.iter().map(|it| it.within(bound)).collect::<Vec<_>>();
    assert!(all_accepted(&within(bound)));
    let largest = (0..=4096).map(|x| contract.largest_error(&[x])).fold(0.0, f64::max);
    assert!(largest <= bound && !all_accepted(&within(largest - 0.001)), "{largest} {bound}");
}

/// By its own command line, as its author uses it.
#[test]
fn the_bound_of_a_device_of_a_user_is_printed() {
    let dir = tempfile::tempdir().expect("a directory");
    put(dir.path().join("s.toml"), "device = \"smoothstep\"\n");
    let file = dir.path().join("s.toml");
    let text = succeeded(cargo_example("smoothstep").arg("certify").arg(&file));
    assert!(text.contains("certified: |output - formula| <= 0.6"), "{text}");
    assert!(
        text.contains("with a bound that Gappa found, because the contract states none"),
        "{text}"
    );
}

/// A bound that is found for a device of the catalogue is no more than its author has proved, and no less than an error that is
/// known.
#[test]
fn bounds_that_are_found_lie_between_errors_and_bounds_by_hand() {
    let (design, contract) = device("cosine-power", "");
    let (bound, _) = found(&design, contract.as_ref());
    let errors = (0..4096).map(|at| {
        let cosine = (1 << 20) - at * 31;
        contract.largest_error(&[cosine, 1 + at % 40, 255, 255, 255])
    });
    let largest = errors.fold(0.0, f64::max);
    assert!(largest > 0.5 && largest <= bound, "{largest} {bound}");
    assert!(bound <= contract.bounds().governing().units, "{bound}");
}

/// Changes a net: a constant gets a sixteenth smaller, an inverter a wire, operands and inputs change places.
fn plant(design: &mut Design, name: &str) {
    let net = design.nets.iter_mut().find(|net| net.name == name);
    let net = net.unwrap_or_else(|| panic!("there is a net `{name}`"));
    match &mut net.driver {
        Driver::Constant(bits) => {
            assert!(*bits >= 16, "`{name}` has a sixteenth");
            *bits -= *bits >> 4;
            let raw = net.format.raw(*bits);
            net.range = (raw, raw);
        }
        Driver::Op(op @ Op::Not(_)) => *op = Op::Relabel(op.operands()[0]),
        Driver::Op(Op::Sub(a, b) | Op::Less(a, b)) => std::mem::swap(a, b),
        Driver::Op(Op::Mux { inputs, .. }) => inputs.reverse(),
        other => panic!("no fault is known for {other:?}"),
    }
}

#[test]
fn faulty_hardware_has_no_proof() {
    for (name, net) in [
        ("cosine-power", "one_2"),
        ("threshold", "base_one"),
        ("threshold", "comparator"),
        ("quadratic", "inverters"),
        ("schlick", "one"),
        ("schlick", "quotient_trial"),
        ("schlick", "quotient_bit"),
        ("lyon", "inverse"),
    ] {
        let (mut design, contract) = device(name, "");
        plant(&mut design, net);
        let stated = statements(&design, contract.as_ref(), Duration::MAX);
        assert!(stated.map_or(true, |stated| !all_accepted(&stated)), "{name}: `{net}`");
    }
}

const TABLE: &str = "table.address = 5";

/// Faults in the angles of words, in a word, and in how the points of a line follow.
#[test]
fn faulty_lines_have_no_proof() {
    let is_open = |design: &Design, contract: &dyn Contract| {
        let stated = statements(design, contract, Duration::MAX);
        stated.map_or(true, |stated| !all_accepted(&stated))
    };
    for net in ["angle_complement", "angle_magnitude", "table_address", "angle_source"] {
        let (mut design, contract) = device("cosine-squared", TABLE);
        plant(&mut design, net);
        assert!(is_open(&design, contract.as_ref()), "`{net}`");
    }
    // A word that is off by more than twice the bound, and some places.
    let (design, contract) = device("cosine-squared", TABLE);
    let step = 1 + (contract.bounds().f * 1024.0).ceil() as u64;
    for word in (0..design.roms[0].words.len()).step_by(3) {
        let (mut design, contract) = device("cosine-squared", TABLE);
        let words = &mut design.roms[0].words;
        words[word] =
            if words[word] > 512 { words[word] - 2 * step } else { words[word] + 2 * step };
        assert!(is_open(&design, contract.as_ref()), "word {word}");
    }
    // A second point that is not at the next angle: the register keeps what it holds.
    let (mut design, contract) = device("cosine-squared", TABLE);
    let angle = design.nets.iter().position(|net| net.name == "angle").expect("the register");
    let sum = design.nets.iter_mut().find(|net| net.name == "next_angle").expect("the sum");
    let Driver::Op(Op::Add { a, b, .. }) = &mut sum.driver else { panic!("no sum") };
    let (kept, _) = if a.index() == angle { (*a, *b) } else { (*b, *a) };
    (*a, *b) = (kept, kept);
    let why = statements(&design, contract.as_ref(), Duration::MAX).expect_err("no walk");
    assert_eq!(why, "the angle of the next point is not the sum of an angle and an operand");
}

/// The polynomial alone is no cosine, and a number beside pi/2 is none.
#[test]
fn what_a_cosine_is_made_of_counts() {
    let stated = stated("cosine-squared", "table.address = 4");
    assert!(all_accepted(&stated));
    for (what, other) in [
        ("rest in [-1,1]", "rest in [-1e19,1e19]"),
        ("right in [1.57079632679489661923", "right in [1.5707"),
        ("right in [1.57079632679489661923,1.57079632679489661924]", "right in [1.5,1.5]"),
    ] {
        let changed: Vec<String> =
            stated.iter().map(|it| it.scripts[0].replace(what, other)).collect();
        assert!(changed[0] != stated[0].scripts[0], "{what}");
        assert!(!changed.iter().all(|script| accepted(script)), "{other}");
    }
}

/// A parabola and a quotient are taken for more than intervals say of them, which is stated too.
#[test]
fn what_statements_rest_on_is_stated_and_wrong_premises_are_refused() {
    let quadratic = stated("quadratic", "");
    let premise = quadratic.iter().find(|it| it.output == "adder1").expect("c² − c");
    let script = &premise.scripts[0];
    assert!(accepted(script) && script.contains(" in [-0.25,0]"), "{script}");
    assert!(!accepted(&script.replace(" in [-0.25,0]", " in [-0.2499,0]")));
    let schlick = stated("schlick", "");
    let premises: Vec<_> = schlick.iter().filter(|it| it.output == "quotient").collect();
    assert_eq!(premises.len(), 3);
    assert!(premises.iter().all(|it| accepted(&it.scripts[0])));
    // The divisor may be below the dividend where n may be below 1.
    let dividend = premises.iter().find(|it| it.scripts[0].contains("exponent in [1,1000]"));
    let dividend = &dividend.expect("what the division presupposes").scripts[0];
    assert!(!accepted(&dividend.replace("exponent in [1,1000]", "exponent in [-1,1000]")));
}

#[test]
fn what_cannot_be_stated_says_which_step() {
    let step_of = |name: &str| {
        let (design, contract) = device(name, "");
        statements(&design, contract.as_ref(), Duration::MAX).map(|_| ())
    };
    let step = step_of("quad-cosine").expect_err("a power by a dictionary");
    assert!(step.starts_with("`{` cannot be a part of a formula, `{1: 1, 2: 2,"), "{step}");
    let step = step_of("rough").expect_err("a square root");
    assert_eq!(step, "the function `sqrt` cannot be written for Gappa");
}

/// Returns the statements of a configuration as they are today, those of its record.
fn recorded(name: &str) -> Vec<Statement> {
    let Core { design, contract, .. } = configuration(&format!("configs/{name}.toml"));
    let stated = statements(&design, contract.as_ref(), Duration::MAX).expect("statements");
    let record = json(format!("records/proofs/certificates/{name}.json"));
    assert_eq!(record["certified"], true, "{name}");
    assert_eq!(record["statements"], stated.len(), "{name}");
    let stale = format!("`glint certify configs/{name}.toml --out DIR` makes another record");
    assert_eq!(record["scripts"], certify::digest(&stated), "{stale}");
    stated
}

#[test]
fn recorded_certificates_are_those_of_today_and_proved() {
    for name in CERTIFIED {
        recorded(name).into_par_iter().for_each(|Statement { output, number, scripts, .. }| {
            let is_proved = scripts.iter().any(|script| accepted(script));
            assert!(is_proved, "{name}: {output}, statement {number} is not proved");
        });
    }
}

#[test]
#[ignore = "on request: Coq is no tool that tools/install brings, and takes seconds to minutes a statement"]
fn coq_accepts_certificates() {
    let wanted = CERTIFIED.into_iter().take(BY_COQ);
    let [gappa, coq] = ["gappa", "coqc"].map(tool);
    let all = wanted.flat_map(|it| recorded(it).into_iter().map(move |of| (it, of)));
    let all: Vec<_> = all.collect();
    all.par_iter().for_each(|(name, statement)| {
        let outcome = prove(&gappa, Some(&coq), statement, LIMIT_COQ).expect("tools that work");
        if let ProofOutcome::Open(why) = outcome {
            panic!("{name}: {}, statement {}: {why}", statement.output, statement.number);
        }
    });
}

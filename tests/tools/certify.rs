//! Statements for Gappa: proved of the devices as they are, refused of a smaller bound and of faulty hardware.

use std::time::Duration;

use glint::certify::{Statement, statements};
use glint::config::{Config, parse};
use glint::hdl::netlist::{Driver, Net};
use glint::registry::Registry;
use glint::tools::Tool;

const LIMIT: Duration = Duration::from_secs(120);

fn stated(device: &str, keys: &str) -> Vec<Statement> {
    let registry = Registry::catalogue();
    let text = format!("device = \"{device}\"\nname = \"core\"\n{keys}");
    let config = parse("core.toml", &text, &registry.schemas()).expect("a configuration");
    let device = registry.device(device).expect("in the catalogue");
    let design = device.sequential(&config).expect("a design");
    statements(&design, (device.contract)(&config).as_ref(), Duration::MAX).expect("statements")
}

fn accepted(script: &str) -> bool {
    let gappa = Tool::find("gappa").unwrap_or_else(|error| panic!("{error}"));
    let place = tempfile::tempdir().expect("a directory");
    std::fs::write(place.path().join("statement.g"), script).expect("a script");
    let run = gappa.run(["statement.g"], place.path(), LIMIT).expect("Gappa ends");
    run.status.success() && !run.output.contains("trivially equal")
}

fn all_accepted(statements: &[Statement]) -> bool {
    statements.iter().all(|statement| statement.scripts.iter().any(|script| accepted(script)))
}

#[test]
fn bounds_are_proved_and_smaller_ones_are_not() {
    for power in [2, 16] {
        let stated = stated("cosine-power", &format!("power = {power}\n"));
        assert!(all_accepted(&stated), "power = {power}");
        // The same with a bound of half a unit, which the rounding of the outputs alone may take.
        let smaller = |script: &String| {
            let (before, after) = script.split_once("| <= ").expect("a goal");
            let (_, after) = after.split_once(" }").expect("its end");
            format!("{before}| <= 0.5 }}{after}")
        };
        let refused = stated.iter().any(|it| !it.scripts.iter().any(|it| accepted(&smaller(it))));
        assert!(refused, "power = {power}");
    }
}

#[test]
fn faulty_hardware_has_no_proof() {
    let registry = Registry::catalogue();
    let device = registry.device("cosine-power").expect("in the catalogue");
    let config = Config::defaults(&(device.schema)(), "core");
    let design = device.sequential(&config).expect("a design");
    let contract = (device.contract)(&config);
    // 1.0, from which the cosine is taken, a sixteenth too small.
    let mut faulty = design.clone();
    let one = |net: &&mut Net| {
        net.format.frac > 0
            && net.format.raw(1 << net.format.frac) == net.range.0
            && net.range.0 == net.range.1
    };
    let net = faulty.nets.iter_mut().find(one).expect("the constant 1.0");
    let Driver::Constant(bits) = &mut net.driver else { panic!("`{}` is a constant", net.name) };
    *bits -= *bits >> 4;
    let raw = net.format.raw(*bits);
    net.range = (raw, raw);
    let stated = statements(&faulty, contract.as_ref(), Duration::MAX);
    assert!(stated.map_or(true, |stated| !all_accepted(&stated)));
}

#[test]
fn what_cannot_be_stated_says_which_step() {
    let registry = Registry::catalogue();
    let step_of = |device: &str| {
        let device = registry.device(device).expect("in the catalogue");
        let config = Config::defaults(&(device.schema)(), "core");
        let design = device.sequential(&config).expect("a design");
        statements(&design, (device.contract)(&config).as_ref(), Duration::MAX).map(|_| ())
    };
    let step = step_of("quad-cosine").expect_err("a line");
    assert_eq!(step, "a computation of several results is not unrolled");
    let step = step_of("rough").expect_err("a square root");
    assert_eq!(step, "the function `sqrt` has no translation");
}

#[test]
fn committed_certificates_are_those_of_today_and_proved() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("configs/cosine_power.toml")).expect("a file");
    let registry = Registry::catalogue();
    let config = parse("core.toml", &text, &registry.schemas()).expect("a configuration");
    let device = registry.device("cosine-power").expect("in the catalogue");
    let design = device.sequential(&config).expect("a design");
    let stated = statements(&design, (device.contract)(&config).as_ref(), Duration::MAX)
        .expect("statements");
    let directory = "proofs/certificates/cosine_power";
    let files = std::fs::read_dir(root.join(directory)).expect("certificates");
    assert_eq!(files.count(), stated.len());
    for statement in &stated {
        let file = format!("{directory}/{}_{}.g", statement.output, statement.number);
        let committed = std::fs::read_to_string(root.join(&file)).expect("a certificate");
        let (_, script) = committed.split_once("\n\n").expect("a head and a script");
        assert!(statement.scripts.iter().any(|it| it == script), "{file} is of another time");
        assert!(accepted(&committed), "{file} is not proved");
    }
}

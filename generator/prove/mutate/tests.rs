//! Tests the equivalence proofs against simulation, on a sample of the faults: a fault that simulation notices must never be
//! proved equivalent.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::proof::Prover;
use super::{Detector, FaultKind, Faults, How, MutantVerdict, NetlistFault, plant, run, unreached};
use glint_base::fixed::Format;
use glint_config as config;
use glint_core::core::{Core, TEST_SEED};
use glint_core::registry::Registry;
use glint_rtl::dsl::fixture::design;
use glint_rtl::dsl::step;

/// Tests plant only every n-th fault; with `GLINT_TESTS=all`, n is smaller. n must not be a multiple of three, because each
/// bit has three faults.
fn every() -> usize {
    if std::env::var("GLINT_TESTS").is_ok_and(|tests| tests == "all") { 29 } else { 211 }
}

/// A fault may replace an operand by a net that the prover does not see around the fault.
#[test]
fn faults_that_read_other_nets_are_no_proof_and_no_panic() {
    let core = core("configs/rough_up5k_pipelined.toml");
    let prover = Prover::new(&core.design).unwrap();
    let faults = Faults::of(&core.design);
    let wired: Vec<_> = faults.iter().filter(|fault| fault.kind == FaultKind::Wiring).collect();
    let proved = wired.par_iter().filter(|fault| prover.proves(&fault.site).is_some()).count();
    assert!(proved < wired.len(), "{proved} of {}", wired.len());
}

/// The number of points with which most faults show.
const POINTS: u64 = 200;

fn at(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn core(path: &str) -> Core {
    let registry = Registry::catalogue();
    let config = config::read(&at(path), &registry.schemas()).unwrap();
    Core::new(*registry.device(&config.device).unwrap(), config).unwrap()
}

#[test]
fn no_proof_of_what_shows() {
    let devices = Registry::catalogue();
    let (mut proved, mut noticed) = (0, 0);
    let names = devices.devices().iter().map(|device| device.name.replace('-', "_"));
    let paths =
        names.flat_map(|name| ["", "_pipelined"].map(|it| format!("configs/{name}{it}.toml")));
    let every_few = ["lyon", "rough"].map(|name| format!("configs/{name}_up5k_pipelined.toml"));
    for path in paths.filter(|path| at(path).exists()).chain(every_few) {
        let core = core(&path);
        let prover = Prover::new(&core.design).unwrap();
        let sound = plant::bare(&core.design);
        let bench = core.shipped_vectors().unwrap();
        assert!(!bench.notice_a_fault_in(&sound).unwrap(), "{path}");
        let faults = Faults::of(&core.design);
        let faults: Vec<_> = faults.iter().step_by(every()).collect();
        let of_each: Vec<(bool, bool)> = faults
            .par_iter()
            .map(|fault| {
                let is_proved = prover.proves(&fault.site).is_some();
                let mutant = fault.planted(&sound);
                let lockstep = core.lockstep_of(&mutant, 5).unwrap();
                let shows = lockstep.run_alone(POINTS).unwrap().mismatch.is_some();
                assert!(!(is_proved && shows), "{path}: {}", fault.id);
                let benched = is_proved && bench.notice_a_fault_in(&mutant).unwrap();
                assert!(!benched, "{path}: the bench notices {}", fault.id);
                (is_proved, shows)
            })
            .collect();
        proved += of_each.iter().filter(|(is_proved, _)| *is_proved).count();
        noticed += of_each.iter().filter(|(_, shows)| *shows).count();
    }
    assert!(proved * every() > 2_900 && noticed * every() > 29_000, "{proved}, {noticed}");
}

/// The default test cannot notice a fault that it never reaches, and it reaches nearly everything.
#[test]
fn what_is_never_reached_is_never_noticed() {
    let core = core("configs/reduced/schlick.toml");
    let faults = Faults::of(&core.design);
    let faults: Vec<&NetlistFault> = faults.iter().collect();
    let unreached = unreached(&core, &faults).unwrap();
    assert!(unreached.len() * 4 < faults.len(), "{} of {}", unreached.len(), faults.len());
    for fault in &unreached {
        let mutant = fault.planted(&core.design);
        let lockstep = core.lockstep_of(&mutant, TEST_SEED).unwrap();
        assert_eq!(lockstep.run(2_000, &|_| ()).unwrap().mismatch, None, "{}", fault.id);
    }
    // An inverted bit shows whenever a signal reads it.
    assert!(unreached.iter().all(|fault| fault.kind != FaultKind::Inverted));
    // The signal `run`, which says that the device runs, is sometimes 0 and sometimes 1.
    let stuck = |fault: &&&NetlistFault| fault.id.starts_with("run[0]:stuck");
    assert!(faults.iter().any(|fault| stuck(&fault)), "no such fault");
    assert_eq!(unreached.iter().filter(stuck).count(), 0);
}

fn verdict(core: &Core, id: &str) -> MutantVerdict {
    let faults = Faults::of(&core.design);
    let fault = faults.iter().find(|fault| fault.id == id);
    run(core, fault, &|| ()).unwrap().remove(0).verdict
}

/// The fault shows only with a cosine in which no other bit is set, and with an exponent n for which the highlight is still lit
/// there.
#[test]
fn a_point_is_searched_for_that_shows_a_fault() {
    let core = core("configs/cosine_power_pipelined.toml");
    let verdict = verdict(&core, "cos_gamma_reg_s0[5]:stuck-at-0");
    let MutantVerdict::Caught(Detector::Directed, difference) = verdict else {
        panic!("{verdict:?}");
    };
    assert!(difference.held.contains(&("cos_gamma".to_owned(), 1 << 5)), "{difference:?}");
}

/// A number is below 1.0 if the bit of 1.0 and all higher bits are 0, whatever the lower bits are.
#[test]
fn lower_bits_do_not_decide_a_comparison() {
    let core = core("configs/lyon_pipelined.toml");
    assert_eq!(
        verdict(&core, "beta_distance_s6[15]:inverted"),
        MutantVerdict::Equivalent(How::Induction)
    );
    assert!(matches!(verdict(&core, "beta_distance_s6[16]:inverted"), MutantVerdict::Caught(..)));
}

/// Only the sign decides whether a number is below 0, although the lower bits of 0 are all zeros.
#[test]
fn the_sign_decides_a_comparison_with_0() {
    let design = design(|d| {
        let [x, y] = ["x", "y"].map(|name| d.operand(name, Format::signed(3, 0)).q());
        let sum = d.add("sum", x, y);
        let held = d.register("held", Format::BIT);
        held.takes(d.less("negative", sum, d.constant("nothing", 0.0, sum.format())));
        d.output("held_out", held.q());
        vec![step("load", [held.load()])]
    });
    let prover = Prover::new(&design).unwrap();
    let proved = |id: &str| {
        let faults = Faults::of(&design);
        let fault = faults.iter().find(|fault| fault.id == id).expect("a fault");
        prover.proves(&fault.site).is_some()
    };
    assert!(proved("sum[0]:inverted"));
    assert!(!proved("sum[4]:inverted") && !proved("sum[4]:stuck-at-0"));
}

/// After a step of a divider, the remainder is not larger than before: it is the difference if that is not negative.
#[test]
fn a_remainder_does_not_grow_by_a_subtraction() {
    let core = core("configs/schlick_pipelined.toml");
    let id = "quotient_remainder_s4[25]";
    assert_eq!(
        verdict(&core, &format!("{id}:stuck-at-0")),
        MutantVerdict::Equivalent(How::Induction)
    );
    assert!(matches!(verdict(&core, &format!("{id}:stuck-at-1")), MutantVerdict::Caught(..)));
}

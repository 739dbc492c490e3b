//! Tests the check of `glint verify` that proves the bound of a contract with Gappa.

use std::time::Duration;

use glint::core::Core;
use glint::hdl::netlist::{Driver, Op};
use glint::verify::{CheckVerdict, Effort, Finding};

use crate::common::cores::configuration;
use crate::common::tools::{EFFORT, finding};

fn found(core: &Core) -> Finding {
    let effort = Effort { full: true, time_limit: Duration::from_secs(300), ..EFFORT };
    finding(core, "certificate", effort)
}

#[test]
fn statements_that_gappa_proves_are_proved() {
    let finding = found(&configuration("configs/cosine_power.toml"));
    assert_eq!(finding.verdict, CheckVerdict::Proved, "{}", finding.words);
}

#[test]
fn what_cannot_be_stated_is_not_confirmed() {
    for (path, verdict) in [
        ("configs/quad_cosine.toml", CheckVerdict::Unconfirmed),
        ("configs/cosine_power_pipelined.toml", CheckVerdict::NotApplicable),
    ] {
        let finding = found(&configuration(path));
        assert_eq!(finding.verdict, verdict, "{path}: {}", finding.words);
    }
}

/// The comparison with ROM(n) is the wrong way round. Which statement has no proof does not depend on which was tried first.
#[test]
fn faulty_hardware_is_not_proved() {
    let mut core = configuration("configs/threshold.toml");
    let net = core.design.nets.iter_mut().find(|net| net.name == "comparator");
    let driver = &mut net.expect("what compares with ROM(n)").driver;
    let Driver::Op(Op::Less(a, b)) = driver else { panic!("{driver:?} is no comparison") };
    std::mem::swap(a, b);
    let finding = found(&core);
    assert_eq!(finding.verdict, CheckVerdict::Unconfirmed, "{}", finding.words);
    assert!(finding.words.starts_with("Gappa does not prove statement"), "{}", finding.words);
    assert_eq!(found(&core).words, finding.words);
}

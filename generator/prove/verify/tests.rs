//! Tests the checks of `glint verify` that need no outside tool. A fault in the design must fail the check `lockstep` but not the
//! check `contract`.

use std::path::Path;
use std::time::Duration;

use super::{CHECKS, CheckSubject, CheckVerdict, Conclusion, Effort, Finding, VerificationRecord};
use glint_config as config;
use glint_core::core::Core;
use glint_core::registry::Registry;

fn core() -> Core {
    let registry = Registry::catalogue();
    let text = include_str!("../../../configs/reduced/rough.toml");
    let config = config::parse("core.toml", text, &registry.schemas()).expect("a configuration");
    let device = *registry.device(&config.device).expect("a device");
    Core::new(device, config).expect("a design")
}

fn verified(core: &Core) -> VerificationRecord {
    let effort = Effort { full: false, without_tools: true, time_limit: Duration::from_secs(1) };
    let subject = CheckSubject::new("core.toml", core, effort, Path::new("records/proofs"));
    let checks = CHECKS.iter().filter(|check| !check.is_outside());
    let answers = checks.map(|check| check.run(&subject, &|_| ())).collect();
    VerificationRecord::new(&subject, answers)
}

fn finding<'a>(record: &'a VerificationRecord, check: &str) -> &'a Finding {
    let answer = record.checks.iter().find(|answer| answer.check == check);
    &answer.expect("a check").finding
}

#[test]
fn the_worst_verdict_decides() {
    let answer =
        |verdict| CHECKS[0].answer(Vec::new(), Finding::without(verdict, ""), Duration::ZERO);
    for (verdict, conclusion) in [
        (CheckVerdict::Passed, Conclusion::Verified),
        (CheckVerdict::NotApplicable, Conclusion::Verified),
        (CheckVerdict::Unconfirmed, Conclusion::Verified),
        (CheckVerdict::LeftOut, Conclusion::InPart),
        (CheckVerdict::Undecided, Conclusion::Incomplete),
        (CheckVerdict::LimitReached, Conclusion::Incomplete),
        (CheckVerdict::NotRun, Conclusion::Incomplete),
        (CheckVerdict::Failed, Conclusion::Failed),
    ] {
        let both = [answer(CheckVerdict::Proved), answer(verdict)];
        assert_eq!(Conclusion::of(&both), conclusion, "{verdict:?}");
    }
}

#[test]
fn a_fault_in_the_design_fails_the_lockstep() {
    let mut core = core();
    assert_eq!(verified(&core).conclusion, Conclusion::Verified);
    // The words of a ROM of the datapath, from the last to the first.
    let control = core.design.control.rom.index();
    let rom = core.design.roms.iter_mut().enumerate();
    let rom = rom.filter(|(at, _)| *at != control).map(|(_, rom)| rom);
    rom.for_each(|rom| rom.words.reverse());
    let record = verified(&core);
    assert_eq!(record.conclusion, Conclusion::Failed);
    let lockstep = finding(&record, "lockstep");
    assert_eq!(lockstep.verdict, CheckVerdict::Failed);
    // The failure names the seed, the clock, the microinstruction, the signal and both values.
    for part in [
        "seed ",
        "after clock ",
        "microinstruction `",
        "in the simulated hardware",
        "in the golden model",
    ] {
        assert!(lockstep.failures[0].contains(part), "{:?}", lockstep.failures);
    }
    // This check does not read the netlist. Its verdict is not a proof, because its sweep leaves out some values of cos_dgamma.
    assert_eq!(finding(&record, "contract").verdict, CheckVerdict::Passed);
}

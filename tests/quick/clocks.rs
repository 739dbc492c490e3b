//! Tests the clocks that a manifest states, for all values of the port `shift` and for the extreme values of the other
//! operands.
//!
//! The ports can carry values outside the domain of the contract. The stated clocks must hold for these values too.

use std::collections::BTreeSet;

use glint::core::Core;
use glint::cosim::trial;

use crate::common::cores::{configurations, device, random, with_keys};

/// Random configurations of `lyon`, whose clocks depend on an operand or not, as a key says.
const CONFIGURATIONS: u64 = 48;

/// Clocks from start to start for every value of the port `shift`, or of none, and for the lowest and the highest
/// of all others.
fn clocks_of_every_shift(core: &Core) -> BTreeSet<u32> {
    let operands = core.contract.operands();
    let shift = operands.iter().find(|operand| operand.name == "shift");
    let shifts =
        shift.map_or(0..=0, |shift| shift.format.min_raw() as i64..=shift.format.max_raw() as i64);
    let mut clocks = BTreeSet::new();
    for shift in shifts {
        for high in [false, true] {
            let raw = |operand: &glint::golden::Operand| match (operand.name.as_str(), high) {
                ("shift", _) => shift,
                (_, false) => operand.format.min_raw() as i64,
                (_, true) => operand.format.max_raw() as i64,
            };
            let point: Vec<i64> = operands.iter().map(raw).collect();
            let (taken, results) =
                trial::throughput(&core.design, core.contract.as_ref(), &point).expect("an end");
            assert_eq!(results, 1);
            clocks.insert(taken);
        }
    }
    clocks
}

#[track_caller]
fn assert_stated_clocks_are_right(core: &Core) {
    let stated = core.timing().expect("a timing");
    let taken = clocks_of_every_shift(core);
    let latest = *taken.last().expect("a clock");
    if taken.len() == 1 {
        assert_eq!(stated.start_to_start, Some(latest), "{}", core.config().name);
        assert_eq!(stated.start_to_done, Some(latest - 1));
        // The result comes in the last clock.
        assert_eq!(stated.start_to_valid, Some(latest - 1));
    } else {
        let fixed = [stated.start_to_valid, stated.start_to_done, stated.start_to_start];
        assert_eq!(fixed, [None; 3], "{}: {taken:?}", core.config().name);
        assert!(stated.start_to_done_at_most.expect("a bound") >= latest - 1);
    }
}

#[test]
fn random_configurations_of_lyon_have_the_stated_clocks() {
    let mut by_shift = 0;
    for seed in 0..CONFIGURATIONS {
        let (_, core) = random(device("lyon"), seed);
        by_shift += u64::from(core.design.find("shift").is_some());
        assert_stated_clocks_are_right(&core);
    }
    assert!((1..CONFIGURATIONS).contains(&by_shift), "{by_shift} by shift");
}

/// The domain holds one shift; the port takes every one.
#[test]
fn a_domain_with_a_single_shift_has_clocks_for_every_shift() {
    let domain = "[domain]\nexponent_min = 100\nexponent_max = 150\n";
    let core = with_keys(device("lyon"), domain).expect("a design");
    let operand = core.contract.operands().iter().find(|operand| operand.name == "shift").cloned();
    let (low, high) = operand.expect("shift").domain;
    assert_eq!(low, high);
    assert_stated_clocks_are_right(&core);
}

/// Clocks that were measured at the domain's corners and are right stay as they were.
#[test]
fn shipped_configurations_have_the_clocks_of_their_microprograms() {
    let expected = [
        ("blinn", Some(10)),
        ("cosine_power", Some(8)),
        ("gauss", Some(10)),
        ("lyon", None),
        ("quad_cosine", Some(1)),
        ("quadratic", Some(5)),
        ("rough", Some(11)),
        ("schlick", Some(14)),
        ("threshold", Some(5)),
    ];
    let all = configurations();
    for (name, clocks) in expected {
        let path = format!("configs/{name}.toml");
        let (_, core) = all.iter().find(|(found, _)| *found == path).expect("a configuration");
        assert_eq!(core.timing().expect("a timing").clocks_per_point(), clocks, "{name}");
    }
}

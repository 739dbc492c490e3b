//! Proofs against the simulation: what is noticed is never proved equivalent.

use std::path::Path;

use super::proof::Prover;
use super::{Faults, plant};
use crate::config;
use crate::cosim::Lockstep;
use crate::flow::Unit;
use crate::registry::Registry;

/// Points in which most faults show.
const POINTS: u64 = 200;

fn unit(path: &str) -> Unit {
    let registry = Registry::catalogue();
    let config = config::read(Path::new(path), &registry.schemas()).unwrap();
    Unit::new(*registry.device(&config.device).unwrap(), config).unwrap()
}

#[test]
fn no_proof_of_what_shows() {
    for path in ["configs/cosine_power.toml", "configs/schlick.toml"] {
        let unit = unit(path);
        let prover = Prover::new(&unit.design).unwrap();
        let sound = plant::bare(&unit.design);
        let (mut proved, mut noticed) = (0, 0);
        for fault in Faults::of(&unit.design).iter() {
            let is_proved = prover.proves(&fault.site).is_some();
            let mutant = fault.planted(&sound);
            let model = (unit.device.model)(&unit.config);
            let lockstep = Lockstep::new(&mutant, model, unit.contract.as_ref(), 5).unwrap();
            let shows = lockstep.run_alone(POINTS).unwrap().mismatch.is_some();
            assert!(!(is_proved && shows), "{path}: {}", fault.id);
            proved += u32::from(is_proved);
            noticed += u32::from(shows);
        }
        assert!(
            proved > 100 && noticed > 1000,
            "{path}: {proved}, {noticed}"
        );
    }
}

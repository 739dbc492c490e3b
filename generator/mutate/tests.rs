//! Proofs against the simulation: what is noticed is never proved equivalent.

use std::path::Path;

use rayon::prelude::*;

use super::proof::Prover;
use super::{Faults, plant};
use crate::config;
use crate::core::Unit;
use crate::cosim::Lockstep;
use crate::registry::Registry;

/// One in so many faults is planted: not a multiple of three, as for each bit there are three.
const EVERY: usize = 29;

/// Points in which most faults show.
const POINTS: u64 = 200;

fn unit(path: &str) -> Unit {
    let registry = Registry::catalogue();
    let config = config::read(Path::new(path), &registry.schemas()).unwrap();
    Unit::new(*registry.device(&config.device).unwrap(), config).unwrap()
}

#[test]
fn no_proof_of_what_shows() {
    let devices = Registry::catalogue();
    let (mut proved, mut noticed) = (0, 0);
    for device in devices.devices() {
        let path = format!("configs/{}.toml", device.name.replace('-', "_"));
        let unit = unit(&path);
        let prover = Prover::new(&unit.design).unwrap();
        let sound = plant::bare(&unit.design);
        let faults = Faults::of(&unit.design);
        let faults: Vec<_> = faults.iter().step_by(EVERY).collect();
        let of_each: Vec<(bool, bool)> = faults
            .par_iter()
            .map(|fault| {
                let is_proved = prover.proves(&fault.site).is_some();
                let mutant = fault.planted(&sound);
                let model = (unit.device.model)(&unit.config);
                let lockstep = Lockstep::new(&mutant, model, unit.contract.as_ref(), 5).unwrap();
                let shows = lockstep.run_alone(POINTS).unwrap().mismatch.is_some();
                assert!(!(is_proved && shows), "{path}: {}", fault.id);
                (is_proved, shows)
            })
            .collect();
        proved += of_each.iter().filter(|(is_proved, _)| *is_proved).count();
        noticed += of_each.iter().filter(|(_, shows)| *shows).count();
    }
    assert!(proved > 100 && noticed > 1000, "{proved}, {noticed}");
}

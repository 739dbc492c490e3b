//! Random configurations over the whole stated ranges: whatever the configuration accepts is generated,
//! equals its golden model on every clock, stays within the bound that was stated beforehand, is clean
//! Verilog, and passes its own bench in Icarus Verilog.

mod common;

use glint::config::sample;
use glint::flow::Unit;
use glint::registry::{Device, Registry};
use rayon::prelude::*;

/// Configurations of each device that are simulated inside the program.
const SIMULATED: u64 = 400;

/// Points of each.
const POINTS: u64 = 150;

fn units(device: &Device, seeds: std::ops::Range<u64>) -> impl ParallelIterator<Item = (String, Unit)> {
    let device = *device;
    let name = device.name;
    seeds.into_par_iter().map(move |seed| {
        let schema = (device.schema)();
        let config = sample(&schema, seed);
        let toml = format!("{name}, seed {seed}\n{}", config.to_toml(&schema));
        let unit = Unit::new(device, config).unwrap_or_else(|error| panic!("{error:?}\n{toml}"));
        (toml, unit)
    })
}

#[test]
fn golden_model_and_simulation_agree_and_the_bound_holds() {
    for device in Registry::catalogue().devices() {
        units(device, 0..SIMULATED).for_each(|(toml, unit)| {
            let bound = unit.contract.bound();
            let outcome = unit
                .lockstep(7)
                .and_then(|mut lockstep| lockstep.run(POINTS, None, &mut |_| ()))
                .unwrap_or_else(|error| panic!("{error:?}\n{toml}"));
            assert!(outcome.mismatch.is_none(), "{:?}\n{toml}", outcome.mismatch);
            assert_eq!(outcome.points, POINTS);
            if let Some(worst) = outcome.worst {
                assert!(worst.units <= bound.units, "{worst:?} is beyond {bound:?}\n{toml}");
            }
        });
    }
}

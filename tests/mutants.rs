//! Faults put into a design are noticed: two words of a ROM, two words of the microprogram or two
//! inputs of a mux change places, and the lock-step comparison with the golden model must differ.
//!
//! What survives is listed in [`EQUIVALENT`], with the reason why the fault changes nothing that the
//! device does. The list is exact: an entry that is noticed after all is an error too.

mod common;

use std::collections::BTreeSet;

use common::units::configurations;
use glint::cosim::{Lockstep, Random};
use glint::flow::Unit;
use glint::netlist::{Design, Driver, NetId, Op, RomId};
use rayon::prelude::*;

/// Points after which a fault counts as unnoticed. Most are noticed within a few.
const POINTS: u64 = 40_000;

/// Pairs of words drawn from a ROM that has too many for all of them.
const SAMPLE: usize = 300;

/// A ROM of at most so many words is tried in all its pairs.
const ALL_PAIRS: usize = 32;

/// Device, fault, and why it changes nothing.
const EQUIVALENT: [(&str, &str, &str); 3] = [
    ("rough", "ROM control: words 2 and 4", SETTLE),
    ("rough", "ROM control: words 2 and 6", SETTLE),
    ("rough", "ROM control: words 4 and 6", SETTLE),
];

/// Of the patent's words that load nothing. `tests/rough_microprogram.rs` notices them in the ROM itself.
const SETTLE: &str = "both load nothing and address ROM 18 by register 2; they differ in V1 V2 alone, \
     which steers the multiplier while no register takes its product";

struct Mutant {
    what: String,
    design: Design,
}

/// Every fault of every kind. The tables of a device that walks lines are left out: its points share an
/// exponent and are neighbours, so that a run sees few of their words. `tests/lines.rs` has all of them.
fn mutants(unit: &Unit) -> Vec<Mutant> {
    let design = &unit.design;
    let mut mutants = Vec::new();
    for id in (0..design.roms.len()).map(|at| RomId(at as u32)) {
        if id == design.control.rom || unit.contract.length().is_none() {
            rom_words(design, id, &mut mutants);
        }
    }
    for (id, net) in design.iter() {
        if let Driver::Op(Op::Mux { inputs, .. }) = &net.driver {
            mux_inputs(design, id, inputs.len(), &mut mutants);
        }
    }
    mutants
}

/// Words that differ change places. With those of the control ROM the words of the microprogram do.
fn rom_words(design: &Design, id: RomId, mutants: &mut Vec<Mutant>) {
    let words = &design.rom(id).words;
    let mut pairs = BTreeSet::new();
    if words.len() <= ALL_PAIRS {
        pairs.extend((0..words.len()).flat_map(|b| (0..b).map(move |a| (a, b))));
    } else {
        pairs.extend((1..words.len()).map(|b| (b - 1, b)));
        let mut random = Random::new(1);
        let mut draw = || random.below(words.len() as u64) as usize;
        let sample = std::iter::from_fn(|| Some((draw(), draw())));
        let differ = |&(a, b): &(usize, usize)| a < b && words[a] != words[b];
        pairs.extend(sample.filter(differ).take(SAMPLE));
    }
    for (a, b) in pairs.into_iter().filter(|&(a, b)| words[a] != words[b]) {
        let mut mutant = design.clone();
        mutant.roms[id.index()].words.swap(a, b);
        if id == design.control.rom {
            mutant.control.words.swap(a, b);
        }
        mutants.push(Mutant {
            what: format!("ROM {}: words {a} and {b}", design.rom(id).name),
            design: mutant,
        });
    }
}

/// Inputs that are different nets change places.
fn mux_inputs(design: &Design, id: NetId, inputs: usize, mutants: &mut Vec<Mutant>) {
    for b in 0..inputs {
        for a in 0..b {
            let mut mutant = design.clone();
            let Driver::Op(Op::Mux { inputs, .. }) = &mut mutant.nets[id.index()].driver else {
                unreachable!("the net is driven by a mux");
            };
            if inputs[a] == inputs[b] {
                continue;
            }
            inputs.swap(a, b);
            mutants.push(Mutant {
                what: format!("mux {}: inputs {a} and {b}", design.net(id).name),
                design: mutant,
            });
        }
    }
}

/// Whether golden model and mutant agree on every clock.
fn survives(unit: &Unit, mutant: &Mutant) -> bool {
    let model = (unit.device.model)(&unit.config);
    let outcome = Lockstep::new(&mutant.design, model, unit.contract.as_ref(), 3)
        .and_then(|lockstep| lockstep.run(POINTS, &|_| ()))
        .unwrap_or_else(|error| panic!("{}: {error:?}", mutant.what));
    outcome.mismatch.is_none()
}

fn assert_all_are_noticed(path: &str, unit: &Unit) {
    let mutants = mutants(unit);
    let of_roms = mutants
        .iter()
        .filter(|mutant| mutant.what.starts_with("ROM "))
        .count();
    assert!(
        of_roms > 0 && of_roms < mutants.len(),
        "{path}: a kind of fault is missing"
    );
    let survivors: BTreeSet<String> = mutants
        .par_iter()
        .filter(|mutant| survives(unit, mutant))
        .map(|mutant| mutant.what.clone())
        .collect();
    let expected: BTreeSet<String> = EQUIVALENT
        .iter()
        .filter(|(device, ..)| *device == unit.device.name)
        .map(|(_, what, _)| (*what).to_owned())
        .collect();
    println!(
        "{path}: {} faults, {of_roms} of them in ROMs, {} equivalent",
        mutants.len(),
        expected.len()
    );
    let unnoticed: Vec<&String> = survivors.difference(&expected).collect();
    assert!(
        unnoticed.is_empty(),
        "{path}: nothing notices {unnoticed:#?}"
    );
    let noticed: Vec<&String> = expected.difference(&survivors).collect();
    assert!(
        noticed.is_empty(),
        "{path}: not equivalent after all: {noticed:#?}"
    );
}

#[test]
fn every_fault_is_noticed() {
    for (path, unit) in configurations() {
        assert_all_are_noticed(&path, &unit);
    }
}

#[test]
fn without_a_fault_nothing_is_noticed() {
    for (path, unit) in configurations() {
        let mutant = Mutant {
            what: "none".to_owned(),
            design: unit.design.clone(),
        };
        assert!(survives(&unit, &mutant), "{path}");
    }
}

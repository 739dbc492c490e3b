//! Faults put into a design are noticed: two words of a ROM, two words of the microprogram or two
//! inputs of a mux change places, and the lock-step comparison with the golden model must differ.

mod common;

use std::collections::BTreeSet;

use common::units::configurations;
use glint::cosim::{Lockstep, Random};
use glint::fixed::Format;
use glint::flow::Unit;
use glint::golden::{Bound, Contract, Operand};
use glint::netlist::{Design, Driver, NetId, Op, RegisterKind, RomId};
use rayon::prelude::*;

/// Points after which a fault counts as unnoticed. Most are noticed within a few.
const POINTS: u64 = 500_000;

/// Pairs of words drawn from a ROM that has too many for all of them.
const SAMPLE: usize = 300;

/// A ROM of at most so many words is tried in all its pairs.
const ALL_PAIRS: usize = 32;

struct Mutant {
    what: String,
    design: Design,
    /// The operand that addresses the ROM at fault, and the two words.
    aim: Option<(String, i64, i64)>,
}

/// The contract of a device with the domain of one operand narrowed, so that the stimulus meets it.
struct Aimed<'a> {
    contract: &'a dyn Contract,
    operands: Vec<Operand>,
}

impl<'a> Aimed<'a> {
    fn new(contract: &'a dyn Contract, aim: Option<&(String, i64, i64)>) -> Self {
        let mut operands = contract.operands().to_vec();
        if let Some((name, low, high)) = aim {
            let aimed = operands.iter_mut().find(|operand| operand.name == *name);
            aimed.expect("an operand").domain = (*low, *high);
        }
        Self { contract, operands }
    }
}

impl Contract for Aimed<'_> {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }
    fn outputs(&self) -> &[String] {
        self.contract.outputs()
    }
    fn f_format(&self) -> Format {
        self.contract.f_format()
    }
    fn f(&self, control: &[i64]) -> i64 {
        self.contract.f(control)
    }
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.contract.colour(f, colour)
    }
    fn reference(&self, control: &[i64]) -> f64 {
        self.contract.reference(control)
    }
    fn references(&self, control: &[i64]) -> [f64; 2] {
        self.contract.references(control)
    }
    fn point(&self, control: &[i64], index: u64) -> Vec<i64> {
        self.contract.point(control, index)
    }
    fn length(&self) -> Option<&str> {
        self.contract.length()
    }
    fn bound(&self) -> Bound {
        self.contract.bound()
    }
}

/// The operand whose register is the address of a ROM.
fn addressing_operand(design: &Design, rom: RomId) -> Option<String> {
    let net = design.net(design.rom(rom).address);
    let is_operand = matches!(net.driver, Driver::Register(id)
        if design.register(id).kind == RegisterKind::Operand);
    is_operand.then(|| net.name.trim_end_matches("_reg").to_owned())
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
        // Words that are all alike have no such pair.
        let sample = std::iter::repeat_with(|| (draw(), draw())).take(100 * SAMPLE);
        let differ = |&(a, b): &(usize, usize)| a < b && words[a] != words[b];
        pairs.extend(sample.filter(differ).take(SAMPLE));
    }
    let operand = addressing_operand(design, id);
    for (a, b) in pairs.into_iter().filter(|&(a, b)| words[a] != words[b]) {
        let mut mutant = design.clone();
        mutant.roms[id.index()].words.swap(a, b);
        if id == design.control.rom {
            mutant.control.words.swap(a, b);
        }
        mutants.push(Mutant {
            what: format!("ROM {}: words {a} and {b}", design.rom(id).name),
            design: mutant,
            aim: operand
                .clone()
                .map(|operand| (operand, a.min(b) as i64, a.max(b) as i64)),
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
                aim: None,
            });
        }
    }
}

/// Whether golden model and mutant agree on every clock.
fn survives(unit: &Unit, mutant: &Mutant) -> bool {
    let model = (unit.device.model)(&unit.config);
    let contract = Aimed::new(unit.contract.as_ref(), mutant.aim.as_ref());
    let outcome = Lockstep::new(&mutant.design, model, &contract, 3)
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
    println!(
        "{path}: {} faults, {of_roms} of them in ROMs",
        mutants.len()
    );
    let unnoticed: Vec<&str> = mutants
        .par_iter()
        .filter(|mutant| survives(unit, mutant))
        .map(|mutant| mutant.what.as_str())
        .collect();
    assert!(
        unnoticed.is_empty(),
        "{path}: nothing notices {unnoticed:#?}"
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
            aim: None,
        };
        assert!(survives(&unit, &mutant), "{path}");
    }
}

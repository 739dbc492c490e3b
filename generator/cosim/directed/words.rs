//! Computations that notice a fault in a word of a ROM.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use anyhow::Result;

use super::Candidate;
use super::side_by_side::{LANES, SideBySide};
use crate::golden::Contract;
use crate::hdl::netlist::Design;
use crate::hdl::sim::{Machine, Program};

/// Of the upper half of a word every other bit is tried: what notices it mostly notices the next, which weighs more.
const STEP: usize = 2;

/// Of the candidates, those that together notice every fault that any of them does: a bit of the upper half of a word
/// is inverted while those that read the word run.
pub fn chosen(
    design: &Design,
    contract: &dyn Contract,
    candidates: &[Candidate],
) -> Result<Vec<usize>> {
    let machine = Machine::new(Arc::new(Program::new(design)?));
    let mut device = SideBySide::new(design, contract, machine)?;
    let readers = readers(candidates);
    let mut chosen = BTreeSet::new();
    let mut first = 0;
    for (at, rom) in design.roms.iter().enumerate() {
        let words = first as u32..(first + rom.words.len()) as u32;
        first += rom.words.len();
        if at == design.control.rom.index() {
            continue;
        }
        let width = design.width(rom.data);
        let faults = readers.range(words).flat_map(|(word, readers)| {
            (width / 2..width).step_by(STEP).map(move |bit| (*word, 1 << bit, readers))
        });
        for (word, bit, readers) in faults {
            device.machine.invert(word as usize, bit);
            let operands = readers.iter().map(|&at| candidates[at].operands.as_slice());
            let shown = device.run(operands, |_, _| ())?;
            device.machine.invert(word as usize, bit);
            let pairs = readers.iter().zip(shown);
            let noticing: Vec<usize> = pairs
                .filter(|(at, shown)| candidates[**at].shown != *shown)
                .map(|(at, _)| *at)
                .collect();
            if !noticing.iter().any(|at| chosen.contains(at)) {
                chosen.extend(noticing.first());
            }
        }
    }
    Ok(chosen.into_iter().collect())
}

/// For each word the brightest of its readers, as many as there are lanes.
fn readers(candidates: &[Candidate]) -> BTreeMap<u32, Vec<usize>> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by_key(|&at| Reverse(candidates[at].class));
    let mut readers: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for at in order {
        for &word in &candidates[at].read {
            let readers = readers.entry(word).or_default();
            if readers.len() < LANES {
                readers.push(at);
            }
        }
    }
    readers
}

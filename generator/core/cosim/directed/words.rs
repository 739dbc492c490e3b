//! Finds computations that detect faults in the words of a design's ROMs.
//!
//! A computation detects a fault if its results change when a bit in the upper half of a word is inverted. The search tries
//! the candidates of the pool that read the word, and then computations with similar operands. The search gives up after twelve
//! rounds.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use anyhow::Result;

use super::PoolComputation;
use super::memories::Memories;
use super::side_by_side::{LANES, OutputTrace, SideBySide};
use crate::cosim::{PointSource, Random};
use glint_golden::{Contract, Operand};
use glint_rtl::netlist::Design;
use glint_rtl::sim::{CompiledDesign, Machine};

/// The largest number of clocks of a computation that the search tries for a ROM word. A longer computation reads a whole ROM,
/// and `directed` chooses it separately.
pub const LONGEST: u32 = 64;

/// The approximate number of clocks that the chosen computations may take, at one computation for each word. If all words would
/// take more, only every n-th word has computations, evenly over all memories. A word can need several computations. With two
/// lights, for example, the bench of `shading` has 168 000 clocks, which Icarus Verilog simulates in five seconds.
const MOST_CLOCKS: u64 = 40_000;

/// The number of rounds that try other computations for a word, if no candidate detects a fault in it. Operands stay in their
/// domains for `ROUNDS` rounds, and then in their formats for `ROUNDS_BEYOND` rounds.
const ROUNDS: usize = 6;
const ROUNDS_BEYOND: usize = 6;

/// The number of tried computations that survive a round: a fault in the word changes their results most. The next round tries
/// computations near them.
const KEPT: usize = 8;

/// The computations that were chosen because they detect faults in ROM words.
#[derive(Default)]
pub struct Chosen {
    pub chosen: BTreeSet<usize>,
    /// The raw operands of computations that the search has added.
    pub found: Vec<Vec<i64>>,
    /// Computations were chosen for every `word_stride`-th word that the candidates read.
    pub word_stride: usize,
}

/// Chooses computations that detect faults in ROM words, from the `candidates` and from further computations near them. The
/// words with the numbers in `known` and the control ROM need no computation.
///
/// # Errors
/// Fails if the design cannot be simulated, if it does not belong to the contract, or if a computation does not end.
pub fn chosen(
    design: &Design,
    contract: &dyn Contract,
    candidates: &[PoolComputation],
    known: &BTreeSet<u32>,
) -> Result<Chosen> {
    let mut copied = design.clone();
    let memories = Memories::copied(&mut copied, LANES);
    let machine = Machine::new(Arc::new(CompiledDesign::new(&copied)?));
    let device = SideBySide::new(&copied, contract, machine)?.with_copies(&copied, memories)?;
    let points = PointSource::new(contract);
    let random = Random::new(3);
    let mut search = WordSearch { device, points, random, candidates, result: Chosen::default() };
    let mut widths = Vec::new();
    for rom in &design.roms {
        let width = if design.is_control_memory(rom) { 0 } else { design.width(rom.data) };
        widths.extend(std::iter::repeat_n(width, rom.words.len()));
    }
    let mut readers = readers(candidates);
    readers.retain(|word, _| !known.contains(word));
    let stride = word_stride(candidates, &readers);
    search.result.word_stride = stride;
    for (word, readers) in readers.into_iter().step_by(stride) {
        let width = widths[word as usize];
        let upper = (width / 2..width).fold(0, |bits, bit| bits | 1 << bit);
        search.word(word, upper, &readers)?;
    }
    Ok(search.result)
}

/// Returns the smallest stride with which one computation for each chosen word takes at most about [`MOST_CLOCKS`] clocks.
fn word_stride(candidates: &[PoolComputation], readers: &BTreeMap<u32, Vec<usize>>) -> usize {
    let first = readers.values().filter_map(|readers| readers.first());
    let clocks: u64 = first.map(|&at| u64::from(candidates[at].shown.clocks)).sum();
    clocks.div_ceil(MOST_CLOCKS).max(1) as usize
}

/// Returns, for each word that is read, at most [`LANES`] candidates that read it, brightest first, without the candidates
/// that take more than [`LONGEST`] clocks.
fn readers(candidates: &[PoolComputation]) -> BTreeMap<u32, Vec<usize>> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.retain(|&at| candidates[at].shown.clocks <= LONGEST);
    order.sort_by_key(|&at| Reverse(candidates[at].class));
    let mut readers: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for at in order {
        for &word in &candidates[at].read {
            let of_word = readers.entry(word).or_default();
            if of_word.len() < LANES {
                of_word.push(at);
            }
        }
    }
    readers
}

struct WordSearch<'a> {
    device: SideBySide,
    points: PointSource<'a>,
    random: Random,
    candidates: &'a [PoolComputation],
    result: Chosen,
}

impl WordSearch<'_> {
    /// Chooses computations that detect the bits in the mask `left` of a word. `readers` has the candidates that read the
    /// word.
    fn word(&mut self, word: u32, mut left: u64, readers: &[usize]) -> Result<()> {
        let candidates = self.candidates;
        for at in readers {
            if self.result.chosen.contains(at) {
                let PoolComputation { operands, shown, .. } = &candidates[*at];
                left &= !self.noticed(word, left, operands, shown)?;
            }
        }
        let mut nearest: Vec<&[i64]> =
            readers.iter().map(|&at| candidates[at].operands.as_slice()).collect();
        let all = nearest.clone();
        // A computation that detects the lowest bit mostly detects the bits above it too, because they weigh more.
        let mut unnoticed = 0;
        // The latest bit that some computation detects. `climb` starts from it.
        let mut least = highest(left.max(1));
        while left & !unnoticed != 0 {
            let bit = lowest(left & !unnoticed);
            let shown = self.run(&all, word, bit)?;
            let mut noticing: Vec<usize> = Vec::new();
            for (&at, shown) in readers.iter().zip(&shown) {
                if candidates[at].shown != *shown {
                    noticing.push(at);
                }
            }
            let Some(&first) = noticing.first() else {
                unnoticed |= bit;
                continue;
            };
            nearest = noticing.iter().map(|&at| candidates[at].operands.as_slice()).collect();
            least = bit;
            self.result.chosen.insert(first);
            let PoolComputation { operands, shown, .. } = &candidates[first];
            left &= !(bit | self.noticed(word, left, operands, shown)?);
        }
        self.climb(word, left, least, nearest.iter().map(|operands| operands.to_vec()).collect())
    }

    /// Searches for computations that detect the bits in the mask `left` of a word. The search starts from `nearest`, which
    /// detect the bit `probe`. The search moves on to computations near them in which a fault of this bit changes the results
    /// more and more.
    ///
    /// Within the domain, some words are read only far from any highlight. The last rounds therefore take operands from their
    /// whole formats, where the golden model still predicts the device.
    fn climb(
        &mut self,
        word: u32,
        mut left: u64,
        mut probe: u64,
        nearest: Vec<Vec<i64>>,
    ) -> Result<()> {
        let mut round = 0;
        let mut kept: Vec<(u64, Vec<i64>)> = Vec::new();
        let mut tried = nearest;
        while left != 0 && round < ROUNDS + ROUNDS_BEYOND {
            let operands: Vec<&[i64]> = tried.iter().map(Vec::as_slice).collect();
            let fault_free = self.run(&operands, word, 0)?;
            let bit = highest(left);
            let shown = self.run(&operands, word, bit)?;
            if let Some(at) = fault_free.iter().zip(&shown).position(|(right, it)| right != it) {
                left &= !(bit | self.noticed(word, left, &tried[at], &fault_free[at])?);
                self.result.found.push(tried[at].clone());
                probe = bit;
                kept = vec![(1, tried[at].clone())];
            } else {
                // The bit `probe` was inverted already.
                let shown = if probe == bit { shown } else { self.run(&operands, word, probe)? };
                for (at, operands) in tried.into_iter().enumerate() {
                    kept.push((shown[at].differs(&fault_free[at]), operands));
                }
                kept.sort_by_key(|(shows, _)| Reverse(*shows));
                kept.truncate(KEPT);
                round += 1;
            }
            tried = self.near(&kept, round > ROUNDS);
        }
        Ok(())
    }

    /// Returns the outputs of computations with the bits in the mask `bits` of a word inverted.
    fn run(&mut self, computations: &[&[i64]], word: u32, bits: u64) -> Result<Vec<OutputTrace>> {
        let faults: Vec<u64> = vec![bits; computations.len()];
        self.device.run_with(computations, word, &faults)
    }

    /// Returns the bits in the mask `bits` of a word for which a computation detects a fault in this bit alone. `right` must be
    /// the computation's output without a fault.
    fn noticed(
        &mut self,
        word: u32,
        bits: u64,
        operands: &[i64],
        right: &OutputTrace,
    ) -> Result<u64> {
        let mut single_bits: Vec<u64> = (0..u64::BITS).map(|bit| bits & 1 << bit).collect();
        single_bits.retain(|&bit| bit != 0);
        let mut noticed = 0;
        for faults in single_bits.chunks(LANES) {
            let shown = self.device.run_with(&vec![operands; faults.len()], word, faults)?;
            for (bit, shown) in faults.iter().zip(shown) {
                if shown != *right {
                    noticed |= bit;
                }
            }
        }
        Ok(noticed)
    }

    /// Draws one computation for each lane near the computations in `kept`. A quarter of them are then moved to where the
    /// formula has a random value from 0 to 1. If `beyond` is true, control operands may leave their domains.
    fn near(&mut self, kept: &[(u64, Vec<i64>)], beyond: bool) -> Vec<Vec<i64>> {
        let Self { points, random, .. } = self;
        let operands = points.operands();
        let control = operands.iter().filter(|operand| !operand.colour).count();
        let mut all = Vec::with_capacity(LANES);
        for lane in 0..LANES {
            let mut values = kept[lane % kept.len()].1.clone();
            for (at, (operand, value)) in operands.iter().zip(&mut values).enumerate() {
                if points.length() != Some(at) {
                    *value = moved(random, operand, *value, beyond);
                }
            }
            if lane.is_multiple_of(4) {
                points.to_value(&mut values[..control], random.unit());
            }
            all.push(values);
        }
        all
    }
}

/// Returns a value near `raw` for an operand. A control operand moves by a random magnitude in half of the cases. A control
/// operand without fraction bits may also get a new random value. A colour is at most an eighth of its domain below its
/// largest value.
fn moved(random: &mut Random, operand: &Operand, raw: i64, beyond: bool) -> i64 {
    let (low, high) = if beyond && !operand.colour {
        (operand.format.min_raw() as i64, operand.format.max_raw() as i64)
    } else {
        operand.domain
    };
    if operand.colour {
        return high - random.magnitude(high.abs_diff(low) / 8) as i64;
    }
    let off = random.magnitude(high.abs_diff(low)) as i64;
    match random.below(8) {
        0 | 1 => raw.saturating_add(off).clamp(low, high),
        2 | 3 => raw.saturating_sub(off).clamp(low, high),
        4 if operand.format.frac <= 0 => random.within(low, high),
        _ => raw,
    }
}

fn lowest(bits: u64) -> u64 {
    bits & bits.wrapping_neg()
}

fn highest(bits: u64) -> u64 {
    1 << bits.ilog2()
}

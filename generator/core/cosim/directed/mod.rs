//! Chooses computations for the test bench that is emitted with a core, so that the bench detects faults in the core.
//!
//! A user who ports the core, edits a memory or changes the synthesis tool relies on this bench. Random points (sets of
//! operands) may miss words of a ROM and outcomes of a comparison. This module therefore draws a large pool of computations,
//! simulates them, and chooses some of them:
//!
//! - For each word of a ROM, except the control ROM, that any computation reads, and each bit in the upper half of the word:
//!   one computation whose results change if the bit is inverted. If the pool has no such computation, the module searches near
//!   the computations that read the word, and gives up after some rounds. For a device that computes a line of points, and
//!   reads a word in each clock, the module chooses a line that reads the word. If all this takes too many clocks, only every
//!   n-th word has such a computation.
//! - For a highlight device that computes lines: one line of the largest length in the contract's domain, but of at most 4095
//!   intervals.
//! - Every combination of the smallest and the largest values of the operands, but at most the first 128 combinations. Colours
//!   have only their largest value. Lines have at most three points in these combinations.
//! - For each bit of each net, each input of a mux and each outcome of a comparison: two computations that exercise this bit,
//!   input or outcome with large results, two with small results and two with results of 0. Fewer are chosen if the pool has no
//!   more, or if all chosen computations would take more than 20 000 clocks.
//!
//! The choice depends neither on time nor on threads: the same design always gets the same computations.

mod features;
mod memories;
mod pool;
mod side_by_side;
mod words;

use std::collections::{BTreeSet, BinaryHeap, HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;

use features::{CLASSES, Watch, observable};
use glint_base::fixed::mask;
use glint_golden::Contract;
use glint_rtl::netlist::Design;
use glint_rtl::sim::{CompiledDesign, Machine};
use side_by_side::{LANES, OutputTrace, SideBySide};

/// The number of computations that must exercise each feature. If the pool has fewer for a feature, all of them are chosen.
const TIMES: u8 = 2;

/// The chosen computations may take this number of clocks before a computation is added for its features. Computations that
/// are chosen for ROM words do not obey this limit.
const MOST_CLOCKS: u32 = 20_000;

struct PoolComputation {
    operands: Vec<i64>,
    shown: OutputTrace,
    /// The class of the computation's brightest result; see [`class`].
    class: usize,
    features: Vec<u32>,
    /// The ROM words that the computation reads, numbered through all ROMs, in ascending order.
    read: Vec<u32>,
}

/// A cache of chosen computations. The key is the contract and the design without its name, so a sequential core and the
/// pipeline that is made from it share their computations.
#[derive(Default)]
pub struct ComputationCache(Mutex<HashMap<String, Arc<Mutex<Option<Computations>>>>>);

#[derive(Clone, Default)]
pub struct Computations {
    /// The raw operands of each computation, in the order of `Contract::operands`.
    pub operands: Vec<Vec<i64>>,
    /// The distance between two ROM words whose inverted bits a computation detects. For example, 2 means that every second
    /// word has such a computation.
    pub word_stride: usize,
}

impl ComputationCache {
    /// Returns the result of [`computations`] for a design, whatever its name, from the cache if it is there. `contract_digest`
    /// must be different for different contracts.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated, or if a computation does not end. A failure is not cached.
    pub fn computations(
        &self,
        design: &Design,
        contract: &dyn Contract,
        contract_digest: &str,
    ) -> Result<Computations> {
        let unnamed = Design { name: String::new(), ..design.clone() };
        let key = format!("{contract_digest} {unnamed}");
        let slot = {
            let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            known.entry(key).or_default().clone()
        };
        // A thread that wants the same computations waits here.
        let mut found = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if found.is_none() {
            *found = Some(computations(design, contract)?);
        }
        Ok(found.clone().unwrap_or_default())
    }
}

/// Chooses the computations of the test bench of a design. The same design always gets the same computations.
///
/// # Errors
/// Fails if the design cannot be simulated, if design and contract do not have the same operands and outputs, if the design is
/// a pipeline, or if a computation does not end.
pub fn computations(design: &Design, contract: &dyn Contract) -> Result<Computations> {
    let observed = observable(design);
    let machine = Machine::new(Arc::new(CompiledDesign::new(&observed)?));
    let mut device = SideBySide::new(&observed, contract, machine)?;
    let mut watch = Watch::new(&observed);
    let mut candidates = Vec::new();
    let pool = pool::pool(contract);
    let mut batches = Vec::new();
    for (points, watched) in
        [(&pool.corners, true), (&pool.drawn, true), (&pool.readers, false), (&pool.sweeps, false)]
    {
        for batch in points.chunks(LANES) {
            batches.push((batch, watched));
        }
    }
    for (batch, watched) in batches {
        let shown = device.run(batch.iter().map(Vec::as_slice), |machine, busy| {
            if watched { watch.note(machine, busy) } else { watch.note_words(machine, busy) }
        })?;
        for (lane, (operands, shown)) in batch.iter().zip(shown).enumerate() {
            let class = class(contract, &shown);
            let (features, read) = watch.take(lane, class);
            candidates.push(PoolComputation {
                operands: operands.clone(),
                shown,
                class,
                features,
                read,
            });
        }
    }
    let mut chosen: Vec<usize> = (0..pool.corners.len()).collect();
    if contract.length().is_some() {
        let first = watch.count() as u32;
        for candidate in &mut candidates {
            if candidate.class + 1 == CLASSES {
                candidate.features.extend(candidate.read.iter().map(|word| first + word));
            }
        }
        let sweeping = candidates.len() - pool.sweeps.len();
        chosen.extend(sweeps(&candidates[sweeping..]).into_iter().map(|at| sweeping + at));
    }
    let mut known = BTreeSet::new();
    for &at in &chosen {
        if candidates[at].shown.clocks > words::LONGEST {
            known.extend(candidates[at].read.iter().copied());
        }
    }
    let of_words = words::chosen(design, contract, &candidates, &known)?;
    chosen.extend(of_words.chosen);
    chosen.sort_unstable();
    chosen.dedup();
    let words: usize = design.roms.iter().map(|rom| rom.words.len()).sum();
    choose(&candidates, watch.count(), watch.count() + words, &mut chosen);
    let mut operands = Vec::new();
    for at in chosen {
        operands.push(candidates[at].operands.clone());
    }
    operands.extend(of_words.found);
    Ok(Computations { operands, word_stride: of_words.word_stride })
}

/// Chooses lines that read many words of tables, by their indices in `lines`. The first line, which is the longest, is always
/// chosen. Another line is chosen if the number of words that it is the first to read exceeds half of its clocks.
fn sweeps(lines: &[PoolComputation]) -> Vec<usize> {
    let mut read = HashSet::new();
    let mut chosen = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let news = line.read.iter().filter(|word| !read.contains(*word)).count();
        if at == 0 || 2 * news > line.shown.clocks as usize {
            read.extend(line.read.iter().copied());
            chosen.push(at);
        }
    }
    chosen
}

/// Returns the class of the brightest result; see [`features::CLASSES`].
fn class(contract: &dyn Contract, shown: &OutputTrace) -> usize {
    let mut class = 0;
    for (_, outputs) in &shown.results {
        for (it, &output) in contract.outputs().iter().zip(outputs) {
            let most = mask(it.format.width());
            class = class.max(usize::from(output > 0) + usize::from(output > most / 16));
        }
    }
    class
}

/// Adds candidates to `chosen`, always the candidate that exercises the most missing features per clock, as long as
/// [`MOST_CLOCKS`] allows. Features from number `words` on are ROM words, which must be read only once; `count` is the number
/// of all features.
fn choose(candidates: &[PoolComputation], words: usize, count: usize, chosen: &mut Vec<usize>) {
    let mut coverage = FeatureCoverage { wanted: vec![TIMES; count], clocks: 0 };
    coverage.wanted[words..].fill(1);
    for &at in &*chosen {
        coverage.add(&candidates[at]);
    }
    // The gain of a candidate only falls as other candidates are chosen. The candidate at the top of the heap is therefore the
    // best if its gain has not changed.
    let mut heap = BinaryHeap::new();
    for (at, candidate) in candidates.iter().enumerate() {
        heap.push((coverage.gain(candidate), std::cmp::Reverse(at)));
    }
    while let Some((stated, std::cmp::Reverse(at))) = heap.pop() {
        let now = coverage.gain(&candidates[at]);
        if now == 0 {
            continue;
        }
        if now < stated {
            heap.push((now, std::cmp::Reverse(at)));
        } else if coverage.clocks + candidates[at].shown.clocks <= MOST_CLOCKS {
            coverage.add(&candidates[at]);
            chosen.push(at);
        }
    }
}

/// The number of times that each feature must still be exercised, and the clocks of the chosen computations.
struct FeatureCoverage {
    wanted: Vec<u8>,
    clocks: u32,
}

impl FeatureCoverage {
    fn add(&mut self, computation: &PoolComputation) {
        self.clocks += computation.shown.clocks;
        for &feature in &computation.features {
            let wanted = &mut self.wanted[feature as usize];
            *wanted = wanted.saturating_sub(1);
        }
    }

    /// Returns the number of missing features that a computation would add, per 2^20 clocks.
    fn gain(&self, computation: &PoolComputation) -> u64 {
        let mut news: u64 = 0;
        for &feature in &computation.features {
            news += u64::from(self.wanted[feature as usize] > 0);
        }
        (news << 20) / u64::from(computation.shown.clocks.max(1))
    }
}

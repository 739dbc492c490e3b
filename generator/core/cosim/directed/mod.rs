//! Chooses computations for the test bench that is emitted with a core, so that the bench detects faults in the core.
//!
//! A user who ports the core, edits a memory or changes the synthesis tool relies on this bench. Random points (sets of operands)
//! reach neither every word of a ROM nor both outcomes of every comparison. This module therefore draws a large pool of
//! computations, simulates them, and chooses some of them:
//!
//! - For each ROM word that any computation reads, and each bit in the upper half of the word: one computation whose results
//!   change if the bit is inverted. If the pool has none, the module searches near the computations that read the word. For a
//!   device that computes a line of points, and reads a word a clock, it chooses a line that reads the word. If all this takes
//!   too many clocks, only every second word has such a computation, or every third, and so on.
//! - For a device that computes lines: one line of the largest length in the contract's domain.
//! - Every combination of the smallest and the largest values of the operands that determine `f`.
//! - For each bit of each net, each input of a mux and each outcome of a comparison: some computations that exercise it with
//!   large results, some with small results and some with results of 0.
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

/// The number of computations that must show each feature, or all of them if there are fewer.
const TIMES: u8 = 2;

/// Clocks of all computations together.
const MOST_CLOCKS: u32 = 20_000;

/// A computation of the pool.
struct PoolComputation {
    operands: Vec<i64>,
    shown: OutputTrace,
    /// How bright its results are, as a class.
    class: usize,
    features: Vec<u32>,
    /// The words that it reads, numbered through all ROMs.
    read: Vec<u32>,
}

/// A cache of chosen computations, by design. A core and the pipeline that is made from it have the same computations.
#[derive(Default)]
pub struct ComputationCache(Mutex<HashMap<String, Arc<Mutex<Option<Computations>>>>>);

/// The computations that were chosen for a test bench.
#[derive(Clone, Default)]
pub struct Computations {
    /// The raw operands of each computation, in the order of `Contract::operands`.
    pub operands: Vec<Vec<i64>>,
    /// The spacing of the ROM words that have a computation which detects an inverted bit: every word if this is 1, every second
    /// word if it is 2, and so on.
    pub word_stride: usize,
}

impl ComputationCache {
    /// Returns [`computations`] of a design from the cache, or chooses and caches them. The name of the design does not matter;
    /// `contract_digest` tells one contract from another.
    ///
    /// # Errors
    /// Fails as [`computations`] does.
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

/// Chooses the computations of the test bench of a design.
///
/// # Errors
/// Fails if the design cannot be simulated, or does not belong to the contract.
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

/// Chooses lines that read table after table: the first line, which is the longest, and each line that reads mostly new
/// words.
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

/// Returns a class for the brightest result: 0 in the dark, 1 dim, 2 beyond a sixteenth of the largest output.
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

/// Adds the candidates that show, per clock, the most features that were not shown often enough. It ends when no feature is
/// missing or there are enough clocks. Features from number `words` on are ROM words, which must be read once.
fn choose(candidates: &[PoolComputation], words: usize, count: usize, chosen: &mut Vec<usize>) {
    let mut coverage = FeatureCoverage { wanted: vec![TIMES; count], clocks: 0 };
    coverage.wanted[words..].fill(1);
    for &at in &*chosen {
        coverage.add(&candidates[at]);
    }
    // The gain of a candidate only falls as others are chosen. The first candidate whose gain has not changed is therefore
    // the best.
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

/// The features that the chosen computations still lack, and their clocks.
struct FeatureCoverage {
    /// How many more times each feature must be shown.
    wanted: Vec<u8>,
    /// The clocks of all chosen computations.
    clocks: u32,
}

impl FeatureCoverage {
    /// Adds a computation.
    fn add(&mut self, computation: &PoolComputation) {
        self.clocks += computation.shown.clocks;
        for &feature in &computation.features {
            let wanted = &mut self.wanted[feature as usize];
            *wanted = wanted.saturating_sub(1);
        }
    }

    /// Returns the number of features that a computation would add, per 2^20 clocks.
    fn gain(&self, computation: &PoolComputation) -> u64 {
        let mut news: u64 = 0;
        for &feature in &computation.features {
            news += u64::from(self.wanted[feature as usize] > 0);
        }
        (news << 20) / u64::from(computation.shown.clocks.max(1))
    }
}

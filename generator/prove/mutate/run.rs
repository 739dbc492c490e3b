//! Plants faults one at a time in a core's netlist, and finds the verdict on each: caught by a check, proved equivalent, or
//! undecided.
//!
//! For each fault, the module tries in turn a short test, the proofs, the default test and a last check, until one of them
//! decides. For a fault in a table, the last check is directed tests. For any other fault in a pipeline, it is a search for a
//! point at which the mutant differs. For a fault that is not proved equivalent, the module also finds whether the shipped bench
//! notices it.

use std::sync::OnceLock;

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::coverage::{Coverage, OperandValues, TestPlace};
use super::fault::{NetlistFault, Site};
use super::pinned_operands::{self, Tried};
use super::plant;
use super::proof::Prover;
use super::verdict::{Detector, FaultResult, How, MutantVerdict, SignalDifference};
use super::witness_search::PointSearch;
use glint_core::core::{self, Core};
use glint_core::cosim::{Lockstep, Mismatch};
use glint_core::observation::Vectors;
use glint_golden::Model;
use glint_rtl::netlist::{Design, RomId};

/// The number of points of the short test. They are the first points of the default test's first stream, so the default test also
/// finds a difference in them.
const FIRST_POINTS: u64 = 256;

/// A longer test that may read words which the default test does not read.
const BEYOND_POINTS: u64 = 1_000_000;
const BEYOND_SEED: u64 = 2;

/// Plants each of `faults` in turn, checks the mutant, and returns the verdicts in the same order. Calls `progress` after each
/// fault.
///
/// # Errors
///
/// Fails if a mutant cannot be simulated, or if golden model and fault-free simulation disagree. The message may have the fault's
/// id.
pub fn run<'f>(
    core: &Core,
    faults: impl IntoIterator<Item = &'f NetlistFault>,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<FaultResult>> {
    let lockstep = core.lockstep(core::TEST_SEED)?;
    let sound = plant::bare(&core.design);
    let pipeline = sound.pipeline.as_ref();
    let beside =
        pipeline.map(|it| PointSearch::new(&sound, it, core.contract.as_ref())).transpose()?;
    let bench = Bench {
        core,
        sound,
        beside,
        model: core.opened.golden(),
        prover: Prover::new(&core.design),
        tested: Coverage::of(&core.design, &lockstep, core::TEST_POINTS)?,
        beyond: OnceLock::new(),
        shipped: core.shipped_vectors()?,
        latency: core.design.pipeline.as_ref().map_or(0, |it| it.stages.len() as u64),
    };
    let faults: Vec<&NetlistFault> = faults.into_iter().collect();
    faults
        .into_par_iter()
        .map(|fault| {
            let found = bench.found(fault);
            progress();
            found.with_context(|| format!("the mutant `{}`", fault.id))
        })
        .collect()
}

/// The state that the checks of all faults of a configuration share.
struct Bench<'a> {
    core: &'a Core,
    sound: Design,
    beside: Option<PointSearch>,
    model: Box<dyn Model>,
    prover: Option<Prover<'a>>,
    /// The positions at which the default test reads each ROM word.
    tested: Coverage,
    /// The positions in a longer test, computed at the first use.
    beyond: OnceLock<Coverage>,
    shipped: Vectors,
    /// The number of stages of a pipeline, which is the largest number of points in it; 0 for a sequential core.
    latency: u64,
}

impl Bench<'_> {
    fn found(&self, fault: &NetlistFault) -> Result<FaultResult> {
        let mutant = fault.planted(&self.sound);
        let verdict = self.verdict(fault, &mutant)?;
        // A fault that changes nothing that is compared changes no output.
        let shipped = !matches!(verdict, MutantVerdict::Equivalent(_))
            && self.shipped.notice_a_fault_in(&mutant)?;
        Ok(FaultResult { fault: fault.clone(), verdict, shipped })
    }

    fn verdict(&self, fault: &NetlistFault, mutant: &Design) -> Result<MutantVerdict> {
        if let Some(mismatch) = self.first_look(mutant, &fault.site)? {
            return Ok(caught(mismatch));
        }
        let prover = self.prover.as_ref();
        if let Some(how) = prover.and_then(|prover| prover.proves(&fault.site)) {
            return Ok(MutantVerdict::Equivalent(how));
        }
        let word = self.words(&fault.site);
        if word.is_none() || !self.places(&fault.site).is_empty() {
            let lockstep = self.lockstep(mutant, core::TEST_SEED)?;
            if let Some(mismatch) = lockstep.run(core::TEST_POINTS, &|_| ())?.mismatch {
                return Ok(caught(mismatch));
            }
        }
        match word {
            Some((rom, words)) => self.directed(mutant, rom, words),
            None => self.searched(mutant),
        }
    }

    /// Searches for a point at which the mutant of a pipeline differs from the fault-free pipeline, and confirms it with the
    /// golden model. Without such a point, the verdict is `Undecided`.
    fn searched(&self, mutant: &Design) -> Result<MutantVerdict> {
        let Some(beside) = &self.beside else {
            return Ok(MutantVerdict::Undecided);
        };
        let found =
            beside.search(mutant, |held| pinned_operands::alone(self.core, mutant, held))?;
        Ok(found
            .map_or(MutantVerdict::Undecided, |it| MutantVerdict::Caught(Detector::Directed, it)))
    }

    /// Returns the first difference in a short part of the default test.
    fn first_look(&self, mutant: &Design, site: &Site) -> Result<Option<Mismatch>> {
        let looks = match self.words(site) {
            Some(_) => self.places(site),
            None => vec![(core::TEST_SEED, FIRST_POINTS)],
        };
        self.shown(mutant, looks)
    }

    /// Returns the first difference in `streams`. A stream is a seed and the number of results to compare.
    fn shown(&self, mutant: &Design, streams: Vec<(u64, u64)>) -> Result<Option<Mismatch>> {
        for (seed, points) in streams {
            let mismatch = self.lockstep(mutant, seed)?.run_alone(points)?.mismatch;
            if mismatch.is_some() {
                return Ok(mismatch);
            }
        }
        Ok(None)
    }

    /// Runs a mutant with faulty table words: first with fixed operands that read the words, then with all operands if they have
    /// few enough bits. If no combination differs for any of the words, the verdict is `Equivalent`.
    fn directed(
        &self,
        mutant: &Design,
        rom: RomId,
        words: &[(usize, u64)],
    ) -> Result<MutantVerdict> {
        let directed = |difference| MutantVerdict::Caught(Detector::Directed, difference);
        let mut all_tried = true;
        for &(word, _) in words {
            let addressing = pinned_operands::addressing(self.core, rom, word);
            for held in addressing.iter().cloned().chain(self.readings(rom, word)?) {
                if let Some(difference) = pinned_operands::drawn(self.core, mutant, held)? {
                    return Ok(directed(difference));
                }
            }
            if let Some(mismatch) = self.beyond_shows(mutant, rom, word)? {
                return Ok(directed(SignalDifference { held: Vec::new(), mismatch }));
            }
            let tried = match addressing {
                Some(held) => {
                    pinned_operands::all(self.core, mutant, held, pinned_operands::MOST_BITS)?
                }
                None => pinned_operands::all(
                    self.core,
                    mutant,
                    OperandValues::new(),
                    pinned_operands::NARROW,
                )?,
            };
            match tried {
                Tried::All => {}
                Tried::Nothing => all_tried = false,
                Tried::Differs(held) => {
                    let shown = pinned_operands::drawn(self.core, mutant, held)?;
                    return Ok(shown.map_or(MutantVerdict::Undecided, directed));
                }
            }
        }
        Ok(if all_tried {
            MutantVerdict::Equivalent(How::Operands)
        } else {
            MutantVerdict::Undecided
        })
    }

    /// Returns the control operands of computations that read a word, as raw values by name.
    fn readings(&self, rom: RomId, word: usize) -> Result<Vec<OperandValues>> {
        let design = &self.sound;
        let mut readings: Vec<OperandValues> = self.tested.operands(design, rom, word).collect();
        if readings.is_empty() {
            readings = self.beyond()?.operands(design, rom, word).collect();
        }
        let contract = self.core.contract.operands();
        let is_colour = |name: &str| contract.iter().any(|it| it.colour && it.name == name);
        for reading in &mut readings {
            reading.retain(|(name, _)| !is_colour(name));
        }
        Ok(readings)
    }

    /// Returns the first difference in the streams of a longer test that read a word, if the default test does not read it.
    /// Returns `None` for a sequential core, where the operand registers give directed operands for the word.
    fn beyond_shows(&self, mutant: &Design, rom: RomId, word: usize) -> Result<Option<Mismatch>> {
        if self.latency == 0 || !self.tested.places(rom, word).is_empty() {
            return Ok(None);
        }
        self.shown(mutant, self.ends(self.beyond()?.places(rom, word)))
    }

    /// Returns the streams that read words: the seed, and the number of results up to the end of the computation after the read.
    /// For example, a read after 40 results in a pipeline of 7 stages gives the seed and 49.
    fn ends<'p>(&self, places: impl IntoIterator<Item = &'p TestPlace>) -> Vec<(u64, u64)> {
        let end = |place: &TestPlace| (place.seed, place.points + 2 + self.latency);
        places.into_iter().map(end).collect()
    }

    fn lockstep<'d>(&'d self, mutant: &'d Design, seed: u64) -> Result<Lockstep<'d>> {
        let contract = self.core.contract.as_ref();
        Lockstep::new(mutant, self.model.boxed_clone(), contract, seed)
    }

    /// Returns the table and its faulty words, each with its address. Returns `None` if the fault is not in a table, or is in the
    /// control ROM.
    fn words<'s>(&self, site: &'s Site) -> Option<(RomId, &'s [(usize, u64)])> {
        match site {
            Site::Words(rom, words) if *rom != self.sound.control.rom => Some((*rom, words)),
            _ => None,
        }
    }

    /// Returns the streams in which the default test reads the faulty words (`Self::ends`).
    fn places(&self, site: &Site) -> Vec<(u64, u64)> {
        let Some((rom, words)) = self.words(site) else {
            return Vec::new();
        };
        self.ends(words.iter().flat_map(|&(word, _)| self.tested.places(rom, word)))
    }

    fn beyond(&self) -> Result<&Coverage> {
        if let Some(coverage) = self.beyond.get() {
            return Ok(coverage);
        }
        let lockstep = self.lockstep(&self.sound, BEYOND_SEED)?;
        let coverage = Coverage::of(&self.sound, &lockstep, BEYOND_POINTS)?;
        Ok(self.beyond.get_or_init(|| coverage))
    }
}

fn caught(mismatch: Mismatch) -> MutantVerdict {
    let held = Vec::new();
    MutantVerdict::Caught(Detector::Cosim, SignalDifference { held, mismatch })
}

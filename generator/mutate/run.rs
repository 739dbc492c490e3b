//! Every fault of a configuration through the legs that may notice it.

use std::fmt;
use std::sync::OnceLock;

use anyhow::{Context, Result};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::aim::{self, Point};
use super::coverage::{Coverage, Place};
use super::fault::{Fault, Site};
use super::plant;
use super::proof::Prover;
use crate::cosim::{Lockstep, Mismatch};
use crate::flow::{self, Unit};
use crate::golden::Model;
use crate::netlist::Design;

/// Points of a first look. They are the first of the default test's first stream, so that what differs in
/// them differs in the test.
const FIRST_POINTS: u64 = 256;

/// The longer test in which words are looked for that the default test does not read.
const BEYOND_POINTS: u64 = 1_000_000;
const BEYOND_SEED: u64 = 2;

/// What notices a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Leg {
    /// The default test: golden model against built-in simulator.
    Cosim,
    /// Operands, or streams of a longer test, that read the words at fault.
    Aimed,
}

/// How a fault was proved equivalent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum How {
    /// By induction over the words of the microprogram.
    Induction,
    /// By every combination of the values around it.
    Exhaustion,
}

impl fmt::Display for Leg {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Cosim => "co-simulation",
            Self::Aimed => "aimed stimulus",
        })
    }
}

impl fmt::Display for How {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Induction => "by induction over the microprogram",
            Self::Exhaustion => "by every combination of the values around it",
        })
    }
}

/// What a leg showed.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// A signal, on a clock.
    Clock(Mismatch),
    /// A result.
    Point(Point),
}

/// What became of a mutant.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// A leg differs, and where.
    Caught(Leg, Difference),
    /// Proved to change nothing that is compared.
    Equivalent(How),
    /// Neither caught nor proved equivalent.
    Open,
}

/// A fault and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The fault.
    pub fault: Fault,
    /// What became of it.
    pub verdict: Verdict,
}

/// Plants every one of the faults in turn. `progress` is told of each that is done.
///
/// # Errors
/// A mutant that cannot be simulated.
pub fn run<'f>(
    unit: &Unit,
    faults: impl IntoIterator<Item = &'f Fault>,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Found>> {
    let lockstep = unit.lockstep(flow::TEST_SEED)?;
    let bench = Bench {
        unit,
        sound: plant::bare(&unit.design),
        model: (unit.device.model)(&unit.config),
        prover: Prover::new(&unit.design),
        tested: Coverage::of(&unit.design, &lockstep, flow::TEST_POINTS)?,
        beyond: OnceLock::new(),
    };
    let faults: Vec<&Fault> = faults.into_iter().collect();
    faults
        .into_par_iter()
        .map(|fault| {
            let verdict = bench.verdict(fault);
            let verdict = verdict.with_context(|| format!("the mutant `{}`", fault.id))?;
            progress();
            Ok(Found {
                fault: fault.clone(),
                verdict,
            })
        })
        .collect()
}

/// What all faults of a configuration share.
struct Bench<'a> {
    unit: &'a Unit,
    sound: Design,
    model: Box<dyn Model>,
    prover: Option<Prover<'a>>,
    /// Which words the default test reads, and where.
    tested: Coverage,
    /// Which words a longer test reads, once one is asked for that the default test does not read.
    beyond: OnceLock<Coverage>,
}

impl Bench<'_> {
    fn verdict(&self, fault: &Fault) -> Result<Verdict> {
        let mutant = fault.planted(&self.sound);
        let first = (flow::TEST_SEED, FIRST_POINTS);
        let words = match &fault.site {
            Site::Words(rom, words) if *rom != self.sound.control.rom => words,
            _ => &Vec::new(),
        };
        let read = self.places(&self.tested, &fault.site);
        // A word of a table shows where it is read, if anywhere.
        let looks = if words.is_empty() {
            vec![first]
        } else {
            read.clone()
        };
        if let Some(mismatch) = self.differs_at(&mutant, looks)? {
            return Ok(Verdict::Caught(Leg::Cosim, Difference::Clock(mismatch)));
        }
        let prover = self.prover.as_ref();
        if let Some(how) = prover.and_then(|prover| prover.proves(&fault.site)) {
            return Ok(Verdict::Equivalent(how));
        }
        if words.is_empty() || !read.is_empty() {
            let lockstep = self.lockstep(&mutant, flow::TEST_SEED)?;
            if let Some(mismatch) = lockstep.run(flow::TEST_POINTS, &|_| ())?.mismatch {
                return Ok(Verdict::Caught(Leg::Cosim, Difference::Clock(mismatch)));
            }
        }
        if let Site::Words(rom, words) = &fault.site
            && *rom != self.sound.control.rom
        {
            for &(word, _) in words {
                if let Some(point) = aim::at_word(self.unit, &mutant, *rom, word)? {
                    return Ok(Verdict::Caught(Leg::Aimed, Difference::Point(point)));
                }
            }
            let places = self.places(self.beyond()?, &fault.site);
            if let Some(mismatch) = self.differs_at(&mutant, places)? {
                return Ok(Verdict::Caught(Leg::Aimed, Difference::Clock(mismatch)));
            }
        }
        Ok(Verdict::Open)
    }

    fn lockstep<'d>(&'d self, mutant: &'d Design, seed: u64) -> Result<Lockstep<'d>> {
        let contract = self.unit.contract.as_ref();
        Lockstep::new(mutant, self.model.boxed_clone(), contract, seed)
    }

    /// The difference in the first of the streams that shows one, each up to its place.
    fn differs_at(&self, mutant: &Design, places: Vec<Place>) -> Result<Option<Mismatch>> {
        for (seed, points) in places {
            let lockstep = self.lockstep(mutant, seed)?;
            if let Some(mismatch) = lockstep.run_alone(points)?.mismatch {
                return Ok(Some(mismatch));
            }
        }
        Ok(None)
    }

    /// Where the words at fault are read: to the end of the computation after the one that reads.
    fn places(&self, coverage: &Coverage, site: &Site) -> Vec<Place> {
        let Site::Words(rom, words) = site else {
            return Vec::new();
        };
        let places = words
            .iter()
            .flat_map(|&(word, _)| coverage.places(*rom, word));
        places.map(|&(seed, points)| (seed, points + 2)).collect()
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

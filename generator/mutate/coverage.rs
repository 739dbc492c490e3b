//! Which words of tables a test reads, and where: so that a fault in a word need not be looked for all over the
//! test.

use anyhow::Result;

use crate::cosim::Lockstep;
use crate::netlist::{Design, NetId, RomId};
use crate::sim::Simulator;

/// Places that are kept of each word.
const PLACES: usize = 6;

/// A place in a test: the seed of a stream, and the results in it up to there.
pub(super) type Place = (u64, u64);

/// For each ROM and word, the first places at which it is read.
pub(super) struct Coverage(Vec<Vec<Vec<Place>>>);

/// The places of one stream.
struct Watch {
    seed: u64,
    /// For each ROM its address, and the word of the latest clock.
    addresses: Vec<(NetId, u64)>,
    places: Vec<Vec<Vec<Place>>>,
}

impl Watch {
    fn new(design: &Design, seed: u64) -> Self {
        let roms = design.roms.iter();
        Self {
            seed,
            addresses: roms.clone().map(|rom| (rom.address, u64::MAX)).collect(),
            places: roms.map(|rom| vec![Vec::new(); rom.words.len()]).collect(),
        }
    }

    fn note(&mut self, points: u64, simulator: &Simulator) {
        for ((address, latest), places) in self.addresses.iter_mut().zip(&mut self.places) {
            let word = simulator.value(*address);
            if std::mem::replace(latest, word) == word {
                continue;
            }
            if let Some(places) = places.get_mut(word as usize)
                && places.len() < PLACES
                && places.last().is_none_or(|(_, latest)| *latest < points)
            {
                places.push((self.seed, points));
            }
        }
    }
}

impl Coverage {
    /// Of a run of `points` results.
    ///
    /// # Errors
    /// A design that cannot be simulated.
    pub(super) fn of(design: &Design, lockstep: &Lockstep<'_>, points: u64) -> Result<Self> {
        let streams = lockstep.watch(points, |seed| Watch::new(design, seed), Watch::note)?;
        let roms = design.roms.iter();
        let mut all: Vec<Vec<Vec<Place>>> =
            roms.map(|rom| vec![Vec::new(); rom.words.len()]).collect();
        for stream in streams {
            let words = all
                .iter_mut()
                .flatten()
                .zip(stream.places.into_iter().flatten());
            for (all, places) in words {
                let room = PLACES - all.len();
                all.extend(places.into_iter().take(room));
            }
        }
        Ok(Self(all))
    }

    /// Where a word is read.
    pub(super) fn places(&self, rom: RomId, word: usize) -> &[Place] {
        &self.0[rom.index()][word]
    }
}

//! Records when a test of the simulated hardware reads each ROM word, and with which operands.
//!
//! A fault in a ROM word can only show after a read of the word. The first check of the fault therefore runs only the recorded
//! parts of the test.

use anyhow::Result;

use glint_base::cone;
use glint_core::cosim::Lockstep;
use glint_rtl::netlist::{Design, Driver, NetId, NetlistRegister, RegisterKind, Role, RomId};
use glint_rtl::sim::Simulator;

/// The largest number of positions that are recorded for each word.
const PLACES: usize = 6;

pub(super) type OperandValues = Vec<(String, i64)>;

/// A position in a test. For example, seed 1 and 40 points are the position in the stream with seed 1 after 40 results.
#[derive(Clone)]
pub(super) struct TestPlace {
    pub(super) seed: u64,
    /// The number of results of the stream before the position.
    pub(super) points: u64,
    /// The bit patterns in the operand registers.
    operands: Vec<u64>,
}

/// The first positions in a test at which the simulated hardware reads each word of each ROM.
pub(super) struct Coverage {
    places: Vec<Vec<Vec<TestPlace>>>,
    operands: Vec<NetId>,
}

struct PlaceWatch<'a> {
    seed: u64,
    /// The net of each ROM's address, and the address in the latest clock.
    addresses: Vec<(NetId, u64)>,
    operands: &'a [NetId],
    places: Vec<Vec<Vec<TestPlace>>>,
}

impl<'a> PlaceWatch<'a> {
    fn new(design: &Design, operands: &'a [NetId], seed: u64) -> Self {
        let addresses = design.roms.iter().map(|rom| (rom.address, u64::MAX)).collect();
        Self { seed, addresses, operands, places: no_places(design) }
    }

    /// Records the words that the ROMs read now. `points` is the number of results so far.
    fn note(&mut self, points: u64, simulator: &Simulator) {
        for ((address, latest), places) in self.addresses.iter_mut().zip(&mut self.places) {
            let word = simulator.value(*address);
            if std::mem::replace(latest, word) == word {
                continue;
            }
            if let Some(places) = places.get_mut(word as usize)
                && places.len() < PLACES
                && places.last().is_none_or(|latest| latest.points < points)
            {
                let operands = self.operands.iter().map(|&net| simulator.value(net)).collect();
                places.push(TestPlace { seed: self.seed, points, operands });
            }
        }
    }
}

fn no_places(design: &Design) -> Vec<Vec<Vec<TestPlace>>> {
    design.roms.iter().map(|rom| vec![Vec::new(); rom.words.len()]).collect()
}

impl Coverage {
    /// Runs a test of `points` results on the fault-free design.
    ///
    /// # Errors
    /// Fails if the design cannot be simulated.
    pub(super) fn of(design: &Design, lockstep: &Lockstep<'_>, points: u64) -> Result<Self> {
        let mut operands: Vec<NetId> = Vec::new();
        for register in &design.registers {
            if register.kind == RegisterKind::Operand {
                operands.push(register.q);
            }
        }
        let streams = lockstep.watch(
            points,
            |seed| PlaceWatch::new(design, &operands, seed),
            PlaceWatch::note,
        )?;
        let mut all = no_places(design);
        for stream in streams {
            let words = all.iter_mut().flatten().zip(stream.places.into_iter().flatten());
            for (all, places) in words {
                let room = PLACES - all.len();
                all.extend(places.into_iter().take(room));
            }
        }
        Ok(Self { places: all, operands })
    }

    pub(super) fn places(&self, rom: RomId, word: usize) -> &[TestPlace] {
        &self.places[rom.index()][word]
    }

    /// Returns the raw values in the operand registers at each recorded position for a ROM word.
    pub(super) fn operands(
        &self,
        design: &Design,
        rom: RomId,
        word: usize,
    ) -> impl Iterator<Item = OperandValues> {
        self.places(rom, word).iter().map(|place| {
            let mut values = OperandValues::new();
            for (&net, &bits) in self.operands.iter().zip(&place.operands) {
                if let Driver::Register(register) = design.net(net).driver
                    && let Some(name) = operand_of(design, design.register(register))
                {
                    values.push((name.to_owned(), design.net(net).format.raw(bits) as i64));
                }
            }
            values
        })
    }
}

/// Returns the name of the operand that `register` holds, or `None` if it loads neither a port nor an operand buffer.
pub(super) fn operand_of<'d>(design: &'d Design, register: &NetlistRegister) -> Option<&'d str> {
    let taken = cone::reached(register.data, |net| match &design.net(net).driver {
        Driver::Op(op) => op.operands(),
        Driver::Register(buffer) => design.register(*buffer).data.into_iter().collect(),
        _ => Vec::new(),
    });
    for port in &design.ports {
        if matches!(port.role, Role::Operand { .. }) && taken.contains(&port.net) {
            return Some(&design.net(port.net).name);
        }
    }
    None
}

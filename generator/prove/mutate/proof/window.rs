//! Proves faults equivalent if their neighbourhood is small, by trying every combination of values around the fault.
//!
//! A window reaches from the fault forward over some cells, at most to multipliers, registers, ROMs and outputs. It
//! reaches backward to the fewest bits that determine it: a minimum cut. Each net of the cut takes every value of its
//! interval. For example, the window of an inverted bit may end at an AND that masks the bit.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, OnceLock};

use rayon::prelude::*;

use super::cut::smallest_cut;
use super::flat::Flat;
use super::interval;
use crate::mutate::fault::Site;
use glint_base::interval::Interval;
use glint_rtl::netlist::{Design, Driver, NetId, Op, RomId, eval};

/// Values that are evaluated together.
const LANES: usize = 128;

/// A net in all lanes.
type NetLanes = [u64; LANES];

/// The lanes of nets, by their numbers; for a mutant, only its own nets have lanes.
type LanesByNet = Vec<Option<Box<NetLanes>>>;

/// The most combinations that are tried, as a power of two.
const BITS: u32 = 22;

/// The distance between lanes that are tried one after the other. It is prime, so that all are tried. It is large,
/// because neighbouring values tend to show the same.
const STRIDE: u64 = 40_009;

/// Windows of one design.
pub(super) struct Windows<'a> {
    design: Cow<'a, Design>,
    order: Vec<NetId>,
    intervals: Vec<Interval>,
    /// The cells that read a net.
    readers: Vec<Vec<NetId>>,
    /// Whether something else reads it: a register, a ROM, a port, a comparison with the golden model.
    sinks: Vec<bool>,
    /// Whether a multiplier reads it.
    multiplied: Vec<bool>,
    /// For each net of a multiplier that products share, one net for each product.
    copies: BTreeMap<NetId, Vec<NetId>>,
    /// For each ROM, the words that may be read, once they are asked for; `None` if there are too many.
    read: Vec<OnceLock<Option<BTreeSet<u64>>>>,
}

impl<'a> Windows<'a> {
    /// Prepares the windows of a design. Returns `None` for a design with a combinational loop.
    pub(super) fn of(design: &'a Design) -> Option<Self> {
        let (design, copies) = match &design.pipeline {
            Some(pipeline) => {
                let flat = Flat::of(design, pipeline);
                (Cow::Owned(flat.design), flat.copies)
            }
            None => (Cow::Borrowed(design), BTreeMap::new()),
        };
        let order = design.levelise().ok()?;
        let intervals = interval::of_all(&design, &order);
        let mut readers = vec![Vec::new(); design.nets.len()];
        let mut sinks = vec![false; design.nets.len()];
        let mut multiplied = sinks.clone();
        for (id, net) in design.iter() {
            if let Driver::Op(op) = &net.driver {
                for operand in op.operands() {
                    readers[operand.index()].push(id);
                    multiplied[operand.index()] |= matches!(op, Op::Mul(..));
                }
            }
        }
        let registers = design.registers.iter();
        let read = registers.flat_map(|register| [register.data, register.enable]);
        let read = read.flatten().chain(design.roms.iter().map(|rom| rom.address));
        // A net that is compared with a golden model's register is observed itself.
        let checkpoints = design.pipeline.iter().flat_map(|pipeline| &pipeline.checkpoints);
        let seen = design.outputs().map(|port| port.net).chain(checkpoints.map(|it| it.net));
        for net in read.chain(seen) {
            sinks[net.index()] = true;
        }
        Some(Self {
            read: design.roms.iter().map(|_| OnceLock::new()).collect(),
            design,
            order,
            intervals,
            readers,
            sinks,
            multiplied,
            copies,
        })
    }

    /// Returns whether the fault never leaves its window.
    pub(super) fn proves(&self, site: &Site) -> bool {
        match site {
            Site::Words(rom, words) if *rom != self.design.control.rom => {
                let known = &self.read[rom.index()];
                // Not inside `get_or_init`, which would make others wait: work that is tried at the same time may ask
                // for it too.
                let read = match known.get() {
                    Some(read) => read,
                    None => {
                        let read = self.words_read(*rom);
                        known.get_or_init(|| read)
                    }
                };
                let is_read = |(word, _): &(usize, u64)| {
                    read.as_ref().is_none_or(|read| read.contains(&(*word as u64)))
                };
                !words.iter().any(is_read) || self.stays_inside(self.design.rom(*rom).data, site)
            }
            // The fault is in each product.
            Site::Bit(net, ..) if self.copies.contains_key(net) => {
                self.copies[net].iter().all(|copy| self.stays_inside(*copy, site))
            }
            Site::Driver(net, _) if self.copies.contains_key(net) => false,
            Site::Bit(net, ..) | Site::Driver(net, _) => {
                let driver = &self.design.net(*net).driver;
                // The value that a register takes, or that an input brings, is at fault in another net.
                !matches!(driver, Driver::Register(_) | Driver::Input)
                    && self.stays_inside(*net, site)
            }
            _ => false,
        }
    }

    /// Returns the words of a ROM that may be read.
    fn words_read(&self, rom: RomId) -> Option<BTreeSet<u64>> {
        let address = self.design.rom(rom).address;
        let read = Mutex::new(BTreeSet::new());
        self.try_all(&[address].into(), &BTreeSet::new(), None, |values, _, count| {
            read.lock().is_ok_and(|mut read| {
                read.extend(&of(values, None, address)[..count]);
                true
            })
        })?;
        read.into_inner().ok()
    }

    /// Returns whether all nets that leave some neighbourhood of the net are the same with the fault.
    fn stays_inside(&self, net: NetId, site: &Site) -> bool {
        // Short of multipliers first: beyond them is more to try.
        let mut tried = Vec::new();
        [false, true].into_iter().any(|through| self.stays_within(net, site, through, &mut tried))
    }

    /// Tries the sets of nets that the net reaches within some number of cells, smaller sets first, except the sets
    /// that were `tried`. With `through`, they reach through multipliers.
    fn stays_within(
        &self,
        net: NetId,
        site: &Site,
        through: bool,
        tried: &mut Vec<BTreeSet<NetId>>,
    ) -> bool {
        let mut affected = BTreeSet::from([net]);
        loop {
            let beyond: BTreeSet<NetId> = affected
                .iter()
                .flat_map(|net| self.cells_reading(*net, through))
                .filter(|reader| !affected.contains(reader))
                .collect();
            let leaves = |net: &NetId| {
                let stops = self.sinks[net.index()] || !through && self.multiplied[net.index()];
                let mut readers = self.cells_reading(*net, through);
                stops || readers.any(|reader| beyond.contains(&reader))
            };
            let leaving: Vec<NetId> = affected.iter().copied().filter(leaves).collect();
            let fault = Some((net, site));
            let is_new = !tried.contains(&affected);
            let stays = || {
                self.try_all(&affected, &affected, fault, |sound, mutant, count| {
                    let lanes = |own, net| &of(sound, own, net)[..count];
                    let is_same = |net: &NetId| lanes(None, *net) == lanes(Some(mutant), *net);
                    leaving.iter().all(is_same)
                })
            };
            if is_new && stays() == Some(true) {
                return true;
            }
            tried.push(affected.clone());
            if beyond.is_empty() {
                return false;
            }
            affected.extend(beyond);
        }
    }

    /// Returns the cells that read a net, with multipliers or without.
    fn cells_reading(&self, net: NetId, through: bool) -> impl Iterator<Item = NetId> {
        let multiplies =
            |net: NetId| matches!(self.design.net(net).driver, Driver::Op(Op::Mul(..)));
        let readers = self.readers[net.index()].iter().copied();
        readers.filter(move |reader| through || !multiplies(*reader))
    }

    /// Evaluates `wanted`, without and with the fault, for every combination of the values that determine it. None of
    /// these values is in `affected`. Returns whether `holds` always returned true; it gets both results and the
    /// number of lanes that count. Returns `None` if there are too many combinations.
    fn try_all(
        &self,
        wanted: &BTreeSet<NetId>,
        affected: &BTreeSet<NetId>,
        fault: Option<(NetId, &Site)>,
        holds: impl Fn(&LanesByNet, &LanesByNet, usize) -> bool + Sync,
    ) -> Option<bool> {
        // The words at fault are all that the net brings that matters.
        let words = match fault {
            Some((net, Site::Words(rom, words))) => {
                Some((net, &self.design.rom(*rom).words, words))
            }
            _ => None,
        };
        let at_fault = |net: NetId| words.filter(|(at, ..)| *at == net);
        let size = |net: NetId| {
            let (low, high) = self.intervals[net.index()];
            at_fault(net).map_or(high - low + 1, |(.., words)| words.len() as i128)
        };
        let bits = |net: NetId| 128 - (size(net) - 1).leading_zeros();
        let mut uncut = affected.clone();
        uncut.retain(|net| at_fault(*net).is_none());
        let cut = smallest_cut(&self.design, wanted, &uncut, &bits, BITS)?;
        let total = cut
            .iter()
            .try_fold(1i128, |total, net| total.checked_mul(size(*net)))
            .filter(|total| *total <= 1 << BITS)? as u64;
        let mut inside = BTreeSet::new();
        let mut todo: Vec<NetId> = wanted.iter().copied().collect();
        while let Some(net) = todo.pop() {
            if !cut.contains(&net) && inside.insert(net) {
                todo.extend(self.operands(net));
            }
        }
        let steps: Vec<NetId> =
            self.order.iter().copied().filter(|net| inside.contains(net)).collect();
        let nothing = || [(); 2].map(|()| vec![None; self.design.nets.len()]);
        let chunks = total.div_ceil(LANES as u64);
        let all = (0..chunks).into_par_iter().map_init(nothing, |[sound, mutant], chunk| {
            let from = chunk * STRIDE % chunks * LANES as u64;
            let count = (total - from).min(LANES as u64) as usize;
            let mut place = 1;
            for &net in &cut {
                let (low, _) = self.intervals[net.index()];
                let format = self.design.net(net).format;
                let size = size(net) as u64;
                let number = |lane: usize| (from + lane as u64) / place % size;
                let values = match at_fault(net) {
                    None => std::array::from_fn(|lane| format.bits(low + i128::from(number(lane)))),
                    Some((_, before, words)) => {
                        let word = |lane: usize| words[number(lane) as usize];
                        put(mutant, net, std::array::from_fn(|lane| word(lane).1));
                        std::array::from_fn(|lane| before[word(lane).0])
                    }
                };
                put(sound, net, values);
                place *= size;
            }
            for &net in &steps {
                let value = self.evaluate(net, &self.design.net(net).driver, sound, None);
                put(sound, net, value);
                if let Some((at, site)) = fault
                    && affected.contains(&net)
                {
                    let driver = match site {
                        Site::Driver(_, driver) if at == net => driver,
                        _ => &self.design.net(net).driver,
                    };
                    let mut value = self.evaluate(net, driver, sound, Some(mutant));
                    if let Site::Bit(_, bit, how) = site
                        && at == net
                    {
                        value = value.map(|bits| how.applied(bits, *bit));
                    }
                    put(mutant, net, value);
                }
            }
            holds(sound, mutant, count)
        });
        Some(all.all(|holds| holds))
    }

    fn operands(&self, net: NetId) -> Vec<NetId> {
        match &self.design.net(net).driver {
            Driver::Op(op) => op.operands(),
            _ => Vec::new(),
        }
    }

    /// Returns a net in all lanes. The mutant's own lanes come before the lanes of the fault-free design.
    fn evaluate(
        &self,
        net: NetId,
        driver: &Driver,
        sound: &LanesByNet,
        mutant: Option<&LanesByNet>,
    ) -> NetLanes {
        let of = |net: NetId| of(sound, mutant, net);
        match driver {
            Driver::Constant(bits) => [*bits; LANES],
            Driver::Op(op) => {
                let format = |net: NetId| self.design.net(net).format;
                eval::cell(op, self.design.width(net), &format, &of)
            }
            // A source is in the cut, and has its values.
            _ => *of(net),
        }
    }
}

/// Keeps the lanes of a net.
fn put(values: &mut LanesByNet, net: NetId, lanes: NetLanes) {
    match &mut values[net.index()] {
        Some(held) => **held = lanes,
        empty => *empty = Some(Box::new(lanes)),
    }
}

/// Returns the lanes of a net: the mutant's own lanes if it has them, else the lanes of the fault-free design.
fn of<'v>(sound: &'v LanesByNet, mutant: Option<&'v LanesByNet>, net: NetId) -> &'v NetLanes {
    let own = mutant.and_then(|mutant| mutant[net.index()].as_deref());
    own.or(sound[net.index()].as_deref()).expect("a net stands behind its operands")
}

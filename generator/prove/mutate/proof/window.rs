//! Proves a fault equivalent by trying every combination of values on the nets around it.
//!
//! A window is a part of the netlist. It reaches forward from the fault over some cells, at most to registers, ROMs and
//! outputs. Backward it reaches to a minimum cut: the fewest bits that determine the window. The proof tries every value in
//! the intervals of these nets; if there are more than 2^22 combinations, it fails. For example, the window of an inverted bit
//! may end at an AND that masks the bit.

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

/// The number of combinations that are evaluated together, each in a lane.
const LANES: usize = 128;

type NetLanes = [u64; LANES];

/// The lanes of nets. For a mutant, only nets that the fault may change have lanes.
type LanesByNet = Vec<Option<Box<NetLanes>>>;

/// The largest number of combinations that are tried, as a power of two.
const BITS: u32 = 22;

/// The distance between chunks of combinations that are tried one after the other. It is prime, so all chunks are tried, and
/// large, because neighbouring combinations tend to give the same answer.
const STRIDE: u64 = 40_009;

/// A prover for one design that tries every combination of values in a window, a small part of the netlist around a fault.
pub(super) struct Windows<'a> {
    design: Cow<'a, Design>,
    order: Vec<NetId>,
    intervals: Vec<Interval>,
    readers: Vec<Vec<NetId>>,
    /// Whether a net has a reader besides cells: a register, a ROM, a port, or the comparison with the golden model.
    sinks: Vec<bool>,
    multiplied: Vec<bool>,
    /// The copies of each net of a multiplier that several products share: one net for each product.
    copies: BTreeMap<NetId, Vec<NetId>>,
    /// The addresses of each ROM's words that may be read, once they are computed; `None` inside for too many combinations.
    read: Vec<OnceLock<Option<BTreeSet<u64>>>>,
}

impl<'a> Windows<'a> {
    /// Prepares the proofs for `design`. Returns `None` for a design with a combinational loop.
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
        for register in &design.registers {
            for net in [register.data, register.enable].into_iter().flatten() {
                sinks[net.index()] = true;
            }
        }
        for rom in &design.roms {
            sinks[rom.address.index()] = true;
        }
        for port in design.outputs() {
            sinks[port.net.index()] = true;
        }
        if let Some(pipeline) = &design.pipeline {
            // A net that is compared with a golden model's register is observed itself.
            for checkpoint in &pipeline.checkpoints {
                sinks[checkpoint.net.index()] = true;
            }
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

    /// Returns whether, for every combination of values in a window, the fault changes no value outside. A fault in a register,
    /// an input, an enable, a reset or the control ROM is never proved here. A fault in words of another ROM is always proved if
    /// the words are never read.
    pub(super) fn proves(&self, site: &Site) -> bool {
        match site {
            Site::Words(rom, words) if *rom != self.design.control.rom => {
                !self.reads_any(*rom, words) || self.stays_inside(self.design.rom(*rom).data, site)
            }
            // A fault in a shared multiplier is in each of its products.
            Site::Bit(net, ..) if self.copies.contains_key(net) => {
                self.copies[net].iter().all(|copy| self.stays_inside(*copy, site))
            }
            Site::Driver(net, _) if self.copies.contains_key(net) => false,
            Site::Bit(net, ..) | Site::Driver(net, _) => {
                let driver = &self.design.net(*net).driver;
                // A fault of a register or an input is in a net that the window does not have.
                !matches!(driver, Driver::Register(_) | Driver::Input)
                    && self.stays_inside(*net, site)
            }
            _ => false,
        }
    }

    /// Returns whether one of `words`, given with their addresses, may be read. Returns true if this cannot be decided.
    fn reads_any(&self, rom: RomId, words: &[(usize, u64)]) -> bool {
        let known = &self.read[rom.index()];
        // The addresses are computed outside `get_or_init`, which would make other threads wait. Two threads may compute them
        // at once.
        let addresses = match known.get() {
            Some(addresses) => addresses,
            None => {
                let addresses = self.words_read(rom);
                known.get_or_init(|| addresses)
            }
        };
        match addresses {
            Some(addresses) => words.iter().any(|(at, _)| addresses.contains(&(*at as u64))),
            None => !words.is_empty(),
        }
    }

    /// Returns the addresses at which `rom` may be read, or `None` if there are too many combinations to try.
    fn words_read(&self, rom: RomId) -> Option<BTreeSet<u64>> {
        let address = self.design.rom(rom).address;
        let read = Mutex::new(BTreeSet::new());
        self.try_all(&[address].into(), &BTreeSet::new(), None, |values, _, count| {
            let Ok(mut addresses) = read.lock() else { return false };
            addresses.extend(&lanes_of(values, None, address)[..count]);
            true
        })?;
        read.into_inner().ok()
    }

    /// Returns whether the fault changes no net at the end of some window.
    fn stays_inside(&self, net: NetId, site: &Site) -> bool {
        // Windows that end at multipliers come first, because others need more combinations.
        let mut tried = Vec::new();
        [false, true].into_iter().any(|through| self.stays_within(net, site, through, &mut tried))
    }

    /// Tries windows of growing size, except windows in `tried`: the nets that `net` reaches within 0, 1, 2, … cells. With
    /// `through`, a window reaches through multipliers.
    fn stays_within(
        &self,
        net: NetId,
        site: &Site,
        through: bool,
        tried: &mut Vec<BTreeSet<NetId>>,
    ) -> bool {
        let mut affected = BTreeSet::from([net]);
        loop {
            let mut beyond: BTreeSet<NetId> = BTreeSet::new();
            for &inside in &affected {
                beyond.extend(self.cells_reading(inside, through));
            }
            beyond.retain(|reader| !affected.contains(reader));
            let mut leaving: Vec<NetId> = Vec::new();
            for &inside in &affected {
                let stops =
                    self.sinks[inside.index()] || !through && self.multiplied[inside.index()];
                let mut readers = self.cells_reading(inside, through);
                if stops || readers.any(|reader| beyond.contains(&reader)) {
                    leaving.push(inside);
                }
            }
            let is_new = !tried.contains(&affected);
            if is_new && self.hides(&affected, &leaving, (net, site)) {
                return true;
            }
            tried.push(affected.clone());
            if beyond.is_empty() {
                return false;
            }
            affected.extend(beyond);
        }
    }

    /// Returns whether the fault changes no net of `leaving`, for every combination of values that determines the `affected`
    /// nets. Returns false if there are too many combinations.
    fn hides(&self, affected: &BTreeSet<NetId>, leaving: &[NetId], fault: (NetId, &Site)) -> bool {
        let is_same = self.try_all(affected, affected, Some(fault), |sound, mutant, count| {
            leaving.iter().all(|&net| {
                lanes_of(sound, None, net)[..count] == lanes_of(sound, Some(mutant), net)[..count]
            })
        });
        is_same == Some(true)
    }

    /// Returns the cells that read a net; multipliers are included only with `through`.
    fn cells_reading(&self, net: NetId, through: bool) -> impl Iterator<Item = NetId> {
        let readers = self.readers[net.index()].iter().copied();
        readers.filter(move |reader| through || !self.is_product(*reader))
    }

    fn is_product(&self, net: NetId) -> bool {
        matches!(self.design.net(net).driver, Driver::Op(Op::Mul(..)))
    }

    /// Evaluates the nets `wanted`, without and with the fault, for every combination of values on a cut outside `affected` that
    /// determines these nets. `holds` gets the lanes without and with the fault, and the number of lanes that count. Returns
    /// whether `holds` always returned true, or `None` if there are too many combinations.
    fn try_all(
        &self,
        wanted: &BTreeSet<NetId>,
        affected: &BTreeSet<NetId>,
        fault: Option<(NetId, &Site)>,
        holds: impl Fn(&LanesByNet, &LanesByNet, usize) -> bool + Sync,
    ) -> Option<bool> {
        let words = match fault {
            Some((net, Site::Words(rom, words))) => {
                Some(FaultyWords { net, sound: &self.design.rom(*rom).words, faulty: words })
            }
            _ => None,
        };
        let bits = |net: NetId| 128 - (self.count_values(net, words) - 1).leading_zeros();
        let mut uncut = affected.clone();
        if let Some(words) = words {
            uncut.remove(&words.net);
        }
        let cut = smallest_cut(&self.design, wanted, &uncut, &bits, BITS)?;
        let mut combinations: i128 = 1;
        for &net in &cut {
            combinations = combinations.checked_mul(self.count_values(net, words))?;
        }
        if combinations > 1 << BITS {
            return None;
        }
        let total = combinations as u64;
        let steps = self.cells_behind(&cut, wanted);
        if let Some((net, site)) = fault
            && !reads_known_nets(net, site, &cut, &steps)
        {
            return None;
        }
        let nets = self.design.nets.len();
        let chunks = total.div_ceil(LANES as u64);
        let all = (0..chunks).into_par_iter().map_init(
            || [vec![None; nets], vec![None; nets]],
            |[sound, mutant], chunk| {
                let from = chunk * STRIDE % chunks * LANES as u64;
                let count = (total - from).min(LANES as u64) as usize;
                self.put_combinations(from, &cut, words, sound, mutant);
                for &net in &steps {
                    let lanes = self.evaluate(net, &self.design.net(net).driver, sound, None);
                    put(sound, net, lanes);
                    if let Some(fault) = fault
                        && affected.contains(&net)
                    {
                        put(mutant, net, self.evaluate_at_fault(net, fault, sound, mutant));
                    }
                }
                holds(sound, mutant, count)
            },
        );
        Some(all.all(|holds| holds))
    }

    /// Returns the number of values of `net` to try. For the output of a ROM with faulty `words`, only these words count.
    fn count_values(&self, net: NetId, words: Option<FaultyWords>) -> i128 {
        match words {
            Some(words) if words.net == net => words.faulty.len() as i128,
            _ => {
                let (low, high) = self.intervals[net.index()];
                high - low + 1
            }
        }
    }

    /// Returns the nets between `cut` and `wanted`, with `wanted`, in the order of evaluation.
    fn cells_behind(&self, cut: &BTreeSet<NetId>, wanted: &BTreeSet<NetId>) -> Vec<NetId> {
        let mut behind = BTreeSet::new();
        let mut todo: Vec<NetId> = wanted.iter().copied().collect();
        while let Some(net) = todo.pop() {
            if !cut.contains(&net) && behind.insert(net) {
                todo.extend(self.operands(net));
            }
        }
        self.order.iter().copied().filter(|net| behind.contains(net)).collect()
    }

    /// Writes the combinations from number `from` on into the lanes of the cut's nets. The first net of the cut changes from lane
    /// to lane, like the last digit of a number.
    fn put_combinations(
        &self,
        from: u64,
        cut: &BTreeSet<NetId>,
        words: Option<FaultyWords>,
        sound: &mut LanesByNet,
        mutant: &mut LanesByNet,
    ) {
        let mut place = 1;
        for &net in cut {
            let size = self.count_values(net, words) as u64;
            let digit = |lane: usize| (from + lane as u64) / place % size;
            let values = match words {
                Some(words) if words.net == net => {
                    let word = |lane: usize| words.faulty[digit(lane) as usize];
                    put(mutant, net, std::array::from_fn(|lane| word(lane).1));
                    std::array::from_fn(|lane| words.sound[word(lane).0])
                }
                _ => {
                    let (low, _) = self.intervals[net.index()];
                    let format = self.design.net(net).format;
                    std::array::from_fn(|lane| format.bits(low + i128::from(digit(lane))))
                }
            };
            put(sound, net, values);
            place *= size;
        }
    }

    fn evaluate_at_fault(
        &self,
        net: NetId,
        (at_fault, site): (NetId, &Site),
        sound: &LanesByNet,
        mutant: &LanesByNet,
    ) -> NetLanes {
        let driver = match site {
            Site::Driver(_, driver) if at_fault == net => driver,
            _ => &self.design.net(net).driver,
        };
        let lanes = self.evaluate(net, driver, sound, Some(mutant));
        match site {
            Site::Bit(_, bit, how) if at_fault == net => lanes.map(|bits| how.applied(bits, *bit)),
            _ => lanes,
        }
    }

    fn operands(&self, net: NetId) -> Vec<NetId> {
        match &self.design.net(net).driver {
            Driver::Op(op) => op.operands(),
            _ => Vec::new(),
        }
    }

    /// Returns the lanes of a net with the driver `driver`. An operand has the mutant's lanes, or else of the fault-free design.
    fn evaluate(
        &self,
        net: NetId,
        driver: &Driver,
        sound: &LanesByNet,
        mutant: Option<&LanesByNet>,
    ) -> NetLanes {
        match driver {
            Driver::Constant(bits) => [*bits; LANES],
            Driver::Op(op) => eval::cell(
                op,
                self.design.width(net),
                &|operand| self.design.net(operand).format,
                &|operand| lanes_of(sound, mutant, operand),
            ),
            // A net without a cell is in the cut, and already has its lanes.
            _ => *lanes_of(sound, mutant, net),
        }
    }
}

#[derive(Clone, Copy)]
struct FaultyWords<'s> {
    net: NetId,
    sound: &'s [u64],
    /// The address and the faulty contents of each faulty word.
    faulty: &'s [(usize, u64)],
}

/// Returns whether the faulty driver of a net reads only nets of the cut and nets that are evaluated earlier.
fn reads_known_nets(net: NetId, site: &Site, cut: &BTreeSet<NetId>, steps: &[NetId]) -> bool {
    let Site::Driver(_, Driver::Op(op)) = site else { return true };
    let end = steps.iter().position(|step| *step == net).unwrap_or(steps.len());
    let earlier = &steps[..end];
    op.operands().iter().all(|operand| cut.contains(operand) || earlier.contains(operand))
}

fn put(values: &mut LanesByNet, net: NetId, lanes: NetLanes) {
    match &mut values[net.index()] {
        Some(held) => **held = lanes,
        empty => *empty = Some(Box::new(lanes)),
    }
}

/// Returns the lanes of `net` in the mutant, or else in the fault-free design.
fn lanes_of<'v>(sound: &'v LanesByNet, mutant: Option<&'v LanesByNet>, net: NetId) -> &'v NetLanes {
    if let Some(mutant) = mutant
        && let Some(lanes) = &mutant[net.index()]
    {
        return lanes;
    }
    sound[net.index()].as_deref().expect("a net stands behind its operands")
}

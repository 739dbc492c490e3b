//! Faults that change nothing that is compared, and the proof of it.
//!
//! One proof is an induction over clocks. In every microinstruction, fault-free design and mutant are
//! evaluated side by side over known bits, with the bits noted in which they may differ. Where neither an
//! output nor a register that the golden model predicts differs in any microinstruction, while registers inside of
//! blocks may differ as far as those before have left them so, they never do. The other tries every
//! combination of values around the fault ([`window`]).

mod cut;
mod interval;
mod known;
mod sound;
mod window;

use known::Known;
use sound::Sound;
use window::Windows;

use super::fault::{Bit, Site};
use super::verdict::How;
use crate::base::fixed::{Format, mask};
use crate::hdl::netlist::{Design, Driver, NetId, Op, RegId, RegisterKind, RomId};

/// Proves faults of one design equivalent.
pub(super) struct Prover<'a> {
    sound: Sound<'a>,
    /// Of each net, the bits that are compared in every clock.
    compared: Vec<u64>,
    windows: Windows<'a>,
}

/// Where fault-free design and mutant may differ, after power-up in no bit.
#[derive(Clone, Debug, PartialEq)]
struct State {
    registers: Vec<u64>,
    roms: Vec<u64>,
}

/// The nets of the mutant in one microinstruction.
struct Nets {
    /// What is known of the mutant's.
    known: Vec<Known>,
    /// The bits that may differ from those of the fault-free design.
    differ: Vec<u64>,
}

impl<'a> Prover<'a> {
    /// `None` for a design with a combinational loop.
    pub(super) fn new(design: &'a Design) -> Option<Self> {
        let mut compared = vec![0; design.nets.len()];
        let outputs = design.outputs().map(|port| port.net);
        let registers = design.registers.iter();
        let registers = registers.filter(|register| register.kind != RegisterKind::Internal);
        let checkpoints = design.pipeline.iter().flat_map(|pipeline| &pipeline.checkpoints);
        let checkpoints = checkpoints.map(|checkpoint| checkpoint.net);
        for net in outputs.chain(registers.map(|register| register.q)).chain(checkpoints) {
            compared[net.index()] = mask(design.width(net));
        }
        let sound = Sound::of(design)?;
        let windows = Windows::of(design)?;
        Some(Self { sound, compared, windows })
    }

    /// How it is proved, if it is, that nothing that is compared ever differs with this fault.
    pub(super) fn proves(&self, site: &Site) -> Option<How> {
        if self.by_induction(site) {
            Some(How::Induction)
        } else {
            self.windows.proves(site).then_some(How::Exhaustion)
        }
    }

    fn by_induction(&self, site: &Site) -> bool {
        let design = self.sound.design;
        let resets = |id: &RegId| design.register(*id).reset;
        match site {
            // What reset does is no part of the proof.
            Site::Reset(_) => return false,
            Site::Bit(net, bit, how) => {
                if let Driver::Register(id) = &design.net(*net).driver
                    && resets(id).is_some_and(|reset| how.applied(reset, *bit) != reset)
                {
                    return false;
                }
            }
            _ => {}
        }
        let length = self.sound.nets.len();
        let nothing =
            State { registers: vec![0; design.registers.len()], roms: vec![0; design.roms.len()] };
        let mut states = vec![nothing; length];
        let mut todo: Vec<usize> = (0..length).collect();
        while let Some(at) = todo.pop() {
            let nets = self.settle(at, &states[at], site);
            let seen = |(net, bits): (&u64, &u64)| net & bits != 0;
            if nets.differ.iter().zip(&self.compared).any(seen) {
                return false;
            }
            let next = self.next(at, &nets, site);
            for (register, differ) in design.registers.iter().zip(&next.registers) {
                if *differ != 0 && register.kind != RegisterKind::Internal {
                    return false;
                }
            }
            for &to in &self.sound.following[at] {
                let mut joined = states[to].clone();
                let pairs = joined.registers.iter_mut().zip(&next.registers);
                pairs.for_each(|(all, more)| *all |= more);
                joined.roms.iter_mut().zip(&next.roms).for_each(|(all, more)| *all |= more);
                if joined != states[to] {
                    states[to] = joined;
                    todo.push(to);
                }
            }
        }
        true
    }

    fn settle(&self, at: usize, state: &State, site: &Site) -> Nets {
        let design = self.sound.design;
        let sound = &self.sound.nets[at];
        let mut nets = Nets { known: sound.clone(), differ: vec![0; design.nets.len()] };
        for &id in &self.sound.order {
            let width = design.width(id);
            let (mut known, mut differ) = match (&design.net(id).driver, site) {
                (_, Site::Driver(net, driver)) if *net == id => {
                    self.replaced(at, id, driver, &nets)
                }
                (Driver::Op(op), _)
                    if op.operands().iter().any(|it| nets.differ[it.index()] != 0) =>
                {
                    let value = |net: NetId| nets.known[net.index()];
                    (known::cell(design, op, width, &value), self.cell(at, op, width, &nets))
                }
                (Driver::Register(register), _) => {
                    let differ = state.registers[register.index()];
                    (sound[id.index()].without(differ), differ)
                }
                (Driver::Rom(rom), _) => self.rom(*rom, state, site, &nets, sound[id.index()]),
                (Driver::Field(field), Site::Words(rom, words)) if *rom == design.control.rom => {
                    let other = words.iter().find(|(address, _)| *address == at);
                    other.map_or((sound[id.index()], 0), |(_, bits)| {
                        let low = design.field_positions()[field.index()];
                        let known = Known::all(bits >> low, width);
                        (known, known.value ^ sound[id.index()].value)
                    })
                }
                _ => (sound[id.index()], 0),
            };
            if let Site::Bit(net, bit, how) = site
                && *net == id
                && !matches!(design.net(id).driver, Driver::Register(_))
            {
                (known, differ) = stuck(known, differ, *bit, *how);
            }
            let agree = known.agree(sound[id.index()]);
            nets.known[id.index()] = known;
            nets.differ[id.index()] = differ & !agree & mask(width);
        }
        nets
    }

    /// A net with another driver than in the fault-free design.
    fn replaced(&self, at: usize, id: NetId, driver: &Driver, nets: &Nets) -> (Known, u64) {
        let design = self.sound.design;
        let width = design.width(id);
        let sound = &self.sound.nets[at];
        let value = |net: NetId| nets.known[net.index()];
        let known = match driver {
            Driver::Constant(bits) => Known::all(*bits, width),
            Driver::Op(op) => known::cell(design, op, width, &value),
            _ => Known::NOTHING,
        };
        let before = taken(design, &design.net(id).driver, &|net| sound[net.index()]);
        let after = taken(design, driver, &value);
        let differ = match before.zip(after) {
            Some((a, b)) if self.sound.same[a.index()] == self.sound.same[b.index()] => {
                nets.differ[a.index()] | nets.differ[b.index()]
            }
            _ => u64::MAX,
        };
        (known, differ)
    }

    /// The bits in which the result of a cell may differ.
    fn cell(&self, at: usize, op: &Op, width: u32, nets: &Nets) -> u64 {
        let design = self.sound.design;
        let differ = |net: &NetId| nets.differ[net.index()];
        let summand = |net: NetId| (nets.known[net.index()], nets.differ[net.index()]);
        match op {
            Op::Relabel(a) | Op::Not(a) => differ(a),
            Op::Extend(a) => {
                let sign =
                    design.net(*a).format.signed && differ(a) >> (design.width(*a) - 1) & 1 == 1;
                differ(a) | if sign { !mask(design.width(*a)) } else { 0 }
            }
            Op::Slice { of, low } => differ(of) >> low,
            Op::Concat(parts) => parts.iter().fold(0, |sum: u64, part| {
                sum.checked_shl(design.width(*part)).unwrap_or(0) | differ(part)
            }),
            Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b) => differ(a) | differ(b),
            Op::Add { a, b, carry } => {
                let zero = (Known::all(0, 1), 0);
                let carry = carry.map_or(zero, summand);
                known::sum_differs([summand(*a), summand(*b)], carry, width)
            }
            Op::Sub(a, b) => {
                let (known, differ) = summand(*b);
                let inverted = (known.not(width), differ);
                let one = (Known::all(1, 1), 0);
                known::sum_differs([summand(*a), inverted], one, width)
            }
            Op::Mul(a, b) => above(differ(a) | differ(b)),
            Op::Less(a, b) => {
                let known = |net: &NetId| nets.known[net.index()];
                // Below a number with zeros at its end are whole runs of numbers that differ in these bits alone; so are
                // those above one with ones at its end. No run goes over a change of sign.
                let Format { signed, .. } = design.net(*a).format;
                let most = design.width(*a) - u32::from(signed);
                let run = |bits: u64| mask(bits.trailing_ones().min(most));
                let (below, above) = (run(known(b).zeros()), run(known(a).value));
                let same = differ(b) == 0 && differ(a) & !below == 0
                    || differ(a) == 0 && differ(b) & !above == 0;
                u64::from(!same)
            }
            Op::Equal(..) | Op::Any(_) | Op::All(_) => 1,
            Op::Mux { select, inputs } => {
                let after = nets.known[select.index()];
                let lines = design.width(*select);
                if differ(select) == 0 {
                    return known::choices(after, lines, inputs)
                        .fold(0, |all, input| all | differ(&input));
                }
                let before = self.sound.nets[at][select.index()];
                let possible = known::choices(before, lines, inputs);
                let possible = possible.chain(known::choices(after, lines, inputs));
                let possible: Vec<NetId> = possible.collect();
                let same = |net: &NetId| self.sound.same[net.index()];
                if possible.iter().all(|net| same(net) == same(&possible[0])) {
                    possible.iter().fold(0, |all, net| all | differ(net))
                } else {
                    u64::MAX
                }
            }
        }
    }

    fn rom(
        &self,
        id: RomId,
        state: &State,
        site: &Site,
        nets: &Nets,
        sound: Known,
    ) -> (Known, u64) {
        let rom = self.sound.design.rom(id);
        let differ =
            if rom.synchronous { state.roms[id.index()] } else { self.read(id, site, nets) };
        (sound.without(differ), differ)
    }

    /// The bits in which a word read may differ.
    fn read(&self, id: RomId, site: &Site, nets: &Nets) -> u64 {
        let rom = self.sound.design.rom(id);
        let mut differ = match nets.differ[rom.address.index()] {
            0 => 0,
            // No more than the words do, where every address has one.
            _ if rom.words.len() == 1 << self.sound.design.width(rom.address) => {
                rom.words.iter().fold(0, |differ, word| differ | (word ^ rom.words[0]))
            }
            _ => u64::MAX,
        };
        if let Site::Words(at_fault, words) = site
            && *at_fault == id
        {
            let address = nets.known[rom.address.index()];
            for &(at, word) in words.iter().filter(|(at, _)| address.may_be(*at as u64)) {
                differ |= word ^ rom.words[at];
            }
        }
        differ
    }

    /// What may differ after the clock.
    fn next(&self, at: usize, nets: &Nets, site: &Site) -> State {
        let design = self.sound.design;
        let registers = (0..design.registers.len() as u32).map(RegId);
        State {
            registers: registers.map(|id| self.taken(at, id, nets, site)).collect(),
            roms: (0..design.roms.len() as u32)
                .map(|id| self.read(RomId(id), site, nets))
                .collect(),
        }
    }

    fn taken(&self, at: usize, id: RegId, nets: &Nets, site: &Site) -> u64 {
        let design = self.sound.design;
        let sound = &self.sound.nets[at];
        let register = design.register(id);
        let (q, width) = (register.q.index(), design.width(register.q));
        let Some(data) = register.data.map(NetId::index) else {
            return 0;
        };
        let (mut offered, mut differ) = (nets.known[data], nets.differ[data]);
        if let Site::Bit(net, bit, how) = site
            && *net == register.q
        {
            (offered, differ) = stuck(offered, differ, *bit, *how);
            differ &= !offered.agree(sound[data]);
        }
        let one = Known::all(1, 1);
        let before = register.enable.map_or(one, |net| sound[net.index()]).whole(1);
        let (after, same) = match site {
            Site::Enable(at_fault, always) if *at_fault == id => {
                let after = Some(u64::from(*always));
                (after, before == after)
            }
            _ => {
                let after = register.enable.map_or(one, |net| nets.known[net.index()]);
                (after.whole(1), register.enable.is_none_or(|net| nets.differ[net.index()] == 0))
            }
        };
        match (before, after) {
            (Some(1), Some(1)) => differ,
            (Some(0), Some(0)) => nets.differ[q],
            _ if same => differ | nets.differ[q],
            // One takes and the other holds, or who knows.
            _ if self.sound.same[data] == self.sound.same[q] => differ | nets.differ[q],
            _ => {
                let side = |enable, taken: Known, held: Known| match enable {
                    Some(1) => taken,
                    Some(_) => held,
                    None => taken.join(held),
                };
                let sound = side(before, sound[data], sound[q]);
                let mutant = side(after, offered, nets.known[q]);
                mask(width) & !sound.agree(mutant)
            }
        }
    }
}

/// The net whose value a net takes, if it takes one.
fn taken(design: &Design, driver: &Driver, value: &impl Fn(NetId) -> Known) -> Option<NetId> {
    match driver {
        Driver::Op(Op::Relabel(a)) => Some(*a),
        Driver::Op(Op::Mux { select, inputs }) => {
            let mut possible = known::choices(value(*select), design.width(*select), inputs);
            let first = possible.next();
            possible.next().is_none().then_some(first).flatten()
        }
        _ => None,
    }
}

/// A bit at fault.
fn stuck(known: Known, differ: u64, bit: u32, how: Bit) -> (Known, u64) {
    let one = 1 << bit;
    match how {
        Bit::Stuck0 | Bit::Stuck1 => {
            (Known { mask: known.mask | one, value: how.applied(known.value, bit) }, differ | one)
        }
        Bit::Inverted => {
            (Known { mask: known.mask, value: (known.value ^ one) & known.mask }, differ | one)
        }
    }
}

/// From the lowest of these bits up.
fn above(bits: u64) -> u64 {
    bits.checked_ilog2().map_or(0, |_| u64::MAX << bits.trailing_zeros())
}

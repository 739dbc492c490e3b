//! Lists the faults that mutation testing plants in a netlist, each with a name that stays the same from run to run.
//!
//! For example, `adder15[3]:stuck-at-0` is bit 3 of the net `adder15`, stuck at 0. For a large ROM, the list has only a sample of
//! the faulty words.

use std::collections::BTreeSet;

use super::kind::FaultKind;
use super::operators;
use glint_base::fixed::mask;
use glint_core::cosim::Random;
use glint_rtl::netlist::{Design, Driver, Net, NetId, Op, RegId, Role, RomId};

/// The limits for a complete list: the number of words of a ROM for all swaps of two words, and the number of its bits for all
/// inversions.
const ALL_WORDS: usize = 32;
const ALL_BITS: usize = 1024;

/// The numbers of pairs of words, and of bits, that are drawn for larger ROMs. In addition, about `NEIGHBOURS` pairs of
/// neighbouring words are swapped.
const SAMPLE: usize = 200;
const SAMPLED_BITS: usize = 200;
const NEIGHBOURS: usize = 256;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BitChange {
    Stuck0,
    Stuck1,
    Inverted,
}

impl BitChange {
    pub const ALL: [Self; 3] = [Self::Stuck0, Self::Stuck1, Self::Inverted];

    /// Returns `bits` with bit number `bit` changed. For example, bit 0 of 0b1010 inverted gives 0b1011.
    pub fn applied(self, bits: u64, bit: u32) -> u64 {
        match self {
            Self::Stuck0 => bits & !(1 << bit),
            Self::Stuck1 => bits | 1 << bit,
            Self::Inverted => bits ^ 1 << bit,
        }
    }
}

/// The place of a fault in a netlist, and the change at this place.
#[derive(Clone, Debug, PartialEq)]
pub enum Site {
    Bit(NetId, u32, BitChange),
    /// A different driver for a net that is not the output of a register or memory.
    Driver(NetId, Driver),
    /// A register that loads its data always (`true`) or never (`false`).
    Enable(RegId, bool),
    /// A register that the reset does not affect.
    Reset(RegId),
    Words(RomId, Vec<(usize, u64)>),
}

/// One change at one place, for example bit 3 of the net `adder15` stuck at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct NetlistFault {
    /// A unique name, made of names in the design: `adder15[3]:stuck-at-0`. A fault of a ROM names the word:
    /// `coefficient@1005[2]` is a bit of word 1005, and `coefficient@1004,1005` swaps two words.
    pub id: String,
    pub kind: FaultKind,
    pub site: Site,
}

/// The faults that can be planted in a netlist, each in a mutant of its own. For large ROMs, the list is a sample.
#[derive(Clone, Debug, Default)]
pub struct Faults(Vec<NetlistFault>);

impl Faults {
    /// Lists the faults of `design`. The sample for large ROMs is always the same.
    pub fn of(design: &Design) -> Self {
        let mut faults = Self::default();
        // Two nets are left out: the reset, which the environment drives, and the control word, because its fields are nets
        // with faults of their own.
        let reset = design.port(|role| role == Role::Reset).map(|port| port.net);
        let control = design.roms.get(design.control.rom.index()).map(|rom| rom.data);
        let left_out = [reset, control];
        for (id, net) in design.iter() {
            if !left_out.contains(&Some(id)) {
                faults.bits(id, net);
            }
            match &net.driver {
                Driver::Constant(bits) => faults.constant(id, net, *bits),
                Driver::Op(op) => faults.cell(design, id, op),
                _ => {}
            }
        }
        for at in 0..design.registers.len() as u32 {
            faults.register(design, RegId(at));
        }
        for at in 0..design.roms.len() as u32 {
            faults.rom(design, RomId(at));
        }
        faults
    }

    /// Keeps at most `most` faults, spread evenly over the list.
    pub fn thin(&mut self, most: usize) {
        let all = self.0.len();
        let mut at = 0;
        self.0.retain(|_| {
            at += 1;
            all <= most || (at - 1) * most / all != at * most / all
        });
    }

    pub fn iter(&self) -> impl Iterator<Item = &NetlistFault> {
        self.0.iter()
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn find(&self, id: &str) -> Option<&NetlistFault> {
        self.0.iter().find(|fault| fault.id == id)
    }

    fn add(&mut self, id: String, kind: FaultKind, site: Site) {
        self.0.push(NetlistFault { id, kind, site });
    }

    /// Adds three faults for each bit of a net, unless it is a constant, renamed or undriven. For example, a net `adder15` of
    /// 4 bits has 12 such faults, from `adder15[0]:stuck-at-0` to `adder15[3]:inverted`.
    fn bits(&mut self, id: NetId, net: &Net) {
        if matches!(net.driver, Driver::Constant(_) | Driver::Undriven | Driver::Op(Op::Relabel(_)))
        {
            return;
        }
        for bit in 0..net.format.width() {
            for how in BitChange::ALL {
                let (name, kind) = match how {
                    BitChange::Stuck0 => ("stuck-at-0", FaultKind::StuckAt0),
                    BitChange::Stuck1 => ("stuck-at-1", FaultKind::StuckAt1),
                    BitChange::Inverted => ("inverted", FaultKind::Inverted),
                };
                let id_text = format!("{}[{bit}]:{name}", net.name);
                self.add(id_text, kind, Site::Bit(id, bit, how));
            }
        }
    }

    fn constant(&mut self, id: NetId, net: &Net, bits: u64) {
        let width = net.format.width();
        let mut others = BTreeSet::new();
        for (name, other) in [("plus-1", bits.wrapping_add(1)), ("minus-1", bits.wrapping_sub(1))] {
            let other = other & mask(width);
            if others.insert(other) {
                let site = Site::Driver(id, Driver::Constant(other));
                self.add(format!("{}:{name}", net.name), FaultKind::Constant, site);
            }
        }
    }

    fn cell(&mut self, design: &Design, id: NetId, op: &Op) {
        for (name, kind, op) in operators::of(design, id, op) {
            let site = Site::Driver(id, Driver::Op(op));
            self.add(format!("{}:{name}", design.net(id).name), kind, site);
        }
    }

    fn register(&mut self, design: &Design, id: RegId) {
        let register = design.register(id);
        let name = &design.net(register.q).name;
        if register.enable.is_some() {
            for (how, always) in [("always-enabled", true), ("never-enabled", false)] {
                self.add(format!("{name}:{how}"), FaultKind::Enable, Site::Enable(id, always));
            }
        }
        if register.reset.is_some() {
            self.add(format!("{name}:no-reset"), FaultKind::Reset, Site::Reset(id));
        }
    }

    fn rom(&mut self, design: &Design, id: RomId) {
        let rom = design.rom(id);
        let control = id == design.control.rom;
        let (width, words) = (design.width(rom.data), &rom.words);
        let mut random = Random::new(1);
        let total = words.len() * width as usize;
        let bits: BTreeSet<usize> = if control || total <= ALL_BITS {
            (0..total).collect()
        } else {
            std::iter::repeat_with(|| random.below(total as u64) as usize)
                .take(SAMPLED_BITS)
                .collect()
        };
        for at in bits {
            let (word, bit) = (at / width as usize, at % width as usize);
            let kind = match control {
                true => FaultKind::ControlBit,
                false if 2 * bit >= width as usize => FaultKind::RomHighBit,
                false => FaultKind::RomBit,
            };
            let site = Site::Words(id, vec![(word, words[word] ^ 1 << bit)]);
            let id_text = if control {
                format!("{}@{word}.{}", rom.name, field_bit(design, bit as u32))
            } else {
                format!("{}@{word}[{bit}]", rom.name)
            };
            self.add(id_text, kind, site);
        }
        for (a, b) in pairs(words, &mut random) {
            let kind = if control { FaultKind::ControlWords } else { FaultKind::RomWords };
            let site = Site::Words(id, vec![(a, words[b]), (b, words[a])]);
            self.add(format!("{}@{a},{b}", rom.name), kind, site);
        }
    }
}

/// Returns pairs of addresses with different words: all such pairs of a small ROM, or neighbours and a sample for a large ROM.
fn pairs(words: &[u64], random: &mut Random) -> BTreeSet<(usize, usize)> {
    let mut pairs = BTreeSet::new();
    if words.len() <= ALL_WORDS {
        pairs.extend((0..words.len()).flat_map(|b| (0..b).map(move |a| (a, b))));
    } else {
        let step = words.len().div_ceil(NEIGHBOURS);
        pairs.extend((1..words.len()).step_by(step).map(|b| (b - 1, b)));
        let mut draw = || random.below(words.len() as u64) as usize;
        // If all words are equal, no pair differs; the limit of draws ends the search then.
        let sample = std::iter::repeat_with(|| (draw(), draw())).take(100 * SAMPLE);
        let differ = |&(a, b): &(usize, usize)| a < b && words[a] != words[b];
        pairs.extend(sample.filter(differ).take(SAMPLE));
    }
    pairs.retain(|&(a, b)| words[a] != words[b]);
    pairs
}

/// Names the field of the control word that contains bit number `bit`, and the bit's position in the field, for example
/// `difference_load[0]`.
fn field_bit(design: &Design, bit: u32) -> String {
    let fields = design.control.fields.iter().zip(design.field_positions());
    let mut holding =
        fields.filter(|(field, low)| (*low..low + design.width(field.net)).contains(&bit));
    match holding.next() {
        Some((field, low)) => format!("{}[{}]", field.name, bit - low),
        None => format!("[{bit}]"),
    }
}

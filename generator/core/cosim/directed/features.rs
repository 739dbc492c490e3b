//! Records which features of a design each computation exercises.
//!
//! A feature is one event at one net of the design: a mux takes one of its inputs, a comparison has one of its outcomes, a bit
//! is 1 or 0. The words that a computation reads from ROMs are recorded too. The module `directed` uses the record to choose a
//! few computations that together exercise as many features as a limit of clocks allows.

use super::side_by_side::{LANES, Lanes};
use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Driver, NetId, Op};
use glint_rtl::sim::Machine;

/// The number of classes of brightness. Class 0 has the computations whose results are all 0, class 2 the computations with a
/// result above a sixteenth of the largest output, and class 1 all other computations. A feature is counted separately in each
/// class, because a fault in a computation with the result 0 seldom shows.
pub const CLASSES: usize = 3;

/// A net, or a few nets, with features that are recorded. Each variant has up to 64 features, one for each bit of a `u64`.
enum Watched {
    /// The bits of a net that are 1, after an exclusive or with the mask. The mask is 0, or has a 1 for every bit of the net;
    /// then the features are the bits that are 0.
    Ones(NetId, u64),
    /// The input that a mux takes, if another input has a different value in that clock. All inputs from number 63 on count as
    /// one feature. The nets are the select and the inputs.
    Choice(NetId, Vec<NetId>),
    /// The outcomes of a comparison of two nets: equal, less, greater, greater by one, less by one. The numbers are a mask of
    /// the nets' bits, and the mask of the sign bit, or 0 without a sign.
    Comparison(NetId, NetId, u64, u64),
    /// The bit that alone is 1 in a net, after an exclusive or with the mask. With a mask of ones, this is the bit that alone
    /// is 0.
    Alone(NetId, u64),
    /// The four combinations of the values of two nets of one bit.
    Pair(NetId, NetId),
}

/// Observes the nets of a simulated design, and records the features that the computation of each lane exercises.
pub struct Watch {
    watched: Vec<Watched>,
    done: Vec<[u64; LANES]>,
    /// For each ROM of the datapath: its address net, the number of its first word through all ROMs, and the number of its
    /// words.
    addresses: Vec<(NetId, usize, usize)>,
    read: Vec<Vec<u32>>,
}

impl Watch {
    /// Prepares to observe all features of `design`. Every net must have a name; see [`observable`].
    pub fn new(design: &Design) -> Self {
        let mut watched = Vec::new();
        for (id, net) in design.iter() {
            match &net.driver {
                Driver::Constant(_) | Driver::Undriven | Driver::Op(Op::Relabel(_)) => continue,
                // For a mask of ones, the recorded bits are the bits that are 0.
                _ => watched.extend([0, mask(design.width(id))].map(|it| Watched::Ones(id, it))),
            }
            let Driver::Op(op) = &net.driver else { continue };
            match op {
                Op::Mux { select, inputs } => {
                    watched.push(Watched::Choice(*select, inputs.clone()))
                }
                &Op::Equal(a, b) | &Op::Less(a, b) | &Op::Sub(a, b) => {
                    let width = design.width(a);
                    let sign = if design.net(a).format.signed { 1 << (width - 1) } else { 0 };
                    watched.push(Watched::Comparison(a, b, mask(width), sign));
                }
                &Op::Any(of) => watched.push(Watched::Alone(of, 0)),
                &Op::All(of) => watched.push(Watched::Alone(of, mask(design.width(of)))),
                &(Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b)) if design.width(a) == 1 => {
                    watched.push(Watched::Pair(a, b));
                }
                _ => {}
            }
        }
        let mut words = 0;
        let mut addresses = Vec::new();
        for rom in &design.roms {
            if !design.is_control_memory(rom) {
                addresses.push((rom.address, words, rom.words.len()));
            }
            words += rom.words.len();
        }
        Self {
            done: vec![[0; LANES]; watched.len()],
            watched,
            addresses,
            read: vec![Vec::new(); LANES],
        }
    }

    /// Returns the number of features in all brightness classes. Everything that is observed has 64 features in each class.
    /// ROM words are not counted.
    pub fn count(&self) -> usize {
        64 * CLASSES * self.watched.len()
    }

    pub fn note(&mut self, machine: &Machine<LANES>, busy: Lanes) {
        for (watched, done) in self.watched.iter().zip(&mut self.done) {
            let mut add = |of: &dyn Fn(usize) -> u64| {
                for (lane, done) in done.iter_mut().enumerate() {
                    if busy >> lane & 1 == 1 {
                        *done |= of(lane);
                    }
                }
            };
            match watched {
                Watched::Ones(net, flip) => {
                    let bits = machine.lanes(*net);
                    add(&|lane| bits[lane] ^ flip);
                }
                Watched::Choice(select, inputs) => {
                    let select = machine.lanes(*select);
                    add(&|lane| {
                        let taken = (select[lane] as usize).min(inputs.len() - 1);
                        let bits = machine.lane(inputs[taken], lane);
                        let others = |&input: &NetId| machine.lane(input, lane) != bits;
                        u64::from(inputs.iter().any(others)) << taken.min(63)
                    });
                }
                Watched::Comparison(a, b, mask, sign) => {
                    let (a, b) = (machine.lanes(*a), machine.lanes(*b));
                    add(&|lane| {
                        let (a, b) = (a[lane], b[lane]);
                        let off = a.wrapping_sub(b) & mask;
                        let side = if off == 0 {
                            0
                        } else if a ^ sign < b ^ sign {
                            1
                        } else {
                            2
                        };
                        1 << side | u64::from(off == 1) << 3 | u64::from(off == *mask) << 4
                    });
                }
                Watched::Alone(net, flip) => {
                    let bits = machine.lanes(*net);
                    add(&|lane| {
                        let bits = bits[lane] ^ flip;
                        if bits.is_power_of_two() { bits } else { 0 }
                    });
                }
                Watched::Pair(a, b) => {
                    let (a, b) = (machine.lanes(*a), machine.lanes(*b));
                    add(&|lane| 1 << (2 * a[lane] + b[lane]));
                }
            }
        }
        self.note_words(machine, busy);
    }

    /// Records only the ROM words that are read in this clock, in the lanes of the set `busy`.
    pub fn note_words(&mut self, machine: &Machine<LANES>, busy: Lanes) {
        for &(address, first, count) in &self.addresses {
            let bits = machine.lanes(address);
            for (lane, read) in self.read.iter_mut().enumerate() {
                let word = (bits[lane] as usize).min(count);
                if busy >> lane & 1 == 1 && word < count {
                    read.push((first + word) as u32);
                }
            }
        }
    }

    /// Returns the features that the computation in `lane` has exercised, for the brightness class `class`, and the words that
    /// it has read. Words are numbered through all ROMs, ascend, and occur once. The record of the lane is empty afterwards.
    pub fn take(&mut self, lane: usize, class: usize) -> (Vec<u32>, Vec<u32>) {
        let mut features = Vec::new();
        for (at, done) in self.done.iter_mut().enumerate() {
            let mut bits = std::mem::take(&mut done[lane]);
            while bits != 0 {
                let bit = bits.trailing_zeros() as usize;
                features.push(((64 * at + bit) * CLASSES + class) as u32);
                bits &= bits - 1;
            }
        }
        let mut read = std::mem::take(&mut self.read[lane]);
        read.sort_unstable();
        read.dedup();
        (features, read)
    }
}

/// Returns a copy of the design in which every net has a name. The simulator can read only nets with a name.
pub fn observable(design: &Design) -> Design {
    let mut observable = design.clone();
    for net in &mut observable.nets {
        net.named = true;
    }
    observable
}

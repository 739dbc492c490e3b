//! Evaluates one microinstruction on pairs of bits that may be unknown, for the proof by induction. The evaluation covers the
//! fault-free design alone, or together with a mutant.
//!
//! A pipeline has no microinstructions; each slot counts as one.

use super::interval;
use super::pairs::{self, Pairs};
use crate::mutate::fault::Site;
use glint_base::interval::Interval;
use glint_rtl::netlist::{Design, Driver, NetId, Op, RegId, RomId};

/// The possible pairs of each register and synchronous ROM between two clocks.
pub(super) type PairState = Vec<Pairs>;

/// A design, with the order in which its nets are evaluated for a proof about a fault.
pub(super) struct Order<'a> {
    pub(super) design: &'a Design,
    /// The nets, each after the nets that it reads.
    order: Vec<NetId>,
    /// The first net with the same driver, and so with the same value, for each net.
    same: Vec<NetId>,
    /// The register with the number of the microinstruction or slot; `None` for a pipeline that takes a point every clock.
    counter: Option<RegId>,
    /// The interval of raw values of each net over all slots, for a pipeline with an interval longer than 1.
    in_all_slots: Vec<Interval>,
    /// For each ROM and each bit, whether the bit can be 0 and 1 in some word.
    words: Vec<Pairs>,
}

/// A planted fault, and the pairs of every net of the fault-free design in the executed microinstruction.
pub(super) type Injected<'s> = (&'s Site, &'s [Pairs]);

impl<'a> Order<'a> {
    /// Prepares the evaluation. Returns `None` for a design with a combinational loop.
    pub(super) fn of(design: &'a Design) -> Option<Self> {
        let mut order = design.levelise().ok()?;
        let mut in_all_slots = Vec::new();
        if let Some(pipeline) = &design.pipeline {
            // Each stage comes after the stage before it.
            let mut by_stage = order.clone();
            by_stage.sort_by_key(|net| pipeline.clock_of(*net));
            if pipeline.interval == 1 {
                order = by_stage;
            } else {
                in_all_slots = interval::of_all(design, &by_stage);
            }
        }
        let counter = match &design.pipeline {
            None => Some(design.control.address),
            Some(pipeline) => match pipeline.slot.map(|slot| &design.net(slot).driver) {
                Some(Driver::Register(id)) => Some(*id),
                _ => None,
            },
        };
        let mut words = Vec::new();
        for rom in &design.roms {
            let width = design.width(rom.data);
            let each = rom.words.iter().map(|&word| Pairs::constant(word, width));
            words.push(each.reduce(Pairs::or).unwrap_or(Pairs::same(width)));
        }
        Some(Self { design, same: same(design, &order), order, counter, in_all_slots, words })
    }

    /// Returns the nets of a [`PairState`]: first the registers, then the ROMs.
    pub(super) fn held(&self) -> impl Iterator<Item = NetId> {
        let registers = self.design.registers.iter().map(|register| register.q);
        registers.chain(self.design.roms.iter().map(|rom| rom.data))
    }

    /// Returns the pairs of all nets in microinstruction number `at`. Without a `fault`, both bits of each pair are of the
    /// fault-free design.
    pub(super) fn settle(
        &self,
        at: usize,
        state: &PairState,
        fault: Option<Injected>,
    ) -> Vec<Pairs> {
        let design = self.design;
        let mut nets = vec![Pairs::constant(0, 0); design.nets.len()];
        let mut intervals = vec![(0, 0); design.nets.len()];
        for &id in &self.order {
            let net = design.net(id);
            let width = design.width(id);
            let of = |net: NetId| nets[net.index()];
            let value = match (&net.driver, fault) {
                (_, Some((Site::Driver(at_fault, driver), sound))) if *at_fault == id => {
                    self.replaced(id, driver, &nets, sound)
                }
                (Driver::Op(op), Some((_, sound)))
                    if op.operands().iter().all(|it| of(*it).differ() == 0) =>
                {
                    sound[id.index()]
                }
                (Driver::Op(op), _) => pairs::cell(design, op, width, &of, &self.same),
                (Driver::Constant(bits), _) => Pairs::constant(*bits, width),
                (Driver::Register(register), None) if Some(*register) == self.counter => {
                    Pairs::constant(at as u64, width)
                }
                (Driver::Register(register), _) => state[register.index()],
                (Driver::Rom(rom), _) if design.rom(*rom).synchronous => {
                    state[design.registers.len() + rom.index()]
                }
                (Driver::Rom(rom), _) => self.read(*rom, &nets, fault),
                (Driver::Field(field), _) => {
                    let sound = design.control.microprogram[at].values[field.index()];
                    let mut bits = sound;
                    if let Some((Site::Words(rom, words), _)) = fault
                        && *rom == design.control.rom
                        && let Some((_, word)) = words.iter().find(|(address, _)| *address == at)
                    {
                        bits = word >> design.field_positions()[field.index()];
                    }
                    Pairs::constant(sound, width).across(Pairs::constant(bits, width))
                }
                (Driver::Input | Driver::Undriven, _) => Pairs::same(width),
            };
            nets[id.index()] = match fault {
                None => {
                    let interval = match (&net.driver, self.in_all_slots.get(id.index())) {
                        // The register has the value that was computed in the slot before.
                        (Driver::Register(_), Some(interval)) => *interval,
                        _ => interval::of(design, id, &|net| intervals[net.index()], &|net| {
                            nets[net.index()]
                        }),
                    };
                    intervals[id.index()] = interval;
                    value.and(Pairs::of_interval(interval, width))
                }
                Some((site, sound)) => {
                    let of_mutant = match (site, &net.driver) {
                        // The fault changes the value that the register takes at the edge, in `next`.
                        (_, Driver::Register(_)) => value,
                        (Site::Bit(at_fault, bit, how), _) if *at_fault == id => {
                            value.at_fault(*bit, *how)
                        }
                        _ => value,
                    };
                    of_mutant.within(sound[id.index()])
                }
            };
        }
        nets
    }

    /// Returns the pairs of net `id` if the mutant drives it by `driver`. `nets` has the pairs of earlier nets.
    fn replaced(&self, id: NetId, driver: &Driver, nets: &[Pairs], sound: &[Pairs]) -> Pairs {
        let design = self.design;
        let width = design.width(id);
        let value = |net: NetId| nets[net.index()];
        let new = match driver {
            Driver::Constant(bits) => Pairs::constant(*bits, width),
            Driver::Op(op) => pairs::cell(design, op, width, &value, &self.same),
            _ => Pairs::same(width),
        };
        let before = taken(design, &design.net(id).driver, &|net| sound[net.index()]);
        let after = taken(design, driver, &value);
        match (before, after) {
            (Some(a), Some(b)) if self.same[a.index()] == self.same[b.index()] => value(b),
            _ => sound[id.index()].across(new),
        }
    }

    /// Returns the pairs of a ROM's word. A fault may change the address or the words.
    fn read(&self, id: RomId, nets: &[Pairs], fault: Option<Injected>) -> Pairs {
        let rom = self.design.rom(id);
        let width = self.design.width(rom.data);
        let words = self.words[id.index()];
        let Some((site, sound)) = fault else {
            return words;
        };
        let address = nets[rom.address.index()];
        let mut differ = match address.differ() {
            0 => 0,
            // If every address has a word, only bits that differ between words can differ.
            _ if rom.words.len() == 1 << self.design.width(rom.address) => {
                let mut between_words = 0;
                for word in &rom.words {
                    between_words |= word ^ rom.words[0];
                }
                between_words
            }
            _ => u64::MAX,
        };
        if let Site::Words(at_fault, words) = site
            && *at_fault == id
        {
            for &(at, word) in words {
                if address.may_be(at as u64) {
                    differ |= word ^ rom.words[at];
                }
            }
        }
        // A synchronous ROM shows the word in the next clock.
        let sound_word = if rom.synchronous { words } else { sound[rom.data.index()] };
        sound_word.across(Pairs::same(width)).and(Pairs::same(width).or_any(differ))
    }

    /// Returns the contents of registers and synchronous ROMs after the rising edge, from the pairs of all nets before it.
    /// `reloads` says for each register whether its data equal its content in the fault-free design; it is read only with a
    /// fault.
    pub(super) fn next(
        &self,
        nets: &[Pairs],
        fault: Option<Injected>,
        reloads: &[bool],
    ) -> PairState {
        let design = self.design;
        let one = Pairs::constant(1, 1);
        let mut state = PairState::new();
        for (at, register) in design.registers.iter().enumerate() {
            let held = (nets[register.q.index()], self.same[register.q.index()]);
            let Some(data) = register.data else {
                state.push(held.0);
                continue;
            };
            let mut offered = (nets[data.index()], self.same[data.index()]);
            let mut enable = match register.enable {
                Some(enable) => nets[enable.index()],
                None => one,
            };
            match fault {
                Some((Site::Bit(net, bit, how), _)) if *net == register.q => {
                    offered.0 = offered.0.at_fault(*bit, *how);
                }
                Some((Site::Enable(id, always), _)) if *id == RegId(at as u32) => {
                    enable = enable.across(Pairs::constant(u64::from(*always), 1));
                }
                _ => {}
            }
            // Whether the mutant loads or not, it has the content and the data of the fault-free design, which are equal.
            let is_alike = [held.0, offered.0].iter().all(|it| it.differ() == 0);
            if fault.is_some() && is_alike && reloads.get(at) == Some(&true) {
                state.push(held.0);
                continue;
            }
            // If nothing differs, the fault-free design already has the answer.
            if fault.is_some() && [enable, held.0, offered.0].iter().all(|it| it.differ() == 0) {
                state.push(held.0);
                continue;
            }
            let next = pairs::chosen(enable, 1, &[held, offered]);
            state.push(match (register.reset, fault) {
                (Some(bits), None) => next.or(Pairs::constant(bits, design.width(register.q))),
                _ => next,
            });
        }
        for (at, rom) in design.roms.iter().enumerate() {
            let held = (nets[rom.data.index()], rom.data);
            let word = (self.read(RomId(at as u32), nets, fault), rom.address);
            let enable = match rom.enable {
                Some(enable) => nets[enable.index()],
                None => one,
            };
            state.push(pairs::chosen(enable, 1, &[held, word]));
        }
        state
    }
}

/// Returns the net that `driver` passes on: the input of a renaming, or the only input that a mux can select. Returns `None` for
/// other drivers.
fn taken(design: &Design, driver: &Driver, value: &impl Fn(NetId) -> Pairs) -> Option<NetId> {
    match driver {
        Driver::Op(Op::Relabel(a)) => Some(*a),
        Driver::Op(Op::Mux { select, inputs }) => {
            let mut possible = pairs::choices(value(*select), design.width(*select), inputs);
            let first = possible.next()?;
            if possible.all(|input| input == first) { Some(first) } else { None }
        }
        _ => None,
    }
}

/// Returns the number of microinstructions, or of slots of a pipeline.
pub(super) fn count(design: &Design) -> usize {
    match &design.pipeline {
        Some(pipeline) => pipeline.interval,
        None => design.control.microprogram.len().max(1),
    }
}

/// Returns the microinstructions or slots that may follow number `at`, in ascending order. A reset leads to number 0. A pipeline
/// stays in a slot while it waits.
pub(super) fn following(design: &Design, at: usize) -> Vec<usize> {
    let mut following = vec![0];
    match &design.pipeline {
        Some(pipeline) => following.extend([at, (at + 1) % pipeline.interval]),
        None => {
            let last = count(design) - 1;
            following.extend(design.control.successors(at).into_iter().map(|to| to.min(last)));
        }
    }
    following.sort_unstable();
    following.dedup();
    following
}

/// Finds, for each net, the first net in `order` with the same driver.
pub(super) fn same(design: &Design, order: &[NetId]) -> Vec<NetId> {
    let mut same: Vec<NetId> = design.iter().map(|(id, _)| id).collect();
    let mut drivers: Vec<(Driver, u32, bool, NetId)> = Vec::new();
    for &id in order {
        let net = design.net(id);
        let mut driver = net.driver.clone();
        let mut signed = false;
        match &mut driver {
            Driver::Op(Op::Relabel(of)) => {
                same[id.index()] = same[of.index()];
                continue;
            }
            Driver::Op(op) => {
                // Whether an operand is signed matters for extensions, comparisons and products.
                signed = op.operands().iter().any(|net| design.net(*net).format.signed);
                *op = op.map(|operand| same[operand.index()]);
            }
            Driver::Constant(_) => {}
            _ => continue,
        }
        let width = design.width(id);
        let known = drivers
            .iter()
            .find(|(other, bits, sign, _)| *other == driver && *bits == width && *sign == signed);
        match known {
            Some((.., first)) => same[id.index()] = *first,
            None => drivers.push((driver, width, signed, id)),
        }
    }
    same
}

//! What is known of the fault-free design in each microinstruction; a pipeline, which has none, is taken as one that follows
//! itself.

use super::interval;
use super::known::{self, Known};
use crate::hdl::netlist::{Design, Driver, NetId, Op, Register};

/// What is known in each microinstruction, whatever the inputs are.
pub(super) struct Sound<'a> {
    pub(super) design: &'a Design,
    /// An order of evaluation.
    pub(super) order: Vec<NetId>,
    /// For each microinstruction, each net.
    pub(super) nets: Vec<Vec<Known>>,
    /// For each microinstruction those that may follow it.
    pub(super) following: Vec<Vec<usize>>,
    /// For each net the first that has the same driver: the same value.
    pub(super) same: Vec<NetId>,
}

impl<'a> Sound<'a> {
    /// `None` for a design with a combinational loop.
    pub(super) fn of(design: &'a Design) -> Option<Self> {
        let mut order = design.levelise().ok()?;
        if let Some(pipeline) = &design.pipeline {
            // Registers behind the logic of the stage before.
            order.sort_by_key(|net| pipeline.stage_of[net.index()]);
        }
        let length = design.control.microprogram.len().max(1);
        let mut sound = Self {
            design,
            same: same(design, &order),
            order,
            nets: Vec::new(),
            following: (0..length).map(|at| following(design, at)).collect(),
        };
        // What registers hold in each microinstruction: at power-up 0, in microinstruction 0.
        let mut held: Vec<Option<Vec<Known>>> = vec![None; length];
        held[0] = Some(vec![Known::all(0, 64); design.registers.len()]);
        let mut changed = vec![0];
        while let Some(at) = changed.pop() {
            let Some(before) = held[at].clone() else {
                continue;
            };
            let nets = sound.settle(at, &before);
            let after: Vec<Known> =
                design.registers.iter().map(|register| sound.next(register, &nets)).collect();
            for &to in &sound.following[at] {
                let joined = match &held[to] {
                    None => after.clone(),
                    Some(there) => there.iter().zip(&after).map(|(a, b)| a.join(*b)).collect(),
                };
                if held[to].as_ref() != Some(&joined) {
                    held[to] = Some(joined);
                    changed.push(to);
                }
            }
        }
        let nothing = || vec![Known::NOTHING; design.registers.len()];
        sound.nets = (0..length)
            .map(|at| sound.settle(at, &held[at].clone().unwrap_or_else(nothing)))
            .collect();
        Some(sound)
    }

    /// All nets in a microinstruction, with what registers hold.
    fn settle(&self, at: usize, held: &[Known]) -> Vec<Known> {
        let design = self.design;
        let mut nets = vec![Known::NOTHING; design.nets.len()];
        let mut intervals = vec![(0, 0); design.nets.len()];
        for &id in &self.order {
            let net = design.net(id);
            let width = design.width(id);
            let known = match &net.driver {
                Driver::Constant(bits) => Known::all(*bits, width),
                Driver::Register(register) if *register == design.control.address => {
                    Known::all(at as u64, width)
                }
                Driver::Register(register) => held[register.index()],
                Driver::Field(field) => {
                    Known::all(design.control.microprogram[at].values[field.index()], width)
                }
                Driver::Rom(rom) => {
                    // At power-up a synchronous ROM shows 0.
                    let rom = design.rom(*rom);
                    let words = rom.words.iter().map(|&word| Known::all(word, width));
                    let start = rom.synchronous.then_some(Known::all(0, width));
                    words.chain(start).reduce(Known::join).unwrap_or_default()
                }
                Driver::Op(op) => known::cell(design, op, width, &|net| nets[net.index()]),
                Driver::Input | Driver::Undriven => Known::NOTHING,
            };
            let of = |net: NetId| intervals[net.index()];
            let interval = interval::of(design, id, &of, &|net| nets[net.index()]);
            intervals[id.index()] = interval;
            nets[id.index()] = known.and_also(Known::of_interval(interval, width));
        }
        nets
    }

    fn next(&self, register: &Register, nets: &[Known]) -> Known {
        let held = nets[register.q.index()];
        let Some(data) = register.data else {
            return held;
        };
        let taken = nets[data.index()];
        let enable = register.enable.map_or(Known::all(1, 1), |net| nets[net.index()]);
        let next = match enable.whole(1) {
            Some(1) => taken,
            Some(_) => held,
            None => held.join(taken),
        };
        match register.reset {
            Some(reset) => next.join(Known::all(reset, self.design.width(register.q))),
            None => next,
        }
    }
}

/// The microinstructions that may follow one, reset included, which leads to microinstruction 0 from any.
fn following(design: &Design, at: usize) -> Vec<usize> {
    let Some(last) = design.control.microprogram.len().checked_sub(1) else {
        return vec![at];
    };
    let mut following = vec![0];
    following.extend(design.control.successors(at).into_iter().map(|to| to.min(last)));
    following.sort_unstable();
    following.dedup();
    following
}

/// For each net the first with the same driver.
fn same(design: &Design, order: &[NetId]) -> Vec<NetId> {
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
                // Whether an operand is signed counts where it is extended, compared or multiplied.
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

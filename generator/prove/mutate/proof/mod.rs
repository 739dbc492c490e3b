//! Proves that a fault changes nothing that is compared.
//!
//! One proof is an induction over clocks. In every microinstruction, it evaluates the fault-free design and the
//! mutant side by side, over the pairs of bits that a net can have in both ([`pairs`]). Registers inside of blocks
//! may differ as far as earlier microinstructions let them. If no output and no register that the golden model
//! predicts differs in any microinstruction, they never do. The other proof tries every combination of values around
//! the fault ([`window`]).

mod cut;
mod flat;
mod interval;
mod pairs;
mod step;
mod window;

use pairs::Pairs;
use step::{Order, PairState, count, following};
use window::Windows;

use super::fault::Site;
use super::verdict::How;
use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Driver, NetId, RegId, RegisterKind};

/// Proves faults of one design equivalent.
pub(super) struct Prover<'a> {
    order: Order<'a>,
    /// For each microinstruction, the values that each net of the fault-free design can have, whatever the inputs
    /// are.
    nets: Vec<Vec<Pairs>>,
    /// For each microinstruction, the microinstructions that may follow it.
    following: Vec<Vec<usize>>,
    /// For each microinstruction the bits of each net that are compared in it.
    compared: Vec<Vec<u64>>,
    windows: Windows<'a>,
}

impl<'a> Prover<'a> {
    /// Prepares the proofs of a design. Returns `None` for a design with a combinational loop.
    pub(super) fn new(design: &'a Design) -> Option<Self> {
        let length = count(design);
        let mut compared = vec![vec![0; design.nets.len()]; length];
        let mut compare = |net: NetId, slot: Option<usize>| {
            for (at, compared) in compared.iter_mut().enumerate() {
                if slot.is_none_or(|slot| slot == at) {
                    compared[net.index()] = mask(design.width(net));
                }
            }
        };
        let registers = design.registers.iter();
        let registers = registers.filter(|register| register.kind != RegisterKind::Internal);
        let outputs = design.outputs().map(|port| port.net);
        outputs.chain(registers.map(|register| register.q)).for_each(|net| compare(net, None));
        if let Some(pipeline) = &design.pipeline {
            // There is a point in a stage in one slot alone.
            let slot = |net: NetId| pipeline.clock_of(net) % pipeline.interval;
            pipeline.checkpoints.iter().for_each(|it| compare(it.net, Some(slot(it.net))));
        }
        let order = Order::of(design)?;
        let following: Vec<_> = (0..length).map(|at| following(design, at)).collect();
        // At power-up everything that is held is 0, in microinstruction 0.
        let mut held: Vec<Option<PairState>> = vec![None; length];
        held[0] = Some(order.held().map(|net| Pairs::constant(0, design.width(net))).collect());
        let mut todo = vec![0];
        while let Some(at) = todo.pop() {
            let Some(state) = &held[at] else { continue };
            let after = order.next(&order.settle(at, state, None), None);
            for &to in &following[at] {
                let there = held[to].as_ref();
                let joined = there.map_or_else(|| after.clone(), |it| join(it, &after));
                if there != Some(&joined) {
                    held[to] = Some(joined);
                    todo.push(to);
                }
            }
        }
        let anything = || order.held().map(|net| Pairs::same(design.width(net))).collect();
        let state = |at: usize| held[at].clone().unwrap_or_else(anything);
        let nets = (0..length).map(|at| order.settle(at, &state(at), None)).collect();
        Some(Self { nets, order, following, compared, windows: Windows::of(design)? })
    }

    /// Returns how it is proved, if it is, that nothing that is compared ever differs with this fault.
    pub(super) fn proves(&self, site: &Site) -> Option<How> {
        if self.by_induction(site) {
            Some(How::Induction)
        } else {
            self.windows.proves(site).then_some(How::Exhaustion)
        }
    }

    fn by_induction(&self, site: &Site) -> bool {
        let design = self.order.design;
        let resets = |id: &RegId| design.register(*id).reset;
        match site {
            // The effect of a reset is no part of the proof.
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
        let held = |nets: &Vec<Pairs>| -> PairState {
            self.order.held().map(|net| nets[net.index()]).collect()
        };
        let mut states: Vec<PairState> = self.nets.iter().map(held).collect();
        let mut todo: Vec<usize> = (0..states.len()).collect();
        while let Some(at) = todo.pop() {
            let fault = Some((site, &self.nets[at][..]));
            let nets = self.order.settle(at, &states[at], fault);
            let seen = |(net, bits): (&Pairs, &u64)| net.differ() & bits != 0;
            if nets.iter().zip(&self.compared[at]).any(seen) {
                return false;
            }
            let next = self.order.next(&nets, fault);
            let differs = |net: &Pairs| net.differ() != 0;
            let mut registers = design.registers.iter().zip(&next);
            if registers.any(|(it, next)| it.kind != RegisterKind::Internal && differs(next)) {
                return false;
            }
            for &to in &self.following[at] {
                let sound = held(&self.nets[to]);
                let possible = next.iter().zip(&sound).map(|(next, sound)| next.within(*sound));
                let joined = join(&states[to], &possible.collect());
                if joined != states[to] {
                    states[to] = joined;
                    todo.push(to);
                }
            }
        }
        true
    }
}

/// Joins two states: each bit may be as in either. For example, a bit that is 0 in one state and 1 in the other may be
/// both.
fn join(one: &PairState, other: &PairState) -> PairState {
    one.iter().zip(other).map(|(one, other)| one.or(*other)).collect()
}

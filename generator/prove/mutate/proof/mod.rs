//! Proves that a fault never changes an output or a register that the golden model predicts.
//!
//! The first proof is an induction over clocks. In every microinstruction, it evaluates the fault-free design and the mutant
//! together, and tracks which pairs of values each bit can have ([`pairs`]). An internal register, for example one behind a
//! multiplier, may differ: the induction passes its possible pairs on to the next microinstructions. If no output and no
//! predicted register differs in any microinstruction, the mutant is equivalent. A pipeline has slots in place of
//! microinstructions, and its checkpoints are also compared. The induction proves no fault that changes a reset. The second proof
//! tries every combination of values on the nets around the fault ([`window`]). A register that loads once more without a change
//! of its data keeps its value ([`reload`]).

mod cut;
mod flat;
mod interval;
mod pairs;
mod reload;
mod step;
mod window;

use pairs::Pairs;
use step::{Order, PairState, count, following};
use window::Windows;

use super::fault::Site;
use super::verdict::How;
use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Driver, NetId, RegisterKind};

/// Proves that a planted fault never changes a compared output or register.
pub(super) struct Prover<'a> {
    order: Order<'a>,
    /// The values that each net of the fault-free design can have, for each microinstruction.
    nets: Vec<Vec<Pairs>>,
    following: Vec<Vec<usize>>,
    /// A mask of the bits of each net that are compared, for each microinstruction.
    compared: Vec<Vec<u64>>,
    /// Whether each register would load the value that it already has, for each microinstruction.
    reloads: Vec<Vec<bool>>,
    windows: Windows<'a>,
}

impl<'a> Prover<'a> {
    /// Prepares the proofs for `design`. Returns `None` for a design with a combinational loop.
    pub(super) fn new(design: &'a Design) -> Option<Self> {
        let length = count(design);
        let compared = compared_bits(design, length);
        let order = Order::of(design)?;
        let following: Vec<_> = (0..length).map(|at| following(design, at)).collect();
        let anything: PairState = order.held().map(|net| Pairs::same(design.width(net))).collect();
        let mut nets = Vec::new();
        for (at, state) in reached_states(&order, &following).iter().enumerate() {
            nets.push(order.settle(at, state.as_ref().unwrap_or(&anything), None));
        }
        let reloads = reload::reloads(design, &nets, &following);
        Some(Self { nets, order, following, compared, reloads, windows: Windows::of(design)? })
    }

    /// Returns the method that proves the fault at `site` equivalent, or `None` if neither method does.
    pub(super) fn proves(&self, site: &Site) -> Option<How> {
        if self.by_induction(site) {
            Some(How::Induction)
        } else if self.windows.proves(site) {
            Some(How::Exhaustion)
        } else {
            None
        }
    }

    /// Returns whether the induction proves the fault equivalent; never for a fault that changes a reset.
    fn by_induction(&self, site: &Site) -> bool {
        if self.changes_reset(site) {
            return false;
        }
        let registers = &self.order.design.registers;
        let sound: Vec<PairState> = self.nets.iter().map(|nets| self.held_in(nets)).collect();
        let mut states = sound.clone();
        let mut todo: Vec<usize> = (0..states.len()).collect();
        while let Some(at) = todo.pop() {
            let fault = Some((site, &self.nets[at][..]));
            let nets = self.order.settle(at, &states[at], fault);
            for (net, bits) in nets.iter().zip(&self.compared[at]) {
                if net.differ() & bits != 0 {
                    return false;
                }
            }
            let next = self.order.next(&nets, fault, &self.reloads[at]);
            for (register, value) in registers.iter().zip(&next) {
                if register.kind != RegisterKind::Internal && value.differ() != 0 {
                    return false;
                }
            }
            for &to in &self.following[at] {
                let mut possible = PairState::new();
                for (value, sound) in next.iter().zip(&sound[to]) {
                    possible.push(value.within(*sound));
                }
                let joined = join(&states[to], &possible);
                if joined != states[to] {
                    states[to] = joined;
                    todo.push(to);
                }
            }
        }
        true
    }

    /// Returns whether the fault changes a reset's effect, which the induction does not model.
    fn changes_reset(&self, site: &Site) -> bool {
        let design = self.order.design;
        match site {
            Site::Reset(_) => true,
            Site::Bit(net, bit, how) => match &design.net(*net).driver {
                Driver::Register(id) => match design.register(*id).reset {
                    Some(reset) => how.applied(reset, *bit) != reset,
                    None => false,
                },
                _ => false,
            },
            _ => false,
        }
    }

    fn held_in(&self, nets: &[Pairs]) -> PairState {
        self.order.held().map(|net| nets[net.index()]).collect()
    }
}

/// Returns, for each microinstruction or slot, a mask of the compared bits of each net. Outputs and predicted registers are
/// always compared. A checkpoint is compared in the slot in which its stage can hold a point.
fn compared_bits(design: &Design, length: usize) -> Vec<Vec<u64>> {
    let mut always: Vec<NetId> = design.outputs().map(|port| port.net).collect();
    for register in &design.registers {
        if register.kind != RegisterKind::Internal {
            always.push(register.q);
        }
    }
    let mut compared = vec![vec![0; design.nets.len()]; length];
    for bits_of_nets in &mut compared {
        for net in &always {
            bits_of_nets[net.index()] = mask(design.width(*net));
        }
    }
    if let Some(pipeline) = &design.pipeline {
        for checkpoint in &pipeline.checkpoints {
            // A stage has a point in only one slot of the interval.
            let slot = pipeline.clock_of(checkpoint.net) % pipeline.interval;
            compared[slot][checkpoint.net.index()] = mask(design.width(checkpoint.net));
        }
    }
    compared
}

/// Returns the state before each microinstruction, with all values that are possible from power-up on; `None` for a
/// microinstruction that the design never reaches.
fn reached_states(order: &Order, following: &[Vec<usize>]) -> Vec<Option<PairState>> {
    let design = order.design;
    let mut reached: Vec<Option<PairState>> = vec![None; following.len()];
    // At power-up every register and ROM output is 0, in microinstruction 0.
    reached[0] = Some(order.held().map(|net| Pairs::constant(0, design.width(net))).collect());
    let mut todo = vec![0];
    while let Some(at) = todo.pop() {
        let Some(state) = &reached[at] else { continue };
        let after = order.next(&order.settle(at, state, None), None, &[]);
        for &to in &following[at] {
            let mut entering = after.clone();
            if to > 0 && design.pipeline.is_none() {
                // Only a running device leaves microinstruction 0.
                entering[design.control.run.index()] = Pairs::constant(1, 1);
            }
            let joined = match &reached[to] {
                Some(before) => join(before, &entering),
                None => entering,
            };
            if reached[to].as_ref() != Some(&joined) {
                reached[to] = Some(joined);
                todo.push(to);
            }
        }
    }
    reached
}

/// Returns the union of two states: each bit may have its values from `one` and from `other`.
fn join(one: &PairState, other: &PairState) -> PairState {
    one.iter().zip(other).map(|(one, other)| one.or(*other)).collect()
}

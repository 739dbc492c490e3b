//! Finds the microinstructions in which a register would load the value that it already has.
//!
//! For example, a register loads a product in one microinstruction, and the factors do not change in the next two. In these two,
//! a second load makes no difference. A fault that causes the load is therefore equivalent. The analysis covers sequential
//! designs; a pipeline has no such microinstructions.

use std::collections::BTreeSet;

use super::pairs::Pairs;
use glint_rtl::netlist::{Design, Driver, FieldId, NetId, Sequence};

/// Whether a register or a synchronous ROM takes a new value in a microinstruction.
#[derive(Clone, Copy, PartialEq)]
enum Load {
    Never,
    Always,
    Possible,
}

/// A register or a synchronous ROM, with the sources of its next value.
struct Holder {
    /// The enable; `None` for a holder that takes a value in every clock.
    enable: Option<NetId>,
    /// The registers and synchronous ROMs from which the next value is computed.
    holders: BTreeSet<usize>,
    /// The fields of the control word from which the next value is computed.
    fields: BTreeSet<FieldId>,
    /// Whether the next value depends on an input of the design, which may change in any clock.
    reads_input: bool,
}

/// Returns for each microinstruction and each register whether the next value certainly equals the present value. `nets` has the
/// possible values of all nets in each microinstruction, and `following` the microinstructions that may follow.
///
/// If the microprogram dispatches, each computation keeps to the microinstructions for one value of the selector. A register must
/// then keep its value for each of these values.
pub(super) fn reloads(
    design: &Design,
    nets: &[Vec<Pairs>],
    following: &[Vec<usize>],
) -> Vec<Vec<bool>> {
    let registers = design.registers.len();
    if design.pipeline.is_some() {
        return vec![vec![false; registers]; nets.len()];
    }
    let holders = holders(design);
    let mut reloads = vec![vec![true; registers]; nets.len()];
    for selected in 0..selector_values(design) {
        let following = executed_following(design, following, selected);
        let facts = facts(design, &holders, nets, &following);
        for (at, of_registers) in reloads.iter_mut().enumerate() {
            let is_executed = following.iter().any(|following| following.contains(&at));
            for (reloads, fact) in of_registers.iter_mut().zip(&facts[at]) {
                *reloads &= !is_executed || *fact;
            }
        }
    }
    reloads
}

/// Returns the number of values of the operand by which the microprogram dispatches, or 1 if it does not dispatch.
fn selector_values(design: &Design) -> usize {
    let mut sequences = design.control.microprogram.iter().map(|it| &it.sequence);
    let targets = sequences.find_map(|sequence| match sequence {
        Sequence::Dispatch { to, .. } => Some(to.len()),
        _ => None,
    });
    targets.unwrap_or(1)
}

/// Returns `following` without the microinstructions that no computation with the selector value `selected` executes.
fn executed_following(
    design: &Design,
    following: &[Vec<usize>],
    selected: usize,
) -> Vec<Vec<usize>> {
    let mut of_value = vec![Vec::new(); following.len()];
    let mut todo = vec![0];
    while let Some(at) = todo.pop() {
        if !of_value[at].is_empty() {
            continue;
        }
        let mut next = following[at].clone();
        if let Sequence::Dispatch { to, .. } = &design.control.microprogram[at].sequence {
            // A reset leads to microinstruction 0.
            next.retain(|address| *address == 0 || *address == to[selected]);
        }
        todo.extend(&next);
        of_value[at] = next;
    }
    of_value
}

/// Returns for each microinstruction and each holder whether the next value certainly equals the present value.
fn facts(
    design: &Design,
    holders: &[Holder],
    nets: &[Vec<Pairs>],
    following: &[Vec<usize>],
) -> Vec<Vec<bool>> {
    let count = nets.len();
    // Every fact is assumed at first, except in the idle microinstruction, and dropped where it does not follow.
    let mut facts = vec![vec![true; holders.len()]; count];
    facts[0] = vec![false; holders.len()];
    let mut is_changed = true;
    while is_changed {
        is_changed = false;
        for at in 0..count {
            for &to in &following[at] {
                for (number, holder) in holders.iter().enumerate() {
                    let holds = follows(design, holders, holder, &nets[at], &facts[at], (at, to))
                        && (load(holder, &nets[at]) == Load::Always || facts[at][number]);
                    if facts[to][number] && !holds {
                        facts[to][number] = false;
                        is_changed = true;
                    }
                }
            }
        }
    }
    facts
}

/// Returns whether all sources of the next value of `holder` are the same in microinstruction `to` as in `at`, directly before
/// it. `facts` says which holders would load the values that they have in `at`.
fn follows(
    design: &Design,
    holders: &[Holder],
    holder: &Holder,
    nets: &[Pairs],
    facts: &[bool],
    (at, to): (usize, usize),
) -> bool {
    let keeps = |other: &usize| load(&holders[*other], nets) == Load::Never || facts[*other];
    let microprogram = &design.control.microprogram;
    let is_same = |field: &FieldId| {
        microprogram[at].values[field.index()] == microprogram[to].values[field.index()]
    };
    !holder.reads_input && holder.holders.iter().all(keeps) && holder.fields.iter().all(is_same)
}

fn load(holder: &Holder, nets: &[Pairs]) -> Load {
    let Some(enable) = holder.enable else { return Load::Always };
    let bit = nets[enable.index()];
    match (bit.may_be(0), bit.may_be(1)) {
        (true, false) => Load::Never,
        (false, true) => Load::Always,
        _ => Load::Possible,
    }
}

/// Returns the registers and then the ROMs, including ROMs that are read in the same clock, which never change.
fn holders(design: &Design) -> Vec<Holder> {
    let mut holders = Vec::new();
    for register in &design.registers {
        holders.push(holder(design, register.data, register.enable));
    }
    for rom in &design.roms {
        holders.push(holder(design, Some(rom.address), rom.enable));
    }
    holders
}

fn holder(design: &Design, data: Option<NetId>, enable: Option<NetId>) -> Holder {
    let mut holder =
        Holder { enable, holders: BTreeSet::new(), fields: BTreeSet::new(), reads_input: false };
    let mut seen = BTreeSet::new();
    let mut todo: Vec<NetId> = data.into_iter().collect();
    while let Some(net) = todo.pop() {
        if !seen.insert(net.index()) {
            continue;
        }
        match &design.net(net).driver {
            Driver::Op(op) => todo.extend(op.operands()),
            Driver::Register(id) => drop(holder.holders.insert(id.index())),
            Driver::Rom(id) if design.rom(*id).synchronous => {
                holder.holders.insert(design.registers.len() + id.index());
            }
            Driver::Rom(id) => todo.push(design.rom(*id).address),
            Driver::Field(field) => drop(holder.fields.insert(*field)),
            Driver::Input | Driver::Undriven => holder.reads_input = true,
            Driver::Constant(_) => {}
        }
    }
    holder
}

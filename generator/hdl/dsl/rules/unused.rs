//! Finds superfluous hardware in a description without mistakes: logic on which no output depends, a mux that always passes the
//! same input, or a choice that no microinstruction makes.

use std::collections::HashSet;

use super::operands::{read_by, used};
use crate::netlist::{Design, Driver, FieldId, FieldKind, Net, NetId, Op, Partition};
use glint_base::codes;
use glint_base::cone::reached;
use glint_base::diagnostic::Diagnostic;

/// Select lines in `partly_used` may have choices that no microinstruction makes.
pub(in crate::dsl) fn warnings(design: &Design, partly_used: &HashSet<FieldId>) -> Vec<Diagnostic> {
    let mut found = dead(design);
    found.extend(constant(design));
    found.extend(unmade(design, partly_used));
    found
}

/// Finds registers, memories and named cells on which no output depends. Leaves out memories and cells that other unused logic
/// reads, so that one mistake gives one warning.
fn dead(design: &Design) -> Vec<Diagnostic> {
    let used = used(design);
    let mut dead: Vec<(NetId, &Net)> = Vec::new();
    for (id, net) in design.iter() {
        let is_described = net.named && net.partition == Partition::Datapath;
        let is_logic = matches!(net.driver, Driver::Register(_) | Driver::Rom(_) | Driver::Op(_));
        if is_described && is_logic && !used.contains(&id) {
            dead.push((id, net));
        }
    }
    let inputs = dead.iter().flat_map(|(id, _)| read_by(design, *id));
    let read = reached(inputs, |id| design.combinational_inputs(id));
    let mut found = Vec::new();
    for (id, net) in dead {
        if matches!(net.driver, Driver::Register(_)) || !read.contains(&id) {
            let message = format!("`{}` is not used: no output depends on it", net.name);
            found.push(Diagnostic::new(codes::UNUSED, message, net.location));
        }
    }
    found
}

/// Finds named muxes whose select is constant, or whose inputs are all the same.
fn constant(design: &Design) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (_, net) in design.iter().filter(|(_, net)| net.named) {
        let Driver::Op(Op::Mux { select, inputs }) = &net.driver else { continue };
        let (low, high) = design.net(*select).range;
        let passed = match low == high {
            true => inputs.get(low as usize).or(inputs.last()),
            false => inputs.first().filter(|first| inputs.iter().all(|input| input == *first)),
        };
        if let Some(passed) = passed {
            let name = &design.net(*passed).name;
            let message = format!(
                "mux `{}` always passes `{name}` on: use that signal in place of the mux",
                net.name
            );
            found.push(Diagnostic::new(codes::UNUSED, message, net.location));
        }
    }
    found
}

fn unmade(design: &Design, partly_used: &HashSet<FieldId>) -> Vec<Diagnostic> {
    let control = &design.control;
    let mut found = Vec::new();
    for (at, field) in control.fields.iter().enumerate() {
        let FieldKind::Select(choices) = &field.kind else { continue };
        if partly_used.contains(&FieldId(at as u32)) {
            continue;
        }
        let mut unmade: Vec<&str> = Vec::new();
        for (number, name) in (0..).zip(choices) {
            if control.microprogram.iter().all(|it| it.values[at] != number) {
                unmade.push(name);
            }
        }
        if !unmade.is_empty() {
            let names = unmade.join("`, `");
            let message = format!("no microinstruction selects `{names}` with `{}`", field.name);
            let location = design.net(field.net).location;
            found.push(Diagnostic::new(codes::UNUSED_CONTROL, message, location));
        }
    }
    found
}

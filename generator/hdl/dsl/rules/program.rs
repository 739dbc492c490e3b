//! Checks the microprogram of a description: it must raise `valid`, but only after the result is loaded. Some microinstruction
//! must choose an input of every mux, and every loop must be able to end.

use std::collections::HashSet;

use crate::netlist::{
    Control, Design, Driver, FieldId, FieldKind, NetId, RegId, RegisterKind, Role, Sequence,
    passed_on, setting_of,
};
use glint_base::codes;
use glint_base::cone::reached;
use glint_base::diagnostic::Diagnostic;

/// `picked` has the fields to which some microinstruction gives a value.
pub(super) fn check(design: &Design, picked: &HashSet<FieldId>) -> Vec<Diagnostic> {
    let mut found = early(design);
    found.extend(silent(design));
    found.extend(unpicked(design, picked));
    found.extend(endless(design));
    found
}

/// Returns a mistake if a design with a result never raises `valid`.
fn silent(design: &Design) -> Option<Diagnostic> {
    let control = &design.control;
    let result = design.port(|role| role == Role::Result)?;
    let valid = design.port(|role| role == Role::Valid)?.net;
    let mut raised = control.microprogram.iter().map(|it| setting_of(design, it, valid));
    raised.all(|raised| raised == Some(0)).then(|| {
        let message = format!(
            "no microinstruction sets `valid`, so nothing tells when `{}` is ready: add `valid()` to the \
             microinstruction in which the result is ready",
            design.net(result.net).name
        );
        Diagnostic::new(codes::VALID, message, design.rom(control.rom).location)
    })
}

fn unpicked(design: &Design, picked: &HashSet<FieldId>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (at, field) in design.control.fields.iter().enumerate() {
        if let FieldKind::Select(choices) = &field.kind
            && !picked.contains(&FieldId(at as u32))
        {
            let message = format!(
                "no microinstruction selects an input with `{}` (`{}`): add a `pick` to a microinstruction, \
                 or remove the mux",
                field.name,
                choices.join("`, `")
            );
            let location = design.net(field.net).location;
            found.push(Diagnostic::new(codes::UNUSED_CONTROL, message, location));
        }
    }
    found
}

/// Finds microinstructions that raise `valid` while they load a register that a result shows: the output shows the loaded value
/// only in the next clock. Such a microinstruction is accepted if every path to it loads the register before.
fn early(design: &Design) -> Vec<Diagnostic> {
    let control = &design.control;
    let mut found = Vec::new();
    let Some(valid) = design.port(|role| role == Role::Valid).map(|port| port.net) else {
        return found;
    };
    for at in 0..control.microprogram.len() {
        if setting_of(design, &control.microprogram[at], valid) != Some(1) {
            continue;
        }
        for port in design.ports.iter().filter(|port| port.role == Role::Result) {
            let shown =
                cone(design, at, port.net).into_iter().filter_map(|id| register(design, id));
            let Some(register) = shown.into_iter().find(|&register| {
                loads(design, at, register) == Some(1) && comes_without_load(design, at, register)
            }) else {
                continue;
            };
            let q = design.net(design.register(register).q);
            let microinstruction = &control.microprogram[at];
            let message = format!(
                "microinstruction `{}` sets `valid` and loads `{}`, which `{}` shows only from the next \
                 microinstruction on: move `valid()` to the next microinstruction",
                microinstruction.name,
                q.name,
                design.net(port.net).name
            );
            found.push(
                Diagnostic::new(codes::VALID, message, microinstruction.location)
                    .note("the register".to_owned(), q.location),
            );
            break;
        }
    }
    found
}

fn register(design: &Design, id: NetId) -> Option<RegId> {
    match design.net(id).driver {
        Driver::Register(register) => Some(register),
        _ => None,
    }
}

/// Returns whether microinstruction `at` loads a register, as 1 or 0, and `None` if signals besides the control word decide. A
/// register without an enable gives 1.
fn loads(design: &Design, at: usize, register: RegId) -> Option<u64> {
    match design.register(register).enable {
        Some(enable) => setting_of(design, &design.control.microprogram[at], enable),
        None => Some(1),
    }
}

/// Returns whether a path leads from microinstruction 0 to `at` through microinstructions that do not load the register.
fn comes_without_load(design: &Design, at: usize, register: RegId) -> bool {
    let goes = |from: usize| loads(design, from, register) == Some(0);
    at == 0 || goes(0) && controlled(&design.control, 0, goes).contains(&at)
}

/// Returns `from` and the microinstructions that control can reach from it, if control passes only microinstructions for which
/// `goes` is true.
fn controlled(control: &Control, from: usize, goes: impl Fn(usize) -> bool) -> HashSet<usize> {
    reached([from], |now| if goes(now) { control.successors(now) } else { Vec::new() })
}

/// Returns `net` and all nets on which it depends in the clock of microinstruction `at`. If this microinstruction determines the
/// select of a mux, only the chosen input counts.
fn cone(design: &Design, at: usize, net: NetId) -> HashSet<NetId> {
    reached([net], |id| match design.net(id).driver {
        Driver::Field(_) => Vec::new(),
        _ => passed_on(design, &design.control.microprogram[at], id),
    })
}

/// Finds loops that cannot end. In such a loop, no microinstruction changes a register on which the condition depends, and no
/// other microinstruction leaves the loop or waits for `start`.
fn endless(design: &Design) -> Vec<Diagnostic> {
    let control = &design.control;
    let mut found = Vec::new();
    for (at, microinstruction) in control.microprogram.iter().enumerate() {
        let Sequence::LoopWhile { condition, to } = microinstruction.sequence else { continue };
        if to > at {
            continue;
        }
        // The body: the microinstructions from which control comes back to `at`.
        let within = controlled(control, to, |now| now != at);
        let mut body: Vec<usize> = Vec::new();
        for &from in &within {
            if controlled(control, from, |now| within.contains(&now)).contains(&at) {
                body.push(from);
            }
        }
        let is_left = body.iter().any(|&now| {
            let waits = now == 0 || control.microprogram[now].sequence == Sequence::WaitStart;
            waits || now != at && control.successors(now).iter().any(|next| !body.contains(next))
        });
        if is_left {
            continue;
        }
        let cone = cone(design, at, condition);
        if cone.iter().any(|&id| changes(design, &body, id)) {
            continue;
        }
        let mut held: Vec<&str> = Vec::new();
        for &id in &cone {
            if register(design, id).is_some() {
                held.push(&design.net(id).name);
            }
        }
        held.sort_unstable();
        let why = match held[..] {
            [] => "which is constant".to_owned(),
            _ => format!("and no microinstruction of the loop changes `{}`", held.join("`, `")),
        };
        let condition = design.net(condition);
        let message = format!(
            "microinstruction `{}` goes back to `{}` while `{}` is 1, {why}: the loop never ends, or is \
             never repeated",
            microinstruction.name, control.microprogram[to].name, condition.name
        );
        found.push(
            Diagnostic::new(codes::ENDLESS, message, microinstruction.location)
                .note("the condition".to_owned(), condition.location),
        );
    }
    found
}

/// Returns whether the net `id` may change while a loop executes the microinstructions `body`. Cells count as unchanged; the
/// caller looks at their operands.
fn changes(design: &Design, body: &[usize], id: NetId) -> bool {
    match design.net(id).driver {
        Driver::Input => true,
        Driver::Rom(rom) => design.rom(rom).synchronous,
        // Operands are not written while the device is busy.
        Driver::Register(id) => match design.register(id).kind {
            RegisterKind::Operand => false,
            RegisterKind::Buffer | RegisterKind::Sequencer | RegisterKind::Internal => true,
            RegisterKind::Architectural => body.iter().any(|&at| loads(design, at, id) != Some(0)),
        },
        _ => false,
    }
}

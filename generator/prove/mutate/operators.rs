//! Lists the faults that replace a whole cell by a different cell: a wrong operator, swapped operands or mux inputs, a mux stuck
//! at one input, a sum without its carry or rounding bit, or a slice one bit too low or too high.

use super::kind::FaultKind;
use glint_rtl::netlist::{Design, Driver, NetId, Op};

/// Returns the faulty cells that can replace `op`, the driver of net `id`. For example, `a & b` gives the fault `or`, which is `a
/// | b`. A product gives no fault.
pub(super) fn of(design: &Design, id: NetId, op: &Op) -> Vec<(String, FaultKind, Op)> {
    let width = design.width(id);
    match op {
        Op::Mux { select, inputs } => mux(design, *select, inputs),
        Op::Add { a, b, carry } => add(design, *a, *b, *carry),
        Op::Sub(a, b) => {
            vec![swapped(Op::Sub(*b, *a)), operator("add", Op::Add { a: *a, b: *b, carry: None })]
        }
        Op::Less(a, b) => vec![swapped(Op::Less(*b, *a)), operator("equal", Op::Equal(*a, *b))],
        Op::Equal(a, b) => {
            let alike = design.net(*a).format.signed == design.net(*b).format.signed;
            alike.then(|| operator("less", Op::Less(*a, *b))).into_iter().collect()
        }
        Op::And(a, b) => vec![operator("or", Op::Or(*a, *b))],
        Op::Or(a, b) => vec![operator("and", Op::And(*a, *b))],
        Op::Xor(a, b) => vec![operator("or", Op::Or(*a, *b))],
        Op::Not(a) => vec![operator("not-inverted", Op::Relabel(*a))],
        Op::Any(a) if design.width(*a) > 1 => vec![operator("all", Op::All(*a))],
        Op::All(a) if design.width(*a) > 1 => vec![operator("any", Op::Any(*a))],
        Op::Slice { of, low } => slice(*of, *low, width, design.width(*of)),
        _ => Vec::new(),
    }
}

fn operator(name: &str, op: Op) -> (String, FaultKind, Op) {
    (name.to_owned(), FaultKind::Operator, op)
}

fn swapped(op: Op) -> (String, FaultKind, Op) {
    ("operands-swapped".to_owned(), FaultKind::Operands, op)
}

/// Swaps two inputs that are different nets, or always passes on the same input. For example, a mux of two different inputs
/// has the faults `inputs-0-1-swapped`, `input-0-always` and `input-1-always`.
fn mux(design: &Design, select: NetId, inputs: &[NetId]) -> Vec<(String, FaultKind, Op)> {
    let mut faults = Vec::new();
    for b in 0..inputs.len() {
        for a in (0..b).filter(|&a| inputs[a] != inputs[b]) {
            let mut inputs = inputs.to_vec();
            inputs.swap(a, b);
            let name = format!("inputs-{a}-{b}-swapped");
            faults.push((name, FaultKind::MuxInputs, Op::Mux { select, inputs }));
        }
    }
    let constant = |net: NetId| matches!(design.net(net).driver, Driver::Constant(_));
    for (at, &input) in inputs.iter().enumerate() {
        if inputs[..at].contains(&input) {
            continue;
        }
        let limits = inputs.iter().filter(|&&other| other != input);
        let kind = if inputs.len() == 2 && !constant(input) && limits.copied().all(constant) {
            FaultKind::Saturation
        } else {
            FaultKind::MuxChoice
        };
        faults.push((format!("input-{at}-always"), kind, Op::Relabel(input)));
    }
    faults
}

/// Replaces the sum by a difference, or leaves out its carry or rounding bit.
fn add(design: &Design, a: NetId, b: NetId, carry: Option<NetId>) -> Vec<(String, FaultKind, Op)> {
    let mut faults = vec![operator("sub", Op::Sub(a, b))];
    if carry.is_some() {
        let op = Op::Add { a, b, carry: None };
        faults.push(("no-carry".to_owned(), FaultKind::Rounding, op));
    }
    for (bit, rest) in [(a, b), (b, a)] {
        // An operand that is 0 or 1 rounds the other operand to the nearest.
        if design.net(bit).range == (0, 1) && carry.is_none() {
            faults.push(("truncated".to_owned(), FaultKind::Rounding, Op::Relabel(rest)));
        }
    }
    faults
}

/// Returns slices that take their bits one position lower or higher, if the net of `have` bits has such bits.
fn slice(of: NetId, low: u32, width: u32, have: u32) -> Vec<(String, FaultKind, Op)> {
    let mut faults = Vec::new();
    let mut shifted = |name: &str, low| {
        faults.push((name.to_owned(), FaultKind::Wiring, Op::Slice { of, low }));
    };
    if low > 0 {
        shifted("one-bit-lower", low - 1);
    }
    if low + width < have {
        shifted("one-bit-higher", low + 1);
    }
    faults
}

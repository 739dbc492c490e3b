//! Computes the interval of values of each net, from the cell that drives the net and the intervals of the cell's operands. The
//! proofs about faults try only values within these intervals.
//!
//! The device's description also states intervals, but a stated interval may be too narrow for a proof. For example, the stated
//! interval of a shared multiplier's operand may hold for only some of the products. The module trusts a stated interval only for
//! a register that is not of the kind `Internal`, such as an operand register. The interval must also contain 0, because every
//! register is 0 at power-up.

use super::pairs::{self, Pairs};
use glint_base::interval::{Interval, fits, hull, of_values};
use glint_rtl::netlist::interval::of_cell;
use glint_rtl::netlist::{Design, Driver, NetId, NetlistRegister, Op, RegisterKind};

/// Returns whether the stated interval of a register holds in every clock from power-up on.
pub(super) fn trusted(design: &Design, register: &NetlistRegister) -> bool {
    let (low, high) = design.net(register.q).range;
    register.kind != RegisterKind::Internal && low <= 0 && high >= 0
}

/// Returns the interval of raw values of each net, for any inputs. An operand that comes after a net in `order` may have any
/// value of its format.
pub(super) fn of_all(design: &Design, order: &[NetId]) -> Vec<Interval> {
    let mut intervals: Vec<Option<Interval>> = vec![None; design.nets.len()];
    for &id in order {
        let known =
            |net: NetId| intervals[net.index()].unwrap_or_else(|| design.net(net).format.range());
        intervals[id.index()] = Some(of(design, id, &known, &|net| Pairs::same(design.width(net))));
    }
    intervals.into_iter().map(|it| it.unwrap_or((0, 0))).collect()
}

/// Computes the interval of net `id` from the intervals (`of`) and the possible bits (`known`) of its operands.
pub(super) fn of(
    design: &Design,
    id: NetId,
    of: &impl Fn(NetId) -> Interval,
    known: &impl Fn(NetId) -> Pairs,
) -> Interval {
    let net = design.net(id);
    let all = net.format.range();
    let within = |interval| if fits(interval, net.format) { interval } else { all };
    let cell = |op: &Op| of_cell(op, net.format, &|net| design.net(net).format, of);
    match &net.driver {
        Driver::Constant(bits) => (net.format.raw(*bits), net.format.raw(*bits)),
        Driver::Register(register) if trusted(design, design.register(*register)) => net.range,
        // The register's data is evaluated before the register; at power-up and after a reset, the register holds 0.
        Driver::Register(register) if design.pipeline.is_some() => {
            let data = design.register(*register).data;
            data.and_then(|data| hull([of(data), (0, 0)])).map_or(all, within)
        }
        Driver::Rom(rom) => {
            let raws = design.rom(*rom).words.iter().map(|&word| net.format.raw(word));
            of_values(raws.chain([0])).unwrap_or(all)
        }
        Driver::Op(Op::Mux { select, inputs }) => {
            let is_of_two = inputs.len() == 2 && inputs[0] != inputs[1];
            let sign = if is_of_two { sign(design, *select) } else { None };
            let mut taken = Vec::new();
            for input in pairs::choices(known(*select), design.width(*select), inputs) {
                let (low, high) = of(input);
                taken.push(match sign {
                    // If the sign of a net chooses between two inputs, the net itself has only one sign when it is chosen.
                    Some((signed_net, negative))
                        if design.net(input).format.signed
                            && pairs::named(design, input) == signed_net =>
                    {
                        if negative == (input == inputs[1]) {
                            (low.min(-1), high.min(-1))
                        } else {
                            (low.max(0), high.max(0))
                        }
                    }
                    _ => (low, high),
                });
            }
            hull(taken).map_or(all, within)
        }
        // Both operands may be one net under two names.
        Driver::Op(Op::Mul(a, b)) if pairs::square(design, *a, *b) => cell(&Op::Mul(*a, *a)),
        Driver::Op(op) => cell(op),
        _ => all,
    }
}

/// Returns the net with the sign `bit`, and whether the bit is 1 for a negative value. Returns `None` if `bit` is no sign.
fn sign(design: &Design, bit: NetId) -> Option<(NetId, bool)> {
    match &design.net(pairs::named(design, bit)).driver {
        Driver::Op(Op::Not(a)) => {
            let (signed_net, negative) = sign(design, *a)?;
            Some((signed_net, !negative))
        }
        Driver::Op(Op::Slice { of, low })
            if design.net(*of).format.signed && low + 1 == design.width(*of) =>
        {
            Some((pairs::named(design, *of), true))
        }
        _ => None,
    }
}

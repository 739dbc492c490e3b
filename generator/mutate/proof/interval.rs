//! The interval of values of each net, from what it is made of.
//!
//! The intervals that the description states are not used but for registers: that of a view of a shared
//! multiplier holds under some selections only.

use super::known::{self, Known};
use crate::hdl::netlist::{Design, Driver, NetId, Op, Register, RegisterKind};

/// The smallest and the largest raw value.
pub(super) type Interval = (i128, i128);

/// Whether the stated interval of a register holds in every clock from power-up on.
pub(super) fn trusted(design: &Design, register: &Register) -> bool {
    let (low, high) = design.net(register.q).range;
    register.kind != RegisterKind::Internal && low <= 0 && high >= 0
}

/// Of one net, when `of` has those of its operands, and `known` what is known of them.
pub(super) fn of(
    design: &Design,
    id: NetId,
    of: &impl Fn(NetId) -> Interval,
    known: &impl Fn(NetId) -> Known,
) -> Interval {
    let net = design.net(id);
    let all = net.format.range();
    let fits = |interval: Interval| match interval {
        (low, high) if net.format.holds(low) && net.format.holds(high) => interval,
        _ => all,
    };
    let hull = |a: Interval, b: Interval| (a.0.min(b.0), a.1.max(b.1));
    match &net.driver {
        Driver::Constant(bits) => (net.format.raw(*bits), net.format.raw(*bits)),
        Driver::Register(register) if trusted(design, design.register(*register)) => net.range,
        // The stage before comes before it in the order of evaluation; at power-up and after a reset it holds 0.
        Driver::Register(register) if design.pipeline.is_some() => {
            design.register(*register).data.map_or(all, |data| fits(hull(of(data), (0, 0))))
        }
        Driver::Rom(rom) => {
            let raw = design.rom(*rom).words.iter().map(|&word| net.format.raw(word));
            let raw = raw.map(|raw| (raw, raw));
            raw.fold((0, 0), hull)
        }
        Driver::Op(op) => match op {
            Op::Relabel(a) | Op::Extend(a) => fits(of(*a)),
            Op::Slice { of: a, low } => match of(*a) {
                (least, most) if least >= 0 => fits((least >> low, most >> low)),
                _ => all,
            },
            Op::Concat(parts) => {
                let joined = parts.iter().try_fold((0, 0), |sum: Interval, part| {
                    let (low, high) = of(*part);
                    let width = design.width(*part);
                    (low >= 0).then_some(((sum.0 << width) + low, (sum.1 << width) + high))
                });
                joined.map_or(all, fits)
            }
            Op::Add { a, b, carry } => {
                let (a, b, carry) = (of(*a), of(*b), carry.map_or((0, 0), of));
                fits((a.0 + b.0 + carry.0, a.1 + b.1 + carry.1))
            }
            Op::Sub(a, b) => {
                let (a, b) = (of(*a), of(*b));
                fits((a.0 - b.1, a.1 - b.0))
            }
            Op::Mul(a, b) => {
                let is_square = known::square(design, *a, *b);
                let (a, b) = (of(*a), of(*b));
                let corners = [(a.0, b.0), (a.0, b.1), (a.1, b.0), (a.1, b.1)];
                let products = corners.map(|(a, b)| a.checked_mul(b));
                let products = products.into_iter().collect::<Option<Vec<_>>>();
                let products = products.map(|products| {
                    let products = products.into_iter().map(|product| (product, product));
                    products.reduce(hull).unwrap_or(all)
                });
                let products = products
                    .map(|(low, high)| if is_square { (low.max(0), high) } else { (low, high) });
                products.map_or(all, fits)
            }
            Op::Mux { select, inputs } => {
                known::choices(known(*select), design.width(*select), inputs)
                    .map(of)
                    .reduce(hull)
                    .map_or(all, fits)
            }
            _ => all,
        },
        _ => all,
    }
}

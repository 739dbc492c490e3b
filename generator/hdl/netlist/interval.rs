//! Computes the interval of raw values that a cell can produce, from the intervals of its operands. For example, the sum of two
//! nets from 0 to 3 lies between 0 and 6, if its format can represent 6.

use super::Op;
use glint_base::fixed::{Format, mask};
use glint_base::interval::{Interval, hull, product, wrap};

/// Returns the interval of raw values that a cell with the result `format` can produce, at worst the whole range of the format.
/// For example, a product of a net with itself is a square, which is never negative.
pub fn of_cell<N: Copy + PartialEq>(
    op: &Op<N>,
    format: Format,
    format_of: &impl Fn(N) -> Format,
    of: &impl Fn(N) -> Interval,
) -> Interval {
    let all = format.range();
    let wrapped = |interval: Interval| match wrap(interval, format) {
        Some(wrap) => (interval.0 + wrap, interval.1 + wrap),
        None => all,
    };
    let bit = |never: bool, always: bool| (i128::from(always), i128::from(!never));
    match op {
        Op::Relabel(a) | Op::Extend(a) => wrapped(of(*a)),
        Op::Slice { of: a, low } => wrapped((of(*a).0 >> low, of(*a).1 >> low)),
        Op::Concat(parts) => wrapped(parts.iter().fold((0, 0), |(low, high), part| {
            let width = format_of(*part).width();
            // A negative value of a signed part contributes its bit pattern, so that all patterns count. If the part is the top
            // of a signed number, its sign is the sign of the number, and the order of values remains.
            let is_sign = format.signed && Some(part) == parts.first();
            let own = if of(*part).0 < 0 && !is_sign { (0, mask(width).into()) } else { of(*part) };
            ((low << width) + own.0, (high << width) + own.1)
        })),
        Op::Not(a) => {
            let ones = if format.signed { -1 } else { format.max_raw() };
            (ones - of(*a).1, ones - of(*a).0)
        }
        Op::Add { a, b, carry } => {
            let (a, b, carry) = (of(*a), of(*b), carry.map_or((0, 0), of));
            wrapped((a.0 + b.0 + carry.0, a.1 + b.1 + carry.1))
        }
        Op::Sub(a, b) => wrapped((of(*a).0 - of(*b).1, of(*a).1 - of(*b).0)),
        Op::Mul(a, b) => match product(of(*a), of(*b)) {
            (low, high) if !format.holds(low) || !format.holds(high) => all,
            (low, high) if a == b => (low.max(0), high),
            products => products,
        },
        Op::Equal(a, b) => {
            let (a, b) = (of(*a), of(*b));
            bit(a.1 < b.0 || b.1 < a.0, a.0 == a.1 && a == b)
        }
        Op::Less(a, b) => bit(of(*a).0 >= of(*b).1, of(*a).1 < of(*b).0),
        Op::Any(a) => bit(of(*a) == (0, 0), of(*a).0 > 0 || of(*a).1 < 0),
        // The result of a bitwise and of two numbers is not greater than the smaller one.
        Op::And(a, b) if of(*a).0 >= 0 && of(*b).0 >= 0 => match format.width() {
            1 => (of(*a).0.min(of(*b).0), of(*a).1.min(of(*b).1)),
            _ => (0, of(*a).1.min(of(*b).1)),
        },
        Op::Or(a, b) if format == Format::BIT => (of(*a).0.max(of(*b).0), of(*a).1.max(of(*b).1)),
        Op::Mux { select, inputs } => {
            let (low, high) = of(*select);
            let last = inputs.len() as i128 - 1;
            let reached = low.clamp(0, last) as usize..=high.clamp(0, last) as usize;
            hull(inputs[reached].iter().map(|&input| of(input))).map_or(all, wrapped)
        }
        Op::And(..) | Op::Or(..) | Op::Xor(..) | Op::All(_) => all,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::netlist::{NetId, eval};

    /// Tries operands of three bits: every pair of intervals, and every pair of values in them.
    #[test]
    fn what_a_cell_gives_is_in_its_interval() {
        let [a, b] = [NetId(0), NetId(1)];
        let three = |signed| Format { signed, int: 3 - i32::from(signed), frac: 0 };
        let within = |op: &Op, format: Format, [x, y]: [Interval; 2], signed: bool| {
            let of = |net: NetId| if net == a { x } else { y };
            let (low, high) = of_cell(op, format, &|_| three(signed), &of);
            for (x, y) in (x.0..=x.1).flat_map(|x| (y.0..=y.1).map(move |y| (x, y))) {
                let bits = [x, y].map(|raw| [three(signed).bits(raw)]);
                let of = |net: NetId| &bits[net.index()];
                let [out] = eval::cell(op, format.width(), &|_| three(signed), &of);
                let raw = format.raw(out);
                assert!((low..=high).contains(&raw), "{op:?} {format} of {x}, {y}: {raw}");
            }
        };
        for signed in [false, true] {
            let (least, most) = three(signed).range();
            let intervals =
                (least..=most).flat_map(|low| (low..=most).map(move |high| (low, high)));
            let pairs = intervals.clone().flat_map(|x| intervals.clone().map(move |y| [x, y]));
            for pair in pairs {
                let wide = |width: i32| Format { signed, int: width - i32::from(signed), frac: 0 };
                for op in [Op::Relabel(a), Op::Not(a), Op::And(a, b), Op::Or(a, b), Op::Xor(a, b)] {
                    within(&op, three(signed), pair, signed);
                }
                for op in [Op::Add { a, b, carry: None }, Op::Sub(a, b)] {
                    within(&op, three(signed), pair, signed);
                }
                within(&Op::Extend(a), wide(5), pair, signed);
                within(&Op::Mul(a, b), wide(6), pair, signed);
                within(&Op::Concat(vec![a, b]), wide(6), pair, signed);
                within(&Op::Slice { of: a, low: 1 }, wide(2), pair, signed);
                for op in [Op::Equal(a, b), Op::Less(a, b), Op::Any(a), Op::All(a)] {
                    within(&op, Format::BIT, pair, signed);
                }
            }
        }
    }
}

//! Splits products that are too wide for the multipliers of an FPGA target into sums of narrower products.
//!
//! A factor that is too wide is divided into as many upper bits as a multiplier takes, and the remaining lower bits. A few
//! lower bits are multiplied row by row in look-up tables; more lower bits become a product of their own. In a square, the two
//! partial products with the lower bits l become one product: `(u·2^r + l)² = u²·4^r + l·(u·2^(r+1) + l)`. If a factor is at
//! most a power of two, its highest bit is 1 only if all other bits are 0. The product is then either the other factor,
//! shifted, or a product without this bit.

use super::graph::{Graph, Label, NodeId, NodeOp};
use super::rebuild::rebuilt;
use super::sums::shortened;
use super::unroll::Unrolled;
use glint_base::fixed::Format;
use glint_base::target::Timing;

/// The most lower bits whose product is made of rows in look-up tables.
const MOST_ROWS: u32 = 4;

/// Splits products that are too wide for the target's multipliers, and shortens the carry chains of sums and differences
/// (`sums::shortened`).
pub fn split(unrolled: &Unrolled, target: &Timing) -> Unrolled {
    rebuilt(unrolled, |graph, op, node| {
        Some(match op {
            NodeOp::Mul(a, b) => product(graph, target, *a, *b, node.format, &node.label),
            op => shortened(graph, op.clone(), node.format, node.range, &node.label),
        })
    })
}

/// Returns the exact product of `a` and `b`, made of products that fit the target's multipliers. Both factors or neither are
/// signed.
fn product(
    graph: &mut Graph,
    target: &Timing,
    a: NodeId,
    b: NodeId,
    format: Format,
    label: &Label,
) -> NodeId {
    let parts = parts(graph, target, [a, b], format, label);
    match parts[..] {
        [ShiftedValue { value, places: 0 }] => value,
        _ => summed(graph, parts, format, label),
    }
}

/// Returns terms whose sum is the product of `a` and `b`: only one if the multipliers take the factors or a special case applies.
fn parts(
    graph: &mut Graph,
    target: &Timing,
    [a, b]: [NodeId; 2],
    format: Format,
    label: &Label,
) -> Vec<ShiftedValue> {
    let (wide, narrow) = if graph.width(a) >= graph.width(b) { (a, b) } else { (b, a) };
    // The target states the sizes for unsigned operands. Most multipliers take a sign bit in addition.
    let (most, other) = target.multiplier;
    let limit = if graph.width(narrow) <= other { most } else { other };
    let value = if graph.width(wide) <= limit {
        graph.op(NodeOp::Mul(a, b), format, label)
    } else if !format.signed && reaches_a_power_of_two(graph, wide) {
        below_the_highest(graph, target, [wide, narrow], format, label)
    } else if let Some([positive, other]) = with_a_sign(graph, [a, b]) {
        below_the_sign(graph, target, positive, other, format, label)
    } else {
        return cut(graph, target, [wide, narrow], limit, format.signed, label);
    };
    vec![ShiftedValue { value, places: 0 }]
}

/// Returns whether the largest value of an unsigned factor is a power of two, and alone has the highest bit: 16 for 5 bits.
fn reaches_a_power_of_two(graph: &Graph, factor: NodeId) -> bool {
    let (low, high) = graph.node(factor).range;
    low >= 0 && high == 1 << (graph.width(factor) - 1)
}

/// Multiplies by a factor `wide` whose highest bit is 1 only if all its other bits are 0. Then the product is `narrow`, shifted.
/// Otherwise it is the product of `narrow` and the other bits of `wide`.
fn below_the_highest(
    graph: &mut Graph,
    target: &Timing,
    [wide, narrow]: [NodeId; 2],
    format: Format,
    label: &Label,
) -> NodeId {
    let (places, width) = (graph.width(wide) - 1, graph.width(narrow));
    let highest = slice(graph, wide, places, Format::BIT, &label.part("highest"));
    let below = slice(graph, wide, 0, unsigned(places), &label.part("below"));
    let inside = label.part("inside");
    let whole = if wide == narrow {
        let square = product(graph, target, below, below, unsigned(2 * places), &inside);
        NodeOp::Concat(vec![highest, square])
    } else {
        let product = product(graph, target, below, narrow, unsigned(places + width), &inside);
        let zero = graph.constant(0, unsigned(width), &unnamed(label));
        let other = NodeOp::Mux { select: highest, inputs: vec![zero, narrow] };
        let other = graph.op(other, unsigned(width), &label.part("at_highest"));
        let upper = slice(graph, product, places, unsigned(width), label);
        // One of the two operands is always 0.
        let upper = graph.op(NodeOp::Or(upper, other), unsigned(width), &unnamed(label));
        NodeOp::Concat(vec![upper, slice(graph, product, 0, unsigned(places), label)])
    };
    let bits = if wide == narrow { 2 * places + 1 } else { places + width };
    let whole = graph.op(whole, unsigned(bits), &unnamed(label));
    graph.op(NodeOp::Extend(whole), format, label)
}

/// Orders `a` and `b` so that the first factor is signed and never negative, and the second has bits besides its sign, if
/// possible.
fn with_a_sign(graph: &Graph, [a, b]: [NodeId; 2]) -> Option<[NodeId; 2]> {
    let positive = |id: NodeId| graph.node(id).format.signed && graph.node(id).range.0 >= 0;
    let factors = if positive(a) { [a, b] } else { [b, a] };
    (positive(factors[0]) && graph.width(factors[1]) > 1).then_some(factors)
}

/// Multiplies two signed factors; only `other` may be negative. The bits of `other` without the sign are multiplied first. If
/// the sign is set, `positive` is then subtracted at the weight of the sign. This takes narrower multipliers than a signed
/// product.
fn below_the_sign(
    graph: &mut Graph,
    target: &Timing,
    positive: NodeId,
    other: NodeId,
    format: Format,
    label: &Label,
) -> NodeId {
    let (width, places) = (graph.width(positive) - 1, graph.width(other) - 1);
    let positive = graph.resize(positive, width, false);
    let sign = slice(graph, other, places, Format::BIT, &label.part("sign"));
    let below = slice(graph, other, 0, unsigned(places), &label.part("below"));
    let inside = label.part("inside");
    let product = product(graph, target, positive, below, unsigned(width + places), &inside);
    let zero = graph.constant(0, unsigned(width), &unnamed(label));
    let less = NodeOp::Mux { select: sign, inputs: vec![zero, positive] };
    let less = graph.op(less, unsigned(width), &label.part("at_sign"));
    let upper = slice(graph, product, places, unsigned(width), label);
    let [upper, less] = [upper, less].map(|it| graph.resize(it, width + 1, true));
    let upper = graph.op(NodeOp::Sub(upper, less), integer(true, width + 1), &label.part("upper"));
    let lower = slice(graph, product, 0, unsigned(places), label);
    let whole = NodeOp::Concat(vec![upper, lower]);
    let whole = graph.op(whole, integer(true, width + 1 + places), &unnamed(label));
    graph.op(NodeOp::Extend(whole), format, label)
}

/// A number `value · 2^places`.
#[derive(Clone, Copy)]
struct ShiftedValue {
    value: NodeId,
    places: u32,
}

fn summed(
    graph: &mut Graph,
    mut parts: Vec<ShiftedValue>,
    format: Format,
    label: &Label,
) -> NodeId {
    parts.sort_by_key(|term| std::cmp::Reverse(width_with_places(graph, term)));
    // The widest term comes last, so that only the last addition is as wide.
    parts.rotate_left(1);
    let mut terms = parts.into_iter();
    let mut sum = terms.next().expect("a product has parts");
    for term in terms {
        let widest = width_with_places(graph, &sum).max(width_with_places(graph, &term));
        let width = (widest + 1).min(format.width());
        let signed = [sum, term].iter().any(|it| graph.node(it.value).format.signed);
        let [a, b] = [sum, term].map(|it| in_ones(graph, it, width, signed, label));
        let (op, format) = (NodeOp::Add { a, b, carry: None }, integer(signed, width));
        let value = shortened(graph, op, format, format.range(), &label.part("sum"));
        sum = ShiftedValue { value, places: 0 };
    }
    let value = in_ones(graph, sum, format.width(), format.signed, label);
    graph.op(NodeOp::Relabel(value), format, label)
}

/// Returns the number of bits of a term with its places.
fn width_with_places(graph: &Graph, term: &ShiftedValue) -> u32 {
    term.places + graph.width(term.value)
}

/// Returns a term as a node of `width` bits, signed if `signed`.
fn in_ones(
    graph: &mut Graph,
    term: ShiftedValue,
    width: u32,
    signed: bool,
    label: &Label,
) -> NodeId {
    let shifted = shifted(graph, term, label);
    graph.resize(shifted, width, signed)
}

/// Appends a zero for each place.
fn shifted(
    graph: &mut Graph,
    ShiftedValue { value, places }: ShiftedValue,
    label: &Label,
) -> NodeId {
    if places == 0 {
        return value;
    }
    let format = graph.node(value).format;
    let zeros = graph.constant(0, unsigned(places), &unnamed(label));
    let format = integer(format.signed, format.width() + places);
    graph.op(NodeOp::Concat(vec![value, zeros]), format, &unnamed(label))
}

/// Divides the wider factor into its `limit` upper bits and the remaining lower bits. For example, a limit of 18 bits divides a
/// factor of 21 bits into 18 upper bits and 3 lower bits. On ECP5 the lower bits become rows if the other factor has at most 22
/// bits.
fn cut(
    graph: &mut Graph,
    target: &Timing,
    [wide, narrow]: [NodeId; 2],
    limit: u32,
    signed: bool,
    label: &Label,
) -> Vec<ShiftedValue> {
    let rest = graph.width(wide) - limit;
    let upper_bits = slice(graph, wide, rest, integer(signed, limit), &label.part("upper_bits"));
    // The factors of the upper and of the lower bits, and the weight of the upper product.
    let (upper_factor, rest_factor, places) = if wide == narrow {
        let lower = slice(graph, wide, 0, unsigned(rest), &label.part("lower_bits"));
        let zero = graph.constant(0, Format::BIT, &unnamed(label));
        let both = NodeOp::Concat(vec![upper_bits, zero, lower]);
        let both = graph.op(both, integer(signed, limit + 1 + rest), &unnamed(label));
        (upper_bits, both, 2 * rest)
    } else {
        (narrow, narrow, rest)
    };
    let upper_format = integer(signed, limit + graph.width(upper_factor));
    let upper_label = label.part("upper");
    let mut terms = parts(graph, target, [upper_bits, upper_factor], upper_format, &upper_label);
    for term in &mut terms {
        term.places += places;
    }
    // The lower bits have no sign; their product has the sign of the other operand.
    let width = graph.width(rest_factor);
    let lower = if rest <= MOST_ROWS && rest * width <= target.row_bits {
        vec![ShiftedValue { value: rows(graph, wide, rest, rest_factor, label), places: 0 }]
    } else {
        let lower_bits = slice(graph, wide, 0, unsigned(rest), &label.part("lower_bits"));
        let bits = rest + u32::from(signed);
        let lower_bits = graph.resize(lower_bits, bits, signed);
        let format = integer(signed, bits + width);
        parts(graph, target, [lower_bits, rest_factor], format, &label.part("lower"))
    };
    terms.extend(lower);
    terms
}

/// Multiplies the lowest `rest` bits of `wide`, at least one, by `narrow`, one row a bit. The row of bit 2 is `narrow · 4` or 0.
fn rows(graph: &mut Graph, wide: NodeId, rest: u32, narrow: NodeId, label: &Label) -> NodeId {
    let signed = graph.node(narrow).format.signed;
    let width = graph.width(narrow);
    let of_row = integer(signed, width);
    let mut sum: Option<NodeId> = None;
    for row in 0..rest {
        let bit = slice(graph, wide, row, Format::BIT, &label.part("row"));
        let unnamed = unnamed(&label.part("row"));
        let zero = graph.constant(0, of_row, &unnamed);
        let mux = NodeOp::Mux { select: bit, inputs: vec![zero, narrow] };
        let taken = graph.op(mux, of_row, &unnamed);
        let shifted = shifted(graph, ShiftedValue { value: taken, places: row }, &unnamed);
        sum = Some(match sum {
            None => shifted,
            Some(sum) => {
                let total = width + row + 1;
                let [a, b] = [sum, shifted].map(|it| graph.resize(it, total, signed));
                let (op, format) = (NodeOp::Add { a, b, carry: None }, integer(signed, total));
                shortened(graph, op, format, format.range(), &label.part("rows"))
            }
        });
    }
    sum.expect("there is a row for every bit of the rest, which is not empty")
}

/// Returns the format of an integer with `width` bits, including the sign if `signed`.
pub(super) fn integer(signed: bool, width: u32) -> Format {
    Format { signed, int: width as i32 - i32::from(signed), frac: 0 }
}

fn unsigned(width: u32) -> Format {
    integer(false, width)
}

/// Labels a node whose name is generated.
fn unnamed(label: &Label) -> Label {
    Label { doc: String::new(), named: false, ..label.clone() }
}

fn slice(graph: &mut Graph, of: NodeId, low: u32, format: Format, label: &Label) -> NodeId {
    graph.op(NodeOp::Slice { of, low }, format, &unnamed(label))
}

#[cfg(test)]
mod tests {
    use crate::dsl::fixture::design;
    use crate::dsl::{Designer, InputOperand, Signal, step};
    use crate::netlist::{Design, Driver, Interpreter, Op};
    use crate::pipeline::{Delays, Goal, IntervalGoal, Options, pipeline};
    use glint_base::fixed::Format;
    use glint_base::target::{TIMINGS, Timing};

    /// Multiplies two factors in one stage, for a target whose multipliers take 4 bits by 4.
    fn product(factors: impl for<'d> Fn(&'d Designer) -> [Signal<'d>; 2]) -> Design {
        let design = design(|d| {
            let [a, b] = factors(d);
            let product = d.mul("product", a, b);
            let held = d.register("held", product.format());
            held.takes(product);
            d.output("product_out", held.q());
            vec![step("product", [held.load()])]
        });
        let target: &Timing =
            Box::leak(Box::new(Timing { multiplier: (4, 4), ..TIMINGS[0].clone() }));
        let options = Options {
            interval: IntervalGoal::Clocks(1),
            target,
            goal: Goal::Stages(1),
            registered: false,
            stall: true,
            side: 0,
            delays: Delays::Registers,
        };
        pipeline(&design, &options).expect("a pipeline")
    }

    fn result(design: &Design, operands: &[u64]) -> u64 {
        let mut device = Interpreter::new(design).expect("no loop");
        let mut operands = operands.iter();
        let inputs: Vec<u64> = design
            .inputs()
            .map(|port| match design.net(port.net).name.as_str() {
                "rst_n" | "in_valid" | "out_ready" => 1,
                _ => *operands.next().expect("an operand"),
            })
            .collect();
        device.settle(&inputs);
        device.edge();
        device.settle(&inputs);
        device.value(design.find("product_out").expect("a result"))
    }

    /// Returns the number of multipliers, and checks that no factor has more than 4 bits.
    fn multipliers(design: &Design) -> usize {
        let products = design.iter().filter_map(|(_, net)| match net.driver {
            Driver::Op(Op::Mul(a, b)) => Some([a, b]),
            _ => None,
        });
        products.inspect(|it| assert!(it.iter().all(|&it| design.width(it) <= 4))).count()
    }

    fn limited<'d>(d: &'d Designer, name: &str, bits: i32, most: f64) -> InputOperand<'d> {
        d.operand_clamped(name, Format::unsigned(bits, 0), 0.0, most)
    }

    #[test]
    fn a_square_is_that_of_all_bits() {
        for bits in 5..=8 {
            let made = product(|d| [d.operand("x", Format::unsigned(bits, 0)).q(); 2]);
            for x in 0..1 << bits {
                assert_eq!(result(&made, &[x]), x * x, "{bits} bits");
            }
        }
        for bits in 5..=8 {
            let made = product(|d| [d.operand("x", Format::signed(bits - 1, 0)).q(); 2]);
            for x in 0..1_u64 << bits {
                let value = Format::signed(bits - 1, 0).raw(x);
                assert_eq!(i128::from(result(&made, &[x])), value * value, "{bits} bits");
            }
        }
    }

    #[test]
    fn a_factor_may_reach_a_power_of_two() {
        let square = product(|d| [limited(d, "x", 6, 32.0).q(); 2]);
        for x in 0..64 {
            assert_eq!(result(&square, &[x]), x.min(32) * x.min(32));
        }
        for (bits, most, multipliers_of) in [(5, 16, 1), (6, 32, 1), (7, 64, 1)] {
            let made = product(|d| {
                [
                    limited(d, "a", bits, f64::from(most)).q(),
                    limited(d, "b", bits, f64::from(most)).q(),
                ]
            });
            assert_eq!(multipliers(&made), multipliers_of, "{bits} bits");
            for (a, b) in (0..1 << bits).flat_map(|a| (0..1 << bits).map(move |b| (a, b))) {
                let [x, y] = [a, b].map(|it: u64| it.min(u64::from(most as u32)));
                assert_eq!(result(&made, &[a, b]), x * y, "{a} by {b}");
            }
        }
    }

    #[test]
    fn a_signed_factor_meets_one_that_is_never_negative() {
        for (unsigned, signed) in [(4, 5), (4, 6), (6, 5), (7, 7), (7, 1)] {
            let made = product(|d| {
                let a = d.operand("a", Format::unsigned(unsigned, 0)).q();
                [a, d.operand("b", Format::signed(signed - 1, 0)).q()]
            });
            if (unsigned, signed) == (4, 5) {
                assert_eq!(multipliers(&made), 1);
            }
            let out = design_format(&made);
            for (a, b) in
                (0..1_u64 << unsigned).flat_map(|a| (0..1_u64 << signed).map(move |b| (a, b)))
            {
                let expected = i128::from(a) * Format::signed(signed - 1, 0).raw(b);
                assert_eq!(out.raw(result(&made, &[a, b])), expected, "{a} by {b}");
            }
        }
    }

    #[test]
    fn the_widest_part_of_a_product_is_added_once() {
        let made = product(|d| ["a", "b"].map(|name| d.operand(name, Format::unsigned(8, 0)).q()));
        assert_eq!(multipliers(&made), 1);
        for (a, b) in (0..256).flat_map(|a| (0..256).map(move |b| (a, b))) {
            assert_eq!(result(&made, &[a, b]), a * b, "{a} by {b}");
        }
        let sums = made.iter().filter_map(|(id, net)| match net.driver {
            Driver::Op(Op::Add { .. }) => Some(made.width(id)),
            _ => None,
        });
        let mut sums: Vec<u32> = sums.collect();
        sums.sort_unstable();
        // Rows of 4 bits take three sums, and so do rows of 8 bits. The lower parts are added from the fifth place to
        // the carry, in 9 bits, and the upper parts in 8 bits.
        assert_eq!(sums, [5, 5, 5, 8, 9, 9, 9, 9]);
    }

    fn design_format(design: &Design) -> Format {
        design.net(design.find("product_out").expect("a result")).format
    }
}

//! Products no wider than the multipliers of the target.
//!
//! An operand that is too wide is cut in two: its upper bits, as many as a multiplier takes, and the rest.
//! A rest of a few bits becomes rows of the product in look-up tables, as on paper: a synthesiser would
//! spend a whole multiplier on it. A longer rest, or one of long rows, is a product of its own.

use super::graph::{Graph, Label};
use super::rebuild::rebuilt;
use super::sums::shortened;
use super::target::Target;
use super::unroll::Unrolled;
use crate::base::fixed::Format;
use crate::hdl::netlist::{NetId, Op};

/// The most bits of an operand that become rows in look-up tables.
const MOST_ROWS: u32 = 4;

/// The same computation with products that the target's multipliers take.
pub fn split(unrolled: &Unrolled, target: &Target) -> Unrolled {
    rebuilt(unrolled, |graph, op, node| {
        Some(match op {
            Op::Mul(a, b) => product(graph, target, *a, *b, node.format, &node.label),
            op => shortened(graph, op.clone(), node.format, node.range, &node.label),
        })
    })
}

/// `a·b`, of one sign, exact.
fn product(
    graph: &mut Graph,
    target: &Target,
    a: NetId,
    b: NetId,
    format: Format,
    label: &Label,
) -> NetId {
    let signed = format.signed;
    let (wide, narrow) = if graph.width(a) >= graph.width(b) { (a, b) } else { (b, a) };
    // The sizes of the target are of unsigned operands; most multipliers take a sign bit with them.
    let (most, other) = target.multiplier;
    let limit = if graph.width(narrow) <= other { most } else { other };
    if graph.width(wide) <= limit {
        return graph.op(Op::Mul(a, b), format, label);
    }
    let part = |name: &str| Label {
        name: format!("{}_{name}", label.name),
        doc: String::new(),
        named: true,
        ..label.clone()
    };
    let integer = |signed: bool, width: u32| Format {
        signed,
        int: width as i32 - i32::from(signed),
        frac: 0,
    };
    let rest = graph.width(wide) - limit;
    let upper_bits = graph.op(
        Op::Slice { of: wide, low: rest },
        integer(signed, limit),
        &Label { named: false, ..part("upper_bits") },
    );
    let upper_format = integer(signed, limit + graph.width(narrow));
    let upper = product(graph, target, upper_bits, narrow, upper_format, &part("upper"));
    // The lower bits have no sign; the product with them has that of the other operand.
    let lower = if rest <= MOST_ROWS && rest * graph.width(narrow) <= target.row_bits {
        rows(graph, wide, rest, narrow, &part)
    } else {
        let lower_bits = graph.op(
            Op::Slice { of: wide, low: 0 },
            integer(false, rest),
            &Label { named: false, ..part("lower_bits") },
        );
        let sign = u32::from(signed);
        let lower_bits = graph.resize(lower_bits, rest + sign, signed);
        let format = integer(signed, rest + sign + graph.width(narrow));
        product(graph, target, lower_bits, narrow, format, &part("lower"))
    };
    // upper·2^rest + lower: the lowest bits are those of the lower part.
    let total = format.width() - rest;
    let (low_width, low_signed) = (graph.width(lower), graph.node(lower).format.signed);
    let low_bits = graph.op(
        Op::Slice { of: lower, low: 0 },
        integer(false, rest),
        &Label { named: false, ..part("low_bits") },
    );
    let upper = graph.resize(upper, total, signed);
    let sum = if low_width > rest {
        let carried = graph.op(
            Op::Slice { of: lower, low: rest },
            integer(low_signed, low_width - rest),
            &Label { named: false, ..part("carried") },
        );
        let carried = graph.resize(carried, total, signed);
        graph.op(
            Op::Add { a: upper, b: carried, carry: None },
            integer(signed, total),
            &part("sum"),
        )
    } else {
        upper
    };
    graph.op(Op::Concat(vec![sum, low_bits]), format, label)
}

/// The product of the lowest `rest` bits of `wide` with `narrow`, a row for each.
fn rows(
    graph: &mut Graph,
    wide: NetId,
    rest: u32,
    narrow: NetId,
    part: &impl Fn(&str) -> Label,
) -> NetId {
    let signed = graph.node(narrow).format.signed;
    let width = graph.width(narrow);
    let format = |width: u32| Format { signed, int: width as i32 - i32::from(signed), frac: 0 };
    let mut sum: Option<NetId> = None;
    for row in 0..rest {
        let unnamed = Label { named: false, ..part("row") };
        let bit = graph.op(Op::Slice { of: wide, low: row }, Format::BIT, &unnamed);
        let zero = graph.constant(0, format(width), &unnamed);
        let mux = Op::Mux { select: bit, inputs: vec![zero, narrow] };
        let taken = graph.op(mux, format(width), &unnamed);
        let shifted = if row == 0 {
            taken
        } else {
            let low = graph.constant(0, Format::unsigned(row as i32, 0), &unnamed);
            graph.op(Op::Concat(vec![taken, low]), format(width + row), &unnamed)
        };
        sum = Some(match sum {
            None => shifted,
            Some(sum) => {
                let total = width + row + 1;
                let (a, b) =
                    (graph.resize(sum, total, signed), graph.resize(shifted, total, signed));
                let (op, format) = (Op::Add { a, b, carry: None }, format(total));
                shortened(graph, op, format, format.range(), &part("rows"))
            }
        });
    }
    sum.expect("there is a row for every bit of the rest, which is not empty")
}

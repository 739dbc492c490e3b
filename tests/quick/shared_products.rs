//! Tests a multiplier that computes one product with a signed operand and one of unsigned operands. Each register gets its
//! whole product, whichever input the signed operand is on, with or without a register behind each operand mux. Another test
//! checks that the multiplier has no sign bits.

use glint::dsl::{Designer, end, hold, step, valid};
use glint::fixed::Format;
use glint::hdl::netlist::Design;

use crate::common::Sure;
use crate::common::host::Host;

const SIGNED: Format = Format::signed(3, 2);
const UNSIGNED: Format = Format::unsigned(4, 1);
const LEFT: Format = Format::unsigned(1, 5);
const RIGHT: Format = Format::unsigned(0, 7);

/// Multiplies `a · b` and then `c · e`, and takes both into registers that hold every bit.
fn device(a_first: bool, held: bool) -> Design {
    let d = Designer::new("products");
    let [a, b, c, e] = [("a", SIGNED), ("b", UNSIGNED), ("c", LEFT), ("e", RIGHT)]
        .map(|(name, format)| d.operand(name, format).q());
    let select = d.select("operands", &["signed", "unsigned"]);
    let (first, second) = if a_first { (a, b) } else { (b, a) };
    let mut left = d.bus("left", select, [first, c]);
    let mut right = d.bus("right", select, [second, e]);
    if held {
        (left, right) = (left.held(), right.held());
    }
    let product = d.shared_mul("product", &left, &right);
    let signed = product.of(first, second);
    let of_signed = d.register("of_signed", signed.format());
    of_signed.takes(signed);
    d.output("signed_out", of_signed.q());
    let unsigned = product.of(c, e);
    let of_unsigned = d.register("of_unsigned", unsigned.format());
    of_unsigned.takes(unsigned);
    d.output("unsigned_out", of_unsigned.q());
    d.microprogram([
        step("idle", []),
        step("settle a, b", [left.pick(first), right.pick(second)]),
        step("take a, b", [hold(), of_signed.load()]),
        step("settle c, e", [left.pick(c), right.pick(e)]),
        step("take c, e", [hold(), of_unsigned.load()]),
        step("end", [valid(), end()]),
    ]);
    d.finish().sure()
}

/// Runs a design, and returns the contents of its two registers.
fn run(design: &Design, operands: [i64; 4]) -> [i64; 2] {
    let mut host = Host::new(design);
    let named: Vec<(&str, i64)> = ["a", "b", "c", "e"].into_iter().zip(operands).collect();
    host.start(&named);
    (0..6).for_each(|_| host.clock());
    ["of_signed", "of_unsigned"].map(|name| host.raw(name))
}

#[test]
fn every_product_is_whole() {
    for (a_first, held) in [(false, false), (false, true), (true, false), (true, true)] {
        let design = device(a_first, held);
        for a in -32..32i64 {
            for b in [0, 1, 2, 15, 16, 30, 31] {
                let (c, e) = (63 - (a & 63), 127 - b);
                assert_eq!(
                    run(&design, [a, b, c, e]),
                    [a * b, c * e],
                    "a_first: {a_first}, held: {held}; {a} * {b}, {c} * {e}"
                );
            }
        }
    }
}

#[test]
fn the_multiplier_has_no_sign_bits() {
    let design = device(true, false);
    let product = design.find("product").unwrap();
    // 5 bits of `a` below its sign and 6 of `c`, times 7 of `e`.
    assert_eq!(design.net(product).format, Format::unsigned(6 + 7, 0));
}

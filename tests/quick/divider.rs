//! Tests the divider of the DSL in the built-in simulator: every quotient, remainder and number of clocks for operands of few
//! bits, against integer division.

use glint::dsl::{Designer, end, loop_while, step, valid};
use glint::fixed::Format;
use glint::hdl::blocks::divider::Divider;
use glint::hdl::netlist::Design;

use crate::common::Sure;
use crate::common::host::Host;

/// Returns a device that divides two operands.
fn ratio(dividend: Format, divisor: Format, bits: i32) -> Design {
    let d = Designer::new("ratio");
    let a = d.operand("a", dividend);
    let b = d.operand("b", divisor);
    let ratio = Divider::new(&d, "ratio", a.q(), b.q(), bits);
    d.output("ratio_out", ratio.quotient());
    let repeat = loop_while(ratio.more(), "bit");
    d.microprogram([
        step("operands", []),
        step("load", ratio.load()),
        step("bit", ratio.step().into_iter().chain([repeat])),
        step("result", [valid(), end()]),
    ]);
    d.finish().sure()
}

/// Quotient, remainder, and the clocks from `start` to `valid`; the rest of the division before is still there.
fn divide(host: &mut Host, a: u64, b: u64) -> (u64, u64, u32) {
    let clocks = run(host, &[("a", a as i64), ("b", b as i64)]);
    (host.value("ratio_out"), host.value("ratio_remainder"), clocks)
}

/// Ends the computation before, and starts another; returns the clocks until `valid`.
fn run(host: &mut Host, operands: &[(&str, i64)]) -> u32 {
    host.clock();
    host.start(operands);
    host.until_valid()
}

#[test]
fn every_quotient_of_five_bits_is_exact() {
    let format = Format::unsigned(5, 0);
    for bits in [2, 3, 7, 8] {
        let design = ratio(format, format, bits as i32);
        let mut host = Host::new(&design);
        for b in 1..32u64 {
            for a in 0..=b {
                let (quotient, remainder, clocks) = divide(&mut host, a, b);
                // 1.0 is not representable: the largest fraction, which leaves the divisor.
                let exact = ((a << bits) / b).min((1 << bits) - 1);
                assert_eq!(quotient, exact, "{a} / {b} to {bits} bits");
                assert_eq!(remainder, (a << bits) - exact * b, "{a} / {b} to {bits} bits");
                // The words 0, load and result, and one clock a bit.
                assert_eq!(clocks, bits + 3);
            }
        }
    }
}

#[test]
fn a_quotient_by_zero_is_the_largest_fraction() {
    let format = Format::unsigned(5, 0);
    let design = ratio(format, format, 6);
    let mut host = Host::new(&design);
    assert_eq!(divide(&mut host, 0, 0).0, 63);
    // Nothing of it is left in the next division.
    assert_eq!(divide(&mut host, 1, 3), (21, 1, 9));
}

/// a has two fraction bits and b none: a/4 over b. Where b has the fraction bits, a over b/4.
#[test]
fn fraction_points_are_aligned() {
    for (a_frac, b_frac) in [(2, 0), (0, 2)] {
        let a_format = Format::unsigned(4 - a_frac, a_frac);
        let b_format = Format::unsigned(4 - b_frac, b_frac);
        let design = ratio(a_format, b_format, 5);
        let mut host = Host::new(&design);
        for b in 1..16u64 {
            for a in 0..16u64 {
                let (num, den) = (a << b_frac, b << a_frac);
                if num <= den {
                    let exact = ((num << 5) / den).min(31);
                    assert_eq!(divide(&mut host, a, b).0, exact, "{a} / {b}");
                }
            }
        }
    }
}

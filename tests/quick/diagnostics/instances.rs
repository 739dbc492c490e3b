//! Tests mistakes in descriptions that use other devices as parts.

use super::{BYTE, Found, finish};
use glint::dsl::{Designer, Signal, end, step, valid};
use glint::fixed::Format;

/// Its operand, a clock later.
fn held(d: &Designer) {
    let x = d.operand("x", BYTE);
    let y = d.register("y", BYTE);
    y.takes(x.q());
    d.output("y_out", y.q());
    d.microprogram([step("idle", []), step("load", [y.load()]), step("result", [valid(), end()])]);
}

/// Returns a dataflow of an operand, right but for what `describe` makes of it.
#[track_caller]
fn dataflow(describe: impl for<'d> FnOnce(&'d Designer, Signal<'d>) -> Signal<'d>) -> Found {
    let d = Designer::new("device");
    let a = d.operand("a", BYTE).q();
    d.output("a_out", describe(&d, a));
    d.dataflow();
    finish(d)
}

#[test]
fn a_right_dataflow_has_no_mistakes() {
    dataflow(|_, a| a).are([]);
    dataflow(|d, a| d.instance("part", held, &[("x", a)]).out("y_out")).are([]);
}

#[test]
fn parts_that_nothing_executes_are_a_mistake_at_the_first() {
    let d = Designer::new("device");
    let a = d.operand("a", BYTE).q();
    let line = line!() + 1;
    d.output("a_out", d.instance("part", held, &[("x", a)]).out("y_out"));
    let mistakes = d.finish().expect_err("a mistake").0;
    assert_eq!(mistakes.len(), 1);
    assert_eq!(
        mistakes[0].message,
        "no microprogram executes the parts: call `dataflow()` after the parts"
    );
    assert_eq!(mistakes[0].location.line(), line);
}

#[test]
fn operands_and_results_of_parts_go_by_name_and_format() {
    dataflow(|d, a| {
        d.instance("none", held, &[]);
        d.instance("wrong", held, &[("z", a)]);
        d.instance("wide", held, &[("x", a.with_fraction(12))]);
        d.instance("part", held, &[("x", a)]);
        d.instance("part", held, &[("x", a)]);
        d.instance("right", held, &[("x", a)]).out("z_out");
        a
    })
    .are([
        "the part `none` has the operands x, but is given ",
        "the part `wrong` has the operands x, but is given z",
        "operand `x` of `wide` is u0.8, but `a_reg_scaled` is u0.12 with values from 0 to 4080 ulp: narrow \
         the signal or change the format",
        "two parts are named `part`",
        "the part `right` has no output `z_out`: its outputs are y_out",
    ]);
}

#[test]
fn a_part_has_one_result_and_no_mistakes() {
    fn itself(d: &Designer) {
        let x = d.operand("x", BYTE).q();
        d.output("y_out", d.instance("own", itself, &[("x", x)]).out("y_out"));
        d.dataflow();
    }
    dataflow(|d, a| {
        d.instance("endless", itself, &[("x", a)]);
        a
    })
    .are(["the part `own` is nested 8 deep: does a description contain itself?"]);
    dataflow(|d, a| {
        let waits = |d: &Designer| {
            let x = d.operand("x", BYTE).q();
            d.output("y_out", x);
            let wait = step("wait", [glint::dsl::wait_for_start()]);
            d.microprogram([step("idle", []), wait, step("result", [valid(), end()])]);
        };
        d.instance("waits", waits, &[("x", a)]);
        a
    })
    .are(["`waits` cannot be a part: the microinstruction `wait` waits for `start`"]);
}

#[test]
fn nothing_stands_beside_a_dataflow_that_takes_clocks() {
    dataflow(|d, a| d.pipeline("later", a)).are([
        "`later` follows its input after one clock, and `dataflow()` does not wait for this clock: read the \
         memory without a clock, remove the register, or put it into a part",
    ]);
    let d = Designer::new("device");
    let a = d.operand("a", Format::unsigned(0, 8)).q();
    d.output("a_out", d.instance("part", held, &[("x", a)]).out("y_out"));
    d.microprogram([step("idle", []), step("result", [valid(), end()])]);
    let found = d.finish().unwrap_err().to_string();
    assert!(
        found.contains(
            "a description with parts cannot have a microprogram of its own: call `dataflow()`"
        ),
        "{found}"
    );
}

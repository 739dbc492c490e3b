//! Tests mistakes in microprograms: the order and the end of microinstructions, selections, `valid`, jumps and loops.

use glint::dsl::{
    Designer, Signal, StepSetting, dispatch, end, jump_if, loop_while, next, step, valid,
};
use glint::fixed::{Format, Overflow, Rounding};

use super::{BYTE, Found, finish, mistakes, program};

#[test]
fn fields_must_not_clash() {
    program(|d, load| {
        let a = d.operand("a", BYTE);
        let b = d.operand("b", BYTE);
        let select = d.select("select", &["a", "b"]);
        let first = d.mux_on("first", select, [a.q(), b.q()]);
        let second = d.mux_on("second", select, [b.q(), a.q()]);
        vec![
            step("idle", []),
            step("both", [first.pick(a.q()), second.pick(a.q()), load]),
            step("end", [end()]),
        ]
    })
    .are(["microinstruction `both`: `second.pick(a_reg)` clashes with `first.pick(a_reg)`: \
             they share select lines"]);
}

#[test]
fn a_mux_picks_one_of_its_inputs() {
    program(|d, load| {
        let a = d.operand("a", BYTE);
        let b = d.operand("b", BYTE);
        let m = d.mux("m", [a.q(), a.q()]);
        vec![step("idle", [m.pick(b.q())]), step("x", [m.pick(a.q()), load]), step("end", [end()])]
    })
    .are(["`b_reg` is not an input of `m`", "`a_reg` is more than one input of `m`"]);
}

#[test]
fn microinstructions_stand_in_order() {
    program(|_, load| {
        vec![step("idle", []), step("end", [load.clone(), end()]), step("after", [load])]
    })
    .are(["microinstruction `after` cannot be reached"]);

    program(|_, load| vec![step("idle", []), step("load", [load])])
        .are(["the last microinstruction, `load`, does not end"]);

    program(|_, load| vec![step("idle", [load.clone()]), step("load", [load, end()])])
        .are(["microinstruction `idle` sets `y_load`, but the device waits for `start` in this \
               microinstruction"]);

    program(|_, load| vec![step("idle", []), step("two ways", [load, next(), end()])])
        .are(["microinstruction `two ways` has two successors"]);

    program(|_, load| {
        vec![step("idle", []), step("twice", [load.clone()]), step("twice", [load, end()])]
    })
    .are(["two microinstructions are named `twice`"]);

    program(|_, _| vec![step("idle", []), step("end", [end()])])
        .are(["no microinstruction sets `y_load`"]);

    program(|_, load| vec![step("only", [load, end()])])
        .are(["a microprogram needs at least two microinstructions: one waits for `start`, and one ends the \
               computation"]);

    program(|d, load| {
        let bit = d.operand("more", Format::BIT);
        vec![
            step("idle", []),
            step("load", [load, loop_while(bit.q(), "nowhere")]),
            step("end", [end()]),
        ]
    })
    .are(["microinstruction `load` goes to `nowhere`, but no microinstruction has this name"]);
}

#[test]
fn a_dispatch_has_a_later_microinstruction_for_each_value_of_an_operand() {
    let dispatching = |to: &'static [&'static str]| {
        program(move |d, load| {
            let opcode = d.operand("opcode", Format::BIT);
            vec![
                step("idle", []),
                step("before", []),
                step("choose", [dispatch(opcode.q(), to)]),
                step("load", [load]),
                step("end", [end()]),
            ]
        })
    };
    dispatching(&["load", "end", "end"])
        .are(["microinstruction `choose` dispatches to 3 microinstructions, but `opcode_reg` has 2 values: \
               state a microinstruction for each value"]);
    dispatching(&["load", "before"])
        .are(["microinstruction `choose` dispatches to `before`, which does not come after it: a dispatch \
               jumps ahead"]);
    dispatching(&["load", "nowhere"]).are([
        "microinstruction `choose` goes to `nowhere`, but no microinstruction has this name",
    ]);
    program(|d, load| {
        let opcode = d.operand("opcode", Format::BIT);
        let inverted = d.not("inverted", opcode.q());
        vec![
            step("idle", []),
            step("choose", [dispatch(inverted, &["load", "end"])]),
            step("load", [load]),
            step("end", [end()]),
        ]
    })
    .are(["microinstruction `choose` dispatches by `inverted`, which is not the register of an operand"]);
    program(|d, load| {
        let [first, second] = ["first", "second"].map(|name| d.operand(name, Format::BIT));
        vec![
            step("idle", []),
            step("choose", [dispatch(first.q(), &["load", "again"])]),
            step("load", [load]),
            step("again", [dispatch(second.q(), &["end", "end"])]),
            step("end", [end()]),
        ]
    })
    .are(["microinstruction `again` dispatches by `second_reg`, but an earlier one by `first_reg`: all \
           dispatches must have the same selector"]);
}

#[test]
fn a_design_has_one_microprogram() {
    let d = Designer::new("device");
    finish(d).are(["the design has no microprogram"]);
    let d = Designer::new("device");
    for _ in 0..2 {
        d.microprogram([step("idle", []), step("end", [end()])]);
    }
    finish(d).are(["the description has a second microprogram"]);
}

#[test]
fn products_are_taken_under_their_selection() {
    let d = Designer::new("device");
    let a = d.operand("a", BYTE);
    let b = d.operand("b", Format::unsigned(2, 6));
    let select = d.select("operands", &["a", "b"]);
    let first = d.bus("first", select, [a.q(), b.q()]);
    let second = d.bus("second", select, [a.q(), b.q()]);
    let product = d.shared_mul("product", &first, &second);
    let y = d.register("y", BYTE);
    let square = product.of(a.q(), a.q());
    y.takes(d.narrow("square", square, BYTE, Rounding::Truncate, Overflow::Saturate));
    d.output("y_out", y.q());
    d.microprogram([
        step("idle", []),
        step("wrong", [first.pick(b.q()), y.load()]),
        step("end", [valid(), end()]),
    ]);
    finish(d).are(["microinstruction `wrong` loads `y` with the product of (a), but selects (b)"]);
}

#[test]
fn held_products_settle_under_their_selection() {
    let found = |settled: bool| {
        let d = Designer::new("device");
        let a = d.operand("a", BYTE);
        let b = d.operand("b", BYTE);
        let select = d.select("operands", &["a", "b"]);
        let first = d.bus("first", select, [a.q(), b.q()]).held();
        let second = d.bus("second", select, [a.q(), b.q()]).held();
        let product = d.shared_mul("product", &first, &second);
        let y = d.register("y", Format::unsigned(0, 16));
        // The lines that choose between two products are themselves lines of a microinstruction.
        let squares = [product.of(a.q(), a.q()), product.of(b.q(), b.q())];
        y.takes(d.choose("square", select.out().bit(0), squares));
        d.output("y_out", y.q());
        let before = settled.then(|| first.pick(b.q()));
        d.microprogram([
            step("idle", []),
            step("settle", before),
            step("load", [first.pick(b.q()), y.load()]),
            step("end", [valid(), end()]),
        ]);
        finish(d)
    };
    found(true).are([]);
    found(false)
        .are(["microinstruction `load` loads `y` with the product of (b), but the preceding \
             microinstruction `settle` selects (a)"]);
}

#[test]
fn valid_may_follow_one_bit() {
    let follows = |clocks: u32, last: fn() -> Vec<StepSetting>| {
        program(|d, load| {
            let x = d.operand("a", Format::BIT);
            d.valid_after(x.q(), clocks);
            vec![step("idle", []), step("load", [load]), step("result", last())]
        })
    };
    follows(0, || vec![end()]).are([]);
    follows(3, || vec![end()]).are([]);
    follows(1, || vec![valid(), end()]).are([
        "microinstruction `result` sets `valid`, but `valid` follows a signal in this design",
    ]);
    mistakes(|d| {
        d.valid_after(d.operand("a", BYTE).q(), 1);
    })
    .are(["`valid` follows `a_reg`, which has more than one bit"]);
    program(|d, load| {
        let (a, b) = (d.operand("a", Format::BIT), d.operand("b", Format::BIT));
        d.valid_after(a.q(), 1);
        d.valid_after(b.q(), 1);
        vec![step("idle", []), step("load", [load, end()])]
    })
    .are(["`valid` follows two signals: `b_reg` is the second"]);
}

#[test]
fn a_jump_goes_to_a_microinstruction() {
    let jumps = |to: &'static str| {
        program(|d, load| {
            let x = d.operand("a", Format::BIT);
            vec![
                step("idle", []),
                step("first", [jump_if(x.q(), to)]),
                step("load", [load]),
                step("result", [valid(), end()]),
            ]
        })
    };
    jumps("result").are([]);
    jumps("nowhere")
        .are(["microinstruction `first` goes to `nowhere`, but no microinstruction has this name"]);
}

#[test]
fn valid_follows_the_load_of_the_result() {
    program(|_, load| vec![step("idle", []), step("load", [load, valid()]), step("end", [end()])])
        .are(["microinstruction `load` sets `valid` and loads `y`, which `y_out` shows only from the next \
               microinstruction on: move `valid()` to the next microinstruction"]);
    // A result that is shown while the next is loaded was loaded before.
    program(|_, load| {
        vec![
            step("idle", []),
            step("first", [load.clone()]),
            step("next", [load, valid()]),
            step("last", [valid(), end()]),
        ]
    })
    .are([]);
}

#[test]
fn results_need_valid_and_muxes_need_a_choice() {
    program(|_, load| vec![step("idle", []), step("load", [load]), step("end", [end()])]).are([
        "no microinstruction sets `valid`, so nothing tells when `y_out` is ready: add `valid()` to the \
         microinstruction in which the result is ready",
    ]);
    mistakes(|d| {
        let x = d.operand("other", BYTE).q();
        d.output("out", d.mux("m", [x, d.not("inverted", x)]).out());
    })
    .are(["no microinstruction selects an input with `m_select` (`other_reg`, `inverted`): add a `pick` to a \
           microinstruction, or remove the mux"]);
}

/// Returns a loop around the load of `y`, as long as `condition` says.
#[track_caller]
fn looped(condition: impl for<'d> FnOnce(&'d Designer) -> Signal<'d>) -> Found {
    program(|d, load| {
        let condition = condition(d);
        vec![
            step("idle", []),
            step("begin", [load.clone()]),
            step("again", [load, loop_while(condition, "begin")]),
            step("result", [valid(), end()]),
        ]
    })
}

/// Returns a microinstruction that counts down from a signal, as often as that says.
#[track_caller]
fn counted(from: impl for<'d> FnOnce(&'d Designer) -> Signal<'d>) -> Found {
    program(|d, load| {
        let count = d.down_counter("count", from(d));
        let more = d.any("more", count.q());
        vec![
            step("idle", []),
            step("begin", [load, count.load()]),
            step("again", [count.count(), loop_while(more, "again")]),
            step("result", [valid(), end()]),
        ]
    })
}

#[test]
fn a_loop_must_end() {
    looped(|d| {
        let n = d.operand("n", Format::unsigned(4, 0));
        d.any("more", n.q())
    })
    .are(["microinstruction `again` goes back to `begin` while `more` is 1, and no microinstruction of the \
           loop changes `n_reg`: the loop never ends, or is never repeated"]);
    looped(|d| d.raw_constant("steady", 1, Format::BIT)).are([
        "microinstruction `again` goes back to `begin` while `steady` is 1, which is constant: the \
               loop never ends, or is never repeated",
    ]);
    // What the loop loads may end it.
    counted(|d| d.raw_constant("three", 3, Format::unsigned(2, 0))).are([]);
    // A loop without an end of its own may have a way out.
    program(|d, load| {
        let steady = d.raw_constant("steady", 1, Format::BIT);
        let count = d.down_counter("count", d.raw_constant("three", 3, Format::unsigned(2, 0)));
        let none = d.not("none", d.any("more", count.q()));
        vec![
            step("idle", []),
            step("begin", [load, count.load()]),
            step("test", [count.count(), jump_if(none, "result")]),
            step("again", [loop_while(steady, "test")]),
            step("result", [valid(), end()]),
        ]
    })
    .are([]);
}

#[test]
fn every_operand_must_be_used() {
    mistakes(|d| {
        let _ = d.operand("spare", BYTE);
    })
    .are(["operand `spare` is not used: no output depends on it"]);
    // It is read, but by a register that no output shows.
    program(|d, load| {
        let z = d.register("z", BYTE);
        z.takes(d.operand("spare", BYTE).q());
        vec![step("idle", []), step("load", [load, z.load()]), step("end", [valid(), end()])]
    })
    .are(["operand `spare` is not used: no output depends on it"]);
    // How long a loop runs shows.
    counted(|d| d.operand("n", Format::unsigned(4, 0)).q()).are([]);
}

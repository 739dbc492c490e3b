//! Tests that wrong designs, which no checker has seen, are refused and not simulated wrongly.

use super::build::Build;
use crate::netlist::{Driver, NetId, Op, RegId, Role, RomId};
use crate::sim::Program;
use glint_base::fixed::Format;

const BYTE: Format = Format::unsigned(8, 0);
const SIGNED: Format = Format::signed(7, 0);

/// Returns the message for a design with the port `a`, a byte, which `change` makes wrong.
fn refusal<T>(change: impl FnOnce(&mut Build, NetId) -> T) -> String {
    let mut b = Build::new();
    let a = b.input("a", BYTE);
    Program::new(&b.design).expect("nothing is wrong yet");
    change(&mut b, a);
    let error = Program::new(&b.design).expect_err("it is wrong");
    format!("{error:#}")
}

#[track_caller]
fn assert_says(message: String, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "`{message}` does not say `{word}`");
    }
}

#[test]
fn drivers() {
    let message = refusal(|b, _| b.net("open", BYTE, Driver::Undriven));
    assert_says(message, &["`open`", "nothing drives", "errors.rs"]);
    let message = refusal(|b, _| b.net("stray", BYTE, Driver::Input));
    assert_says(message, &["`stray`", "not among the ports"]);
    let message = refusal(|b, a| b.design.ports.push(b.design.ports[a.index()].clone()));
    assert_says(message, &["`a`", "twice"]);
    let message = refusal(|b, _| b.register("idle", BYTE));
    assert_says(message, &["`idle`", "nothing drives the data input"]);
    let message = refusal(|b, a| {
        let p = b.op("p", BYTE, Op::Not(a));
        let q = b.op("q", BYTE, Op::Not(p));
        b.design.nets[p.index()].driver = Driver::Op(Op::Not(q));
    });
    assert_says(message, &["loop", "`p`", "`q`"]);
}

#[test]
fn widths_and_signs() {
    let message = refusal(|b, a| b.op("sum", Format::unsigned(9, 0), Op::Not(a)));
    assert_says(message, &["`sum` (u9.0)", "`a` (u8.0)", "the widths must be equal"]);
    let message = refusal(|b, a| b.op("part", BYTE, Op::Slice { of: a, low: 1 }));
    assert_says(message, &["`part`", "the bits are not all there"]);
    let message = refusal(|b, a| b.op("both", BYTE, Op::Concat(vec![a, a])));
    assert_says(message, &["`both`", "add up"]);
    let message = refusal(|b, a| {
        let signed = b.op("signed", SIGNED, Op::Relabel(a));
        b.op("product", Format::unsigned(16, 0), Op::Mul(a, signed));
    });
    assert_says(message, &["`product`", "`signed`", "`a`"]);
    let message = refusal(|b, a| {
        b.design.nets[a.index()].format = Format::unsigned(60, 5);
    });
    assert_says(message, &["`a`", "65 bits"]);
    let message = refusal(|b, _| {
        let select = b.rst_n;
        b.op("empty", BYTE, Op::Mux { select, inputs: vec![] });
    });
    assert_says(message, &["`empty`", "two inputs or more"]);
    let message = refusal(|b, a| {
        b.rom("word", BYTE, a, false, &[]);
        b.field("wide", 9);
    });
    assert_says(message, &["9 bits", "8"]);
}

#[test]
fn references() {
    let message = refusal(|b, _| b.op("far", BYTE, Op::Not(NetId(99))));
    assert_says(message, &["net 99"]);
    let message = refusal(|b, _| b.net("far", BYTE, Driver::Register(RegId(7))));
    assert_says(message, &["register 7"]);
    let message = refusal(|b, _| b.net("far", BYTE, Driver::Rom(RomId(7))));
    assert_says(message, &["ROM 7"]);
    let message = refusal(|b, a| {
        b.design.ports[0].role = Role::Strobe;
        let q = b.register("q", BYTE);
        b.of(q).data = Some(a);
        b.of(q).reset = Some(0);
    });
    assert_says(message, &["`q`", "no port is the reset"]);
}

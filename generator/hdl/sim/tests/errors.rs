//! Tests that the simulator refuses wrong designs with a message.

use super::build::Build;
use crate::netlist::{Driver, NetId, Op, RegId, Role, RomId};
use crate::sim::CompiledDesign;
use glint_base::fixed::Format;

const BYTE: Format = Format::unsigned(8, 0);
const SIGNED: Format = Format::signed(7, 0);

/// The message about a design with the 8-bit input port `a`, after `change` has made it wrong, must contain all `words`.
#[track_caller]
fn refuses<T>(words: &[&str], change: impl FnOnce(&mut Build, NetId) -> T) {
    let mut b = Build::new();
    let a = b.input("a", BYTE);
    CompiledDesign::new(&b.design).expect("nothing is wrong yet");
    change(&mut b, a);
    let error = CompiledDesign::new(&b.design).expect_err("it is wrong");
    let message = format!("{error:#}");
    for word in words {
        assert!(message.contains(word), "`{message}` does not say `{word}`");
    }
}

#[test]
fn drivers() {
    refuses(&["`open`", "nothing drives", "errors.rs"], |b, _| {
        b.net("open", BYTE, Driver::Undriven)
    });
    refuses(&["`stray`", "not among the ports"], |b, _| b.net("stray", BYTE, Driver::Input));
    refuses(&["`a`", "twice"], |b, a| b.design.ports.push(b.design.ports[a.index()].clone()));
    refuses(&["`idle`", "nothing drives the data input"], |b, _| b.register("idle", BYTE));
    refuses(&["loop", "`p`", "`q`"], |b, a| {
        let p = b.op("p", BYTE, Op::Not(a));
        let q = b.op("q", BYTE, Op::Not(p));
        b.design.nets[p.index()].driver = Driver::Op(Op::Not(q));
    });
}

#[test]
fn widths_and_signs() {
    refuses(&["`sum` (u9.0)", "`a` (u8.0)", "the widths must be equal"], |b, a| {
        b.op("sum", Format::unsigned(9, 0), Op::Not(a))
    });
    refuses(&["`part`", "the slice must lie within the operand"], |b, a| {
        b.op("part", BYTE, Op::Slice { of: a, low: 1 })
    });
    refuses(&["`both`", "add up"], |b, a| b.op("both", BYTE, Op::Concat(vec![a, a])));
    refuses(&["`product`", "`signed`", "`a`"], |b, a| {
        let signed = b.op("signed", SIGNED, Op::Relabel(a));
        b.op("product", Format::unsigned(16, 0), Op::Mul(a, signed));
    });
    refuses(&["`a`", "65 bits"], |b, a| {
        b.design.nets[a.index()].format = Format::unsigned(60, 5);
    });
    refuses(&["`empty`", "at least two inputs"], |b, _| {
        let select = b.rst_n;
        b.op("empty", BYTE, Op::Mux { select, inputs: vec![] });
    });
    refuses(&["9 bits", "8"], |b, a| {
        b.rom("word", BYTE, a, false, &[]);
        b.field("wide", 9);
    });
}

#[test]
fn references() {
    refuses(&["net 99"], |b, _| b.op("far", BYTE, Op::Not(NetId(99))));
    refuses(&["register 7"], |b, _| b.net("far", BYTE, Driver::Register(RegId(7))));
    refuses(&["ROM 7"], |b, _| b.net("far", BYTE, Driver::Rom(RomId(7))));
    refuses(&["`q`", "has no reset port"], |b, a| {
        b.design.ports[0].role = Role::Strobe;
        let q = b.register("q", BYTE);
        b.of(q).data = Some(a);
        b.of(q).reset = Some(0);
    });
}

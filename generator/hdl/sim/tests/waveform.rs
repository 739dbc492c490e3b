//! Tests waveforms by reading them back with the parser of the `vcd` crate.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use vcd::{Command, IdCode, Parser, ScopeItem};

use super::build::Build;
use crate::netlist::{Design, Driver, Op, Partition, RegId, RomId};
use crate::sim::Simulator;
use glint_base::fixed::Format;

#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Shared {
    fn text(&self) -> Vec<u8> {
        self.0.lock().unwrap().clone()
    }
}

impl Write for Shared {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(text)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Takes this number of bytes, and then fails.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let taken = text.len().min(self.0);
        self.0 -= taken;
        match taken {
            0 => Err(io::Error::other("disk full")),
            _ => Ok(taken),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A counter runs through two microinstructions after the reset, beside a wide product.
fn design() -> Design {
    let mut b = Build::new();
    let bit = Format::BIT;
    let data = b.input("data", Format::signed(31, 0));
    let address = b.register("word_address", bit);
    let not = b.op("other_address", bit, Op::Not(address));
    b.of(address).data = Some(not);
    b.of(address).reset = Some(0);
    let run = b.register("run", bit);
    let one = b.net("one", bit, Driver::Constant(1));
    b.of(run).data = Some(one);
    b.of(run).reset = Some(0);
    b.rom("word_bits", Format::unsigned(3, 0), address, false, &[0b011, 0b101]);
    let select = b.field("select", 2);
    let valid = b.field("valid", 1);
    b.output(valid);
    let wide = b.op("wide", Format::signed(63, 0), Op::Mul(data, data));
    let hidden = b.op("hidden", Format::signed(63, 0), Op::Not(wide));
    b.design.nets[hidden.index()].named = false;
    for net in [address, not, run, select] {
        b.design.nets[net.index()].partition = Partition::Control;
    }
    b.design.control.rom = RomId(0);
    b.design.control.address = RegId(0);
    b.design.control.run = RegId(1);
    b.microinstruction("cos·cos, first");
    b.microinstruction("end");
    b.design
}

/// Returns the variables of a scope and of all scopes inside it: by `scope.name` the width and the code.
fn variables(scope: &str, items: &[ScopeItem]) -> BTreeMap<String, (u32, IdCode)> {
    let mut all = BTreeMap::new();
    for item in items {
        match item {
            ScopeItem::Var(var) => {
                let name = format!("{scope}{}", var.reference);
                assert!(all.insert(name, (var.size, var.code)).is_none());
            }
            ScopeItem::Scope(inner) => {
                let scope = format!("{scope}{}.", inner.identifier);
                all.append(&mut variables(&scope, &inner.children));
            }
        }
    }
    all
}

#[test]
fn names_widths_and_values() {
    let file = Shared::default();
    let mut s = Simulator::new(&design()).unwrap();
    s.trace(file.clone()).unwrap();
    let header = file.text().len();
    assert!(header > 0, "the header is written at once");
    s.clock().unwrap();
    assert!(file.text().len() > header, "and so is each clock");
    s.set(0, 1);
    s.set(1, (-3i64) as u64);
    s.clock().unwrap();
    s.clock().unwrap();
    s.end_trace().unwrap();
    s.clock().unwrap();

    let text = file.text();
    let mut parser = Parser::new(text.as_slice());
    let header = parser.parse_header().unwrap();
    let variables = variables("", &header.items);
    let widths: Vec<_> =
        variables.iter().map(|(name, (width, _))| (name.as_str(), *width)).collect();
    assert_eq!(
        widths,
        [
            ("probe.clk", 1),
            ("probe.control.microinstruction", 1),
            ("probe.control.other_address", 1),
            ("probe.control.run", 1),
            ("probe.control.select", 2),
            ("probe.control.word_address", 1),
            ("probe.data", 32),
            ("probe.datapath.one", 1),
            ("probe.datapath.wide", 64),
            ("probe.datapath.word_bits", 3),
            ("probe.rst_n", 1),
            ("probe.valid", 1),
        ]
    );

    // The value of each variable, as text, after each time.
    let names: BTreeMap<_, _> = variables.iter().map(|(n, (_, id))| (*id, n)).collect();
    let mut now = BTreeMap::new();
    let mut times = Vec::new();
    for command in parser {
        match command.unwrap() {
            Command::Timestamp(time) => times.push((time, now.clone())),
            Command::ChangeScalar(id, value) => {
                now.insert(names[&id].as_str(), value.to_string());
            }
            Command::ChangeVector(id, value) => {
                now.insert(names[&id].as_str(), value.iter().map(|bit| bit.to_string()).collect());
            }
            Command::ChangeString(id, value) => {
                now.insert(names[&id].as_str(), value);
            }
            _ => {}
        }
    }
    // A timestamp comes before its changes, so the values until a time are filed under that time.
    let stamps: Vec<_> = times.iter().map(|(time, _)| *time).collect();
    assert_eq!(stamps, [0, 5000, 10000, 15000, 20000, 25000, 30000, 35000]);
    let until = |time: u64, name: &str| {
        let (_, values) = times.iter().find(|(at, _)| *at == time).unwrap();
        values[name].clone()
    };
    assert_eq!(until(5000, "probe.control.microinstruction"), "idle");
    assert_eq!(until(15000, "probe.data"), "0".repeat(32));
    assert_eq!(until(20000, "probe.data"), format!("{}01", "1".repeat(30)));
    assert_eq!(until(20000, "probe.datapath.wide"), format!("{:064b}", 9));
    assert_eq!(until(20000, "probe.control.microinstruction"), "idle");
    assert_eq!(until(25000, "probe.control.microinstruction"), "end");
    assert_eq!(until(25000, "probe.control.select"), "10");
    assert_eq!(until(35000, "probe.control.microinstruction"), "cos_cos,_first");
    assert_eq!(until(35000, "probe.control.select"), "01");
    for (time, clock) in [(10000, "0"), (15000, "1"), (20000, "0"), (25000, "1")] {
        assert_eq!(until(time, "probe.clk"), clock);
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let trace_and_run = |bytes| -> anyhow::Result<()> {
        let mut s: Simulator = Simulator::new(&design())?;
        s.trace(Full(bytes))?;
        (0..3).try_for_each(|_| s.clock())?;
        s.end_trace()
    };
    let file = Shared::default();
    let mut s: Simulator = Simulator::new(&design()).unwrap();
    s.trace(file.clone()).unwrap();
    (0..3).for_each(|_| s.clock().unwrap());
    s.end_trace().unwrap();
    let whole = file.text().len();
    assert!(trace_and_run(whole).is_ok());
    for bytes in (0..whole).step_by(7).chain([whole - 1]) {
        let error = trace_and_run(bytes).expect_err("not everything fits");
        let message = format!("{error:#}");
        assert!(message.contains("cannot write the waveform"), "{message}");
        assert!(message.contains("disk full"), "{message}");
    }
}

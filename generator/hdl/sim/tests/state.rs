//! Tests the behaviour of registers and memories at the clock edge.

use rust_hdl::core::simulate::simulate;

use super::build::Build;
use crate::netlist::{NetId, Op};
use crate::sim::{Circuit, Simulator};
use glint_base::fixed::Format;

const BYTE: Format = Format::unsigned(8, 0);

fn clock<const N: usize>(
    simulator: &mut Simulator,
    inputs: &[(&str, u64)],
    nets: [NetId; N],
) -> [u64; N] {
    for (name, bits) in inputs {
        let input = simulator.input(name).unwrap();
        simulator.set(input, *bits);
    }
    simulator.clock().unwrap();
    nets.map(|net| simulator.value(net))
}

#[test]
fn reset_goes_before_enable_and_spares_registers_without_it() {
    let mut b = Build::new();
    let data = b.input("data", BYTE);
    let enable = b.input("enable", Format::BIT);
    let plain = b.register("plain", BYTE);
    b.of(plain).data = Some(data);
    let held = b.register("held", BYTE);
    b.of(held).data = Some(data);
    b.of(held).enable = Some(enable);
    let reset = b.register("reset", BYTE);
    b.of(reset).data = Some(data);
    b.of(reset).enable = Some(enable);
    b.of(reset).reset = Some(0x55);

    let mut s = Simulator::new(&b.design).unwrap();
    let nets = [plain, held, reset];
    assert_eq!(nets.map(|net| s.value(net)), [0, 0, 0]);
    let mut step = |rst_n, enable, data| {
        let inputs = [("rst_n", rst_n), ("enable", enable), ("data", data)];
        clock(&mut s, &inputs, nets)
    };
    assert_eq!(step(1, 0, 1), [1, 0, 0]);
    assert_eq!(step(1, 1, 2), [2, 2, 2]);
    assert_eq!(step(0, 0, 3), [3, 2, 0x55]);
    assert_eq!(step(1, 0, 4), [4, 2, 0x55]);
    assert_eq!(step(0, 1, 5), [5, 5, 0x55]);
    assert_eq!(step(1, 1, 0x106), [6, 6, 6]);
}

#[test]
fn the_edge_happens_everywhere_at_once() {
    let mut b = Build::new();
    let data = b.input("data", BYTE);
    let load = b.input("load", Format::BIT);
    let [p, q] = ["p", "q"].map(|name| b.register(name, BYTE));
    let mux = |a, b| Op::Mux { select: load, inputs: vec![a, b] };
    let p_next = b.op("p_next", BYTE, mux(q, data));
    b.of(p).data = Some(p_next);
    b.of(q).data = Some(p);
    // A chain in both orders of declaration, one of them through another name.
    let last = b.register("last", BYTE);
    let middle = b.register("middle", BYTE);
    b.of(last).data = Some(middle);
    let alias = b.op("alias", BYTE, Op::Relabel(q));
    b.of(middle).data = Some(alias);
    let after = b.register("after", BYTE);
    b.of(after).data = Some(last);
    // A register that enables itself stays once it is 0.
    let alive = b.register("alive", Format::BIT);
    let ones = b.op("ones", Format::BIT, Op::All(data));
    b.of(alive).data = Some(ones);
    let not_alive = b.op("not_alive", Format::BIT, Op::Not(alive));
    b.of(alive).enable = Some(not_alive);

    let mut s = Simulator::new(&b.design).unwrap();
    let nets = [p, q, middle, last, after, alive];
    let mut step = |load, data| clock(&mut s, &[("load", load), ("data", data)], nets);
    assert_eq!(step(1, 10), [10, 0, 0, 0, 0, 0]);
    assert_eq!(step(1, 20), [20, 10, 0, 0, 0, 0]);
    assert_eq!(step(0, 255), [10, 20, 10, 0, 0, 1]);
    assert_eq!(step(0, 0), [20, 10, 20, 10, 0, 1]);
    assert_eq!(step(0, 0), [10, 20, 10, 20, 10, 1]);
}

#[test]
fn roms_read_at_once_or_at_the_edge_and_zero_beyond_their_contents() {
    let mut b = Build::new();
    let data = b.input("data", BYTE);
    let address = b.register("address", BYTE);
    b.of(address).data = Some(data);
    let words = [0x1aa, 0xbb, 0xcc];
    let at_once = b.rom("at_once", BYTE, address, false, &words);
    let other = b.rom("other", BYTE, address, false, &[1, 2, 3, 4]);
    let clocked = b.rom("clocked", BYTE, address, true, &words);
    let port_rom = b.rom("port_rom", BYTE, data, true, &words);
    let taken = b.register("taken", BYTE);
    b.of(taken).data = Some(clocked);

    let mut s = Simulator::new(&b.design).unwrap();
    let nets = [address, at_once, other, clocked, port_rom, taken];
    assert_eq!(nets.map(|net| s.value(net)), [0, 0xaa, 1, 0, 0, 0]);
    let mut step = |data| clock(&mut s, &[("data", data)], nets);
    assert_eq!(step(2), [2, 0xcc, 3, 0xaa, 0xcc, 0]);
    assert_eq!(step(3), [3, 0, 4, 0xcc, 0, 0xaa]);
    assert_eq!(step(1), [1, 0xbb, 2, 0, 0xbb, 0xcc]);
    assert_eq!(step(255), [255, 0, 0, 0xbb, 0, 0]);
}

#[test]
fn fields_are_parts_of_the_control_word_most_significant_first() {
    let mut b = Build::new();
    let address = b.register("word_address", Format::unsigned(2, 0));
    let step = b.net("step", Format::unsigned(2, 0), crate::netlist::Driver::Constant(1));
    let next = b.op("next", Format::unsigned(2, 0), Op::Add { a: address, b: step, carry: None });
    b.of(address).data = Some(next);
    b.of(address).reset = Some(0);
    let words = [0b10_1101, 0b00_0010, 0b11_1111, 0b01_0001];
    b.rom("word", Format::unsigned(6, 0), address, false, &words);
    let [high, middle, low] = [("high", 3), ("middle", 2), ("low", 1)].map(|(n, w)| b.field(n, w));

    let mut s = Simulator::new(&b.design).unwrap();
    let nets = [address, high, middle, low];
    assert_eq!(nets.map(|net| s.value(net)), [0, 0b101, 0b10, 1]);
    assert_eq!(clock(&mut s, &[("rst_n", 1)], nets), [1, 0b000, 0b01, 0]);
    assert_eq!(clock(&mut s, &[], nets), [2, 0b111, 0b11, 1]);
    assert_eq!(clock(&mut s, &[], nets), [3, 0b010, 0b00, 1]);
    assert_eq!(clock(&mut s, &[("rst_n", 0)], nets), [0, 0b101, 0b10, 1]);
}

#[test]
fn rust_hdl_settles_it_in_two_updates_and_leaves_it_alone_when_nothing_changes() {
    let mut b = Build::new();
    let data = b.input("data", BYTE);
    let q = b.register("q", BYTE);
    let not = b.op("not", BYTE, Op::Not(data));
    b.of(q).data = Some(not);
    let mut circuit: Circuit = Circuit::new(&b.design).unwrap();
    assert!(simulate(&mut circuit, 1), "nothing has changed");

    circuit.inputs_mut()[1] = [0x0f];
    assert_eq!(circuit.machine.lanes(not), [0xff], "not before the update");
    assert!(!simulate(&mut circuit, 1), "an input has");
    assert_eq!((circuit.machine.lanes(not), circuit.machine.lanes(q)), ([0xf0], [0]));
    assert!(simulate(&mut circuit, 1));

    circuit.clock.next = true.into();
    // Too late for this edge.
    circuit.inputs_mut()[1] = [0x3c];
    assert!(simulate(&mut circuit, 2));
    assert_eq!((circuit.machine.lanes(not), circuit.machine.lanes(q)), ([0xc3], [0xf0]));
    assert!(simulate(&mut circuit, 1));
    circuit.clock.next = false.into();
    assert!(simulate(&mut circuit, 2));
    assert_eq!(circuit.machine.lanes(q), [0xf0], "the falling edge does nothing");
}

#[test]
fn settling_shows_inputs_without_a_clock() {
    let mut b = Build::new();
    let data = b.input("data", BYTE);
    let not = b.op("not", BYTE, Op::Not(data));
    let q = b.register("q", BYTE);
    b.of(q).data = Some(not);
    let mut s = Simulator::new(&b.design).unwrap();
    s.set(1, 1);
    s.settle().unwrap();
    assert_eq!((s.value(not), s.value(q)), (0xfe, 0));
    s.clock().unwrap();
    assert_eq!(s.value(q), 0xfe);
}

#[test]
fn a_clock_with_inputs_of_its_own_leaves_those_that_were_set() {
    let mut b = Build::new();
    let data = b.input("data", BYTE);
    let q = b.register("q", BYTE);
    b.of(q).data = Some(data);
    let mut s: Simulator<2> = Simulator::new(&b.design).unwrap();
    s.set_lanes(1, [1, 2]);
    let mut inputs = vec![[1; 2], [3, 4]];
    s.clock_with(&mut inputs).unwrap();
    assert_eq!((s.lanes(q), &inputs[..]), ([3, 4], [[1; 2], [3, 4]].as_slice()));
    s.clock().unwrap();
    assert_eq!(s.lanes(q), [1, 2]);
}

//! Compares each simulated cell with arithmetic on i128. Operands come from ports, registers and constants.

use super::build::{Build, Random};
use crate::netlist::{Driver, NetId, Op};
use crate::sim::Simulator;
use glint_base::fixed::Format;

/// Simulates a cell for random operands. `expected` computes the result from raw values; the check wraps it to the width.
fn check(
    random: &mut Random,
    operands: &[Format],
    result: Format,
    op: impl Fn(&[NetId]) -> Op,
    expected: impl Fn(&[i128]) -> i128,
) {
    let name = |at: usize| format!("operand_{at}");
    let mut from_ports = Build::new();
    let nets = operands.iter().enumerate();
    let nets: Vec<_> = nets.map(|(at, format)| from_ports.input(&name(at), *format)).collect();
    let direct = from_ports.op("direct", result, op(&nets));
    let registers = operands.iter().enumerate().map(|(at, format)| {
        let q = from_ports.register(&format!("{}_q", name(at)), *format);
        from_ports.of(q).data = Some(nets[at]);
        q
    });
    let registers: Vec<_> = registers.collect();
    let registered = from_ports.op("registered", result, op(&registers));
    let mut simulator: Simulator = Simulator::new(&from_ports.design).unwrap();

    for _ in 0..24 {
        let patterns: Vec<_> =
            operands.iter().map(|format| random.pattern(format.width())).collect();
        let raws = operands.iter().zip(&patterns).map(|(format, bits)| format.raw(*bits));
        let raws: Vec<_> = raws.collect();
        let wanted = expected(&raws).rem_euclid(1 << result.width()) as u64;

        for (at, bits) in patterns.iter().enumerate() {
            // Port 0 is the reset.
            simulator.set(at + 1, *bits);
        }
        simulator.clock().unwrap();
        let mut from_constants = Build::new();
        let nets: Vec<_> = operands
            .iter()
            .enumerate()
            .map(|(at, f)| from_constants.net(&name(at), *f, Driver::Constant(patterns[at])))
            .collect();
        let folded = from_constants.op("folded", result, op(&nets));
        let constant: Simulator = Simulator::new(&from_constants.design).unwrap();

        let of = |what| format!("{:?} {what} of {raws:?} in {operands:?}", op(&nets));
        assert_eq!(simulator.value(direct), wanted, "{}", of("ports"));
        assert_eq!(simulator.value(registered), wanted, "{}", of("registers"));
        assert_eq!(constant.value(folded), wanted, "{}", of("constants"));
    }
}

fn unsigned(width: u32) -> Format {
    Format::unsigned(width as i32, 0)
}

/// Calls a test with every width from 1 to 64 bits, once more with 1, and twice more with 64.
fn widths(mut test: impl FnMut(&mut Random, u32)) {
    let mut random = Random(1);
    for width in (1..=64).chain([1, 64, 64]) {
        test(&mut random, width);
    }
}

fn wire(raw: i128, width: u32) -> i128 {
    raw.rem_euclid(1 << width)
}

#[test]
fn wiring() {
    widths(|random, width| {
        let of = random.format(width);
        let renamed = random.format(width);
        check(random, &[of], renamed, |n| Op::Relabel(n[0]), |v| v[0]);

        if width < 64 {
            let wider = random.within(width + 1, 64);
            let wider = random.format(wider);
            check(random, &[of], wider, |n| Op::Extend(n[0]), |v| v[0]);
        }

        let low = random.within(0, width - 1);
        let part = random.within(1, width - low);
        let part = random.format(part);
        let slice = |n: &[NetId]| Op::Slice { of: n[0], low };
        check(random, &[of], part, slice, |v| v[0] >> low);
    });
}

#[test]
fn concatenation() {
    widths(|random, width| {
        let mut parts = Vec::new();
        let mut left = width;
        while left > 0 {
            let part = random.within(1, left);
            parts.push(random.format(part));
            left -= part;
        }
        let all = random.format(width);
        let joined = |v: &[i128]| {
            parts
                .iter()
                .zip(v)
                .fold(0, |all, (format, raw)| (all << format.width()) + wire(*raw, format.width()))
        };
        check(random, &parts, all, |n| Op::Concat(n.to_vec()), joined);
    });
}

#[test]
fn bitwise() {
    widths(|random, width| {
        let same = [random.format(width), random.format(width)];
        let to = random.format(width);
        check(random, &same[..1], to, |n| Op::Not(n[0]), |v| !v[0]);
        check(random, &same, to, |n| Op::And(n[0], n[1]), |v| v[0] & v[1]);
        check(random, &same, to, |n| Op::Or(n[0], n[1]), |v| v[0] | v[1]);
        check(random, &same, to, |n| Op::Xor(n[0], n[1]), |v| v[0] ^ v[1]);
        let any = |v: &[i128]| i128::from(v[0] != 0);
        check(random, &same[..1], Format::BIT, |n| Op::Any(n[0]), any);
        let all = |v: &[i128]| i128::from(wire(v[0] + 1, width) == 0);
        check(random, &same[..1], Format::BIT, |n| Op::All(n[0]), all);
    });
}

#[test]
fn sums() {
    widths(|random, width| {
        let of = [random.format(width), random.format(width), Format::BIT];
        let to = random.format(width);
        let add = |carry: bool| {
            move |n: &[NetId]| Op::Add { a: n[0], b: n[1], carry: carry.then(|| n[2]) }
        };
        check(random, &of[..2], to, add(false), |v| v[0] + v[1]);
        check(random, &of, to, add(true), |v| v[0] + v[1] + v[2]);
        check(random, &of[..2], to, |n| Op::Sub(n[0], n[1]), |v| v[0] - v[1]);
    });
}

#[test]
fn products() {
    widths(|random, width| {
        if width == 1 {
            return;
        }
        let first = random.within(1, width - 1);
        let second = width - first;
        let mul = |n: &[NetId]| Op::Mul(n[0], n[1]);
        let of = [unsigned(first), unsigned(second)];
        check(random, &of, unsigned(width), mul, |v| v[0] * v[1]);
        let of = [Format::signed(first as i32 - 1, 0), Format::signed(second as i32 - 1, 0)];
        let to = random.format(width);
        check(random, &of, to, mul, |v| v[0] * v[1]);
    });
}

#[test]
fn comparisons() {
    widths(|random, width| {
        let same = [random.format(width); 2];
        let less = |v: &[i128]| i128::from(v[0] < v[1]);
        check(random, &same, Format::BIT, |n| Op::Less(n[0], n[1]), less);
        let mixed = [random.format(width), random.format(width)];
        let equal = |v: &[i128]| i128::from(wire(v[0], width) == wire(v[1], width));
        check(random, &mixed, Format::BIT, |n| Op::Equal(n[0], n[1]), equal);
    });
}

#[test]
fn choices() {
    widths(|random, width| {
        let inputs = random.within(2, 9);
        let select = inputs.next_power_of_two().ilog2();
        let mut of = vec![unsigned(select)];
        of.extend((0..inputs).map(|_| random.format(width)));
        let to = random.format(width);
        let mux = |n: &[NetId]| Op::Mux { select: n[0], inputs: n[1..].to_vec() };
        let last = inputs as usize;
        check(random, &of, to, mux, |v| v[last.min(v[0] as usize + 1)]);
    });
}

//! Random netlists against the interpreter, which evaluates them net by net, as `netlist` documents it.

use super::build::{Build, Random};
use crate::netlist::{Design, Driver, Interpreter, Net, NetId, Op};
use crate::sim::Simulator;
use glint_base::fixed::Format;

/// A design of random cells, registers and ROMs, all connected at random; `big` ones have more
/// registers and fields than the simulator tells apart.
fn design(random: &mut Random, big: bool) -> Design {
    let mut b = Build::new();
    let mut registers = Vec::new();
    for at in 0..random.within(1, 4) {
        let width = random.within(1, 64);
        let format = random.format(width);
        b.input(&format!("in_{at}"), format);
    }
    let (registers_wanted, fields) = if big { (50, 30) } else { (random.within(1, 6), 3) };
    for at in 0..registers_wanted {
        let width = random.within(1, 64);
        let format = random.format(width);
        registers.push(b.register(&format!("q_{at}"), format));
    }
    let word_address = registers[0];
    let words: Vec<_> = (0..random.within(1, 9)).map(|_| random.bits()).collect();
    let of_word = Format::unsigned(fields * 2, 0);
    b.rom("word", of_word, word_address, random.below(2) == 0, &words);
    for at in 0..fields {
        b.field(&format!("field_{at}"), 2);
    }
    for at in 0..random.within(5, 60) {
        cell(&mut b, random, &format!("n_{at}"));
    }
    for q in registers {
        let data = sized(&mut b, random, q.index() + 1000, q);
        let enable = bit(&mut b, random);
        let reset = random.bits();
        let register = b.of(q);
        register.data = Some(data);
        register.enable = random.below(2).eq(&0).then_some(enable);
        register.reset = random.below(3).eq(&0).then_some(reset);
    }
    for net in &mut b.design.nets {
        net.named = random.below(3) == 0;
    }
    b.design
}

/// The nets that are simulated in any case.
fn visible(design: &Design) -> impl Iterator<Item = (NetId, &Net)> {
    design.iter().filter(|(_, net)| net.named)
}

fn any(b: &Build, random: &mut Random) -> NetId {
    NetId(random.below(b.design.nets.len()) as u32)
}

/// A net of one bit.
fn bit(b: &mut Build, random: &mut Random) -> NetId {
    let of = any(b, random);
    let name = format!("bit_{}", b.design.nets.len());
    b.op(&name, Format::BIT, Op::Any(of))
}

/// A net as wide as `like`, with its signedness.
fn sized(b: &mut Build, random: &mut Random, at: usize, like: NetId) -> NetId {
    let of = any(b, random);
    let format = b.design.net(like).format;
    let width = b.design.width(of);
    let name = format!("sized_{at}_{}", b.design.nets.len());
    let op = match width.cmp(&format.width()) {
        std::cmp::Ordering::Less => Op::Extend(of),
        std::cmp::Ordering::Equal => Op::Relabel(of),
        std::cmp::Ordering::Greater => {
            Op::Slice { of, low: random.within(0, width - format.width()) }
        }
    };
    b.op(&name, format, op)
}

fn cell(b: &mut Build, random: &mut Random, name: &str) {
    let a = any(b, random);
    let at = b.design.nets.len();
    let other = sized(b, random, at, a);
    let width = b.design.width(a);
    let same = random.format(width);
    let (format, op) = match random.below(14) {
        0 => {
            let bits = random.bits();
            b.net(name, same, Driver::Constant(bits));
            return;
        }
        1 => {
            let words: Vec<_> = (0..random.within(1, 9)).map(|_| random.bits()).collect();
            b.rom(name, same, a, random.below(2) == 0, &words);
            return;
        }
        2 => (same, Op::Not(a)),
        3 => (same, Op::And(a, other)),
        4 => (same, Op::Or(a, other)),
        5 => (same, Op::Xor(a, other)),
        6 => {
            let carry = bit(b, random);
            let carry = random.below(2).eq(&0).then_some(carry);
            (same, Op::Add { a, b: other, carry })
        }
        7 => (same, Op::Sub(a, other)),
        8 if width <= 32 => {
            let wide = random.format(2 * width);
            (wide, Op::Mul(a, other))
        }
        9 => (Format::BIT, Op::Equal(a, other)),
        10 => (Format::BIT, Op::Less(a, other)),
        11 => (Format::BIT, Op::All(a)),
        12 if width < 64 => {
            let bit = bit(b, random);
            (random.format(width + 1), Op::Concat(vec![bit, a]))
        }
        _ => {
            let inputs = random.within(2, 6);
            let of_select = b.register(&format!("{name}_select"), Format::unsigned(3, 0));
            let select = sized(b, random, at, of_select);
            b.of(of_select).data = Some(select);
            let inputs = (0..inputs).map(|_| sized(b, random, at, a)).collect::<Vec<_>>();
            (same, Op::Mux { select, inputs })
        }
    };
    b.op(name, format, op);
}

#[test]
fn random_netlists_behave_as_documented() {
    for seed in 0..300 {
        let mut random = Random(seed);
        let design = design(&mut random, seed % 4 == 3);
        let mut simulator: Simulator = Simulator::new(&design).unwrap();
        let mut reference = Interpreter::new(&design).unwrap();
        let mut inputs = vec![0; design.inputs().count()];
        for clock in 0..12 {
            for (at, port) in design.inputs().enumerate() {
                if random.below(3) > 0 {
                    let bits = random.pattern(design.width(port.net));
                    simulator.set(at, bits);
                    inputs[at] = bits;
                }
            }
            simulator.clock().unwrap();
            reference.settle(&inputs);
            reference.edge();
            reference.settle(&inputs);
            for (id, net) in visible(&design) {
                assert_eq!(
                    simulator.value(id),
                    reference.value(id),
                    "seed {seed}, clock {clock}, net `{}` of\n{design}",
                    net.name
                );
            }
        }
    }
}

#[test]
fn lanes_are_independent() {
    for seed in 0..20 {
        let mut random = Random(seed);
        let design = design(&mut random, seed % 4 == 3);
        let mut together = Simulator::<5>::new(&design).unwrap();
        let mut alone: [Simulator; 5] = [(); 5].map(|()| Simulator::new(&design).unwrap());
        for _ in 0..12 {
            for (at, port) in design.inputs().enumerate() {
                let lanes = [(); 5].map(|()| random.pattern(design.width(port.net)));
                together.set_lanes(at, lanes);
                alone.iter_mut().zip(lanes).for_each(|(s, bits)| s.set(at, bits));
            }
            together.clock().unwrap();
            alone.iter_mut().for_each(|s| s.clock().unwrap());
            for (id, _) in visible(&design) {
                let expected = [0, 1, 2, 3, 4].map(|lane| alone[lane].value(id));
                assert_eq!(together.lanes(id), expected, "seed {seed}");
            }
        }
    }
}

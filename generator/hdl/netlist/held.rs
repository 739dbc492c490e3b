//! Registers within what follows from the operands alone.
//!
//! Operands cannot change while the device is busy. What is computed from them and nothing else is *steady*: it
//! may take all the clocks from the first microinstruction, which every computation executes once after
//! `start`, to the one that first takes it. Registers within it shorten the paths of those clocks and cost none.
//! Outputs, which follow the operand registers at once, and what the first microinstruction takes stay without.

use super::needed::needed;
use super::{Design, Driver, NetId, Op, RegId, RegisterKind, Sequence};

/// Inserts registers, named `<name>_held`, so that the longest path from an operand becomes shortest; of equally
/// good places those with the fewest bits.
///
/// A device that waits for `start` in the middle of its program stays as it is: its operands change there.
pub fn register_held(design: &mut Design) {
    let microprogram = &design.control.microprogram;
    if microprogram.iter().any(|it| it.sequence == Sequence::WaitStart) {
        return;
    }
    for (net, readers) in Steady::of(design).best() {
        let q = add_register(design, net);
        for reader in readers {
            match reader {
                Reader::Register(register) => design.registers[register.index()].data = Some(q),
                Reader::Cell(cell) => {
                    let Driver::Op(op) = &mut design.nets[cell.index()].driver else {
                        unreachable!("only cells read nets")
                    };
                    op.operands_mut().into_iter().filter(|it| **it == net).for_each(|it| *it = q);
                }
            }
        }
    }
}

/// Who reads a net.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reader {
    /// The data input of a register.
    Register(RegId),
    /// The cell that drives this net.
    Cell(NetId),
}

/// What depends on operands alone, and who reads it.
struct Steady<'a> {
    design: &'a Design,
    /// All nets, each after those that it depends on within a clock.
    order: Vec<NetId>,
    /// Whether a net depends on operand registers and constants alone, and on one operand at least.
    steady: Vec<bool>,
    readers: Vec<Vec<Reader>>,
    /// The clock, counted from that of the first microinstruction, in which a net's value first matters.
    needed: Vec<usize>,
    /// The estimated delay from the operand registers to a steady net, in hundredths of a nanosecond.
    arrival: Vec<u32>,
}

/// The nets that are followed by a register, each with the readers that take the register in its place.
type Cut = Vec<(NetId, Vec<Reader>)>;

/// The clocks from which on each net may be computed of what registers hold: by number of the net.
type Levels = Vec<usize>;

impl<'a> Steady<'a> {
    fn of(design: &'a Design) -> Self {
        let Ok(order) = design.levelise() else {
            unreachable!("a verified design has no combinational loop")
        };
        let count = design.nets.len();
        let mut it = Self {
            design,
            steady: vec![false; count],
            readers: vec![Vec::new(); count],
            needed: needed(design),
            arrival: vec![0; count],
            order,
        };
        for at in 0..it.order.len() {
            let net = it.order[at];
            let constant = |of: &NetId| matches!(design.net(*of).driver, Driver::Constant(_));
            match &design.net(net).driver {
                Driver::Register(id) => {
                    it.steady[net.index()] = design.register(*id).kind == RegisterKind::Operand;
                }
                Driver::Op(op) => {
                    let mut operands = op.operands();
                    operands.sort_unstable();
                    operands.dedup();
                    operands.retain(|of| !constant(of));
                    it.steady[net.index()] =
                        !operands.is_empty() && operands.iter().all(|of| it.steady[of.index()]);
                    let before = operands.iter().map(|of| it.arrival[of.index()]).max();
                    it.arrival[net.index()] = before.unwrap_or(0) + delay(design, op);
                    operands.iter().for_each(|of| it.readers[of.index()].push(Reader::Cell(net)));
                }
                Driver::Constant(_)
                | Driver::Rom(_)
                | Driver::Field(_)
                | Driver::Input
                | Driver::Undriven => {}
            }
        }
        for (number, register) in design.registers.iter().enumerate() {
            if let Some(data) = register.data {
                it.readers[data.index()].push(Reader::Register(RegId(number as u32)));
            }
        }
        it
    }

    /// The registers to insert.
    fn best(&self) -> Cut {
        let mut places: Vec<u32> = self
            .design
            .iter()
            .filter(|(net, _)| self.steady[net.index()] && self.needed[net.index()] > 0)
            .map(|(net, _)| self.arrival[net.index()])
            .collect();
        places.push(0);
        places.sort_unstable();
        places.dedup();
        let mut best: Option<((u32, u32), Cut)> = None;
        for (at, &first) in places.iter().enumerate() {
            for &second in &places[at..] {
                let levels = self.levels(first, second);
                let cut = self.cut(&levels);
                let bits = cut.iter().map(|(net, _)| self.design.width(*net)).sum();
                let cost = (self.longest(&cut), bits);
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, cut));
                }
            }
        }
        best.map_or_else(Vec::new, |(_, cut)| cut)
    }

    /// Cells that settle by `first` are computed in clock 0, by `second` in clock 1, others in clock 2; none
    /// later than it is needed. Wiring stands with those that read it, so that registers hold no copies.
    fn levels(&self, first: u32, second: u32) -> Levels {
        let mut levels = vec![0; self.design.nets.len()];
        for &net in &self.order {
            let arrival = self.arrival[net.index()];
            let wanted = usize::from(arrival > first) + usize::from(arrival > second);
            let own = self.steady[net.index()] && !self.is_operand(net);
            levels[net.index()] = if own { wanted.min(self.needed[net.index()]) } else { 0 };
        }
        for &net in self.order.iter().rev() {
            let driver = &self.design.net(net).driver;
            if self.steady[net.index()]
                && matches!(driver, Driver::Op(Op::Relabel(_) | Op::Extend(_) | Op::Concat(_)))
            {
                let readers = self.readers[net.index()].iter();
                let latest = readers.map(|&reader| self.level_of(reader, &levels)).min();
                levels[net.index()] = latest.unwrap_or(0).min(self.needed[net.index()]);
            }
        }
        levels
    }

    fn is_operand(&self, net: NetId) -> bool {
        matches!(self.design.net(net).driver, Driver::Register(_))
    }

    /// The clock from which on a reader computes. What is not steady takes its operands when it needs them.
    fn level_of(&self, reader: Reader, levels: &Levels) -> usize {
        match reader {
            Reader::Cell(cell) if self.steady[cell.index()] => levels[cell.index()],
            Reader::Cell(cell) => self.needed[cell.index()].min(3),
            Reader::Register(register) => {
                let q = self.design.register(register);
                match q.data {
                    Some(data) if q.enable.is_some() => self.needed[data.index()].min(3),
                    _ => 0,
                }
            }
        }
    }

    /// Steady cells, not operand registers, whose readers compute in a later clock.
    fn cut(&self, levels: &Levels) -> Cut {
        let mut cut = Vec::new();
        for (net, _) in self.design.iter() {
            if !self.steady[net.index()] || self.is_operand(net) || self.arrival[net.index()] == 0 {
                continue;
            }
            let readers = self.readers[net.index()].iter().copied();
            let later: Vec<Reader> = readers
                .filter(|&reader| self.level_of(reader, levels) > levels[net.index()])
                .collect();
            if !later.is_empty() {
                cut.push((net, later));
            }
        }
        cut
    }

    /// The longest path that starts at an operand register or at an inserted one, in hundredths of a nanosecond.
    fn longest(&self, cut: &Cut) -> u32 {
        let mut arrival: Vec<Option<u32>> = vec![None; self.design.nets.len()];
        let mut longest = 0;
        for &net in &self.order {
            match &self.design.net(net).driver {
                Driver::Register(_) if self.steady[net.index()] => arrival[net.index()] = Some(0),
                Driver::Op(op) => {
                    let starts = op.operands().into_iter().filter_map(|of| {
                        let held = cut.iter().find(|(net, _)| *net == of);
                        if held.is_some_and(|(_, to)| to.contains(&Reader::Cell(net))) {
                            Some(0)
                        } else {
                            arrival[of.index()]
                        }
                    });
                    let own = delay(self.design, op);
                    arrival[net.index()] = starts.max().map(|before| before + own);
                }
                _ => {}
            }
            longest = longest.max(arrival[net.index()].unwrap_or(0));
        }
        longest
    }
}

/// About how long a cell of an FPGA takes, with the wires to it, in hundredths of a nanosecond. Only which of
/// two places is the better one depends on it.
fn delay(design: &Design, op: &Op) -> u32 {
    let width = op.operands().iter().map(|&of| design.width(of)).max().unwrap_or(0);
    // Trees of LUTs with four inputs.
    let levels = |inputs: u32| inputs.max(2).next_power_of_two().ilog2().div_ceil(2);
    match op {
        Op::Relabel(_) | Op::Extend(_) | Op::Slice { .. } | Op::Concat(_) | Op::Not(_) => 0,
        Op::And(..) | Op::Or(..) | Op::Xor(..) => 70,
        Op::Mux { inputs, .. } => 80 * (inputs.len() as u32).next_power_of_two().ilog2(),
        Op::Any(_) | Op::All(_) => 90 * levels(width),
        Op::Equal(..) => 90 * levels(2 * width),
        // Carries of adders in a row ripple together.
        Op::Add { .. } | Op::Sub(..) | Op::Less(..) => {
            let in_a_row = op.operands().into_iter().any(|of| ends_in_a_sum(design, of));
            if in_a_row { 150 } else { 150 + 4 * width }
        }
        Op::Mul(..) if width <= 18 => 600,
        Op::Mul(..) => 850,
    }
}

/// Whether a net is a sum, or the product of operands too wide for one multiplier, or bits of one.
fn ends_in_a_sum(design: &Design, net: NetId) -> bool {
    match &design.net(net).driver {
        Driver::Op(Op::Relabel(of) | Op::Extend(of) | Op::Not(of) | Op::Slice { of, .. }) => {
            ends_in_a_sum(design, *of)
        }
        Driver::Op(Op::Mul(a, b)) => design.width(*a).max(design.width(*b)) > 18,
        Driver::Op(op) => matches!(op, Op::Add { .. } | Op::Sub(..)),
        _ => false,
    }
}

/// A register that takes `net` on every clock; the net that it drives.
fn add_register(design: &mut Design, net: NetId) -> NetId {
    let of = design.net(net).clone();
    let taken = |name: &String| design.nets.iter().any(|net| net.name == *name);
    let mut name = format!("{}_held", of.name);
    while taken(&name) {
        name.push('_');
    }
    // It holds 0 from power-up to the first clock.
    let range = (of.range.0.min(0), of.range.1.max(0));
    let doc = format!("{}, delayed by a clock: the operands do not change", of.name);
    let q = design.add_net(super::Net { name, range, block: None, doc, named: true, ..of });
    design.add_register(q, RegisterKind::Internal).data = Some(net);
    q
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::fixed::Format;
    use crate::hdl::dsl::{Designer, Step, end, hold, step, valid, wait_for_start};
    use crate::hdl::netlist::Interpreter;

    const BYTE: Format = Format::unsigned(8, 0);

    /// The sum of two operands is on an output at once, its cube in a register by the microprogram's load.
    fn device(program: fn(Step, Step) -> Vec<Step>) -> Design {
        let d = Designer::new("device");
        let (a, b) = (d.operand("a", BYTE), d.operand("b", BYTE));
        let shown = d.add("shown", a.q(), b.q());
        d.output("shown_out", shown);
        let sum = d.add("sum", a.q(), b.q());
        let square = d.mul("square", sum, sum);
        let cube = d.mul("cube", square, sum);
        let result = d.register("result", cube.format());
        result.takes(cube);
        d.output("result_out", result.q());
        let load = step("load", [result.load()]);
        d.microprogram(program(load, step("shown", [hold(), valid(), end()])));
        d.finish().unwrap_or_else(|mistakes| panic!("{mistakes}"))
    }

    /// What the two products read.
    fn factors(design: &Design) -> [Vec<&str>; 2] {
        ["square", "cube"].map(|name| {
            let inputs = design.combinational_inputs(design.find(name).expect("a product"));
            inputs.iter().map(|&net| design.net(net).name.as_str()).collect()
        })
    }

    #[test]
    fn registers_stand_where_they_halve_the_path_and_not_before_an_output() {
        let design = device(|load, end| vec![step("idle", []), load, end]);
        assert_eq!(factors(&design), [["sum", "sum"], ["square_held", "sum_held"]]);
        // With a clock more to spare each product has one to itself.
        let design = device(|load, end| vec![step("idle", []), step("settle", []), load, end]);
        assert_eq!(factors(&design), [["sum_held", "sum_held"], ["square_held", "sum_held"]]);
        let shown = design.find("shown_out").expect("an output");
        let sources = design.combinational_inputs(shown);
        assert_eq!(sources, [design.find("shown").expect("the sum shown")]);
    }

    #[test]
    fn operands_that_may_change_in_the_middle_of_a_program_are_not_held() {
        let design =
            device(|load, end| vec![step("idle", []), step("wait", [wait_for_start()]), load, end]);
        assert_eq!(factors(&design), [["sum", "sum"], ["square", "sum"]]);
    }

    #[test]
    fn results_come_from_the_operands_written_with_start() {
        let programs: [fn(Step, Step) -> Vec<Step>; 2] = [
            |load, end| vec![step("idle", []), load, end],
            |load, end| vec![step("idle", []), step("settle", []), load, end],
        ];
        for program in programs {
            let design = device(program);
            let mut device = Interpreter::new(&design).expect("no loop");
            let mut clock = |named: [u64; 5], shown: &str| {
                let inputs: Vec<u64> = design
                    .inputs()
                    .map(|port| match design.net(port.net).name.as_str() {
                        "a" => named[0],
                        "b" => named[1],
                        "start" => named[2],
                        "rst_n" => named[3],
                        _ => named[4],
                    })
                    .collect();
                device.settle(&inputs);
                let seen = [shown, "valid"].map(|name| device.value(design.find(name).unwrap()));
                device.edge();
                seen
            };
            clock([0; 5], "valid");
            for (a, b) in [(200, 100), (1, 2), (255, 255), (0, 0), (17, 4)] {
                clock([a, b, 1, 1, 1], "valid");
                // Others at the inputs, which are not written.
                assert_eq!(clock([3, 5, 0, 1, 0], "shown_out")[0], (a + b) & 0x1ff);
                let results = std::iter::repeat_with(|| clock([3, 5, 0, 1, 0], "result_out"));
                let result = results.take(9).find(|[_, valid]| *valid == 1);
                assert_eq!(result, Some([(a + b).pow(3), 1]));
            }
        }
    }
}

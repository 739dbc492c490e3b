//! Inserts registers into logic that depends only on operands, to shorten the longest path of a device.
//!
//! Operands cannot change while the device is busy. Logic that depends only on operands and constants is therefore *steady*: it
//! may take several clocks, up to the microinstruction that first uses its value. The module inserts no register before outputs,
//! or before nets that the first microinstruction uses.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::first_use::needed;
use crate::netlist::{Design, Driver, Net, NetId, Op, RegId, RegisterKind, Sequence};

/// Inserts registers `<name>_held` into steady logic, at most two on a path. The registers make the longest path from an
/// operand as short as the search finds, with the fewest bits among equally short paths.
///
/// A device that waits for `start` in the middle of its microprogram is not changed, because its operands may change there.
pub fn register_held(design: &mut Design) {
    let microprogram = &design.control.microprogram;
    if microprogram.iter().any(|it| it.sequence == Sequence::WaitStart) {
        return;
    }
    let steady = Steady::of(design);
    let cut = steady.cut(steady.best());
    let mut taken: HashSet<String> = design.nets.iter().map(|net| net.name.clone()).collect();
    for (net, readers) in cut {
        let q = add_register(design, net, &mut taken);
        for reader in readers {
            match reader {
                OperandReader::Register(register) => {
                    design.registers[register.index()].data = Some(q)
                }
                OperandReader::Cell(cell) => {
                    let Driver::Op(op) = &mut design.nets[cell.index()].driver else {
                        unreachable!("only cells read nets")
                    };
                    *op = op.map(|&operand| if operand == net { q } else { operand });
                }
            }
        }
    }
}

/// The number of positions that the search tries at a time, for each of the two registers on a path.
const TRIED: usize = 32;

#[derive(Clone, Copy, PartialEq, Eq)]
enum OperandReader {
    /// The data input of this register.
    Register(RegId),
    /// The cell that drives this net.
    Cell(NetId),
}

/// Two ascending limits that divide steady logic among three clocks. A limit is a delay from the operand registers in hundredths
/// of a nanosecond. A cell whose value arrives by the first limit is computed in clock 0, by the second in clock 1, and any other
/// in clock 2. The third entry is always 0. For example, with `[500, 900, 0]` a cell whose value arrives after 6 ns is computed
/// in clock 1.
type CutPlaces = [u32; 3];

/// The numbers that determine in which clock a cell is computed or a register is loaded. The clock is the number of entries that
/// are greater than the entry of [`CutPlaces`] at the same index. For example, `[600, 600, 0]` with the limits `[500, 900, 0]`
/// gives clock 1.
type Thresholds = [u32; 3];

/// Replaces the entries from index `needed` on by 0, so that the net is computed no later than in clock `needed`, its first use.
fn until(needed: usize, thresholds: Thresholds) -> Thresholds {
    std::array::from_fn(|clock| if needed > clock { thresholds[clock] } else { 0 })
}

/// Returns the clock in which a net is computed, counted from the first microinstruction, 0.
fn clock(thresholds: Thresholds, places: CutPlaces) -> usize {
    thresholds.iter().zip(places).filter(|(limit, place)| place < *limit).count()
}

struct OperandCell {
    net: NetId,
    /// The cell's delay, in hundredths of a nanosecond.
    delay: u32,
    /// The operands that are not constants.
    operands: Vec<NetId>,
}

/// The steady nets of a design, which depend on operands alone, and the readers of all nets.
struct Steady<'a> {
    design: &'a Design,
    /// Each cell after the cells on which it depends within a clock.
    cells: Vec<OperandCell>,
    /// The thresholds that determine in which clock each net is computed.
    thresholds: Vec<Thresholds>,
    /// For each net, whether a register may follow it: the net is steady, and not mere wiring of an operand register.
    holds: Vec<bool>,
    /// Each register with the net that it loads and the thresholds of its load.
    registers: Vec<(RegId, NetId, Thresholds)>,
    /// The estimated delays from the operand registers to the steady nets that may be computed later than in clock 0. The
    /// delays are in hundredths of a nanosecond, ascending from 0.
    places: Vec<u32>,
}

impl<'a> Steady<'a> {
    fn of(design: &'a Design) -> Self {
        let Ok(order) = design.levelise() else {
            unreachable!("a verified design has no combinational loop")
        };
        let count = design.nets.len();
        let needed = needed(design);
        // For each net, whether it depends on operand registers and constants alone, with at least one operand.
        let mut steady = vec![false; count];
        let mut arrival = vec![0; count];
        let mut cells = Vec::new();
        for net in order {
            match &design.net(net).driver {
                Driver::Register(id) => {
                    steady[net.index()] = design.register(*id).kind == RegisterKind::Operand;
                }
                Driver::Op(op) => {
                    let mut operands = op.operands();
                    operands.sort_unstable();
                    operands.dedup();
                    operands.retain(|of| !matches!(design.net(*of).driver, Driver::Constant(_)));
                    steady[net.index()] =
                        !operands.is_empty() && operands.iter().all(|of| steady[of.index()]);
                    let before = operands.iter().map(|of| arrival[of.index()]).max();
                    let delay = delay(design, op);
                    arrival[net.index()] = before.unwrap_or(0) + delay;
                    cells.push(OperandCell { net, delay, operands });
                }
                Driver::Constant(_)
                | Driver::Rom(_)
                | Driver::Field(_)
                | Driver::Input
                | Driver::Undriven => {}
            }
        }
        let mut thresholds = vec![[0; 3]; count];
        // For each net, the thresholds of its earliest reader.
        let mut read: Vec<Option<Thresholds>> = vec![None; count];
        let mut registers = Vec::new();
        for (number, register) in design.registers.iter().enumerate() {
            let Some(data) = register.data else { continue };
            let by = match register.enable {
                Some(_) => until(needed[data.index()], [u32::MAX; 3]),
                None => [0; 3],
            };
            note_reader(&mut read[data.index()], by);
            registers.push((RegId(number as u32), data, by));
        }
        for cell in cells.iter().rev() {
            let at = cell.net.index();
            let wiring = matches!(
                &design.net(cell.net).driver,
                Driver::Op(Op::Relabel(_) | Op::Extend(_) | Op::Concat(_))
            );
            // Wiring takes the thresholds of its readers, so that no register stores a copy of bits that another register has.
            let wanted = match (steady[at], wiring) {
                (false, _) => [u32::MAX; 3],
                (true, true) => read[at].unwrap_or([0; 3]),
                (true, false) => [arrival[at], arrival[at], 0],
            };
            thresholds[at] = until(needed[at], wanted);
            for &of in &cell.operands {
                note_reader(&mut read[of.index()], thresholds[at]);
            }
        }
        let mut holds = Vec::with_capacity(count);
        let mut places = BTreeSet::from([0]);
        for at in 0..count {
            let is_cell = matches!(design.nets[at].driver, Driver::Op(_));
            holds.push(steady[at] && is_cell && arrival[at] > 0);
            if steady[at] && needed[at] > 0 {
                places.insert(arrival[at]);
            }
        }
        let places = Vec::from_iter(places);
        Self { design, cells, thresholds, holds, registers, places }
    }

    /// Returns the limits with the shortest longest path, and among such limits with the fewest register bits. Tries all pairs
    /// of limits if there are few. Otherwise tries evenly spread pairs, then pairs near the best one, and so may miss a better
    /// pair.
    fn best(&self) -> CutPlaces {
        let mut windows = [(0, self.places.len() - 1); 2];
        loop {
            let tried = windows.map(|(low, high)| {
                let count = (high - low + 1).min(TRIED);
                let spread = (0..count).map(|at| low + at * (high - low) / (count - 1).max(1));
                spread.collect::<Vec<usize>>()
            });
            let mut pairs = Vec::new();
            for &first in &tried[0] {
                for &second in &tried[1] {
                    if second >= first {
                        pairs.push([first, second]);
                    }
                }
            }
            let cheapest = pairs.into_iter().min_by_key(|&pair| self.cost(self.at(pair)));
            let best = cheapest.unwrap_or([0, 0]);
            if windows.iter().all(|(low, high)| high - low < TRIED) {
                return self.at(best);
            }
            for ((window, tried), best) in windows.iter_mut().zip(tried).zip(best) {
                let at = tried.partition_point(|&it| it < best);
                *window = (tried[at.saturating_sub(1)], tried[(at + 1).min(tried.len() - 1)]);
            }
        }
    }

    fn at(&self, [first, second]: [usize; 2]) -> CutPlaces {
        [self.places[first], self.places[second], 0]
    }

    /// Returns whether a reader in clock `by` gets a register behind `net`.
    fn is_cut(&self, net: NetId, by: usize, places: CutPlaces) -> bool {
        self.holds[net.index()] && by > clock(self.thresholds[net.index()], places)
    }

    /// Returns the delay of the longest path, in hundredths of a nanosecond, and the number of bits of the inserted registers.
    fn cost(&self, places: CutPlaces) -> (u32, u32) {
        let mut arrival: Vec<Option<u32>> = vec![None; self.thresholds.len()];
        let mut held = vec![false; self.thresholds.len()];
        for register in &self.design.registers {
            if register.kind == RegisterKind::Operand {
                arrival[register.q.index()] = Some(0);
            }
        }
        let mut longest = 0;
        for cell in &self.cells {
            let own = clock(self.thresholds[cell.net.index()], places);
            let mut start = None;
            for &of in &cell.operands {
                let cut = self.is_cut(of, own, places);
                held[of.index()] |= cut;
                start = start.max(if cut { Some(0) } else { arrival[of.index()] });
            }
            let end = start.map(|before| before + cell.delay);
            arrival[cell.net.index()] = end;
            longest = longest.max(end.unwrap_or(0));
        }
        for &(_, data, by) in &self.registers {
            held[data.index()] |= self.is_cut(data, clock(by, places), places);
        }
        let mut bits = 0;
        for (net, is_held) in self.design.nets.iter().zip(held) {
            if is_held {
                bits += net.format.width();
            }
        }
        (longest, bits)
    }

    /// Returns the nets behind which registers are inserted, each with the readers that compute in a later clock and so read the
    /// register.
    fn cut(&self, places: CutPlaces) -> BTreeMap<NetId, Vec<OperandReader>> {
        let cells = self.cells.iter().flat_map(|cell| {
            let own = self.thresholds[cell.net.index()];
            cell.operands.iter().map(move |&of| (of, OperandReader::Cell(cell.net), own))
        });
        let registers =
            self.registers.iter().map(|&(id, data, by)| (data, OperandReader::Register(id), by));
        let mut cut = BTreeMap::<NetId, Vec<OperandReader>>::new();
        for (of, reader, by) in cells.chain(registers) {
            if self.is_cut(of, clock(by, places), places) {
                cut.entry(of).or_default().push(reader);
            }
        }
        cut
    }
}

/// Keeps the smaller of the thresholds in each entry; `earliest` is `None` before the first reader.
fn note_reader(earliest: &mut Option<Thresholds>, by: Thresholds) {
    let known = earliest.unwrap_or([u32::MAX; 3]);
    *earliest = Some(std::array::from_fn(|at| known[at].min(by[at])));
}

/// Estimates the delay of a cell and the wires to it on an FPGA, in hundredths of a nanosecond, only to compare positions of
/// registers.
fn delay(design: &Design, op: &Op) -> u32 {
    let width = op.operands().iter().map(|&of| design.width(of)).max().unwrap_or(0);
    // The number of levels of a tree of look-up tables with four inputs each.
    let levels = |inputs: u32| inputs.max(2).next_power_of_two().ilog2().div_ceil(2);
    match op {
        Op::Relabel(_) | Op::Extend(_) | Op::Slice { .. } | Op::Concat(_) | Op::Not(_) => 0,
        Op::And(..) | Op::Or(..) | Op::Xor(..) => 70,
        Op::Mux { inputs, .. } => 80 * (inputs.len() as u32).next_power_of_two().ilog2(),
        Op::Any(_) | Op::All(_) => 90 * levels(width),
        Op::Equal(..) => 90 * levels(2 * width),
        // The carry chains of adders in a row work at the same time, so that only the first one counts with its length.
        Op::Add { .. } | Op::Sub(..) | Op::Less(..) => {
            let in_a_row = op.operands().into_iter().any(|of| ends_in_a_sum(design, of));
            if in_a_row { 150 } else { 150 + 4 * width }
        }
        Op::Mul(..) if width <= 18 => 600,
        Op::Mul(..) => 850,
    }
}

/// Returns whether a net is a sum, a difference, or a product with a factor wider than 18 bits, apart from wiring and inversion.
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

/// Adds a register `<name>_held` that loads `net` on every clock. `_` is added until no net in `taken` has the name.
fn add_register(design: &mut Design, net: NetId, taken: &mut HashSet<String>) -> NetId {
    let of = design.net(net).clone();
    let mut name = format!("{}_held", of.name);
    while !taken.insert(name.clone()) {
        name.push('_');
    }
    // The register is 0 from power-up to its first load.
    let range = (of.range.0.min(0), of.range.1.max(0));
    let doc = format!("{}, delayed by one clock, because the operands do not change", of.name);
    let q = design.add_net(Net { name, range, block: None, doc, named: true, ..of });
    design.add_register(q, RegisterKind::Internal).data = Some(net);
    q
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsl::{Designer, Step, end, fixture, hold, step, valid, wait_for_start};
    use crate::netlist::Interpreter;
    use glint_base::fixed::{Format, Overflow, Rounding};

    const BYTE: Format = Format::unsigned(8, 0);

    /// Trying all pairs of thousands of positions would take too long.
    #[test]
    fn a_long_chain_is_cut_in_three() {
        let design = fixture::design(|d| {
            let x = d.operand("x", BYTE);
            let mut last = x.q();
            for number in 0..3000 {
                let sum = d.add(&format!("sum{number}"), last, x.q());
                let name = format!("part{number}");
                last = d.narrow(&name, sum, BYTE, Rounding::Truncate, Overflow::Wrap);
            }
            let y = d.register("y", BYTE);
            y.takes(last);
            d.output("y_out", y.q());
            let settle = (0..3).map(|at| step(&format!("settle{at}"), []));
            settle.chain([step("load", [y.load()])]).collect()
        });
        let name = |net: &crate::netlist::Net| {
            let number = net.name.strip_suffix("_held")?.trim_matches(char::is_alphabetic);
            number.parse::<u32>().ok()
        };
        let mut held: Vec<u32> = design.nets.iter().filter_map(name).collect();
        held.sort_unstable();
        // Register `y` loads the output of the third inserted register in the last clock.
        let [first, second, 2999] = held[..] else { panic!("{held:?}") };
        assert!((990..1010).contains(&first) && (1990..2010).contains(&second), "{held:?}");
    }

    #[test]
    fn operand_logic_can_be_kept() {
        let design = fixture::design(|d| {
            d.keep_operand_logic();
            let a = d.operand("a", BYTE).q();
            let y = d.register("y", Format::unsigned(32, 0));
            let square = d.mul("square", a, a);
            y.takes(d.mul("fourth", square, square));
            d.output("y_out", y.q());
            vec![step("load", [y.load()])]
        });
        assert!(design.nets.iter().all(|net| !net.name.ends_with("_held")));
    }

    /// An output shows the sum of two operands without a clock, and the microprogram loads the third power of the sum.
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
        // With one more clock before the load, a register lies before each product.
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

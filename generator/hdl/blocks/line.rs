//! Builds the accumulator for the angles along a scan line. The register `angle` starts at the operand `zeta_start`. Every
//! clock adds the operand `delta_zeta`, which may be negative.
//!
//! [`Line`] makes the operands, the adder, the mux, the register and the counter of intervals, and writes the microprogram. The
//! devices `quad-cosine` and `cosine-squared` use it.

use crate::dsl::{Counter, Designer, Mux, Register, Signal, end, jump_if, loop_while, step};
use glint_base::fixed::Format;

/// The numbers of an operand in the source's block diagram.
#[derive(Clone, Copy, Debug)]
pub struct OperandBlocks {
    /// The data input and the write strobe.
    pub inputs: (u16, u16),
    /// The operand's register.
    pub register: u16,
}

/// The numbers of the accumulator in the source's block diagram.
#[derive(Clone, Copy, Debug)]
pub struct LineBlocks {
    /// The operand `delta_zeta`, the difference between the angles of neighbouring points.
    pub delta: OperandBlocks,
    /// The operand `zeta_start`, the angle of the first point.
    pub start: OperandBlocks,
    /// The data input and the write strobe of the operand `length`, the number of intervals between points.
    pub length_inputs: (u16, u16),
    /// The counter of intervals.
    pub counter: u16,
    /// The adder of `delta_zeta` to the angle.
    pub adder: u16,
    /// The mux in front of the register `angle`.
    pub mux: u16,
    /// The register `angle`.
    pub register: u16,
    /// The control line `count`, which makes the counter of intervals count.
    pub count: u16,
    /// The control line `accumulate`, which selects the adder instead of `zeta_start` as the next angle.
    pub select: u16,
    /// The control line `write_angle`, which loads the register `angle`.
    pub write: u16,
}

/// The accumulator of a scan line: the operands `delta_zeta`, `zeta_start` and `length`, and the register `angle`. The outputs
/// `count`, `accumulate` and `write_angle` show the control lines.
///
/// A line of l = `length` intervals has l + 1 points, one a clock. The angle is a signed number that wraps around, so its format
/// must represent every angle of a line, or wrap at a full turn.
pub struct Line<'d> {
    designer: &'d Designer,
    start: Signal<'d>,
    sum: Signal<'d>,
    next: Mux<'d>,
    angle: Register<'d>,
    intervals: Counter<'d>,
    empty: Signal<'d>,
    more: Signal<'d>,
}

impl<'d> Line<'d> {
    /// Makes a line with angles of `format`, which must be signed, and up to 2^`length_bits` − 1 intervals: 12 bits allow 4096
    /// points. `blocks` are the numbers in the source's block diagram, if it has numbers.
    #[track_caller]
    pub fn new(
        d: &'d Designer,
        format: Format,
        length_bits: i32,
        blocks: Option<LineBlocks>,
    ) -> Self {
        let delta =
            d.operand("delta_zeta", format).doc("angle step from point to point, in right angles");
        let mut start =
            d.operand("zeta_start", format).doc("angle of the first point, in right angles");
        let mut length = d
            .operand("length", Format::unsigned(length_bits, 0))
            .doc("number of intervals: the number of points minus 1");
        let mut angle = d
            .register("angle", format)
            .doc("angle of the current point, in right angles; wraps around");
        let mut sum =
            d.add_modulo("next_angle", angle.q(), delta.q(), None).doc("angle of the next point");
        let mut next =
            d.mux("angle_source", [start.q(), sum]).doc("angle of the first point, or of the next");
        let mut intervals = d.down_counter("intervals", length.q()).doc("intervals that remain");
        if let Some(blocks) = blocks {
            let OperandBlocks { inputs, register } = blocks.delta;
            let _ = delta.block(register).inputs(inputs.0, inputs.1);
            let OperandBlocks { inputs, register } = blocks.start;
            start = start.block(register).inputs(inputs.0, inputs.1);
            length = length.inputs(blocks.length_inputs.0, blocks.length_inputs.1);
            sum = sum.block(blocks.adder);
            next = next.block(blocks.mux).line(blocks.select);
            angle = angle.block(blocks.register).line(blocks.write);
            intervals = intervals.block(blocks.counter).line(blocks.count);
        }
        angle.takes(next.out());
        let none = d.raw_constant("no_interval", 0, length.q().format());
        let empty = d.equal("empty", length.q(), none).doc("1 if the line has one point");
        let last = d.raw_constant("last_interval", 1, length.q().format());
        let more = d.less("more", last, intervals.q()).doc("1 if this is not the last interval");
        let shown = [
            ("count", intervals.counting(), "counts down the intervals"),
            ("accumulate", next.select(), "1 for a next point, 0 for the first"),
            ("write_angle", angle.loading(), "writes the angle of a point"),
        ];
        let numbers = blocks.map(|blocks| [blocks.count, blocks.select, blocks.write]);
        for (at, (name, line, doc)) in shown.into_iter().enumerate() {
            let output = d.status(name, line).doc(doc);
            if let Some(numbers) = numbers {
                let _ = output.block(numbers[at]);
            }
        }
        Self { designer: d, start: start.q(), sum, next, angle, intervals, empty, more }
    }

    /// Returns the angle of the current point.
    pub fn angle(&self) -> Signal<'d> {
        self.angle.q()
    }

    /// Sets the microprogram of a device that only computes lines. `clocks` is the number of clocks from a microinstruction that
    /// loads an angle to its results on the outputs, where `valid` is high. Count one for the register of the angle, and one for
    /// every further register up to the outputs. A value of 0 counts as 1.
    #[track_caller]
    pub fn microprogram(&self, clocks: u32) {
        let delay = clocks.max(1);
        self.designer.valid_after(self.angle.loading(), delay);
        let mut steps = vec![
            step("operands", []),
            step(
                "angle <- zeta_start: first point",
                [
                    self.next.pick(self.start),
                    self.angle.load(),
                    self.intervals.load(),
                    jump_if(self.empty, &drain(delay - 1)),
                ],
            ),
            step(
                "angle <- angle + delta_zeta: next point",
                [
                    self.next.pick(self.sum),
                    self.angle.load(),
                    self.intervals.count(),
                    loop_while(self.more, "angle <- angle + delta_zeta: next point"),
                ],
            ),
        ];
        for left in (1..delay).rev() {
            steps.push(step(&drain(left), []));
        }
        steps.push(step(&drain(0), [end()]));
        self.designer.microprogram(steps);
    }
}

/// Names the microinstruction in which the results of the last point reach the outputs after `left` clocks.
fn drain(left: u32) -> String {
    match left {
        0 => "last point on the output".to_owned(),
        1 => "last point follows in one clock".to_owned(),
        left => format!("last point follows in {left} clocks"),
    }
}

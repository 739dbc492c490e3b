//! Models two blocks of [seed 000](crate#symbols) that the devices `quad-cosine` and `cosine-squared` share. They are the
//! accumulator that computes the angles of the points along a scan line, and the table of powers of a cosine.
//!
//! The accumulator begins with the operand `zeta_start` and adds `delta_zeta` for every further point. Angles are in right
//! angles: with F fraction bits, the raw value 2^F is 90°.

use std::f64::consts::FRAC_PI_2;

use super::Operand;
use super::contract::control;
use super::frame::{Frame, FrameStep, Slot, idle, step};
use glint_base::fixed::{Format, MAX_WIDTH, exp2};

/// Returns the raw value of `operand` that is nearest to `angle` (in radians) and in the domain. For example, π/4 gives 32768
/// with 16 fraction bits.
pub fn raw_angle(operand: &Operand, angle: f64) -> i64 {
    let (low, high) = operand.domain;
    let raw = operand.format.quantise(angle / FRAC_PI_2) as i64;
    raw.clamp(low, high)
}

/// Adds the accumulator to `frame`: control block 14, counter 5, adder 6, mux 7 and register 8 of seed 000. Its operands are
/// `delta_zeta`, `zeta_start` and `length`. The angles have the format `format`.
///
/// Returns the slot of register 8, which holds the angle of the current point, and the microinstructions. The outputs show a
/// point `stages` clocks after the pulse on output 37 (`write_angle`) that loads its angle.
pub fn walker(
    frame: &mut Frame,
    format: Format,
    length_bits: u32,
    stages: u32,
) -> (Slot, Vec<FrameStep>) {
    frame.delay_valid(stages);
    let [delta, start] = ["delta_zeta", "zeta_start"].map(|name| frame.operand(name, format));
    let length = frame.operand("length", length_format(length_bits));
    // Counter 5: intervals still to go.
    let intervals = frame.register("intervals", length_format(length_bits));
    let angle = frame.register("angle", format);
    // Outputs 34, 36 and 37 of control block 14.
    let [count, accumulate, write_angle] =
        ["count", "accumulate", "write_angle"].map(|name| frame.flag(name));
    // The first pulse on output 37 loads ζ(X_start), and the counter is set to l.
    let first = step(move |s| {
        s[angle] = s[start];
        s[intervals] = s[length];
    })
    .skip_if(1, move |s| s[length] == 0);
    // Each of the others adds Δζ and counts, until the counter comes to 0.
    let next = step(move |s| {
        s[angle] = wrapped(format, s[angle] + s[delta]);
        s[intervals] -= 1;
    })
    .repeat_while(move |s| s[intervals] > 1);
    let mut program = vec![
        idle(),
        first.valid().asserts(write_angle),
        next.valid().asserts(write_angle).asserts(count).asserts(accumulate),
    ];
    // The device waits until the last point is on the outputs.
    program.extend((1..stages).map(|_| idle()));
    program.push(idle().end());
    (angle, program)
}

fn length_format(length_bits: u32) -> Format {
    Format::unsigned(length_bits as i32, 0)
}

/// Wraps the raw angle to the width of `format`, as the accumulator does. For example, 32 wraps to −32 in `s1.4`, which has 6
/// bits.
#[inline]
fn wrapped(format: Format, raw: i64) -> i64 {
    let above = MAX_WIDTH - format.width();
    raw << above >> above
}

/// Returns the raw angle of point number `index` of a line, wrapped as in the accumulator. `start` is the first angle and `delta`
/// the step.
#[inline]
pub fn angle_at(format: Format, start: i64, delta: i64, index: u64) -> i64 {
    wrapped(format, start.wrapping_add(delta.wrapping_mul(index as i64)))
}

/// Returns the raw step of a line of `length` intervals from the angle `first` to the angle `last`, rounded toward 0. Returns
/// `given` if `length` is 0. For example, 3 intervals from 0 to 300 have the step 100.
pub fn interval(first: i64, last: i64, length: i64, given: i64) -> i64 {
    if length == 0 { given } else { (last - first) / length }
}

/// Returns a Python expression for the angle of point number `index`, in right angles. For `s1.16` it is `((zeta_start + index *
/// delta_zeta + 2) % 4 - 2)`.
pub fn angle_expression(format: Format) -> String {
    let turn = exp2(format.width() as i32 - format.frac);
    let half = turn / 2.0;
    format!("((zeta_start + index * delta_zeta + {half}) % {turn} - {half})")
}

/// Returns the operands `delta_zeta` and `zeta_start`, with every value of `format` in their domain.
pub fn angle_operands(format: Format) -> [Operand; 2] {
    let domain = (format.min_raw() as i64, format.max_raw() as i64);
    [
        ("delta_zeta", "angle from a point to the next, in right angles"),
        ("zeta_start", "angle of the first point, in right angles"),
    ]
    .map(|(name, doc)| control(name, format, domain, doc))
}

/// Returns the operand `length`, with every value of `length_bits` bits in its domain.
pub fn length_operand(length_bits: u32) -> Operand {
    let format = length_format(length_bits);
    let doc = "intervals of the line: one less than its points";
    control("length", format, (0, format.max_raw() as i64), doc)
}

/// Returns the leading `kept` fraction bits of the magnitude of a raw `angle` with `fraction` fraction bits. Returns `None`
/// unless −90° ≤ angle < 90°. The magnitude of a negative angle is its bitwise complement. For example, with `fraction` 4 and
/// `kept` 4, 5 and −6 give 5, and 16 gives `None`.
#[inline]
pub fn magnitude(angle: i64, fraction: u32, kept: u32) -> Option<i64> {
    let right = 1i64 << fraction;
    if !(-right..right).contains(&angle) {
        return None;
    }
    let positive = if angle < 0 { -1 - angle } else { angle };
    Some(positive >> (fraction - kept))
}

/// An upper limit of the f64 rounding errors in a table's values.
const SLACK: f64 = 1.0 / (1u64 << 40) as f64;

/// A table of `cosᵏ` over a right angle, ROM 12 of seed 000. A step is an interval of angles with one word: the mean of `cosᵏ` at
/// the ends of the step. The last word is 0.
#[derive(Clone, Debug)]
pub struct CosineTable {
    /// Raw words with `fraction` fraction bits ([`CosineTable::new`]), one for each step.
    pub words: Vec<i64>,
    /// The largest distance between `cosᵏ` at an end of a step and the unrounded word.
    pub step: f64,
    /// The largest distance between `cosᵏ` at an end of a step and the rounded word, plus a margin for the errors of f64.
    pub total: f64,
    /// The largest slope of `cosᵏ`: the change for each right angle.
    pub slope: f64,
}

impl CosineTable {
    /// Makes 2^`address` steps, whose words have `fraction` fraction bits. k is `power`, a power of two.
    pub fn new(power: u32, address: u32, fraction: u32) -> Self {
        let steps = 1u64 << address;
        let one = exp2(fraction as i32);
        // By the angle's complement: cos(90° · step/steps) = sin(90° · (steps − step)/steps).
        let value = |step: u64| {
            let back = (steps - step) as f64 / steps as f64;
            let cosine = libm::sin(back * std::f64::consts::FRAC_PI_2);
            libm::pow(cosine, f64::from(power))
        };
        let mut table = Self { words: Vec::new(), step: 0.0, total: 0.0, slope: slope(power) };
        for step in 0..steps {
            let (high, low) = (value(step), value(step + 1));
            let exact = if step + 1 == steps { 0.0 } else { 0.5 * (high + low) };
            let word = (exact * one + 0.5).floor().min(one - 1.0);
            let off = |from: f64| (high - from).abs().max((from - low).abs());
            table.step = table.step.max(off(exact));
            table.total = table.total.max(off(word / one));
            table.words.push(word as i64);
        }
        table.total += SLACK;
        table
    }

    /// Returns the index of the word for the raw angle `scaled`, which has `fraction` fraction bits and is in right angles. The
    /// table has 2^`address` words. Negative angles, and angles of a right angle or more, give the last index. For example, half
    /// a right angle gives the index 128 in a table of 256 words.
    #[inline]
    pub fn address(scaled: i64, fraction: u32, address: u32) -> usize {
        let most = (1usize << address) - 1;
        usize::try_from(scaled >> (fraction - address)).map_or(most, |step| step.min(most))
    }
}

/// Returns the largest slope of `cosᵏ` with k = `power`: the change for each right angle. It is at the angle with `tan² = 1/(k −
/// 1)`.
fn slope(power: u32) -> f64 {
    let k = f64::from(power);
    if power == 1 {
        return std::f64::consts::FRAC_PI_2;
    }
    let cosine = (1.0 - 1.0 / k).sqrt();
    k * libm::pow(cosine, k - 1.0) * (1.0 / k).sqrt() * std::f64::consts::FRAC_PI_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_wrap_as_the_circle_does() {
        // s1.4: right angles of 16 raw, a turn of 64.
        let format = Format::signed(1, 4);
        assert_eq!(angle_at(format, 30, 1, 1), 31);
        assert_eq!(angle_at(format, 30, 1, 2), -32);
        assert_eq!(angle_at(format, -32, -1, 1), 31);
        assert_eq!(angle_at(format, 5, -32, 4095), 5 - 32);
    }

    #[test]
    fn magnitudes_by_hand() {
        // 4 fraction bits, 2 kept: 13/16 → 3/4; −1/16 is 0 complemented, −13/16 is 12/16.
        assert_eq!(magnitude(13, 4, 2), Some(3));
        assert_eq!(magnitude(-1, 4, 4), Some(0));
        assert_eq!(magnitude(-13, 4, 4), Some(12));
        assert_eq!(magnitude(15, 4, 4), Some(15));
        assert_eq!(magnitude(16, 4, 4), None);
        assert_eq!(magnitude(-16, 4, 4), Some(15));
        assert_eq!(magnitude(-17, 4, 4), None);
    }

    #[test]
    fn a_table_by_hand() {
        // cos² at 0, 22.5, 45, 67.5 and 90 degrees: 1, 0.8536, 0.5, 0.1464, 0; times 16, middles of the steps.
        let table = CosineTable::new(2, 2, 4);
        assert_eq!(table.words, [15, 11, 5, 0]);
        assert!((table.step - 0.1768).abs() < 1e-4, "{}", table.step);
        // cos⁴ has its steepest slope at 30 degrees: 4 · 0.6495 · 0.5 a radian.
        assert!((slope(4) - 1.299 * FRAC_PI_2).abs() < 1e-3);
        assert_eq!(slope(1), std::f64::consts::FRAC_PI_2);
        assert!((slope(2) - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        // 0.75 with 3 fraction bits in 4 steps; 1.0 and more in the last.
        assert_eq!(CosineTable::address(6, 3, 2), 3);
        assert_eq!(CosineTable::address(5, 3, 2), 2);
        assert_eq!(CosineTable::address(80, 3, 2), 3);
    }
}

//! Builds hardware for cosines of angles: it takes the magnitude of a signed angle and addresses a table of cosᵏ. The devices of
//! scan lines, such as `quad-cosine`, use it.
//!
//! Angles are in right angles, so 90° is 1.0. A signed angle is in the range −90° ≤ angle < 90° exactly if all its integer bits
//! equal its sign bit. The fraction bits of its magnitude address a table without any conversion.

use crate::dsl::{Designer, Signal};
use glint_base::fixed::{Format, Overflow, Rounding, exp2};

/// The result of [`fold`].
#[derive(Clone, Copy)]
pub struct Folded<'d> {
    /// A fraction of a right angle, meaningful only if `within` is 1.
    pub magnitude: Signal<'d>,
    /// 1 if the angle lies in −90° ≤ angle < 90°.
    pub within: Signal<'d>,
}

/// Returns the magnitude of a signed `angle` with `fraction` fraction bits; the angle must have at least this number. For
/// example, in `s1.4` the raw angles 5 and −6 both have the magnitude 5.
///
/// The magnitude of a negative angle is the complement of its bits, which needs no adder. This magnitude is smaller than the
/// exact magnitude by up to one unit in the last place, as truncation makes a positive angle smaller too.
#[track_caller]
pub fn fold<'d>(d: &'d Designer, angle: Signal<'d>, fraction: i32) -> Folded<'d> {
    let Format { int, frac, .. } = angle.format();
    let name = angle.name();
    let sign = angle.bit((int + frac) as u32).named(&format!("{name}_negative"));
    let upper =
        angle.bits(frac as u32, Format::unsigned(int + 1, 0)).named(&format!("{name}_upper"));
    let positive =
        d.not(&format!("{name}_small_positive"), d.any(&format!("{name}_upper_any"), upper));
    let negative = d.all(&format!("{name}_small_negative"), upper);
    let within = d
        .or(&format!("{name}_within"), positive, negative)
        .doc("1 from -90 degrees to less than 90: sign and integer bits agree");
    let leading = angle
        .bits((frac - fraction) as u32, Format::unsigned(0, fraction))
        .named(&format!("{name}_leading"));
    let complement = d.not(&format!("{name}_complement"), leading);
    let magnitude = d
        .choose(&format!("{name}_magnitude"), sign, [leading, complement])
        .doc("absolute angle, because cos is even");
    Folded { magnitude, within }
}

/// Returns the address of a [`cosine_power_table`] for the unsigned angle `scaled`, in right angles: its first `bits` fraction
/// bits. For example, 0.75 gives the address 3 with 2 bits. An angle of a right angle or more, or with `within` 0, gets the last
/// word.
#[track_caller]
pub fn address<'d>(
    d: &'d Designer,
    name: &str,
    scaled: Signal<'d>,
    within: Signal<'d>,
    bits: i32,
) -> Signal<'d> {
    let (limited, format) = (format!("{name}_limited"), Format::unsigned(0, bits));
    let leading = d.narrow(&limited, scaled, format, Rounding::Truncate, Overflow::Saturate);
    let step = leading.read_as(Format::unsigned(bits, 0));
    let last = d.raw_constant(&format!("{name}_last"), (1 << bits) - 1, step.format());
    d.choose(name, within, [last, step])
}

/// Returns the words of a table of `cosᵏ` over a right angle, for the power k = `power`. The words are raw values in `u0.F`
/// with F = `fraction`.
///
/// The table has 2^`bits` steps. A word is the mean of the values at the two ends of its step. The last word is 0, because it
/// also serves all larger angles.
pub fn cosine_power_table(power: u32, bits: i32, fraction: i32) -> Vec<i128> {
    let format = Format::unsigned(0, fraction);
    let steps = 1u32 << bits;
    let mut values = Vec::new();
    for step in 0..steps {
        let angle = f64::from(step) * exp2(-bits) * std::f64::consts::FRAC_PI_2;
        let cosine = libm::cos(angle);
        values.push((0..power).fold(1.0, |product, _| product * cosine));
    }
    let mut words: Vec<i128> = Vec::new();
    for ends in values.windows(2) {
        words.push(format.quantise((ends[0] + ends[1]) / 2.0));
    }
    words.push(0);
    words
}

/// Returns the comments of a table from [`cosine_power_table`]: the angle at which each step begins. Word 1 of 2048 for the
/// square has `cos^2, 0.044 degrees`. The last comment ends with `and on`.
pub fn step_comments(power: u32, bits: i32) -> Vec<String> {
    let steps = 1u32 << bits;
    let mut comments = Vec::new();
    for step in 0..steps {
        let degrees = f64::from(step) * exp2(-bits) * 90.0;
        let on = if step + 1 == steps { " and on" } else { "" };
        comments.push(format!("cos^{power}, {degrees:.3} degrees{on}"));
    }
    comments
}

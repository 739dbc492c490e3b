//! Builds shifters whose shift amount is known only at run time, from rows of muxes.

use crate::dsl::{Designer, Signal};
use glint_base::fixed::Format;

/// Divides `x` by 2^`places`, and rounds down to the fraction bits that `x` has: 13 in `u4.0` by 2 places gives 3, and −13 in `s4.0`
/// gives −4. `places` must be an unsigned integer. The barrel shifter has a row of muxes for each bit of `places`.
#[track_caller]
pub fn right_by<'d>(d: &'d Designer, name: &str, x: Signal<'d>, places: Signal<'d>) -> Signal<'d> {
    let format = x.format();
    // The largest shift comes first, so that a value that it has made narrow stays narrow in the rows that follow.
    (0..places.format().width()).rev().fold(x, |row, bit| {
        let step = 1u32.checked_shl(bit).unwrap_or(u32::MAX);
        let width = row.format().width();
        let have = row.format();
        let shifted = if step < width {
            row.bits(step, Format { int: have.int - step as i32, ..have })
        } else if have.signed {
            row.bits(width - 1, Format { int: -have.frac, ..have })
        } else {
            d.raw_constant("zeros", 0, Format::unsigned(1 - format.frac, format.frac))
        };
        d.choose(&format!("{name}_by{step}"), places.bit(bit), [row, shifted])
    })
}

#[derive(Clone, Copy)]
pub struct Normalised<'d> {
    /// The shifted bits, an unsigned integer of the same width.
    pub word: Signal<'d>,
    /// The number of leading zeros, or of pairs of them for [`normalise_by_pairs`], as an unsigned integer.
    pub zeros: Signal<'d>,
}

/// Shifts `x` to the left until its top bit is 1: 22 in 8 bits has 3 leading zeros and becomes 176.
///
/// Each row of muxes gives one bit of `zeros`, which therefore needs no encoder. If `x` is 0, all bits of `zeros` are 1. A
/// signal of one bit is not shifted, and `zeros` is always 0.
#[track_caller]
pub fn normalise<'d>(d: &'d Designer, name: &str, x: Signal<'d>) -> Normalised<'d> {
    normalise_in_steps(d, name, x, 1)
}

/// Shifts `x` to the left by pairs of places until one of its two top bits is 1: 22 in 8 bits has one pair of leading zeros and
/// becomes 88. If `x` is 0, all bits of `zeros` are 1. A signal of one or two bits is not shifted, and `zeros` is always 0.
#[track_caller]
pub fn normalise_by_pairs<'d>(d: &'d Designer, name: &str, x: Signal<'d>) -> Normalised<'d> {
    normalise_in_steps(d, name, x, 2)
}

/// Shifts `x` to the left by multiples of `least` places until one of its `least` top bits is 1, and returns only the shifted
/// bits. `least` must be a power of two. For example, 22 in 8 bits becomes 176 with `least` 1, and 88 with `least` 2.
#[track_caller]
pub fn left_justified<'d>(d: &'d Designer, name: &str, x: Signal<'d>, least: u32) -> Signal<'d> {
    shift_rows(d, name, x, least, None)
}

/// Shifts as [`left_justified`] does, and also returns the number of places in units of `least`.
#[track_caller]
fn normalise_in_steps<'d>(
    d: &'d Designer,
    name: &str,
    x: Signal<'d>,
    least: u32,
) -> Normalised<'d> {
    let mut count = Vec::new();
    let word = shift_rows(d, name, x, least, Some(&mut count));
    let zeros = if count.is_empty() {
        d.raw_constant("zeros", 0, Format::BIT)
    } else {
        let format = Format::unsigned(count.len() as i32, 0);
        d.join(&format!("{name}_zeros"), &count, format)
    };
    Normalised { word, zeros }
}

/// Builds the rows of muxes of [`left_justified`]. With `count`, each row appends a bit that is 1 if the row shifts, the largest
/// shift first.
#[track_caller]
fn shift_rows<'d>(
    d: &'d Designer,
    name: &str,
    x: Signal<'d>,
    least: u32,
    mut count: Option<&mut Vec<Signal<'d>>>,
) -> Signal<'d> {
    let width = x.format().width();
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let mut word = x.read_as(integer(width));
    for bit in (0..(width - 1).max(1).ilog2() + 1).rev() {
        let step = 1u32 << bit;
        if step >= width || step < least {
            continue;
        }
        let stays = d.any(&format!("{name}_top{step}"), word.bits(width - step, integer(step)));
        let shifted =
            word.bits(0, integer(width - step)).with_fraction(step as i32).shift_left(step as i32);
        word = d.choose(&format!("{name}_by{step}"), stays, [shifted, word]);
        if let Some(count) = &mut count {
            count.push(d.not(&format!("{name}_free{step}"), stays));
        }
    }
    word
}

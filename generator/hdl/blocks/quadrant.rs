//! Builds hardware that maps an angle in any quadrant to the first quadrant, so that a table of one quadrant gives every sine.
//! For example, sin 200° = −sin 20°: the distance from the nearer zero of the sine is 20°, and the sign is negative.

use crate::dsl::{Designer, Signal};
use glint_base::fixed::Format;

/// An angle, mapped to the first quadrant: |sin| of the angle is the sine of `way`.
#[derive(Clone, Copy)]
pub struct Quadrant<'d> {
    /// The distance of the angle from the nearer zero of the sine, in steps of the angle's format, less than a quarter turn.
    pub way: Signal<'d>,
    /// 1 if the sine is negative.
    pub negative: Signal<'d>,
}

/// Maps the angle `turn` to the first quadrant. `turn` must be an unsigned integer whose range is one whole turn; for example, 64
/// steps in `u6.0`. `ahead` quadrants (0 to 3) are added to the angle first, so that 1 gives the cosine.
///
/// Step 20 of 64 is in the second quadrant, 12 steps before the next zero of the sine. A distance of a whole quarter turn becomes
/// one step less, as in [`mirrored`].
#[track_caller]
pub fn quadrant<'d>(d: &'d Designer, name: &str, turn: Signal<'d>, ahead: u32) -> Quadrant<'d> {
    let steps = turn.format().width() - 2;
    let number = turn.bits(steps, Format::unsigned(2, 0));
    let number = match ahead {
        0 => number,
        _ => {
            let ahead = d.raw_constant("ahead", ahead.into(), number.format());
            d.add_modulo(&format!("{name}_number"), number, ahead, None)
        }
    };
    let way = turn.bits(0, Format::unsigned(steps as i32, 0));
    let back = mirrored(d, &format!("{name}_back"), way);
    let way = d.choose(&format!("{name}_way"), number.bit(0), [way, back]);
    Quadrant { way, negative: number.bit(1) }
}

/// Returns 2^w − `way` for the w bits of the unsigned integer `way`, or the largest number for `way` 0. With 4 bits, 5 gives 11,
/// and 0 gives 15.
#[track_caller]
pub fn mirrored<'d>(d: &'d Designer, name: &str, way: Signal<'d>) -> Signal<'d> {
    let format = way.format();
    let zero = d.raw_constant("zero", 0, format);
    let rest = d.sub(&format!("{name}_rest"), zero, way).bits(0, format);
    let most = d.raw_constant("most", format.max_raw(), format);
    d.choose(name, d.any(&format!("{name}_any"), way), [most, rest])
}

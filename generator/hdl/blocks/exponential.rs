//! 2^−y for y ≥ 0: the fraction of y by tables, the integer by a shift.

use super::multipartite::{self, Cut};
use super::shift;
use crate::dsl::{Designer, Signal};
use glint_base::fixed::{Format, Overflow, Rounding, exp2};

/// Formats of the exponential.
#[derive(Clone, Debug)]
pub struct ExponentialFormats {
    /// How the fraction of y is cut; y has as many fraction bits.
    pub cut: Cut,
    /// Fraction bits of the tables.
    pub fraction: i32,
    /// The tables are read on the rising edge.
    pub synchronous: bool,
}

/// `2^−y` as `u0.F`, F = `frac`, rounded as said; what rounds to 1.0 becomes the largest fraction.
///
/// Over its fraction x, 2^−x is the line 1 − x/2, which is ½ beside the inverse of x and costs nothing, less
/// a bend of at most 0.043, which is what the tables hold: they are four bits narrower than tables of 2^−x.
///
/// With `shape.synchronous` the result belongs to the fraction of y of the clock before, and to the integer of
/// this one: hold y for two clocks.
#[track_caller]
pub fn halvings<'d>(
    d: &'d Designer,
    name: &str,
    y: Signal<'d>,
    shape: &ExponentialFormats,
    frac: i32,
    rounding: Rounding,
) -> Signal<'d> {
    let bits = shape.cut.bits();
    let x = y.bits(0, Format::unsigned(0, bits as i32));
    let whole = y.bits(bits, Format::unsigned(y.format().int, 0));
    let bend = multipartite::evaluate(
        d,
        &format!("{name}_bend"),
        x,
        &shape.cut,
        shape.fraction,
        shape.synchronous,
        ("1 - x/2 - 2^-x", |x| bend(x, bits)),
    );
    let x = if shape.synchronous { d.pipeline(&format!("{name}_x"), x) } else { x };
    let half = d.raw_constant("half", 1, Format::BIT);
    let inverse = d.not(&format!("{name}_inverse"), x);
    let line =
        d.join(&format!("{name}_line"), &[half, inverse], Format::unsigned(0, bits as i32 + 1));
    let mantissa = d.sub(&format!("{name}_mantissa"), line, bend).doc("2^-x of the fraction x");
    // Bits that a shift by 0 would drop are never seen; one more than the result has decides the rounding.
    let kept = match rounding {
        Rounding::Truncate => frac,
        Rounding::Nearest => frac + 1,
    };
    let mantissa = d.narrow(
        &format!("{name}_kept"),
        mantissa,
        Format::unsigned(0, kept),
        Rounding::Truncate,
        Overflow::Saturate,
    );
    let shifted = shift::right_by(d, &format!("{name}_shift"), mantissa, whole);
    d.narrow(
        &format!("{name}_rounded"),
        shifted,
        Format::unsigned(0, frac),
        rounding,
        Overflow::Saturate,
    )
}

/// The contents of the tables: the line as it is wired, which lacks half an ulp of x, less 2^−x. The tables take x at
/// the middle of an ulp, where the wired line is a quarter of an ulp below 1 − x/2.
fn bend(x: f64, bits: u32) -> f64 {
    1.0 - x / 2.0 - exp2(-(bits as i32) - 2) - libm::exp2(-x)
}

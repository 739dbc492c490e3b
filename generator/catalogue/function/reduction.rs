//! Builds the range reduction of the device `function`: logic before and after its polynomial.
//!
//! The polynomial covers only a short domain. The logic before it maps an operand x into that domain, and the logic after it
//! restores the result for x. For example, an odd function needs a polynomial for x ≥ 0 only: the logic takes |x|, and negates
//! the result if x is negative.

use crate::piecewise::whole;
use glint_approximate::{Piecewise, Reduction, Rule};
use glint_base::fixed::{Format, Overflow, Rounding};
use glint_rtl::blocks::quadrant::{mirrored, quadrant};
use glint_rtl::blocks::shift::{normalise, right_by};
use glint_rtl::dsl::{Designer, Signal};

/// The steps from the polynomial to the result, in this order.
#[derive(Default)]
pub(super) struct Restoring<'d> {
    /// A value that is added to the polynomial. It has its own fraction bits.
    addend: Option<Signal<'d>>,
    /// The number of bits by which the sum is shifted to the right.
    places: Option<Signal<'d>>,
    /// A bit that is 0 if the result must be 0.
    nonzero: Option<Signal<'d>>,
    /// A bit and a raw value: if the bit is 1, the result is the raw value minus the result so far.
    negative: Option<(Signal<'d>, i64)>,
}

fn integer(bits: u32) -> Format {
    Format::unsigned(bits as i32, 0)
}

/// Returns the number of an operand, and the steps that restore the operand's result from the polynomial.
pub(super) fn reduced<'d>(
    d: &'d Designer,
    x: Signal<'d>,
    it: &Piecewise,
    reduction: &Reduction,
) -> (Signal<'d>, Restoring<'d>) {
    let (whole, bits) = (whole(x), reduction.bits);
    let low = |bits: u32| whole.bits(0, integer(bits));
    let none = Restoring::default();
    match &reduction.rule {
        Rule::Size(centre) => {
            let negative = whole.bit(whole.format().width() - 1).named("negative");
            let size = [low(bits), mirrored(d, "mirrored", low(bits))];
            let number = d.choose("size", negative, size);
            (number, Restoring { negative: centre.map(|centre| (negative, centre)), ..none })
        }
        Rule::Quadrants(ahead) => {
            let it = quadrant(d, "quadrant", low(bits + 2), *ahead);
            (it.way, Restoring { negative: Some((it.negative, 0)), ..none })
        }
        Rule::Octaves { width, pairs, restores } => {
            let found = normalise(d, "octave", whole);
            let rest = found.word.bits(0, integer(width - 1));
            let number = if *pairs {
                let even = found.zeros.bit(0);
                let second = if width % 2 == 1 { even } else { d.not("second", even) };
                d.join("number", &[second, rest], integer(bits))
            } else {
                rest
            };
            let table = |name: &str, word: &dyn Fn(&(u32, i64)) -> i128, fraction: i32| {
                let words: Vec<i128> = restores.iter().map(word).collect();
                let ends = words.iter().fold((0, 0), |ends: (i128, i128), word| {
                    (ends.0.min(*word), ends.1.max(*word))
                });
                let format = Format::holding(ends.0, ends.1, fraction);
                (ends != (0, 0)).then(|| {
                    let rom = d.rom(name, found.zeros, format, &words, false);
                    rom.doc("by the leading zeros of the operand").out()
                })
            };
            let zero = it.domain.0 == 0;
            let restoring = Restoring {
                addend: table("addends", &|it| it.1.into(), it.sums[0].frac),
                places: table("places", &|it| it.0.into(), 0),
                nonzero: zero.then(|| found.word.bit(width - 1)),
                ..none
            };
            (number, restoring)
        }
        Rule::Exponent { scale, whole: most, falls } => {
            let exponent = scale.map_or(whole, |(factor, cut)| {
                let format = Format::holding(factor.into(), factor.into(), 0);
                let factor = d.raw_constant("scale", factor.into(), format);
                let product = d.mul("scaled", whole, factor);
                let format = product.format();
                let kept = format.width() - cut;
                product.bits(cut, Format { int: kept as i32 - i32::from(format.signed), ..format })
            });
            let Format { signed, .. } = exponent.format();
            let above = exponent.format().width().saturating_sub(bits);
            let number = exponent.bits(0, integer(bits.min(exponent.format().width())));
            let (first, last) = it.domain;
            let most_places = reduction.places(first).max(reduction.places(last));
            let places = (most_places > 0).then(|| {
                let format = Format { signed, int: above as i32 - i32::from(signed), frac: 0 };
                let own = exponent.bits(bits, format);
                let format = Format::holding((*most).into(), (*most).into(), 0);
                let most_of = d.raw_constant("most", (*most).into(), format);
                let away = if *falls {
                    d.sub("places", own, most_of)
                } else {
                    d.sub("places", most_of, own)
                };
                away.bits(0, integer(u32::BITS - most_places.leading_zeros()))
            });
            (number, Restoring { places, ..none })
        }
    }
}

impl<'d> Restoring<'d> {
    /// Returns the result in a format, rounded to the nearest.
    pub(super) fn result(
        &self,
        d: &'d Designer,
        polynomial: Signal<'d>,
        format: Format,
    ) -> Signal<'d> {
        let mut value = polynomial;
        if let Some(addend) = self.addend {
            value = d.add("with_octave", value, addend);
        }
        if let Some(places) = self.places {
            // A bit more than the result has decides the rounding.
            let finer = value.with_fraction(value.format().frac + 1);
            value = right_by(d, "shifted", finer, places);
        }
        let Format { int, .. } = value.format();
        let positive = Format { int: int + 1, frac: format.frac, ..value.format() };
        value = d.narrow("rounded", value, positive, Rounding::Nearest, Overflow::Wrap);
        if let Some(nonzero) = self.nonzero {
            let zero = d.raw_constant("zero", 0, value.format());
            value = d.choose("unless_zero", nonzero, [zero, value]);
        }
        if let Some((negative, centre)) = self.negative {
            let own = Format::holding(centre.into(), centre.into(), format.frac);
            let centre = d.raw_constant("centre", centre.into(), own);
            let other = d.sub("taken_off", centre, value);
            value = d.choose("with_sign", negative, [value, other]);
        }
        d.narrow("restored", value, format, Rounding::Truncate, Overflow::Wrap)
    }
}

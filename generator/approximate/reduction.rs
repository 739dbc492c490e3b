//! Maps the operands of a large domain to a short domain, on which a polynomial is fitted (range reduction).
//!
//! For example, a polynomial for f(x) = 1/√x on 1 ≤ x < 4 suffices for all x > 0, since f(4·x) = f(x)/2. The hardware shifts x
//! into the short domain, and shifts the polynomial's value back. This module checks such an identity only at a few points. The
//! bound of the error does not rely on it, because [`super::Piecewise::prove`] compares the result of every operand of the large
//! domain with the formula.

use std::sync::Arc;

use super::{Curve, Outside, Refusal, TargetFunction, UnsuitedReduction};
use glint_base::fixed::{Format, exp2};
use glint_formula::Function::Log2;
use glint_formula::{Enclosure, Expression, Kind, RBig, parse};

glint_config::choices! {
    /// How a range reduction obtains the values of a function f on a large domain from values on a short domain.
    #[derive(Default, Hash)]
    pub enum Identity {
        /// The polynomial covers the whole domain.
        #[default]
        None = "none",
        /// f(−x) = 2 f(0) − f(x), as for `tanh(x)` and `sigmoid(x)`.
        Odd = "odd",
        /// f(−x) = f(x), as for `exp(-x * x)`.
        Even = "even",
        /// f is a sine or cosine whose period is the domain. The polynomial covers one quadrant.
        Quadrants = "quadrants",
        /// f(4x) is f(x) times a power of two, or f(x) plus a constant. For example, √(4x) = 2√x.
        Octaves = "octaves",
        /// f is an exponential function, such as 2^x: the integer part of the exponent becomes a shift.
        Exponent = "exponent",
    }
}

impl Identity {
    /// Returns the name in configurations, for example `even`.
    pub fn word(self) -> &'static str {
        Self::WORDS[self as usize]
    }
}

/// Maps an operand of the large domain to a number, at which the polynomial is evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    pub rule: Rule,
    /// The width of the number.
    pub bits: u32,
    /// The number of fraction bits that the polynomial has in addition to the result's.
    pub guard: u32,
    /// The function that the polynomial approximates, of the number's value x.
    pub formula: Expression,
    /// The format in which the number is a real value, the operand of `formula`.
    pub operand: Format,
}

/// How a raw operand x is mapped to a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Rule {
    /// The number is |x|, but at most the largest number of [`Reduction::bits`] bits. For an odd function f, the field is 2·f(0)
    /// in units of the result's last bit, from which the result of a negative operand is subtracted. An even function has `None`.
    Size(Option<i64>),
    /// The number is the distance from the nearest zero of a sine, after x is increased by the given number of quadrants: 1 for a
    /// cosine. At a peak of the sine, the number is one less than this distance, so that it fits its bits.
    Quadrants(u32),
    /// The number consists of the bits behind the leading 1 bit of x. If octaves come in pairs, an additional leading bit tells
    /// the two apart. For example, the raw operand 5 with 8 bits, 00000101, has five leading zeros. Without pairs, the bits 01
    /// behind its leading 1 give the number 0100000, or 32. The operand 0 has no leading 1; its number and its result are 0.
    Octaves {
        /// The number of bits of the operand.
        width: u32,
        /// Whether two neighbouring octaves share the same restoring steps.
        pairs: bool,
        /// The steps that restore the result, by the number of leading zeros of the operand. A step is a shift to the right in
        /// bits, and the value that is added before it, in units of the polynomial's last bit.
        restores: Vec<(u32, i64)>,
    },
    /// The number is the fraction of the exponent of two; its integer part becomes a shift of the polynomial's value.
    Exponent {
        /// The factor that converts the raw operand to an exponent of two, and the number of low bits that the product drops.
        /// `None` if the raw operand itself is the exponent.
        scale: Option<(i64, u32)>,
        /// The integer part of the exponent at which the results are largest and the shift is 0.
        whole: i64,
        /// Whether `whole` is the smallest integer part, as for a function whose values fall.
        falls: bool,
    },
}

/// Computes the result for an operand from the polynomial's value: an odd function with f(0) = 0 negates it for a negative
/// operand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Restore {
    /// This number is added to the polynomial's value.
    addend: i64,
    /// The sum is then shifted to the right by this number of bits, and rounded to the nearest integer.
    shift: u32,
    /// If given, the shifted sum is then subtracted from this value.
    centre: Option<i64>,
    /// Whether the operand is 0, so that the result is 0 whatever the polynomial's value is.
    zero: bool,
}

impl Restore {
    /// Returns the raw result for the polynomial's raw value: with an addend of 3 and a shift by 1 without a centre, 10 gives 7.
    pub fn result(self, polynomial: i64) -> i64 {
        if self.zero {
            return 0;
        }
        let doubled = i128::from(polynomial + self.addend) << 1;
        let result = (((doubled >> self.shift) + 1) >> 1) as i64;
        self.centre.map_or(result, |centre| centre - result)
    }

    /// Returns the smallest and the largest raw value of the polynomial whose result is from `low` to `high`, or −2^60 and 2^60
    /// if the result is always 0. If no value has such a result, the smallest exceeds the largest.
    pub(super) fn polynomials(self, (low, high): (i64, i64)) -> (i64, i64) {
        const MOST: i128 = 1 << 60;
        if self.zero {
            return (-MOST as i64, MOST as i64);
        }
        let (low, high) = self.centre.map_or((low, high), |centre| (centre - high, centre - low));
        // Returns the smallest value whose result is `limit` or more.
        let least = |limit: i64| {
            let half = (((i128::from(limit) << 1) - 1) << self.shift).clamp(-MOST, MOST);
            ((half + 1) >> 1) - i128::from(self.addend)
        };
        (least(low) as i64, (least(high + 1) - 1) as i64)
    }
}

impl Reduction {
    /// Returns the number of a raw operand, and the steps that restore its result from the polynomial's value. An even function
    /// maps 3 and −3 to the same number 3.
    pub fn reduce(&self, raw: i64) -> (i64, Restore) {
        let mask = (1i64 << self.bits) - 1;
        let mirrored = |low: i64| if low == 0 { mask } else { mask + 1 - low };
        let plain = Restore { shift: self.guard, ..Restore::default() };
        match &self.rule {
            Rule::Size(centre) => {
                let centre = if raw < 0 { *centre } else { None };
                (raw.abs().min(mask), Restore { centre, ..plain })
            }
            Rule::Quadrants(phase) => {
                let turned = raw + (i64::from(*phase) << self.bits);
                let (quadrant, low) = (turned >> self.bits & 3, turned & mask);
                let number = if quadrant & 1 == 1 { mirrored(low) } else { low };
                (number, Restore { centre: (quadrant >= 2).then_some(0), ..plain })
            }
            Rule::Octaves { width, pairs, restores } => {
                if raw == 0 {
                    return (0, Restore { zero: true, ..plain });
                }
                let octave = raw.ilog2();
                let zeros = width - 1 - octave;
                let rest = (raw << zeros) & ((1 << (width - 1)) - 1);
                let second = i64::from(*pairs && octave % 2 == 1);
                let (shift, addend) = restores[zeros as usize];
                let restore = Restore { shift: self.guard + shift.min(NOTHING), addend, ..plain };
                (second << (width - 1) | rest, restore)
            }
            Rule::Exponent { scale, .. } => {
                let shift = self.guard + self.places(raw).min(NOTHING);
                (exponent(*scale, raw) & mask, Restore { shift, ..plain })
            }
        }
    }

    /// Returns the number of bits by which the hardware shifts the polynomial's value to the right, without the guard bits. The
    /// integer part of the exponent of the raw operand `raw` determines it. Other rules than `Exponent` shift by 0.
    pub fn places(&self, raw: i64) -> u32 {
        match self.rule {
            Rule::Exponent { scale, whole, .. } => {
                (whole - (exponent(scale, raw) >> self.bits)).unsigned_abs() as u32
            }
            _ => 0,
        }
    }

    /// Returns the range reduction of `function` by `identity`, and the function that its polynomial approximates. `guard` is the
    /// number of additional fraction bits of the polynomial. With `wider`, the largest |x| of `Odd` and `Even` has its own
    /// number; otherwise it may share the next lower one.
    ///
    /// # Errors
    /// Fails if the function is a curve through samples, or if the identity is `None`. Fails if the function has no value at a
    /// test point, the identity does not hold there, or the domain does not suit it. Also fails if a number would have no bits or
    /// more than [`MOST`] bits.
    pub(super) fn of(
        identity: Identity,
        function: &TargetFunction,
        guard: u32,
        wider: bool,
    ) -> Result<(Self, TargetFunction), Refusal> {
        let Curve::Formula(formula) = &function.curve else {
            return refused(
                UnsuitedReduction::NoReduction,
                "samples cannot have a range reduction",
            );
        };
        let whole = Whole { function, formula, guard };
        let (rule, bits, text) = match identity {
            Identity::None => {
                return refused(UnsuitedReduction::NoReduction, "there is no identity");
            }
            Identity::Odd => whole.size(true, wider)?,
            Identity::Even => whole.size(false, wider)?,
            Identity::Quadrants => whole.quadrants()?,
            Identity::Octaves => whole.octaves()?,
            Identity::Exponent => whole.exponent()?,
        };
        if bits == 0 || bits > MOST {
            let message =
                format!("a reduced operand would have {bits} bits, but 1 to {MOST} are possible");
            return refused(UnsuitedReduction::Bits, &message);
        }
        let place = formula.span.clone();
        let (fraction, text) = text;
        let inner = parse(&text)
            .map_err(|fault| Refusal::of_reduction(UnsuitedReduction::NoIdentity, fault.message))?;
        let reduced = formula.substitute(&Expression::operand("x"), &inner, &place);
        let last = match rule {
            Rule::Size(_) if wider => function.domain.0.abs().max(function.domain.1),
            _ => (1 << bits) - 1,
        };
        let operand = Format::unsigned(bits as i32 - fraction, fraction);
        let inner = TargetFunction {
            curve: Curve::Formula(reduced.clone()),
            domain: (0, last),
            operand,
            outside: Outside::Anything,
            fraction: function.fraction + guard,
            error: function.error * exp2(guard as i32),
        };
        Ok((Self { rule, bits, guard, formula: reduced, operand }, inner))
    }
}

/// Returns the exponent of two for the raw operand `raw`, with the fraction bits of the reduction's number. `scale` is the field
/// of [`Rule::Exponent`].
fn exponent(scale: Option<(i64, u32)>, raw: i64) -> i64 {
    scale.map_or(raw, |(factor, cut)| ((i128::from(raw) * i128::from(factor)) >> cut) as i64)
}

/// A shift to the right by this number of bits leaves nothing of a polynomial's value.
const NOTHING: u32 = 64;

/// The largest number of bits to which an operand may be reduced.
const MOST: u32 = 24;

/// The relative difference up to which two values count as equal.
const EQUAL: f64 = 1e-9;

fn refused<T>(why: UnsuitedReduction, message: &str) -> Result<T, Refusal> {
    Err(Refusal::of_reduction(why, message))
}

/// Returns the refusal of a formula that does not satisfy the identity; `wanted` says why.
fn unlike<T>(wanted: &str) -> Result<T, Refusal> {
    let message = format!("the formula does not satisfy this identity: {wanted}");
    refused(UnsuitedReduction::NoIdentity, &message)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= EQUAL * a.abs().max(b.abs()).max(1e-3)
}

/// Returns whether all values are near the first one, which must exist.
fn all_near(values: &[f64]) -> bool {
    values.iter().all(|&value| near(value, values[0]))
}

/// Returns whether the values at the eighths of a period follow a sine that is `phase` quadrants ahead, with a positive
/// amplitude. A cosine is one quadrant ahead.
fn is_sine(values: &[f64; 8], phase: usize) -> bool {
    let at = |eighth: usize| values[(eighth + 8 - 2 * phase) % 8];
    let largest = at(2);
    let is_zero = |value: f64| value.abs() <= EQUAL * largest;
    largest > 0.0
        && is_zero(at(0))
        && is_zero(at(4))
        && near(at(3), at(1))
        && near(at(5), -at(1))
        && near(at(7), -at(1))
}

/// The rule, and the number of bits of its number. The pair has the number's fraction bits, and the operand as a formula of the
/// number's value x.
type ReductionResult = Result<(Rule, u32, (i32, String)), Refusal>;

/// A function on its large domain. `guard` is the number of additional fraction bits.
struct Whole<'f> {
    function: &'f TargetFunction,
    formula: &'f Expression,
    guard: u32,
}

impl Whole<'_> {
    fn at(&self, x: f64) -> Result<f64, Refusal> {
        self.value_of(self.formula, x)
    }

    /// Returns the binary logarithm of the formula's value at `x`, which itself may be beyond the range of `f64`. Fails if the
    /// formula has no value or no logarithm there.
    fn logarithm_at(&self, x: f64) -> Result<f64, Refusal> {
        let kind = Kind::Unary(Log2, Arc::new(self.formula.clone()));
        self.value_of(&Expression::new(kind, self.formula.span.clone()), x)
    }

    fn value_of(&self, formula: &Expression, x: f64) -> Result<f64, Refusal> {
        let raw = (x * exp2(self.function.operand.frac)) as i64;
        let value = match RBig::try_from(x) {
            Ok(exact) => formula.evaluate_exactly(&[("x", exact)]),
            Err(_) => formula.enclose(&[("x", Enclosure::exactly(x))]),
        };
        value.map(Enclosure::middle).map_err(|fault| self.function.refusal(raw, &fault))
    }

    fn size(&self, odd: bool, wider: bool) -> ReductionResult {
        let TargetFunction { domain: (first, last), operand: Format { frac, .. }, .. } =
            *self.function;
        if first >= 0 || last < 0 {
            return refused(UnsuitedReduction::OneSide, "the domain is on one side of 0");
        }
        let centre = if odd { 2.0 * self.at(0.0)? } else { 0.0 };
        let ends = last.min(-first) as f64 * exp2(-frac);
        for part in [1.0, 0.71, 0.3] {
            let x = (ends * part * exp2(frac)).floor() * exp2(-frac);
            let (right, left) = (self.at(x)?, self.at(-x)?);
            if !near(left, if odd { centre - right } else { right }) {
                return unlike(if odd {
                    "f(-x) is not 2 f(0) - f(x)"
                } else {
                    "f(-x) is not f(x)"
                });
            }
        }
        let centre = (centre * exp2(self.function.fraction as i32) + 0.5).floor() as i64;
        let largest = last.max(-first - i64::from(!wider));
        let bits = i64::BITS - largest.leading_zeros();
        Ok((Rule::Size(odd.then_some(centre)), bits, (frac, "x".to_owned())))
    }

    fn quadrants(&self) -> ReductionResult {
        let TargetFunction { domain: (first, last), operand: Format { frac, .. }, .. } =
            *self.function;
        let count = last - first + 1;
        let quarter = count / 4;
        if count < 8 || !(count as u64).is_power_of_two() || first % quarter != 0 {
            let message = "the domain is not one period of four quadrants, with a power of two as the number \
                           of operands";
            return refused(UnsuitedReduction::NoPeriod, message);
        }
        let mut values = [0.0; 8];
        for (eighth, value) in values.iter_mut().enumerate() {
            let raw = first + (eighth as i64 * quarter / 2 - first).rem_euclid(count);
            *value = self.at(raw as f64 * exp2(-frac))?;
        }
        let Some(phase) = (0..4).find(|phase| is_sine(&values, *phase)) else {
            return unlike("the quadrants of the formula are not the quadrants of a sine");
        };
        let from = first + (-(phase as i64) * quarter - first).rem_euclid(count);
        let text = format!("x + {}", from as f64 * exp2(-frac));
        Ok((Rule::Quadrants(phase as u32), quarter.ilog2(), (frac, text)))
    }

    fn octaves(&self) -> ReductionResult {
        let TargetFunction { domain: (first, last), operand: format, .. } = *self.function;
        if first < 0 || last < 8 || last.ilog2() < first.max(1).ilog2() + 2 {
            return refused(
                UnsuitedReduction::NoReduction,
                "the domain does not have three octaves above 0",
            );
        }
        let (low, high) = (first.max(1).ilog2() as i32, last.ilog2() as i32);
        let (mut steps, mut ratios) = (Vec::new(), Vec::new());
        for octave in [low, high - 2] {
            for part in [1.0, 1.25, 1.625] {
                let x = part * exp2(octave - format.frac);
                let values = [self.at(x)?, self.at(2.0 * x)?, self.at(4.0 * x)?];
                steps.extend([values[1] - values[0], values[2] - values[1]]);
                ratios.push(libm::log2(values[2] / values[0]));
            }
        }
        let width = format.width();
        let (step, ratio) = (steps[0], (ratios[0] + 0.5).floor());
        let rises = ratio > 0.0;
        let (pairs, factor, added) = if all_near(&steps) {
            (false, 0.0, step)
        } else if all_near(&ratios)
            && near(ratios[0], ratio)
            && self.at(exp2(low - format.frac))? > 0.0
        {
            (ratio % 2.0 != 0.0, ratio, 0.0)
        } else {
            return unlike("f(4x) is neither f(x) times a power of two nor f(x) plus a constant");
        };
        if first == 0 && !rises {
            return refused(
                UnsuitedReduction::FromZero,
                "the domain begins at 0, and 0 does not belong to any octave",
            );
        }
        // The octave, or the pair of octaves, for which the polynomial is fitted: the one with the largest results.
        let group_of = |octave: i32| if pairs { octave >> 1 } else { octave };
        let own = match factor {
            0.0 => format.frac.clamp(low, high),
            _ => group_of(if rises { high } else { low }),
        };
        let places = if pairs { factor.abs() } else { factor.abs() / 2.0 };
        let fraction = (self.function.fraction + self.guard) as i32;
        let count = 2u32 << (width - 1).max(1).ilog2();
        let mut restores = Vec::with_capacity(count as usize);
        for zeros in 0..count {
            let octave = (width as i32 - 1 - zeros as i32).clamp(low, high);
            let away = group_of(octave) - own;
            let addend = (added * f64::from(away) * exp2(fraction) + 0.5).floor() as i64;
            restores.push((away.unsigned_abs() * places as u32, addend));
        }
        let rule = Rule::Octaves { width, pairs, restores };
        let rest = width - 1;
        Ok(if pairs {
            let unit = exp2(2 * own - format.frac);
            let text = format!("if(x < 1, {unit} * (1 + x), {} * x)", 2.0 * unit);
            (rule, rest + 1, (rest as i32, text))
        } else {
            (rule, rest, (rest as i32, format!("{} * (1 + x)", exp2(own - format.frac))))
        })
    }

    fn exponent(&self) -> ReductionResult {
        let TargetFunction { domain: (first, last), operand: Format { frac, .. }, .. } =
            *self.function;
        let [from, to] = [first, last].map(|raw| raw as f64 * exp2(-frac));
        let slope = (self.logarithm_at(to)? - self.logarithm_at(from)?) / (to - from);
        for part in [0.25, 0.5, 0.875] {
            let x = from + (to - from) * part;
            let wanted = self.logarithm_at(from)? + slope * (x - from);
            if !slope.is_normal() || !near(self.logarithm_at(x)?, wanted) {
                return unlike("the logarithm of the formula is not a straight line");
            }
        }
        // The distance between two operands for which one result is twice the other.
        let unit = 1.0 / slope.abs();
        let power = (libm::log2(unit) + 0.5).floor();
        let largest = self.at(from)?.max(self.at(to)?);
        let (scale, bits) = if near(unit, exp2(power as i32)) {
            (None, frac + power as i32)
        } else {
            let above = (libm::log2(largest) + 1.0).ceil().max(0.0) as i32;
            let bits = (self.function.fraction + self.guard) as i32 + above + 2;
            let cut = i64::BITS - first.abs().max(last.abs()).leading_zeros() + 1;
            let factor = exp2(cut as i32 + bits - frac) / unit;
            if factor.abs() >= exp2(40) {
                return refused(
                    UnsuitedReduction::Bits,
                    "the factor of the operand would have more than 40 bits",
                );
            }
            (Some(((factor + 0.5).floor() as i64, cut)), bits)
        };
        if bits < 1 || bits > MOST as i32 {
            let message = format!(
                "the fraction of the exponent would have {bits} bits, but 1 to {MOST} are possible"
            );
            return refused(UnsuitedReduction::Bits, &message);
        }
        let falls = slope < 0.0;
        let whole = exponent(scale, if falls { first } else { last }) >> bits;
        let unit = if scale.is_none() { exp2(power as i32) } else { unit };
        let text = format!("{unit} * ({whole} + x)");
        Ok((Rule::Exponent { scale, whole, falls }, bits as u32, (bits, text)))
    }
}

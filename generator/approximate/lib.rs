//! Finds piecewise polynomials in fixed point that approximate a function of one operand, and proves their error.
//!
//! The domain is cut into [`Segments`]. A table holds the coefficients of each segment, and the hardware evaluates the
//! polynomial in integers with Horner's rule. [`find`] chooses the degree, the segments, the coefficients and the widths.
//! [`Piecewise::prove`] then computes the result of every operand and compares it with the formula; the bound includes the
//! error with which the formula is evaluated. If a formula's domain has too many operands, the proof uses intervals within
//! segments instead.

mod minimax;
mod reduction;
mod samples;
mod search;
mod seen;
mod segments;
mod table;

#[cfg(test)]
mod tests;
mod wide;

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, LazyLock, Mutex};

use rayon::prelude::*;

use glint_base::fixed::{Format, exp2};
use glint_formula::{Enclosure, Expression, Fault, RBig};

pub use reduction::{Identity, Reduction, Restore, Rule};
pub use samples::Samples;
pub use search::Wish;
pub use segments::{Layout, SegmentOffset, Segments};

/// The coefficients of a polynomial of the largest degree.
const MOST_SUMS: usize = 4;

/// The most intervals in which a pole is looked for, and the part of the way between operands that is left out beside each:
/// the formula may change there, as `if(x <= 0, …)` does.
const POLES: u32 = 1 << 16;
const BESIDE: f64 = 1.0 / 1024.0;

/// The number of bits that an operand may have if every value is to be computed.
pub const MOST_BITS: u32 = 26;

glint_config::choices! {
    /// The result of an operand outside the domain.
    #[derive(Hash)]
    pub enum Outside {
        /// The result of the nearer end.
        Clamp = "clamp",
        /// The result of the operand as many whole domains away. For example, on the domain 0 to 1 the operand 1.25 gives the
        /// result of 0.25.
        Wrap = "wrap",
        /// Any result.
        Anything = "anything",
    }
}

/// The values of a function.
#[derive(Clone, Debug)]
pub enum Curve {
    /// The values of a formula of the operand x.
    Formula(Expression),
    /// The values of the curve through samples.
    Samples(Samples),
}

/// A function on a domain, and the formats that its operand and result have.
#[derive(Clone, Debug)]
pub struct TargetFunction {
    /// The values that are approximated.
    pub curve: Curve,
    /// The raw operands, first and last. For example, the domain from 1 to below 4 with 16 fraction bits is (65536, 262143).
    pub domain: (i64, i64),
    /// The operand's format.
    pub operand: Format,
    /// The result of other operands.
    pub outside: Outside,
    /// Fraction bits of the result.
    pub fraction: u32,
    /// The largest error, in units of the last place of the result.
    pub error: f64,
}

/// Why there is no approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The configuration key that is best changed.
    pub key: &'static str,
    /// The bytes of the formula that it is about, if it is about one place.
    pub place: Option<Range<usize>>,
    /// The fault, in words.
    pub message: String,
    /// The remedy, in words.
    pub remedy: String,
}

impl Refusal {
    /// Makes a refusal that concerns no place of the formula.
    pub fn new(key: &'static str, message: String, remedy: impl Into<String>) -> Self {
        Self { key, place: None, message, remedy: remedy.into() }
    }
}

/// The bits that are cut off before and after a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HornerStep {
    /// Leading bits of the offset that are multiplied.
    pub offset: u32,
    /// Low bits of the product that are dropped.
    pub dropped: u32,
}

impl HornerStep {
    /// Returns the addend of the next coefficient: the product of a sum and an offset of `rest` bits, both cut. For example,
    /// the sum 5 and the offset −3 give −4 if no bit of the offset and two bits of the product are cut.
    #[inline]
    pub fn product(self, sum: i64, offset: i64, rest: u32) -> i64 {
        let product = i128::from(sum) * i128::from(offset >> (rest - self.offset));
        (product >> self.dropped) as i64
    }
}

/// A piecewise polynomial in integers.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    /// The operand's format.
    pub operand: Format,
    /// The raw operands of the domain.
    pub domain: (i64, i64),
    /// The result of other operands.
    pub outside: Outside,
    /// How operands become the polynomial's.
    pub reduction: Option<Reduction>,
    /// The polynomial's raw operand whose number is 0.
    pub origin: i64,
    /// How numbers choose words.
    pub segments: Segments,
    /// The formats of the coefficients, the constant first.
    pub coefficients: Vec<Format>,
    /// The words of the table, each with its coefficients.
    pub words: Vec<Vec<i64>>,
    /// The cuts of the product that is added to coefficient k.
    pub steps: Vec<HornerStep>,
    /// The formats of the sums from coefficient k on. The first is the format of the polynomial.
    pub sums: Vec<Format>,
    /// The format of the result, which is the polynomial where nothing is reduced.
    pub result: Format,
    /// The proved bound of the error, in units of the last place of the result.
    pub bound: f64,
}

impl TargetFunction {
    /// Returns an interval that contains the value at a raw operand, in units of the last place of the result.
    ///
    /// A formula is evaluated in `f64`. Where that leaves a step or a sign undecided, is beyond the range of `f64`, or is not exact
    /// enough for the allowed error, the formula is evaluated once more with as many bits as it takes.
    ///
    /// # Errors
    /// Fails at the part of the formula that has no value there.
    pub fn limits(&self, raw: i64) -> Result<Enclosure, Fault> {
        let unit = exp2(self.fraction as i32);
        let Enclosure { low, high } = match &self.curve {
            Curve::Formula(formula) => {
                let x = Enclosure::exactly(self.operand.to_f64(raw.into()));
                match formula.enclose(&[("x", x)]) {
                    Ok(value) if (value.high - value.low) * unit <= self.tolerance() => value,
                    _ => formula.evaluate_exactly(&[("x", self.operand_value(raw))])?,
                }
            }
            Curve::Samples(samples) => samples.limits(raw),
        };
        Ok(Enclosure::between(low * unit, high * unit))
    }

    /// Returns the widest interval of a value, in units of the result, that is exact enough for the allowed error.
    fn tolerance(&self) -> f64 {
        ((self.error - 0.5) / 8.0).max(1.0 / 1024.0)
    }

    /// Returns the value of a raw operand.
    fn operand_value(&self, raw: i64) -> RBig {
        let scale = RBig::from(2).pow(-self.operand.frac as isize);
        RBig::from(raw) * scale
    }

    /// Finds neighbouring operands between which the formula has a pole, or comes so near to one that intervals do not tell.
    pub fn pole(&self) -> Option<(f64, f64)> {
        let Curve::Formula(formula) = &self.curve else { return None };
        let mut open = vec![self.domain];
        for _ in 0..POLES {
            let (low, high) = open.pop()?;
            let [from, to] = [low, high].map(|raw| self.operand.to_f64(raw.into()));
            let beside = BESIDE * exp2(-self.operand.frac);
            let inner = Enclosure::between(from + beside, to - beside);
            if formula.enclose(&[("x", inner)]).is_ok_and(Enclosure::is_finite) {
                continue;
            }
            if high - low <= 1 {
                return Some((from, to));
            }
            let middle = low + (high - low) / 2;
            open.extend([(middle, high), (low, middle)]);
        }
        None
    }

    /// Returns whether there are more operands than can be computed.
    pub fn is_wide(&self) -> bool {
        self.domain.1.abs_diff(self.domain.0) >> MOST_BITS != 0
    }

    /// Returns how the bound was proved, as the beginning of a sentence.
    pub fn proof(&self) -> &'static str {
        match &self.curve {
            Curve::Samples(_) => {
                "Every operand of the domain was computed, against the monotone cubic through the samples"
            }
            Curve::Formula(_) if self.is_wide() => {
                "The error was enclosed at all operands, by intervals within each segment"
            }
            Curve::Formula(_) => "Every operand of the domain was computed",
        }
    }

    /// Returns the raw operand whose number is 0, and the bits of a number.
    fn numbering(&self) -> (i64, u32) {
        let span = (self.domain.1 - self.domain.0) as u64;
        let bits = (u64::BITS - span.leading_zeros()).max(1);
        let whole = self.operand.width();
        let origin = self.operand.min_raw() as i64;
        if bits < whole { (self.domain.0, bits) } else { (origin, whole) }
    }

    /// Returns a place where the formula has no value, as a refusal of the formula.
    fn refusal(&self, raw: i64, fault: &Fault) -> Refusal {
        let x = self.operand.to_f64(raw.into());
        Refusal {
            key: "function.formula",
            place: Some(fault.span.clone()),
            message: format!("at x = {x}: {}", fault.message),
            remedy: "keep such places out of the domain: change function.from or function.to"
                .to_owned(),
        }
    }
}

impl Piecewise {
    /// Returns the names of the registers with the sums, the polynomial's first.
    pub fn registers(&self) -> [&'static str; 3] {
        [if self.reduction.is_some() { "polynomial" } else { "result" }, "sum1", "sum2"]
    }

    /// Returns the polynomial's degree. For example, words of three coefficients have degree 2.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Returns the polynomial's operand for a raw operand of the domain, and the way to restore the result from the
    /// polynomial.
    fn reduced(&self, raw: i64) -> (i64, Restore) {
        self.reduction.as_ref().map_or((raw, Restore::default()), |it| it.reduce(raw))
    }

    /// Returns the number of a raw operand within the domain.
    pub fn number(&self, raw: i64) -> u64 {
        (self.reduced(raw).0 - self.origin) as u64 & ((1 << self.segments.bits) - 1)
    }

    /// Returns where a raw operand lies. Beyond the words that the domain reads it is the last.
    pub fn place(&self, raw: i64) -> SegmentOffset {
        let SegmentOffset { word, offset } = self.segments.place(self.number(raw));
        SegmentOffset { word: word.min(self.words.len() - 1), offset }
    }

    /// Returns the sum from coefficient k on, without cutting off upper bits. `above` is the sum from coefficient k + 1 on.
    pub fn sum(&self, k: usize, place: SegmentOffset, above: i64) -> i64 {
        let coefficient = self.words[place.word][k];
        let Some(step) = self.steps.get(k) else { return coefficient };
        coefficient + step.product(above, place.offset, self.segments.rest())
    }

    /// Returns the fraction bits that the sum with the constant has beyond the result.
    pub fn guard(&self) -> u32 {
        (self.coefficients[0].frac - self.sums[0].frac) as u32
    }

    /// Returns all sums of a raw operand, with nothing cut off at the top: the polynomial first.
    fn sums_of(&self, raw: i64) -> [i64; MOST_SUMS] {
        let place = self.place(raw);
        let mut sums = [0; MOST_SUMS];
        let mut above = 0;
        for k in (0..self.coefficients.len()).rev() {
            above = self.sum(k, place, above);
            sums[k] = above;
        }
        sums[0] >>= self.guard();
        sums
    }

    /// Returns the result of a raw operand.
    pub fn result(&self, raw: i64) -> i64 {
        self.restored(raw, self.sums_of(raw)[0])
    }

    /// Returns the result of a raw operand from the value of the polynomial there.
    pub fn restored(&self, raw: i64, polynomial: i64) -> i64 {
        self.reduced(raw).1.result(polynomial)
    }

    /// Returns the number of bits of the table. For example, the table of `configs/function.toml`, for 1/√x from 1 to 2, has 16
    /// words of 35 bits, which are 560 bits.
    pub fn rom_bits(&self) -> u64 {
        let width: u32 = self.coefficients.iter().map(|format| format.width()).sum();
        self.words.len() as u64 * u64::from(width)
    }

    /// Proves a bound of the error against the limits of the function, over every operand of the domain: none is further off,
    /// whatever its exact value.
    ///
    /// # Errors
    /// Fails if the sums of an operand leave their formats, if its result is further off than the function allows, or if the
    /// function has no value there. Fails also if the proof takes too long.
    pub fn prove(&self, function: &TargetFunction) -> Result<f64, Refusal> {
        let (first, last) = self.domain;
        let of = |raw: i64| self.error_at(function, raw);
        let larger = |a: f64, b: f64| Ok(a.max(b));
        match &function.curve {
            Curve::Formula(_) if function.is_wide() => self.prove_by_segments(function),
            _ => (first..=last).into_par_iter().map(of).try_reduce(|| 0.0, larger),
        }
    }

    /// Returns the largest error of the result of a raw operand.
    fn error_at(&self, function: &TargetFunction, raw: i64) -> Result<f64, Refusal> {
        let sums = self.sums_of(raw);
        let result = self.restored(raw, sums[0]);
        let mut all = sums.iter().zip(&self.sums).chain([(&result, &self.result)]);
        if let Some((sum, format)) = all.find(|(sum, format)| !format.holds(i128::from(**sum))) {
            let message = format!("at the operand {raw} a sum is {sum}, which is not {format}");
            return Err(Refusal::new("result.fraction", message, "change the formats"));
        }
        let limits = function.limits(raw).map_err(|fault| function.refusal(raw, &fault))?;
        let result = result as f64;
        let difference = (result - limits.low).abs().max((result - limits.high).abs());
        // A difference of 0 is exact; any other may have been rounded down.
        let error = if difference == 0.0 { 0.0 } else { difference.next_up() };
        if error >= function.error {
            let message = format!("at the operand {raw} the result is {error:.4} units off");
            return Err(Refusal::new("result.error", message, "allow a larger error"));
        }
        Ok(error)
    }
}

type SearchResult = Result<Arc<Piecewise>, Refusal>;

/// Returns the approximation of a function with the least cost, and with a proved bound. A search that was already made is
/// not repeated.
///
/// # Errors
/// Fails if no approximation can be found and proved. The error says why.
pub fn find(function: &TargetFunction, wish: Wish) -> SearchResult {
    static FOUND: LazyLock<Mutex<HashMap<String, SearchResult>>> = LazyLock::new(Mutex::default);
    let key = format!("{function:?} {wish:?}");
    let known = || FOUND.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(found) = known().get(&key) {
        return found.clone();
    }
    let found = search::search(function, wish).map(Arc::new);
    known().insert(key, found.clone());
    found
}

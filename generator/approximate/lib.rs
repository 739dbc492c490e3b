//! Finds piecewise polynomials in fixed point that approximate a function of one operand, and proves a bound on their error.
//!
//! For example, a device can compute 1/√x for x from 1 to 4 with such a polynomial. The domain is cut into [`Segments`]; a table
//! holds the coefficients of each segment, and the hardware evaluates the polynomial in integers by Horner's rule. [`find`]
//! chooses the degree, the segments, the coefficients and the bit widths. [`Piecewise::prove`] then computes the result of every
//! operand and compares it with the formula, allowing for the error with which the formula is evaluated. If the domain has too
//! many operands for that, the proof uses intervals within segments instead.

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

/// The words of a bit that a look-up table of four inputs holds.
pub const FULL_CELL: usize = 16;

/// A domain may have an overhang of its operands divided by 2 to this power at most.
const SMALL_PART: u32 = 5;

/// The largest number of bits of a domain whose operands a proof computes one by one.
pub const MOST_BITS: u32 = 26;

glint_config::choices! {
    /// The results that a device may give for an operand outside the function's domain.
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

/// The function to approximate: a formula, or a curve through samples.
#[derive(Clone, Debug)]
pub enum Curve {
    /// A formula of the operand x.
    Formula(Expression),
    /// The curve through samples, which are measured points.
    Samples(Samples),
}

/// A function on a domain, and the formats that its operand and result have.
#[derive(Clone, Debug)]
pub struct TargetFunction {
    /// The function to approximate: a formula, or a curve through samples.
    pub curve: Curve,
    /// The smallest and the largest raw operand of the domain. For example, the domain from 1 to below 4 with 16 fraction bits is
    /// (65536, 262143).
    pub domain: (i64, i64),
    /// The fixed-point format of the operand x.
    pub operand: Format,
    /// The result that the device gives for operands outside the domain.
    pub outside: Outside,
    /// The number of fraction bits of the result.
    pub fraction: u32,
    /// The largest allowed error, in units of the last bit of the result.
    pub error: f64,
}

/// The reason why no approximation was found, with the key that the user should change.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The configuration key that the user should change.
    pub key: &'static str,
    /// The range of bytes in the formula, if the reason concerns a part of it.
    pub place: Option<Range<usize>>,
    /// The reason why no approximation was found, for the user.
    pub message: String,
    /// The remedy, for the user. For example, it names a larger error that can be reached.
    pub remedy: String,
}

impl Refusal {
    /// Makes a refusal that concerns no particular part of the formula.
    pub fn new(key: &'static str, message: String, remedy: impl Into<String>) -> Self {
        Self { key, place: None, message, remedy: remedy.into() }
    }
}

/// The bit widths of one step of Horner's rule. Let p be the partial sum and t the offset of the operand in its segment: a step
/// computes p·t, drops low bits of the product, and adds the next coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HornerStep {
    /// The number of leading bits of the offset that the step multiplies.
    pub offset: u32,
    /// The number of low bits of the product that the step drops.
    pub dropped: u32,
}

impl HornerStep {
    /// Returns the product of a partial sum and the offset in the segment, without the low bits that this step drops. The step
    /// adds it to the next coefficient. `rest` is the number of bits of the offset. For example, the sum 5 and the offset −3 give
    /// −4 if no bit of the offset and two bits of the product are dropped.
    #[inline]
    pub fn product(self, sum: i64, offset: i64, rest: u32) -> i64 {
        let product = i128::from(sum) * i128::from(offset >> (rest - self.offset));
        (product >> self.dropped) as i64
    }
}

/// A piecewise polynomial in integers: the table of coefficients, and all bit widths of its hardware.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    /// The fixed-point format of the operand x of the device.
    pub operand: Format,
    /// The smallest and the largest raw operand of the domain.
    pub domain: (i64, i64),
    /// The result that the device gives for operands outside the domain.
    pub outside: Outside,
    /// The range reduction that maps an operand to the polynomial's shorter domain, if there is one.
    pub reduction: Option<Reduction>,
    /// The raw operand that has the number 0 in [`Segments`], which numbers the operands of the polynomial from 0.
    pub origin: i64,
    /// The segments, which map the number of an operand to a word of the table.
    pub segments: Segments,
    /// The format of each coefficient, the constant first.
    pub coefficients: Vec<Format>,
    /// The words of the table, one for each segment. A word consists of the coefficients, the constant first.
    pub words: Vec<Vec<i64>>,
    /// The bit widths of Horner's steps, by the coefficient that a step adds: entry k belongs to coefficient k.
    pub steps: Vec<HornerStep>,
    /// The formats of the partial sums of Horner's rule. Entry k is the format of the sum that contains the coefficients from k
    /// on; entry 0 is the format of the whole polynomial.
    pub sums: Vec<Format>,
    /// The format of the result. It is the format of the polynomial if there is no range reduction.
    pub result: Format,
    /// The proved bound of the error, in units of the last bit of the result.
    pub bound: f64,
}

/// The numbers of a domain's operands: the operand `origin` has the number 0.
#[derive(Clone, Copy, Debug)]
struct Numbering {
    origin: i64,
    /// The number of bits of a number, without the overhang.
    bits: u32,
    /// The number of operands with numbers from 2^bits on.
    overhang: u64,
}

impl TargetFunction {
    /// Returns an interval that contains the exact value of the function at a raw operand, in units of the last bit of the
    /// result.
    ///
    /// A formula is first evaluated in `f64`. It is evaluated again with more bits if `f64` leaves a comparison undecided,
    /// overflows, or is not exact enough for the allowed error.
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

    /// Finds two neighbouring operands between which the formula has a pole, or comes so close to one that intervals cannot tell.
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

    /// Returns whether the domain has too many operands for a proof that computes each.
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

    /// Returns the ways to number the operands of the domain, the way to try first at the beginning. The last segment may have
    /// to be shorter than an overhang, so that there is a way without one, too.
    fn numberings(&self, layout: Option<Layout>) -> Vec<Numbering> {
        let with_overhang = self.numbering_with_overhang(layout);
        with_overhang.into_iter().chain([self.numbering_without_overhang()]).collect()
    }

    /// Returns the numbers of the operands if the last segment contains the operands beyond a power of two. Returns `None` if
    /// they are too many. With `layout` halving there is no overhang: its last segment is short.
    fn numbering_with_overhang(&self, layout: Option<Layout>) -> Option<Numbering> {
        let span = (self.domain.1 - self.domain.0) as u64;
        let bits = u64::BITS - span.leading_zeros();
        if bits == 0 || self.outside != Outside::Anything || layout == Some(Layout::Halving) {
            return None;
        }
        let overhang = span + 1 - (1 << (bits - 1));
        let is_short = overhang > 0 && overhang <= span >> SMALL_PART;
        is_short.then_some(Numbering { origin: self.domain.0, bits: bits - 1, overhang })
    }

    fn numbering_without_overhang(&self) -> Numbering {
        let span = (self.domain.1 - self.domain.0) as u64;
        let bits = (u64::BITS - span.leading_zeros()).max(1);
        let whole = self.operand.width();
        if bits < whole {
            return Numbering { origin: self.domain.0, bits, overhang: 0 };
        }
        Numbering { origin: self.operand.min_raw() as i64, bits: whole, overhang: 0 }
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
    /// Returns the names of the registers that hold the partial sums of Horner's rule, starting with the register of the whole
    /// polynomial.
    pub fn registers(&self) -> [&'static str; 3] {
        [if self.reduction.is_some() { "polynomial" } else { "result" }, "sum1", "sum2"]
    }

    /// Returns the degree of the polynomials. For example, words of three coefficients have degree 2.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Returns the polynomial's operand for a raw operand of the domain, and the way to restore the result from the
    /// polynomial.
    fn reduced(&self, raw: i64) -> (i64, Restore) {
        self.reduction.as_ref().map_or((raw, Restore::default()), |it| it.reduce(raw))
    }

    /// Returns the number of a raw operand. Numbers run from 0 over the polynomial's domain, and [`Segments`] finds the
    /// segment of a number.
    pub fn number(&self, raw: i64) -> u64 {
        (self.reduced(raw).0 - self.origin) as u64 & ((1 << self.segments.number_bits()) - 1)
    }

    /// Returns the segment of a raw operand, and the offset of the operand in it. An operand beyond the domain gets the last
    /// segment.
    pub fn place(&self, raw: i64) -> SegmentOffset {
        let SegmentOffset { word, offset } = self.segments.place(self.number(raw));
        SegmentOffset { word: word.min(self.words.len() - 1), offset }
    }

    /// Returns the partial sum of Horner's rule that contains the coefficients from k on, with all its upper bits. `place` is the
    /// segment and the offset; `above` is the partial sum from coefficient k + 1 on.
    pub fn sum(&self, k: usize, place: SegmentOffset, above: i64) -> i64 {
        let coefficient = self.words[place.word][k];
        let Some(step) = self.steps.get(k) else { return coefficient };
        coefficient + step.product(above, place.offset, self.segments.rest())
    }

    /// Returns the number of fraction bits that the result drops from the value of the polynomial.
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

    /// Returns the raw result that the hardware computes for a raw operand.
    pub fn result(&self, raw: i64) -> i64 {
        self.restored(raw, self.sums_of(raw)[0])
    }

    /// Returns the polynomial behind a range reduction, as a function of the reduction's number. Without a range reduction it
    /// is the same polynomial. The bound of the error is infinite, because it is proved for the whole alone.
    pub fn behind_reduction(&self) -> Self {
        let Some(reduction) = &self.reduction else { return self.clone() };
        Self {
            operand: reduction.operand,
            domain: (0, (1 << reduction.bits) - 1),
            outside: Outside::Anything,
            reduction: None,
            result: self.sums[0],
            bound: f64::INFINITY,
            ..self.clone()
        }
    }

    /// Returns the raw result for a raw operand, given the raw value of the polynomial. With a range reduction, the function
    /// undoes the reduction.
    pub fn restored(&self, raw: i64, polynomial: i64) -> i64 {
        self.reduced(raw).1.result(polynomial)
    }

    /// Returns the number of bits of the table. For example, the table of `configs/function.toml`, for 1/√x from 1 to 2, has 16
    /// words of 35 bits, which are 560 bits.
    pub fn rom_bits(&self) -> u64 {
        let width: u32 = self.coefficients.iter().map(|format| format.width()).sum();
        self.words.len() as u64 * u64::from(width)
    }

    /// Returns the number of look-up tables of four inputs that the table takes. A short table takes as many as one of 16 words.
    pub fn rom_cells(&self) -> f64 {
        let width: u32 = self.coefficients.iter().map(|format| format.width()).sum();
        table::cells(self.words.len().max(FULL_CELL), width)
    }

    /// Proves a bound on the error at every operand of the domain, and returns it in units of the last bit of the result. The
    /// result is never further than the bound from the exact value.
    ///
    /// # Errors
    /// Fails if the sums of an operand leave their formats, if its result is further off than the function allows, or if the
    /// function has no value there. Fails also if the proof takes too long.
    pub fn prove(&self, function: &TargetFunction) -> Result<f64, Refusal> {
        let (first, last) = self.domain;
        if matches!(function.curve, Curve::Formula(_)) && function.is_wide() {
            return self.prove_by_segments(function);
        }
        let errors = (first..=last).into_par_iter().map(|raw| self.error_at(function, raw));
        errors.try_reduce(|| 0.0, |a, b| Ok(a.max(b)))
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

/// Returns the cheapest approximation of a function that has a proven bound. If the same search was made before, it returns the
/// earlier result.
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

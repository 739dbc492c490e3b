//! Finds piecewise polynomials in fixed point that approximate a function of one operand, and proves a bound on their error.
//!
//! The domain is divided into [`Segments`]. A table has the polynomial's coefficients for each segment, and the hardware
//! evaluates the polynomial in integers by Horner's rule. [`find`] chooses the degree, the segments, the coefficients and the bit
//! widths. [`Piecewise::prove`] then compares the result of every operand with the exact function: a formula, or a curve through
//! measured points ([`Samples`]). If a formula has more than 2^[`MOST_BITS`] operands, the proof uses intervals of operands. With
//! samples or a range reduction, so many operands are an error.

mod minimax;
mod reduction;
mod refusal;
mod samples;
mod search;
mod seen;
mod segments;
mod shared;
mod table;

#[cfg(test)]
mod tests;
mod wide;
mod writable;

use std::sync::Arc;

use rayon::prelude::*;

use glint_base::fixed::{Format, MAX_WIDTH, exp2};
use glint_formula::{Enclosure, Expression, Fault, RBig};

pub use reduction::{Identity, Reduction, Restore, Rule};
pub use refusal::{Refusal, RefusalKind, UnsuitedReduction};
pub use samples::Samples;
pub use search::{Wish, reachable_error};
pub use segments::{Layout, SegmentOffset, Segments};
pub use shared::{SharedWidths, find_with_widths, widths_with_prefix};
pub use writable::{find_images, reachable_image_error};

/// The most partial sums of a polynomial; the largest degree is 3.
const MOST_SUMS: usize = 4;

/// The number of intervals in which [`TargetFunction::pole`] looks for a pole.
const POLES: u32 = 1 << 16;
/// The distance from an operand that the search for a pole leaves out, as a fraction of the distance between two operands. The
/// formula may jump at an operand, as `if(x <= 0, …)` does.
const BESIDE: f64 = 1.0 / 1024.0;

/// The number of bits that a look-up table with four inputs can store.
pub const FULL_CELL: usize = 16;

/// An overhang (the operands of a domain beyond a power of two) may have at most 2^−5 of the domain's operands.
const SMALL_PART: u32 = 5;

/// A proof computes at most 2 to this power operands one by one. The proof for a larger domain uses intervals.
pub const MOST_BITS: u32 = 26;

glint_config::choices! {
    /// The result for an operand outside the function's domain.
    #[derive(Hash)]
    pub enum Outside {
        /// The result of the nearer end: on the domain 0 to 1, 1.25 gives the result of the largest operand.
        Clamp = "clamp",
        /// The result of the operand moved by whole domain lengths into the domain: on the domain 0 to 1, 1.25 gives the result
        /// of 0.25.
        Wrap = "wrap",
        /// The result is not specified.
        Anything = "anything",
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// A formula of the operand x.
    Formula(Expression),
    /// A curve through measured points.
    Samples(Samples),
}

/// A function of one operand on a domain, with the largest allowed error.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetFunction {
    pub curve: Curve,
    /// The smallest and the largest raw operand, both included: (65536, 262143) for 1 to below 4 with 16 fraction bits.
    pub domain: (i64, i64),
    /// The format of the operand x.
    pub operand: Format,
    pub outside: Outside,
    /// The number of fraction bits of the result.
    pub fraction: u32,
    /// Every error must be below this number, in units of the last bit of the result.
    pub error: f64,
}

/// The bit widths of a step of Horner's rule. With the partial sum p and the operand's offset t in its segment, it computes p·t,
/// drops low bits, and adds the next coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HornerStep {
    /// The number of leading bits of the offset that the step multiplies.
    pub offset: u32,
    /// The number of low bits of the product that the step drops.
    pub dropped: u32,
}

impl HornerStep {
    /// Returns the product of `sum` and `offset` without the dropped bits; the caller adds it to the next coefficient. `rest` is
    /// the number of bits of the whole offset. The sum 5 and the offset −3 give −15, or −4 (rounded down) if two bits are
    /// dropped.
    #[inline]
    pub fn product(self, sum: i64, offset: i64, rest: u32) -> i64 {
        let product = i128::from(sum) * i128::from(offset >> (rest - self.offset));
        (product >> self.dropped) as i64
    }
}

/// A piecewise polynomial in integers: the table of coefficients, and all bit widths of the hardware.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    /// The format of the operand x.
    pub operand: Format,
    /// The smallest and the largest raw operand, both included.
    pub domain: (i64, i64),
    pub outside: Outside,
    /// Maps an operand to the polynomial's shorter domain, if the polynomial does not cover the whole one.
    pub reduction: Option<Reduction>,
    /// The raw operand with the number 0 in [`Segments`].
    pub origin: i64,
    /// The segments, which map the number of an operand to a word of the table.
    pub segments: Segments,
    /// The formats of the coefficients, in order of rising powers: entry 0 is the constant.
    pub coefficients: Vec<Format>,
    /// The table: for each segment, the raw coefficients, the constant first.
    pub words: Vec<Vec<i64>>,
    /// Entry k belongs to the step of Horner's rule that adds coefficient k. The highest coefficient has none.
    pub steps: Vec<HornerStep>,
    /// The formats of the partial sums. Entry k includes coefficient k and all higher ones, so that entry 0 is the polynomial's
    /// value.
    pub sums: Vec<Format>,
    /// The format of the result. Without a range reduction, it is the format of the polynomial's value.
    pub result: Format,
    /// The proved bound of the error, in units of the last bit of the result, or infinity if no proof was made.
    pub bound: f64,
    /// Whether the words can be replaced at run time, to give another function.
    pub is_writable: bool,
}

/// Numbers the operands of a domain from the raw operand `origin`, which has the number 0.
#[derive(Clone, Copy, Debug)]
struct Numbering {
    origin: i64,
    /// The number of bits of a number. The overhang needs one bit more.
    bits: u32,
    /// The overhang: the number of operands whose numbers are 2^`bits` or larger.
    overhang: u64,
}

impl TargetFunction {
    /// Returns an interval that contains the exact value of the function at the raw operand `raw`, in units of the last bit of
    /// the result.
    ///
    /// A formula is first evaluated in `f64`. If the interval is then too wide for the allowed error, or if the evaluation fails,
    /// it is evaluated again with more bits.
    ///
    /// # Errors
    /// Fails if the formula has no value at this operand (1/x at 0), or if 1024 bits do not decide a comparison or a jump. A
    /// curve through samples never fails.
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

    /// Returns the largest width of an interval from `f64` that [`TargetFunction::limits`] accepts, in units of the result's
    /// last bit. If the interval is wider, [`TargetFunction::limits`] evaluates the formula again with more bits. For example,
    /// an allowed error of 1 unit gives 1/16.
    fn tolerance(&self) -> f64 {
        ((self.error - 0.5) / 8.0).max(1.0 / 1024.0)
    }

    /// Returns the exact value of a raw operand: 3 with one fraction bit is 3/2.
    fn operand_value(&self, raw: i64) -> RBig {
        let scale = RBig::from(2).pow(-self.operand.frac as isize);
        RBig::from(raw) * scale
    }

    /// Returns two neighbouring operands, as real numbers, between which the formula has a pole or no value. It also returns them
    /// if interval arithmetic cannot exclude such a place. A curve through samples has none. The search gives up after 65536
    /// intervals.
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

    /// Returns whether the domain has more than 2^[`MOST_BITS`] operands, too many for a proof that computes every operand.
    pub fn is_wide(&self) -> bool {
        self.domain.1.abs_diff(self.domain.0) >> MOST_BITS != 0
    }

    /// Returns the beginning of a sentence that says how the error bound was proved.
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

    /// Returns the numberings that a search should try, in this order: with an overhang, if possible, and without. The segments
    /// of a steep function may be too short for an overhang.
    fn numberings(&self, layout: Option<Layout>) -> Vec<Numbering> {
        let with_overhang = self.numbering_with_overhang(layout);
        with_overhang.into_iter().chain([self.numbering_without_overhang()]).collect()
    }

    /// Returns the numbering in which the last segment also contains the operands beyond a power of two, the overhang. Raw
    /// operands 0 to 1024 get numbers of 10 bits and an overhang of 1. Returns `None` if the overhang has more than 1/32 of the
    /// operands, or if the domain has a single operand. It is also `None` if the results outside the domain are specified
    /// (`Clamp` or `Wrap`). The layout `Halving` also gives `None`, because its last segment is too short.
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

    /// Returns the refusal of a formula without a value. The message states the operand `raw` as a real number.
    fn refusal(&self, raw: i64, fault: &Fault) -> Refusal {
        let x = self.operand.to_f64(raw.into());
        Refusal {
            place: Some(fault.span.bytes.clone()),
            ..Refusal::new(RefusalKind::NoValue, format!("at x = {x}: {}", fault.message))
        }
    }
}

impl Piecewise {
    /// Returns the names of the registers for the partial sums, by the index of the sum. The whole polynomial is `polynomial`
    /// with a range reduction, and `result` without one.
    pub fn registers(&self) -> [&'static str; 3] {
        [if self.reduction.is_some() { "polynomial" } else { "result" }, "sum1", "sum2"]
    }

    /// Returns the degree of the polynomials, one less than the number of coefficients.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Returns the raw operand of the polynomial for a raw operand of the domain, and the steps that restore the result from the
    /// polynomial's value.
    fn reduced(&self, raw: i64) -> (i64, Restore) {
        self.reduction.as_ref().map_or((raw, Restore::default()), |it| it.reduce(raw))
    }

    /// Returns the number, from 0, of a raw operand after the range reduction, if there is one.
    pub fn number(&self, raw: i64) -> u64 {
        (self.reduced(raw).0 - self.origin) as u64 & ((1 << self.segments.number_bits()) - 1)
    }

    /// Returns the segment of a raw operand, and its offset there. An operand beyond the last segment gets the last one.
    pub fn place(&self, raw: i64) -> SegmentOffset {
        let SegmentOffset { word, offset } = self.segments.place(self.number(raw));
        SegmentOffset { word: word.min(self.words.len() - 1), offset }
    }

    /// Returns the partial sum that includes coefficient `k` and all higher ones, not limited to its format. `place` is the
    /// operand's segment and offset, and `above` the partial sum from coefficient `k` + 1 on.
    pub fn sum(&self, k: usize, place: SegmentOffset, above: i64) -> i64 {
        let coefficient = self.words[place.word][k];
        let Some(step) = self.steps.get(k) else { return coefficient };
        coefficient + step.product(above, place.offset, self.segments.rest())
    }

    /// Returns the number of low fraction bits that the polynomial's value drops from the constant's sum.
    pub fn guard(&self) -> u32 {
        (self.coefficients[0].frac - self.sums[0].frac) as u32
    }

    /// Returns all partial sums for a raw operand, not limited to their formats, with entry 0 without its guard bits. Entries
    /// beyond the degree are 0.
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

    /// Returns the raw result that the hardware computes. Each partial sum keeps the bits of its register: within the domain, the
    /// proof shows that these are all bits. `outside` is not applied: the caller must first clamp or wrap an operand outside the
    /// domain.
    pub fn result(&self, raw: i64) -> i64 {
        let place = self.place(raw);
        let mut above = 0;
        for k in (0..self.coefficients.len()).rev() {
            let sum = self.sum(k, place, above);
            let shortened = if k == 0 { sum >> self.guard() } else { sum };
            above = match self.sums.get(k) {
                Some(register) => register.raw(register.bits(shortened.into())) as i64,
                None => shortened,
            };
        }
        self.restored(raw, above)
    }

    /// Returns the polynomial without the range reduction, as a function of the number that the reduction computes. With a range
    /// reduction, its bound is infinite, because only the whole function has a proof.
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

    /// Returns the raw result for the raw operand `raw` and the raw value `polynomial` of the polynomial.
    pub fn restored(&self, raw: i64, polynomial: i64) -> i64 {
        self.reduced(raw).1.result(polynomial)
    }

    /// Returns whether the product of every step fits a net, with one more bit for the sum.
    fn has_narrow_products(&self) -> bool {
        self.steps.iter().zip(&self.sums[1..]).all(|(step, sum)| {
            sum.width() + 1 + step.offset + self.segments.extra_bit() < MAX_WIDTH
        })
    }

    /// Returns the number of bits of the table. For example, `configs/function.toml`, for 1/√x from 1 to 2, has 16 words of 35
    /// bits.
    pub fn rom_bits(&self) -> u64 {
        let width: u32 = self.coefficients.iter().map(|format| format.width()).sum();
        self.words.len() as u64 * u64::from(width)
    }

    /// Returns the number of look-up tables with four inputs that store the table. A table with fewer than 16 words counts as one
    /// with 16.
    pub fn rom_cells(&self) -> f64 {
        let width: u32 = self.coefficients.iter().map(|format| format.width()).sum();
        table::cells(self.words.len().max(FULL_CELL), width)
    }

    /// Proves a bound on the error at every operand of the domain, in units of the last bit of the result.
    ///
    /// # Errors
    /// Fails if a sum does not fit its format, an error is not below the one that `function` allows, or the function has no value
    /// at an operand. For a domain with more than 2^[`MOST_BITS`] operands, also fails if the proof needs too many intervals.
    pub fn prove(&self, function: &TargetFunction) -> Result<f64, Refusal> {
        let (first, last) = self.domain;
        if matches!(function.curve, Curve::Formula(_)) && function.is_wide() {
            return self.prove_by_segments(function);
        }
        let errors = (first..=last).into_par_iter().map(|raw| self.error_at(function, raw));
        errors.try_reduce(|| 0.0, |a, b| Ok(a.max(b)))
    }

    /// Returns the largest possible error at a raw operand, in units of the result's last bit. Fails if a sum does not fit its
    /// format, if the error is not below the allowed error, or if the function has no value.
    fn error_at(&self, function: &TargetFunction, raw: i64) -> Result<f64, Refusal> {
        let sums = self.sums_of(raw);
        let result = self.restored(raw, sums[0]);
        let mut all = sums.iter().zip(&self.sums).chain([(&result, &self.result)]);
        if let Some((sum, format)) = all.find(|(sum, format)| !format.holds(i128::from(**sum))) {
            let message =
                format!("at the raw operand {raw}, a sum is {sum}, which does not fit {format}");
            return Err(Refusal::new(RefusalKind::ResultBits, message));
        }
        let limits = function.limits(raw).map_err(|fault| function.refusal(raw, &fault))?;
        let result = result as f64;
        let difference = (result - limits.low).abs().max((result - limits.high).abs());
        // A difference of 0 is exact. Any other difference may have been rounded down.
        let error = if difference == 0.0 { 0.0 } else { difference.next_up() };
        if error >= function.error {
            let message =
                format!("at the raw operand {raw}, the error of the result is {error:.4} units");
            let kind = match function.is_wide() {
                true => RefusalKind::Unproved,
                false => RefusalKind::ErrorExceeded,
            };
            return Err(Refusal::new(kind, message));
        }
        Ok(error)
    }
}

/// Returns the cheapest approximation of `function` under the choices `wish` that the search finds and proves. Fails if no
/// approximation can be found and proved.
pub fn find(function: &TargetFunction, wish: Wish) -> Result<Arc<Piecewise>, Refusal> {
    search::search(function, wish).map(Arc::new)
}

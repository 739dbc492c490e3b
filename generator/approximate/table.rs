//! Finds the table of coefficients for given segments: the narrowest coefficients with which the result of every operand is
//! within the allowed error.
//!
//! The search rounds the coefficients one after the other, the highest first. After each it subtracts the part of the function
//! that the hardware computes from the coefficients so far, and fits the rest again. The constant comes last: every operand of a
//! segment allows an interval of constants, and a constant in the intersection of these intervals suits all operands of the
//! segment.

use rayon::prelude::*;

use super::minimax::minimax;
use super::seen::AllowedResults;
use super::{HornerStep, MOST_SUMS, Piecewise, Segments};
use glint_base::fixed::{Format, MAX_WIDTH, exp2};
use glint_base::interval::Interval;

/// Points of a segment to which polynomials are fitted.
const FITTED: i64 = 40;

/// The fraction bits of coefficients, in addition to the fraction bits of the result, with which the search begins.
const GENEROUS: i32 = 8;

/// The fewest of them.
const FEWEST: i32 = -8;

/// Bits of a factor that a multiplier of an FPGA takes, with its sign.
const FACTOR: u32 = 18;

/// Look-up tables for a bit of a partial product that a multiplier does not take, and its adder.
const PARTIAL: f64 = 2.0;

/// Bits of a table that a look-up table of four inputs holds.
pub(super) const BITS_A_CELL: f64 = 16.0;

/// A segment in the search.
pub(super) struct CandidateSegment {
    /// The operands of the segment that the search looks at, as a range of indices.
    seen: std::ops::Range<usize>,
    /// The points to which polynomials are fitted: as offsets, as fractions of the segment, and their values.
    offsets: Vec<i64>,
    at: Vec<f64>,
    values: Vec<f64>,
}

/// The fraction bits in addition to the fraction bits of the result, for the constant first, and the number of leading
/// offset bits that each step multiplies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Widths {
    guard: Vec<i32>,
    offset: Vec<u32>,
}

impl Widths {
    /// Returns the cuts of the products; none if one would have to gain bits.
    fn steps(&self) -> Option<Vec<HornerStep>> {
        let of = |(k, &offset): (usize, &u32)| {
            let dropped = self.guard[k + 1] + offset as i32 - self.guard[k];
            u32::try_from(dropped).ok().map(|dropped| HornerStep { offset, dropped })
        };
        self.offset.iter().enumerate().map(of).collect()
    }

    /// Returns the widths with `change` bits more of variable number `at`, if that may be.
    fn with(&self, at: usize, change: i32) -> Option<Self> {
        let mut other = self.clone();
        match other.guard.get_mut(at) {
            Some(guard) => {
                *guard += change;
                let least = if at == 0 { 0 } else { FEWEST };
                if *guard < least {
                    return None;
                }
            }
            None => {
                let offset = &mut other.offset[at - self.guard.len()];
                *offset = u32::try_from(*offset as i32 + change).ok().filter(|bits| *bits > 0)?;
            }
        }
        Some(other)
    }

    /// Limits every variable to its width in `most`.
    fn no_wider(mut self, most: &Self) -> Self {
        self.guard.iter_mut().zip(&most.guard).for_each(|(own, most)| *own = (*own).min(*most));
        self.offset.iter_mut().zip(&most.offset).for_each(|(own, most)| *own = (*own).min(*most));
        self
    }

    /// Returns how many variables there are.
    fn count(&self) -> usize {
        self.guard.len() + self.offset.len()
    }
}

/// The segments of a domain, in the search for the words of their table.
pub(super) struct Table<'s> {
    seen: &'s AllowedResults<'s>,
    cut: Segments,
    pieces: Vec<Option<CandidateSegment>>,
}

/// The words of a table. `None` is a word that no operand reads.
pub(super) type Words = Vec<Option<Vec<i64>>>;

impl<'s> Table<'s> {
    pub(super) fn new(seen: &'s AllowedResults<'s>, cut: Segments) -> Self {
        let mut table = Self { seen, cut, pieces: Vec::new() };
        table.pieces = table.words().map(|word| table.piece(word)).collect();
        table
    }

    /// Returns the words that operands of the domain read, and those before them.
    fn words(&self) -> impl IndexedParallelIterator<Item = usize> {
        let (first, last) = self.seen.function.domain;
        let ends = [first, last].map(|raw| self.cut.place(self.seen.number(raw)).word);
        (0..ends[0].max(ends[1]) + 1).into_par_iter()
    }

    /// Returns the samples in the segment of a word; none without an operand of the domain.
    fn piece(&self, word: usize) -> Option<CandidateSegment> {
        let Self { seen, cut, .. } = self;
        let (first, last) = seen.function.domain;
        let (from, count) = cut.numbers(word);
        let low = (seen.origin + from as i64).max(first);
        let high = (seen.origin + (from + count - 1) as i64).min(last);
        if low > high {
            return None;
        }
        let before = |raw: i64| ((raw - first) as u64).div_ceil(seen.stride as u64) as usize;
        let many = (high - low + 1).min(FITTED);
        let step = (many - 1).max(1);
        let raws = (0..many).map(|k| low + (high - low) * k / step);
        let point = |raw: i64| {
            // It had limits before: all formulas have, or the nearest operand that was looked at has.
            let value = seen.function.limits(raw).map_or(f64::NAN, |limits| limits.middle());
            (cut.place(seen.number(raw)).offset, value)
        };
        let mut points: Vec<(i64, f64)> = raws.map(point).collect();
        // Halving segments run the other way.
        points.sort_by_key(|it| it.0);
        let unit = exp2(-(cut.rest() as i32));
        Some(CandidateSegment {
            seen: before(low)..before(high + 1).min(seen.right.len()),
            at: points.iter().map(|it| it.0 as f64 * unit).collect(),
            values: points.iter().map(|it| it.1).collect(),
            offsets: points.into_iter().map(|it| it.0).collect(),
        })
    }

    /// Returns whether polynomials of unlimited precision are so near to the function that a rounding to the nearest may be. The
    /// segment of the operand `worst` is looked at first, and one that is too long leaves an operand there: where one cut is too
    /// coarse, others mostly are.
    pub(super) fn may_fit(
        seen: &'s AllowedResults<'s>,
        cut: Segments,
        degree: u32,
        worst: &mut Option<i64>,
    ) -> bool {
        let table = Self { seen, cut, pieces: Vec::new() };
        let fits = |piece: &CandidateSegment| match degree {
            0 => table.constant(piece, &[], &[], 0).is_some(),
            _ => minimax(&piece.at, &piece.values, degree as usize).1 < seen.function.error - 0.5,
        };
        let is_too_long = |word: &usize| table.piece(*word).is_some_and(|piece| !fits(&piece));
        let first = worst.map(|raw| cut.place(seen.number(raw)).word).filter(is_too_long);
        let found = first.or_else(|| table.words().find_any(is_too_long));
        if let Some(word) = found.filter(|_| first.is_none()) {
            let (first, last) = seen.function.domain;
            *worst = Some((seen.origin + cut.numbers(word).0 as i64).clamp(first, last));
        }
        found.is_none()
    }

    /// Returns the narrowest coefficients and offsets, none wider than these, if any are right.
    pub(super) fn narrowest(&self, generous: &Widths) -> Option<(Widths, Words)> {
        let mut words = self.fitted(generous)?;
        // How far each can go alone; together they need about a bit more.
        let mut widths = generous.clone();
        for at in 0..generous.count() {
            let mut alone = generous.clone();
            while let Some(lower) = alone.with(at, -1).filter(|it| self.fitted(it).is_some()) {
                alone = lower;
                widths = widths.with(at, -1)?;
            }
        }
        loop {
            if let Some(found) = self.fitted(&widths) {
                words = found;
                break;
            }
            if widths == *generous {
                break;
            }
            for at in 0..generous.count() {
                widths = widths.with(at, 1)?.no_wider(generous);
            }
        }
        Some(self.lowered(widths, words))
    }

    /// Lowers widths one at a time until no operand would be right any more.
    pub(super) fn lowered(&self, mut widths: Widths, mut words: Words) -> (Widths, Words) {
        let mut changed = true;
        while changed {
            changed = false;
            for at in (0..widths.count()).rev() {
                let Some(lower) = widths.with(at, -1) else { continue };
                if let Some(found) = self.fitted(&lower) {
                    (widths, words, changed) = (lower, found, true);
                }
            }
        }
        (widths, words)
    }

    /// Returns the widths with which the search begins.
    pub(super) fn generous(&self, degree: usize) -> Widths {
        let guard = if degree == 0 { 0 } else { GENEROUS };
        Widths { guard: vec![guard; degree + 1], offset: vec![self.cut.rest(); degree] }
    }

    /// Returns widths that were chosen by fewer operands, a bit wider where these are not right but none wider than these, and
    /// the words with them.
    pub(super) fn settled(&self, mut widths: Widths, most: &Widths) -> Option<(Widths, Words)> {
        let count = widths.count();
        let wider = |widths: &Widths, at| {
            let wider = widths.with(at, 1)?.no_wider(most);
            (wider != *widths).then_some(wider)
        };
        loop {
            let one_wider = (0..count).filter_map(|at| wider(&widths, at));
            for some in [widths.clone()].into_iter().chain(one_wider) {
                if let Some(words) = self.fitted(&some) {
                    return Some((some, words));
                }
            }
            let before = widths.clone();
            for at in 0..count {
                widths = wider(&widths, at).unwrap_or(widths);
            }
            if widths == before {
                return None;
            }
        }
    }

    /// Returns the words of a table with these widths, if there are such with which every operand that is looked at is right.
    fn fitted(&self, widths: &Widths) -> Option<Words> {
        let steps = widths.steps()?;
        let fit = |piece: &Option<CandidateSegment>| match piece {
            None => Some(None),
            Some(piece) => {
                let mut coefficients = vec![0; widths.guard.len()];
                let none = vec![0; piece.at.len()];
                let (shape, degree) = ((widths, &steps[..]), widths.guard.len() - 1);
                let found = self.place(piece, shape, &none, &mut coefficients, degree);
                found.then_some(Some(coefficients))
            }
        };
        self.pieces.par_iter().map(fit).collect()
    }

    /// Chooses coefficient `k` and all lower coefficients. `product` is the addend of coefficient `k` at the points of the
    /// fit.
    fn place(
        &self,
        piece: &CandidateSegment,
        shape: (&Widths, &[HornerStep]),
        product: &[i64],
        coefficients: &mut Vec<i64>,
        k: usize,
    ) -> bool {
        let (widths, steps) = shape;
        if k == 0 {
            let guard = widths.guard[0] as u32;
            let constant = self.constant(piece, &coefficients[1..], steps, guard);
            coefficients[0] = constant.unwrap_or(0);
            return constant.is_some();
        }
        let unit = exp2(-widths.guard[k]);
        let rests = piece.values.iter().zip(&piece.at).zip(product);
        let rests =
            rests.map(|((value, at), &product)| value - product as f64 * unit * at.powi(k as i32));
        let wanted = minimax(&piece.at, &rests.collect::<Vec<f64>>(), k).0[k] / unit;
        let nearest = (wanted + 0.5).floor();
        let other = if wanted < nearest { nearest - 1.0 } else { nearest + 1.0 };
        [nearest, other].into_iter().any(|coefficient| {
            coefficients[k] = coefficient as i64;
            let sums = piece.offsets.iter().zip(product).map(|(&offset, product)| {
                steps[k - 1].product(coefficients[k] + product, offset, self.cut.rest())
            });
            let sums: Vec<i64> = sums.collect();
            self.place(piece, shape, &sums, coefficients, k - 1)
        })
    }

    /// Returns the constant with which every operand of the segment is right: the middle of all such. `above` are the other
    /// coefficients.
    fn constant(
        &self,
        piece: &CandidateSegment,
        above: &[i64],
        steps: &[HornerStep],
        guard: u32,
    ) -> Option<i64> {
        let (mut least, mut most) = (i64::MIN, i64::MAX);
        for (at, &(low, high)) in piece.seen.clone().zip(&self.seen.right[piece.seen.clone()]) {
            let offset = self.cut.place(self.seen.number(self.seen.raw(at))).offset;
            let mut sum = above.last().copied().unwrap_or(0);
            for (k, step) in steps.iter().enumerate().rev() {
                sum = step.product(sum, offset, self.cut.rest());
                if k > 0 {
                    sum += above[k - 1];
                }
            }
            least = least.max((low << guard) - sum);
            most = most.min(((high + 1) << guard) - 1 - sum);
            if least > most {
                return None;
            }
        }
        // No operand was looked at if all operands of the segment lie between the operands that the search visits.
        Some(if least == i64::MIN { 0 } else { least + (most - least) / 2 })
    }

    /// Returns the formats of the coefficients, the constant first.
    fn formats(&self, widths: &Widths, words: &Words) -> Vec<Format> {
        let fraction = self.seen.function.fraction as i32;
        let format = |(k, guard): (usize, &i32)| {
            let (low, high) = words.iter().flatten().fold((i64::MAX, i64::MIN), |ends, word| {
                (ends.0.min(word[k]), ends.1.max(word[k]))
            });
            Format::holding(low.into(), high.into(), fraction + guard)
        };
        widths.guard.iter().enumerate().map(format).collect()
    }

    /// Returns by how many bits each coefficient that is multiplied is too wide for a multiplier.
    fn excess(formats: &[Format]) -> impl Iterator<Item = u32> {
        let signed = |format: &Format| format.width() + u32::from(!format.signed);
        formats.iter().skip(1).map(move |format| signed(format).saturating_sub(FACTOR))
    }

    /// Returns the cost of table and partial products in look-up tables.
    pub(super) fn cost(&self, widths: &Widths, words: &Words) -> f64 {
        let formats = self.formats(widths, words);
        let width: u32 = formats.iter().map(|format| format.width()).sum();
        let partial =
            Self::excess(&formats).zip(&widths.offset).map(|(bits, offset)| bits * offset);
        words.len() as f64 * f64::from(width) / BITS_A_CELL
            + PARTIAL * f64::from(partial.sum::<u32>())
    }

    /// Returns narrower widths than `most`, from which the search begins again so that no factor is too wide; none where none is.
    pub(super) fn within_factors(
        &self,
        most: &Widths,
        widths: &Widths,
        words: &Words,
    ) -> Option<Widths> {
        let mut generous = most.clone();
        let mut is_wide = false;
        for (k, bits) in Self::excess(&self.formats(widths, words)).enumerate() {
            if bits > 0 {
                is_wide = true;
                generous.guard[k + 1] = widths.guard[k + 1] - bits as i32;
            }
        }
        is_wide.then_some(generous)
    }

    /// Returns the approximation with these words, if its nets are not too wide.
    pub(super) fn finished(&self, widths: &Widths, words: Words) -> Option<Piecewise> {
        let AllowedResults { result: polynomial, whole, .. } = self.seen;
        let function = whole.map_or(self.seen.function, |it| it.0);
        let coefficients = self.formats(widths, &words);
        // A word that no operand of the domain reads gets the word before it, or the first known word if there is none before
        // it.
        let mut before = words.iter().flatten().next()?.clone();
        let words = words.into_iter().map(|word| {
            before = word.unwrap_or_else(|| before.clone());
            before.clone()
        });
        let words: Vec<Vec<i64>> = words.collect();
        let mut found = Piecewise {
            operand: function.operand,
            domain: function.domain,
            outside: function.outside,
            reduction: whole.map(|it| it.1.clone()),
            origin: self.seen.origin,
            segments: self.cut,
            coefficients,
            words,
            steps: widths.steps()?,
            sums: vec![*polynomial; widths.guard.len()],
            result: whole.map_or(*polynomial, |it| it.2),
            bound: f64::INFINITY,
        };
        let (low, high) = function.domain;
        let none = [(i128::MAX, i128::MIN); MOST_SUMS];
        let with = |mut ends: [Interval; MOST_SUMS], sums: &[Interval]| {
            for (end, sum) in ends.iter_mut().zip(sums) {
                *end = (end.0.min(sum.0), end.1.max(sum.1));
            }
            ends
        };
        let ends = if function.is_wide() {
            let walks = (0..found.words.len()).filter_map(|word| found.walk(word));
            walks.fold(none, |ends, walk| with(ends, &walk.sums))
        } else {
            let of = |ends, raw| {
                with(ends, &found.sums_of(raw).map(|sum| (i128::from(sum), i128::from(sum))))
            };
            let folded = (low..=high).into_par_iter().fold(|| none, of);
            folded.reduce(|| none, |a, b| with(a, &b))
        };
        let sums = found.sums.iter_mut().zip(ends).zip(&found.coefficients).skip(1);
        for ((sum, (low, high)), coefficient) in sums {
            *sum = Format::holding(low, high, coefficient.frac);
        }
        let products = found.steps.iter().zip(&found.sums[1..]);
        let widest = products.map(|(step, sum)| sum.width() + 1 + step.offset);
        let narrow = widest.max().unwrap_or(0) < MAX_WIDTH;
        narrow.then_some(found)
    }
}

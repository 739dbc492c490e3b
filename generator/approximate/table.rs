//! Finds the table of coefficients for given segments. The search lowers the bit widths one bit at a time, while it finds
//! coefficients with an allowed result at every evaluated operand.
//!
//! The search rounds the coefficients one after the other, the highest first. After each coefficient, the search subtracts the
//! part of the function that the hardware computes from the coefficients so far, and fits the rest again. The constant comes
//! last: every operand of a segment allows an interval of constants, and the constant is taken from the intersection of these
//! intervals.

use rayon::prelude::*;

use super::minimax::minimax;
use super::seen::AllowedResults;
use super::{HornerStep, MOST_SUMS, Piecewise, Segments};
use glint_base::fixed::{Format, exp2};
use glint_base::interval::Interval;

/// The number of points in a segment to which a polynomial is fitted.
const FITTED: i64 = 40;

/// A coefficient begins with this number of fraction bits in addition to the result's.
const GENEROUS: i32 = 8;

/// The smallest number of additional fraction bits. A negative number means fewer fraction bits than the result has.
const FEWEST: i32 = -8;

/// The width of a factor that a multiplier of an FPGA accepts, in bits with the sign.
const FACTOR: u32 = 18;

/// The cost of one bit of a partial product that an FPGA's multiplier does not compute, with the adder, in look-up tables.
const PARTIAL: f64 = 2.0;

/// The number of table bits that a look-up table with four inputs stores.
pub(super) const BITS_A_CELL: f64 = 16.0;

/// A segment, with the operands and points by which the search chooses its coefficients.
pub(super) struct CandidateSegment {
    /// The operands that the search evaluates, as indices into [`AllowedResults::right`].
    seen: std::ops::Range<usize>,
    /// The offsets of the points to which polynomials are fitted. `at` has them as fractions of the segment's length, and
    /// `values` has the function's values there.
    offsets: Vec<i64>,
    at: Vec<f64>,
    values: Vec<f64>,
}

/// The bit widths of coefficients and offsets. `guard` has the fraction bits of each coefficient beyond the result's, the
/// constant first. `offset` has the number of leading offset bits that each step of Horner's rule multiplies. The variables are
/// numbered from 0, first all of `guard`, then all of `offset`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Widths {
    pub(super) guard: Vec<i32>,
    pub(super) offset: Vec<u32>,
}

impl Widths {
    /// Returns the steps of Horner's rule, unless the product of a step would have too few fraction bits for the next
    /// coefficient.
    fn steps(&self) -> Option<Vec<HornerStep>> {
        let mut steps = Vec::with_capacity(self.offset.len());
        for (k, &offset) in self.offset.iter().enumerate() {
            let dropped = self.guard[k + 1] + offset as i32 - self.guard[k];
            let dropped = u32::try_from(dropped).ok()?;
            steps.push(HornerStep { offset, dropped });
        }
        Some(steps)
    }

    /// Adds `change` bits to variable number `at`, unless it would become too small. The limit is 0 for the constant, [`FEWEST`]
    /// for another coefficient, and 1 for an offset.
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

    fn no_wider(mut self, most: &Self) -> Self {
        for (own, most) in self.guard.iter_mut().zip(&most.guard) {
            *own = (*own).min(*most);
        }
        for (own, most) in self.offset.iter_mut().zip(&most.offset) {
            *own = (*own).min(*most);
        }
        self
    }

    /// Adds one bit to variable number `at`, limited to the widths `most`. Returns `None` if that changes nothing.
    fn widened(&self, at: usize, most: &Self) -> Option<Self> {
        let wider = self.with(at, 1)?.no_wider(most);
        (wider != *self).then_some(wider)
    }

    fn count(&self) -> usize {
        self.guard.len() + self.offset.len()
    }
}

pub(super) struct Table<'s> {
    seen: &'s AllowedResults<'s>,
    cut: Segments,
    pieces: Vec<Option<CandidateSegment>>,
    /// The smallest and the largest raw value of each coefficient, the constant first; empty without limits.
    limits: Vec<(i64, i64)>,
}

/// Raw coefficients with the constant first, for each word that an operand reads.
pub(super) type Words = Vec<Option<Vec<i64>>>;

impl<'s> Table<'s> {
    pub(super) fn new(seen: &'s AllowedResults<'s>, cut: Segments) -> Self {
        let mut table = Self { seen, cut, pieces: Vec::new(), limits: Vec::new() };
        table.pieces = table.words().map(|word| table.piece(word)).collect();
        table
    }

    /// Limits the coefficients to the numbers of these formats, the constant first.
    pub(super) fn within(self, formats: &[Format]) -> Self {
        let limits = |format: &Format| (format.min_raw() as i64, format.max_raw() as i64);
        Self { limits: formats.iter().map(limits).collect(), ..self }
    }

    /// Returns the nearest number that coefficient `k` can have.
    fn limited(&self, k: usize, coefficient: i64) -> i64 {
        self.limits.get(k).map_or(coefficient, |&(least, most)| coefficient.clamp(least, most))
    }

    /// Returns the indices up to the last word that an operand of the domain reads.
    fn words(&self) -> impl IndexedParallelIterator<Item = usize> {
        let (first, last) = self.seen.function.domain;
        let ends = [first, last].map(|raw| self.cut.place(self.seen.number(raw)).word);
        (0..ends[0].max(ends[1]) + 1).into_par_iter()
    }

    /// Returns the segment of a word with the points to fit, if an operand of the domain lies in it.
    fn piece(&self, word: usize) -> Option<CandidateSegment> {
        let Self { seen, cut, .. } = self;
        let (first, last) = seen.function.domain;
        let (from, count) = cut.numbers(word);
        let low = (seen.origin + from as i64).max(first);
        let high = (seen.origin + (from + count - 1) as i64).min(last);
        if low > high {
            return None;
        }
        let mut points: Vec<(i64, f64)> = Vec::new();
        let many = (high - low + 1).min(FITTED);
        let step = (many - 1).max(1);
        for k in 0..many {
            let raw = low + (high - low) * k / step;
            let offset = cut.place(seen.number(raw)).offset;
            // This operand has limits: either every operand was evaluated before, or the nearest evaluated one has limits.
            let value = seen.function.limits(raw).map_or(f64::NAN, |limits| limits.middle());
            points.push((offset, value));
        }
        // Offsets fall with rising operands in the layout `Halving`.
        points.sort_by_key(|it| it.0);
        let unit = exp2(-(cut.rest() as i32));
        let mut piece = CandidateSegment {
            seen: seen.seen_below(low)..seen.seen_below(high + 1).min(seen.right.len()),
            offsets: Vec::new(),
            at: Vec::new(),
            values: Vec::new(),
        };
        for (offset, value) in points {
            piece.offsets.push(offset);
            piece.at.push(offset as f64 * unit);
            piece.values.push(value);
        }
        Some(piece)
    }

    /// Returns whether polynomials with unrounded coefficients come near enough to the function in all segments of `cut`. The
    /// segment of the operand `worst` is examined first, because a segment that was too long in one division is often too long
    /// in another. If a segment is too long, `worst` becomes an operand there.
    pub(super) fn may_fit(
        seen: &'s AllowedResults<'s>,
        cut: Segments,
        degree: u32,
        worst: &mut Option<i64>,
    ) -> bool {
        let table = Self { seen, cut, pieces: Vec::new(), limits: Vec::new() };
        if let Some(raw) = *worst
            && table.is_too_long(cut.place(seen.number(raw)).word, degree)
        {
            return false;
        }
        let too_long = table.words().find_any(|word| table.is_too_long(*word, degree));
        let Some(word) = too_long else { return true };
        let (first, last) = seen.function.domain;
        *worst = Some((seen.origin + cut.numbers(word).0 as i64).clamp(first, last));
        false
    }

    /// Returns whether the segment of a word is too long for polynomials of this degree, even with unrounded coefficients. A
    /// segment without operands is never too long.
    fn is_too_long(&self, word: usize, degree: u32) -> bool {
        let Some(piece) = self.piece(word) else { return false };
        if degree == 0 {
            return self.constant(&piece, &[], &[], 0).is_none();
        }
        let (_, error) = minimax(&piece.at, &piece.values, degree as usize);
        let fits = error < self.seen.function.error - 0.5;
        !fits
    }

    /// Returns widths, none above its width in `generous`, for which every operand has an allowed result, and the words of the
    /// table. No single width can be one bit smaller. Returns `None` if the widths `generous` do not suffice.
    pub(super) fn narrowest(&self, generous: &Widths) -> Option<(Widths, Words)> {
        let mut words = self.fitted(generous)?;
        // Each variable is first lowered alone. The combination of all lowered variables usually needs about one bit more.
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

    /// Lowers the widths one bit at a time while the table can still be filled with words.
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

    /// Returns the widths with which the search begins. Degree 0 needs no additional fraction bits.
    pub(super) fn generous(&self, degree: usize) -> Widths {
        let guard = if degree == 0 { 0 } else { GENEROUS };
        Widths { guard: vec![guard; degree + 1], offset: vec![self.cut.rest(); degree] }
    }

    /// Widens `widths`, which fewer operands chose, bit by bit up to the widths `most`, until they suffice. Returns them with
    /// the words, or `None` if the widths `most` do not suffice.
    pub(super) fn settled(&self, mut widths: Widths, most: &Widths) -> Option<(Widths, Words)> {
        let count = widths.count();
        loop {
            if let Some(words) = self.fitted(&widths) {
                return Some((widths, words));
            }
            for at in 0..count {
                let Some(one_wider) = widths.widened(at, most) else { continue };
                if let Some(words) = self.fitted(&one_wider) {
                    return Some((one_wider, words));
                }
            }
            let before = widths.clone();
            for at in 0..count {
                widths = widths.widened(at, most).unwrap_or(widths);
            }
            if widths == before {
                return None;
            }
        }
    }

    /// Returns words of these widths with which every evaluated operand has an allowed result; `None` if none are found.
    pub(super) fn fitted(&self, widths: &Widths) -> Option<Words> {
        let steps = widths.steps()?;
        let fitted_words = self.pieces.par_iter().map(|piece| match piece {
            None => Some(None),
            Some(piece) => self.fitted_piece(piece, widths, &steps).map(Some),
        });
        fitted_words.collect()
    }

    /// Returns coefficients of these widths with which every evaluated operand of the segment has an allowed result.
    fn fitted_piece(
        &self,
        piece: &CandidateSegment,
        widths: &Widths,
        steps: &[HornerStep],
    ) -> Option<Vec<i64>> {
        let degree = widths.guard.len() - 1;
        let mut coefficients = vec![0; degree + 1];
        let no_product = vec![0; piece.at.len()];
        let found = self.place(piece, (widths, steps), &no_product, &mut coefficients, degree);
        found.then_some(coefficients)
    }

    /// Chooses coefficient `k` and all lower ones, of the two nearest integers each, and writes them to `coefficients`.
    /// `product` has the hardware's product that coefficient `k` is added to, at each point of the fit. Returns whether every
    /// evaluated operand of the segment then has an allowed result.
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
            coefficients[0] = self.limited(0, constant.unwrap_or(0));
            return constant == Some(coefficients[0]);
        }
        let unit = exp2(-widths.guard[k]);
        let mut rests: Vec<f64> = Vec::with_capacity(piece.at.len());
        for (point, &product) in product.iter().enumerate() {
            let power = piece.at[point].powi(k as i32);
            rests.push(piece.values[point] - product as f64 * unit * power);
        }
        let (polynomial, _) = minimax(&piece.at, &rests, k);
        let wanted = polynomial[k] / unit;
        let nearest = (wanted + 0.5).floor();
        let other = if wanted < nearest { nearest - 1.0 } else { nearest + 1.0 };
        for coefficient in [nearest, other] {
            coefficients[k] = self.limited(k, coefficient as i64);
            let mut sums: Vec<i64> = Vec::with_capacity(piece.at.len());
            for (&offset, product) in piece.offsets.iter().zip(product) {
                let sum = coefficients[k] + product;
                sums.push(steps[k - 1].product(sum, offset, self.cut.rest()));
            }
            if self.place(piece, shape, &sums, coefficients, k - 1) {
                return true;
            }
        }
        false
    }

    /// Returns the middle of the constants with which every evaluated operand of the segment has an allowed result. `above` has
    /// the other coefficients, the lowest first. `guard` is the number of low bits that the sum drops.
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
        // If the search evaluates no operand of the segment, any constant is allowed.
        Some(if least == i64::MIN { 0 } else { least + (most - least) / 2 })
    }

    /// Returns the narrowest formats that contain the coefficients of all words, the constant first.
    fn formats(&self, widths: &Widths, words: &Words) -> Vec<Format> {
        let fraction = self.seen.function.fraction as i32;
        let mut formats = Vec::with_capacity(widths.guard.len());
        for (k, guard) in widths.guard.iter().enumerate() {
            let (mut low, mut high) = (i64::MAX, i64::MIN);
            for word in words.iter().flatten() {
                low = low.min(word[k]);
                high = high.max(word[k]);
            }
            formats.push(Format::holding(low.into(), high.into(), fraction + guard));
        }
        formats
    }

    /// Returns by how many bits each coefficient is too wide for a multiplier of an FPGA, whose factors have [`FACTOR`] bits
    /// with the sign. The constant is left out, because no multiplier reads it. For example, a signed coefficient of 20 bits
    /// gives 2, and one of 18 bits gives 0.
    fn excess(formats: &[Format]) -> impl Iterator<Item = u32> {
        formats.iter().skip(1).map(|format| {
            let signed_width = format.width() + u32::from(!format.signed);
            signed_width.saturating_sub(FACTOR)
        })
    }

    /// Returns the cost of the table, with at least `least_words` words, and of the partial products, in look-up tables.
    pub(super) fn cost(&self, widths: &Widths, words: &Words, least_words: usize) -> f64 {
        let formats = self.formats(widths, words);
        let width: u32 = formats.iter().map(|format| format.width()).sum();
        let mut partial = 0;
        for (bits, offset) in Self::excess(&formats).zip(&widths.offset) {
            partial += bits * offset;
        }
        cells(words.len().max(least_words), width) + PARTIAL * f64::from(partial)
    }

    /// Returns widths for another search, in which no coefficient is too wide for a multiplier: `most`, with fewer fraction bits
    /// for each coefficient that is too wide. Returns `None` if no coefficient is too wide.
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

    /// Returns the approximation with these words, not yet proved. Returns `None` if a product would be too wide for a
    /// net, or if no operand reads a word.
    pub(super) fn finished(&self, widths: &Widths, words: Words) -> Option<Piecewise> {
        let AllowedResults { result: polynomial, whole, .. } = self.seen;
        let function = whole.map_or(self.seen.function, |it| it.0);
        let coefficients = self.formats(widths, &words);
        // A word that no operand of the domain reads gets the preceding word, or the first known one.
        let mut before = words.iter().flatten().next()?.clone();
        let mut filled: Vec<Vec<i64>> = Vec::with_capacity(words.len());
        for word in words {
            before = word.unwrap_or(before);
            filled.push(before.clone());
        }
        let mut found = Piecewise {
            operand: function.operand,
            domain: function.domain,
            outside: function.outside,
            reduction: whole.map(|it| it.1.clone()),
            origin: self.seen.origin,
            segments: self.cut,
            coefficients,
            words: filled,
            steps: widths.steps()?,
            sums: vec![*polynomial; widths.guard.len()],
            result: whole.map_or(*polynomial, |it| it.2),
            bound: f64::INFINITY,
            is_writable: false,
        };
        let ends = limits_of_sums(&found, function.is_wide());
        for (k, sum) in found.sums.iter_mut().enumerate().skip(1) {
            let (low, high) = ends[k];
            *sum = Format::holding(low, high, found.coefficients[k].frac);
        }
        found.has_narrow_products().then_some(found)
    }
}

/// Returns the number of look-up tables with four inputs that store `words` words of `width` bits.
pub(super) fn cells(words: usize, width: u32) -> f64 {
    words as f64 * f64::from(width) / BITS_A_CELL
}

/// Returns the smallest and the largest value of each partial sum over all operands of the domain. For a wide domain, the limits
/// follow from intervals for each segment and may be too wide.
fn limits_of_sums(found: &Piecewise, is_wide: bool) -> [Interval; MOST_SUMS] {
    let no_limits = [(i128::MAX, i128::MIN); MOST_SUMS];
    if is_wide {
        let mut ends = no_limits;
        for word in 0..found.words.len() {
            if let Some(walk) = found.walk(word) {
                ends = hull(ends, &walk.sums);
            }
        }
        return ends;
    }
    let (low, high) = found.domain;
    let parts = (low..=high).into_par_iter().fold(
        || no_limits,
        |ends, raw| {
            let sums = found.sums_of(raw).map(i128::from);
            hull(ends, &sums.map(|sum| (sum, sum)))
        },
    );
    parts.reduce(|| no_limits, |a, b| hull(a, &b))
}

fn hull(mut ends: [Interval; MOST_SUMS], sums: &[Interval]) -> [Interval; MOST_SUMS] {
    for (end, sum) in ends.iter_mut().zip(sums) {
        *end = (end.0.min(sum.0), end.1.max(sum.1));
    }
    ends
}

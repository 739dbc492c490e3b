//! The search for degree, segments, coefficients and widths.
//!
//! Coefficients are rounded one after the other, the highest first: what the hardware makes of those that are chosen is
//! taken off the function, and the rest is fitted again. The constant closes the search: every operand of a segment allows
//! an interval of constants, and one within all of them is right for all.

use rayon::prelude::*;

use super::minimax::minimax;
use super::{Function, Layout, MOST_BITS, Piecewise, Refusal, Segments, Step};
use crate::base::fixed::{Format, MAX_WIDTH, exp2};
use crate::base::interval::Interval;

/// The choices that a user makes of an approximation; the search makes the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Wish {
    /// The degree.
    pub degree: Option<u32>,
    /// How segments are laid.
    pub layout: Option<Layout>,
}

/// The largest degree.
const DEGREES: u32 = 3;

/// Points of a segment to which polynomials are fitted.
const FITTED: i64 = 40;

/// The most bits of a word's number.
const ADDRESS: u32 = 16;

/// The most operands that the search looks at; of more, these are taken evenly.
const HELD: u64 = 1 << 22;

/// The same, of more operands than can be computed.
const HELD_OF_MANY: u64 = 1 << 18;

/// The most bits of an operand's number.
const WIDEST: u32 = 46;

/// By how much the search is stricter where it does not look at every operand: the next of these where a proof fails.
const STRICTER: [f64; 4] = [0.01, 0.05, 0.12, 0.25];

/// Fraction bits of coefficients beyond those of the result, where the search begins.
const GENEROUS: i32 = 8;

/// The fewest of them.
const FEWEST: i32 = -8;

/// The cost of a step of Horner's rule beside the table, in look-up tables: a sum, and a multiplier's wiring.
const STEP: f64 = 50.0;

/// The cost of an octave: a row of the muxes that bring offsets into their place.
const OCTAVE: f64 = 12.0;

/// Bits of a table that a look-up table of four inputs holds.
const BITS_A_CELL: f64 = 16.0;

/// Errors of which the nearest is told where one is out of reach.
const NEAREST: [f64; 14] =
    [0.51, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 64.0, 256.0];

/// Gives the approximation of least cost, proved.
pub(super) fn search(function: &Function, wish: Wish) -> Result<Piecewise, Refusal> {
    let span = function.domain.1.abs_diff(function.domain.0);
    if span >> WIDEST != 0 {
        let bits = u64::BITS - span.leading_zeros();
        return Err(Refusal::new(
            "operand.fraction",
            format!("operands of the domain have {bits} bits, more than {WIDEST}"),
            format!("at most {}", function.operand.frac - (bits - WIDEST) as i32),
        ));
    }
    if let Some(found) = attempt(function, wish)? {
        return Ok(found);
    }
    let larger = NEAREST.into_iter().filter(|&error| error > function.error);
    let reached = larger.into_iter().find(|&error| {
        matches!(attempt(&Function { error, ..function.clone() }, wish), Ok(Some(_)))
    });
    let keeps = match wish.degree {
        Some(degree) => format!("degree {degree} does not keep"),
        None => format!("no degree up to {DEGREES} keeps"),
    };
    let fewer = "fewer operand.fraction or result.fraction bits";
    Err(Refusal::new(
        "result.error",
        format!(
            "{keeps} an error of {} units within 2^{ADDRESS} words and nets of {MAX_WIDTH} bits",
            function.error
        ),
        match reached {
            Some(error) => format!("{error} is reached; or {fewer}"),
            None => fewer.to_owned(),
        },
    ))
}

/// Gives the approximation of least cost, proved, if there is one.
fn attempt(function: &Function, wish: Wish) -> Result<Option<Piecewise>, Refusal> {
    let mut unproved = None;
    for stricter in STRICTER {
        let Some(seen) = Seen::new(function, stricter)? else { break };
        let Some(found) = cheapest(&seen, wish) else { break };
        match found.prove(function) {
            Ok(bound) => return Ok(Some(Piecewise { bound, ..found })),
            Err(refusal) if seen.stride == 1 => return Err(refusal),
            Err(refusal) => unproved = Some(refusal),
        }
    }
    unproved.map_or(Ok(None), Err)
}

/// Gives the approximation of least cost that is right at every operand that is looked at.
fn cheapest(seen: &Seen, wish: Wish) -> Option<Piecewise> {
    let mut best: Option<(f64, Piecewise)> = None;
    // Those first that are rarely far from the best, so that others are seldom searched to their end.
    for degree in [2, 3, 1, 0].into_iter().filter(|it| wish.degree.is_none_or(|own| own == *it)) {
        let most = |best: &Option<(f64, Piecewise)>| {
            // The constant alone has as many bits as the result.
            let word = f64::from(seen.result.width()) / BITS_A_CELL;
            best.as_ref().map_or(1 << ADDRESS, |(cost, _)| {
                ((cost - STEP * f64::from(degree)) / word).max(0.0) as usize
            })
        };
        for cut in seen.cuts(degree, wish.layout, most(&best)) {
            let base = STEP * f64::from(degree) + OCTAVE * f64::from(cut.octaves);
            if cut.words() > most(&best) {
                continue;
            }
            if let Some(found) = Table::new(seen, cut).narrowest(degree as usize) {
                let cost = base + found.rom_bits() as f64 / BITS_A_CELL;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, found));
                }
            }
        }
    }
    best.map(|(_, found)| found)
}

/// The values of a function at the operands that the search looks at.
struct Seen<'f> {
    function: &'f Function,
    origin: i64,
    bits: u32,
    /// From an operand to the next that is looked at.
    stride: i64,
    /// The results that are right, lowest and highest, of each operand that is looked at.
    right: Vec<(i64, i64)>,
    result: Format,
}

/// A segment in the search.
struct Piece {
    /// Its operands that are looked at, by their numbers among all such.
    seen: std::ops::Range<usize>,
    /// Of those to which polynomials are fitted: offsets, the same as fractions of the segment, and values.
    offsets: Vec<i64>,
    at: Vec<f64>,
    values: Vec<f64>,
}

/// Fraction bits beyond those of the result, the constant's first, and leading bits of the offset at each step.
#[derive(Clone, Debug, PartialEq)]
struct Widths {
    guard: Vec<i32>,
    offset: Vec<u32>,
}

impl Widths {
    /// The cuts of the products; none if one would have to gain bits.
    fn steps(&self) -> Option<Vec<Step>> {
        let of = |(k, &offset): (usize, &u32)| {
            let dropped = self.guard[k + 1] + offset as i32 - self.guard[k];
            u32::try_from(dropped).ok().map(|dropped| Step { offset, dropped })
        };
        self.offset.iter().enumerate().map(of).collect()
    }

    /// One bit fewer or more of variable number `at`, if that may be.
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

    /// No variable wider than in another.
    fn no_wider(mut self, most: &Self) -> Self {
        self.guard.iter_mut().zip(&most.guard).for_each(|(own, most)| *own = (*own).min(*most));
        self.offset.iter_mut().zip(&most.offset).for_each(|(own, most)| *own = (*own).min(*most));
        self
    }

    /// How many variables there are.
    fn count(&self) -> usize {
        self.guard.len() + self.offset.len()
    }
}

impl<'f> Seen<'f> {
    /// Evaluates the function; none if an operand has no result that is right. Where it does not look at every operand, less
    /// error is allowed by `stricter`.
    fn new(function: &'f Function, stricter: f64) -> Result<Option<Self>, Refusal> {
        let (first, last) = function.domain;
        let (origin, bits) = function.numbering();
        let count = (last - first) as u64 + 1;
        let held = if function.is_wide() { HELD_OF_MANY } else { HELD };
        // An odd one, so that the low bits take every value.
        let stride = if count > held { count.div_ceil(held) as i64 | 1 } else { 1 };
        let stricter = if stride > 1 { stricter } else { 0.0 };
        let of = |at: u64| {
            let raw = (first + at as i64 * stride).min(last);
            let limits = function.limits(raw).map_err(|fault| function.refusal(raw, &fault))?;
            if limits.low.abs().max(limits.high.abs()) > exp2(48) {
                let message = format!("at the operand {raw} the result has more than 48 bits");
                let remedy = "fewer fraction bits, or another domain";
                return Err(Refusal::new("result.fraction", message, remedy));
            }
            let error = function.allowed(raw) - stricter;
            let nearest = (limits.middle() + 0.5).floor() as i64;
            // Nearer than the error, whatever the exact value is.
            let low = (limits.high - error).floor() as i64 + 1;
            let high = (limits.low + error).ceil() as i64 - 1;
            Ok((nearest, low, high))
        };
        let seen = count.div_ceil(stride as u64) + u64::from(stride > 1);
        let all: Vec<(i64, i64, i64)> =
            (0..seen).into_par_iter().map(of).collect::<Result<_, _>>()?;
        let low = all.iter().map(|it| it.0).min().unwrap_or(0);
        let high = all.iter().map(|it| it.0).max().unwrap_or(0);
        let result = Format::holding(low.into(), high.into(), function.fraction as i32);
        let (least, most) = (result.min_raw() as i64, result.max_raw() as i64);
        let right: Vec<(i64, i64)> =
            all.iter().map(|&(_, low, high)| (low.max(least), high.min(most))).collect();
        if right.iter().any(|(low, high)| low > high) {
            return Ok(None);
        }
        Ok(Some(Self { function, origin, bits, stride, right, result }))
    }

    fn raw(&self, seen: usize) -> i64 {
        let (first, last) = self.function.domain;
        (first + seen as i64 * self.stride).min(last)
    }

    fn number(&self, raw: i64) -> u64 {
        (raw - self.origin) as u64
    }

    /// Ways to cut the domain, into no more than `most` segments, that are fine enough for polynomials of the degree, before
    /// anything is rounded.
    fn cuts(&self, degree: u32, layout: Option<Layout>, most: usize) -> Vec<Segments> {
        let possible = |cut: &Segments| {
            cut.words() <= most.min(1 << ADDRESS)
                && cut.octaves + cut.prefix + u32::from(degree > 0) <= self.bits
        };
        let fits = |cut: &Segments| Table::new(self, *cut).may_fit(degree);
        let finest = |layout: Layout, octaves: u32| {
            let cut = |prefix| Segments { bits: self.bits, layout, octaves, prefix };
            let least = u32::from(octaves == 0);
            (least..=ADDRESS).map(cut).take_while(possible).find(fits)
        };
        let mut cuts: Vec<Segments> = Vec::new();
        let wanted = |own: Layout| layout.is_none_or(|layout| layout == own);
        if wanted(Layout::Uniform) {
            cuts.extend(finest(Layout::Uniform, 0));
        }
        let uniform = cuts.first().map_or(most, Segments::words);
        for own in [Layout::Octaves, Layout::Halving].into_iter().filter(|own| wanted(*own)) {
            let mut least = if layout.is_some() { usize::MAX } else { uniform };
            for octaves in 1..self.bits.min(MOST_BITS) {
                let Some(cut) = finest(own, octaves) else { continue };
                if cut.words() < least {
                    least = cut.words();
                    cuts.push(cut);
                } else if octaves > 4 && cut.words() > least {
                    // More octaves have more words from here on.
                    break;
                }
            }
        }
        let finer: Vec<Segments> =
            cuts.iter().map(|cut| Segments { prefix: cut.prefix + 1, ..*cut }).collect();
        cuts.extend(finer.into_iter().filter(possible));
        cuts.sort_by_key(Segments::words);
        cuts
    }
}

/// The segments of a domain, in the search for the words of their table.
struct Table<'s> {
    seen: &'s Seen<'s>,
    cut: Segments,
    pieces: Vec<Option<Piece>>,
}

/// The words of a table, of which those that no operand reads are not known.
type Words = Vec<Option<Vec<i64>>>;

impl<'s> Table<'s> {
    fn new(seen: &'s Seen<'s>, cut: Segments) -> Self {
        let (first, last) = seen.function.domain;
        let ends = [first, last].map(|raw| cut.place(seen.number(raw)).word);
        let words = 0..ends[0].max(ends[1]) + 1;
        let pieces = words.into_par_iter().map(|word| Self::piece(seen, cut, word)).collect();
        Self { seen, cut, pieces }
    }

    /// The samples in the segment of a word; none without an operand of the domain.
    fn piece(seen: &Seen, cut: Segments, word: usize) -> Option<Piece> {
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
        Some(Piece {
            seen: before(low)..before(high + 1).min(seen.right.len()),
            at: points.iter().map(|it| it.0 as f64 * unit).collect(),
            values: points.iter().map(|it| it.1).collect(),
            offsets: points.into_iter().map(|it| it.0).collect(),
        })
    }

    /// Whether polynomials of unlimited precision are so near to the function that a rounding to the nearest may be.
    fn may_fit(&self, degree: u32) -> bool {
        let fits = |piece: &Piece| match degree {
            0 => self.constant(piece, &[], &[], 0).is_some(),
            _ => {
                minimax(&piece.at, &piece.values, degree as usize).1
                    < self.seen.function.error - 0.5
            }
        };
        self.pieces.par_iter().flatten().all(fits)
    }

    /// The narrowest coefficients and offsets, if any are right.
    fn narrowest(&self, degree: usize) -> Option<Piecewise> {
        let guard = if degree == 0 { 0 } else { GENEROUS };
        let rest = self.cut.rest();
        let generous = Widths { guard: vec![guard; degree + 1], offset: vec![rest; degree] };
        let mut words = self.words(&generous)?;
        // How far each can go alone; together they need about a bit more.
        let mut widths = generous.clone();
        for at in 0..generous.count() {
            let mut alone = generous.clone();
            while let Some(lower) = alone.with(at, -1).filter(|it| self.words(it).is_some()) {
                alone = lower;
                widths = widths.with(at, -1)?;
            }
        }
        loop {
            if let Some(found) = self.words(&widths) {
                words = found;
                break;
            }
            if widths == generous {
                break;
            }
            for at in 0..generous.count() {
                widths = widths.with(at, 1)?.no_wider(&generous);
            }
        }
        let mut changed = true;
        while changed {
            changed = false;
            for at in (0..generous.count()).rev() {
                let Some(lower) = widths.with(at, -1) else { continue };
                if let Some(found) = self.words(&lower) {
                    (widths, words, changed) = (lower, found, true);
                }
            }
        }
        self.finished(&widths, words)
    }

    /// The words of a table with these widths, if there are such with which every operand that is looked at is right.
    fn words(&self, widths: &Widths) -> Option<Words> {
        let steps = widths.steps()?;
        let fit = |piece: &Option<Piece>| match piece {
            None => Some(None),
            Some(piece) => {
                let mut coefficients = vec![0; widths.guard.len()];
                let none = vec![0; piece.at.len()];
                let found = self.place(
                    piece,
                    (widths, &steps),
                    &none,
                    &mut coefficients,
                    widths.guard.len() - 1,
                );
                found.then_some(Some(coefficients))
            }
        };
        self.pieces.par_iter().map(fit).collect()
    }

    /// Chooses coefficient `k` and those below it; `product` is what is added to it at the points of the fit.
    fn place(
        &self,
        piece: &Piece,
        shape: (&Widths, &[Step]),
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

    /// The constant with which every operand of the segment is right: the middle of all such. `above` are the other
    /// coefficients.
    fn constant(&self, piece: &Piece, above: &[i64], steps: &[Step], guard: u32) -> Option<i64> {
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
        // None is looked at where the operands of a segment lie between those that are.
        Some(if least == i64::MIN { 0 } else { least + (most - least) / 2 })
    }

    /// The approximation with these words, if its nets are not too wide.
    fn finished(&self, widths: &Widths, words: Words) -> Option<Piecewise> {
        let function = self.seen.function;
        let fraction = function.fraction as i32;
        // A word that no operand of the domain reads has what stands before or behind it.
        let first = words.iter().flatten().next()?.clone();
        let mut before = first;
        let words: Vec<Vec<i64>> = words
            .into_iter()
            .map(|word| {
                before = word.unwrap_or_else(|| before.clone());
                before.clone()
            })
            .collect();
        let holding = |values: &mut dyn Iterator<Item = i64>, fraction: i32| {
            let (low, high) = values
                .fold((i64::MAX, i64::MIN), |(low, high), value| (low.min(value), high.max(value)));
            Format::holding(low.into(), high.into(), fraction)
        };
        let formats = widths.guard.iter().enumerate();
        let formats = formats
            .map(|(k, guard)| holding(&mut words.iter().map(|word| word[k]), fraction + guard));
        let mut found = Piecewise {
            operand: function.operand,
            domain: function.domain,
            outside: function.outside,
            origin: self.seen.origin,
            segments: self.cut,
            coefficients: formats.collect(),
            words,
            steps: widths.steps()?,
            sums: vec![self.seen.result; widths.guard.len()],
            bound: f64::INFINITY,
        };
        let (low, high) = function.domain;
        let none = vec![(i128::MAX, i128::MIN); widths.guard.len()];
        let with = |mut ends: Vec<Interval>, sums: &[Interval]| {
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
                let sums = found.sums_of(raw).into_iter().map(i128::from);
                with(ends, &sums.map(|sum| (sum, sum)).collect::<Vec<_>>())
            };
            let folded = (low..=high).into_par_iter().fold(|| none.clone(), of);
            folded.reduce(|| none.clone(), |a, b| with(a, &b))
        };
        for (k, (low, high)) in ends.iter().enumerate().skip(1) {
            found.sums[k] = Format::holding(*low, *high, found.coefficients[k].frac);
        }
        let widest = found
            .steps
            .iter()
            .zip(&found.sums[1..])
            .map(|(step, sum)| sum.width() + 1 + step.offset);
        let narrow = widest.max().unwrap_or(0) < MAX_WIDTH;
        narrow.then_some(found)
    }
}

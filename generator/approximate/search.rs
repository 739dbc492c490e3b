//! The search for degree, segments, coefficients and widths.
//!
//! Coefficients are rounded one after the other, the highest first: what the hardware makes of those that are chosen is
//! taken off the function, and the rest is fitted again. The constant closes the search: every operand of a segment allows
//! an interval of constants, and one within all of them is right for all.

use rayon::prelude::*;

use super::minimax::minimax;
use super::reduction::KEY;
use super::{
    Function, Identity, Layout, MOST_BITS, MOST_SUMS, Piecewise, Reduction, Refusal, Segments, Step,
};
use glint_base::fixed::{Format, MAX_WIDTH, exp2};
use glint_base::interval::Interval;

/// The choices that a user makes of an approximation; the search makes the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Wish {
    /// The degree.
    pub degree: Option<u32>,
    /// How segments are laid.
    pub layout: Option<Layout>,
    /// The identity by which operands are reduced.
    pub identity: Identity,
}

/// The largest degree.
const DEGREES: u32 = 3;

/// Points of a segment to which polynomials are fitted.
const FITTED: i64 = 40;

/// The most bits of a word's number.
const ADDRESS: u32 = 16;

/// The most operands that the search looks at; of more, these are taken evenly.
const HELD: u64 = 1 << 25;

/// The most operands by which degree, segments and widths are chosen.
const CHOOSING: usize = 1 << 16;

/// The most operands by which widths are widened, before all have their say.
const WIDENING: usize = 1 << 20;

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
    if wish.identity != Identity::None {
        return attempt_reduced(function, wish);
    }
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

/// Fraction bits of a polynomial beyond those of the result, and whether the largest size has a number of its own: these are
/// tried one after the other where operands are reduced.
fn variants(identity: Identity) -> &'static [(u32, bool)] {
    match identity {
        Identity::Odd | Identity::Even => &[(0, false), (0, true)],
        Identity::Octaves | Identity::Exponent => {
            &[(0, false), (2, false), (4, false), (6, false), (8, false)]
        }
        Identity::Quadrants | Identity::None => &[(0, false)],
    }
}

/// As [`attempt`], of operands that are reduced.
fn attempt_reduced(function: &Function, wish: Wish) -> Result<Option<Piecewise>, Refusal> {
    if function.is_wide() {
        let message = format!("the domain has more than 2^{MOST_BITS} operands to be computed");
        return Err(Refusal::new(KEY, message, "\"none\", or fewer operand.fraction bits"));
    }
    for &(guard, wider) in variants(wish.identity) {
        let (reduction, inner) = Reduction::of(wish.identity, function, guard, wider)?;
        let Some(seen) = Seen::reduced(function, &reduction, &inner)? else { continue };
        if let Some(found) = cheapest(&seen, wish) {
            return found.prove(function).map(|bound| Some(Piecewise { bound, ..found }));
        }
    }
    Ok(None)
}

/// Gives the approximation of least cost that is right at every operand that is looked at.
fn cheapest(seen: &Seen, wish: Wish) -> Option<Piecewise> {
    let few = seen.thinned(CHOOSING);
    let mut found: Vec<(f64, Segments, Widths)> = Vec::new();
    let mut least = f64::INFINITY;
    // Those first that are rarely far from the best, so that others are seldom searched to their end.
    for degree in [2, 3, 1, 0].into_iter().filter(|it| wish.degree.is_none_or(|own| own == *it)) {
        let most = |least: f64| {
            // The constant alone has as many bits as the result.
            let word = f64::from(seen.result.width()) / BITS_A_CELL;
            (((least - STEP * f64::from(degree)) / word).max(0.0) as usize).min(1 << ADDRESS)
        };
        for cut in few.cuts(degree, wish.layout, most(least)) {
            let base = STEP * f64::from(degree) + OCTAVE * f64::from(cut.octaves);
            if cut.words() > most(least) {
                continue;
            }
            let table = Table::new(&few, cut);
            if let Some((widths, words)) = table.narrowest(degree as usize) {
                let cost = base + table.bits(&widths, &words) as f64 / BITS_A_CELL;
                least = least.min(cost);
                found.push((cost, cut, widths));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let more = seen.thinned(WIDENING);
    found.into_iter().find_map(|(_, cut, widths)| {
        let (widths, _) = Table::new(&more, cut).settled(widths)?;
        let table = Table::new(seen, cut);
        let (widths, words) = table.settled(widths)?;
        table.finished(&widths, words)
    })
}

/// The values of a function at the operands that the search looks at.
struct Seen<'f> {
    function: &'f Function,
    origin: i64,
    bits: u32,
    /// From an operand to the next that is looked at.
    stride: i64,
    /// The polynomials that are right, lowest and highest, of each operand that is looked at.
    right: Vec<(i64, i64)>,
    /// The polynomial's format.
    result: Format,
    /// The function of the operands that were reduced to these, and the format of its results.
    whole: Option<(&'f Function, &'f Reduction, Format)>,
}

/// The results that are right of some operands, and between which numbers the nearest are.
struct Nearest {
    right: Vec<(i64, i64)>,
    nearest: (i64, i64),
}

impl Default for Nearest {
    fn default() -> Self {
        Self { right: Vec::new(), nearest: (i64::MAX, i64::MIN) }
    }
}

impl Nearest {
    fn with(mut self, it: Result<(i64, i64, i64), Refusal>) -> Result<Self, Refusal> {
        let (nearest, low, high) = it?;
        self.right.push((low, high));
        self.nearest = (self.nearest.0.min(nearest), self.nearest.1.max(nearest));
        Ok(self)
    }

    fn and(mut self, mut other: Self) -> Self {
        self.right.append(&mut other.right);
        let (low, high) = other.nearest;
        Self { nearest: (self.nearest.0.min(low), self.nearest.1.max(high)), ..self }
    }
}

/// A segment in the search.
struct Piece {
    /// Its operands that are looked at, by their numbers among all such.
    seen: std::ops::Range<usize>,
    /// The points to which polynomials are fitted: offsets, the same as fractions of the segment, and values.
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

impl Function {
    /// The result that is nearest at a raw operand, and the lowest and the highest that are right where less error is allowed
    /// by `stricter`.
    fn right(&self, raw: i64, stricter: f64) -> Result<(i64, i64, i64), Refusal> {
        let limits = self.limits(raw).map_err(|fault| self.refusal(raw, &fault))?;
        if limits.low.abs().max(limits.high.abs()) > exp2(48) {
            let message = format!("at the operand {raw} the result has more than 48 bits");
            let remedy = "fewer fraction bits, or another domain";
            return Err(Refusal::new("result.fraction", message, remedy));
        }
        let error = self.allowed(raw) - stricter;
        let nearest = (limits.middle() + 0.5).floor() as i64;
        // Nearer than the error, whatever the exact value is.
        let low = (limits.high - error).floor() as i64 + 1;
        let high = (limits.low + error).ceil() as i64 - 1;
        Ok((nearest, low, high))
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
        let of = |at: u64| function.right((first + at as i64 * stride).min(last), stricter);
        let seen = count.div_ceil(stride as u64) + u64::from(stride > 1);
        let all = (0..seen).into_par_iter().map(of).try_fold(Nearest::default, Nearest::with);
        let all = all.try_reduce(Nearest::default, |a, b| Ok(a.and(b)))?;
        let (low, high) = all.nearest;
        let result = Format::holding(low.into(), high.into(), function.fraction as i32);
        let (least, most) = (result.min_raw() as i64, result.max_raw() as i64);
        let mut right = all.right;
        right.iter_mut().for_each(|it| *it = (it.0.max(least), it.1.min(most)));
        if right.iter().any(|(low, high)| low > high) {
            return Ok(None);
        }
        Ok(Some(Self { function, origin, bits, stride, right, result, whole: None }))
    }

    /// Evaluates a function whose operands are reduced: a polynomial is right with which the results of all operands are that
    /// are reduced to its own.
    fn reduced(
        whole: &'f Function,
        reduction: &'f Reduction,
        inner: &'f Function,
    ) -> Result<Option<Self>, Refusal> {
        let Some(mut seen) = Self::new(inner, 0.0)? else { return Ok(None) };
        let all = (seen.result.min_raw() as i64, seen.result.max_raw() as i64);
        seen.right.fill(all);
        let (first, last) = whole.domain;
        let nearest = (first..=last).into_par_iter().map(|raw| whole.right(raw, 0.0));
        let ends = nearest.map(|it| it.map(|(nearest, ..)| (nearest, nearest)));
        let (low, high) =
            ends.try_reduce(|| (i64::MAX, i64::MIN), |a, b| Ok((a.0.min(b.0), a.1.max(b.1))))?;
        let result = Format::holding(low.into(), high.into(), whole.fraction as i32);
        let (least, most) = (result.min_raw() as i64, result.max_raw() as i64);
        for from in (first..=last).step_by(CHOOSING) {
            let of = |raw: i64| {
                let (_, low, high) = whole.right(raw, 0.0)?;
                let (number, restore) = reduction.reduce(raw);
                Ok((number as usize, restore.polynomials((low.max(least), high.min(most)))))
            };
            let some: Vec<_> = (from..=last.min(from + CHOOSING as i64 - 1))
                .into_par_iter()
                .map(of)
                .collect::<Result<_, Refusal>>()?;
            for (number, (low, high)) in some {
                let right = &mut seen.right[number];
                *right = (right.0.max(low), right.1.min(high));
                if right.0 > right.1 {
                    return Ok(None);
                }
            }
        }
        seen.whole = Some((whole, reduction, result));
        Ok(Some(seen))
    }

    /// No more than `most` of the operands or so, taken evenly.
    fn thinned(&self, most: usize) -> Self {
        // An odd one, so that the low bits take every value.
        let by = if self.right.len() > most { (self.right.len() / most) | 1 } else { 1 };
        let last = self.right.last().filter(|_| by > 1);
        let right = self.right.iter().step_by(by).chain(last).copied().collect();
        Self { stride: self.stride * by as i64, right, ..*self }
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
    fn narrowest(&self, degree: usize) -> Option<(Widths, Words)> {
        let generous = self.generous(degree);
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
        Some((widths, words))
    }

    /// The widths with which the search begins.
    fn generous(&self, degree: usize) -> Widths {
        let guard = if degree == 0 { 0 } else { GENEROUS };
        Widths { guard: vec![guard; degree + 1], offset: vec![self.cut.rest(); degree] }
    }

    /// Widths that were chosen by fewer operands, a bit wider where these are not right, and the words with them.
    fn settled(&self, mut widths: Widths) -> Option<(Widths, Words)> {
        let generous = self.generous(widths.offset.len());
        let wider = |widths: &Widths, at| {
            let wider = widths.with(at, 1)?.no_wider(&generous);
            (wider != *widths).then_some(wider)
        };
        loop {
            let one_wider = (0..generous.count()).filter_map(|at| wider(&widths, at));
            for some in [widths.clone()].into_iter().chain(one_wider) {
                if let Some(words) = self.words(&some) {
                    return Some((some, words));
                }
            }
            let before = widths.clone();
            for at in 0..generous.count() {
                widths = wider(&widths, at).unwrap_or(widths);
            }
            if widths == before {
                return None;
            }
        }
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

    /// The formats of the coefficients, the constant first.
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

    /// Bits of the table.
    fn bits(&self, widths: &Widths, words: &Words) -> u64 {
        let width: u32 = self.formats(widths, words).iter().map(|format| format.width()).sum();
        words.len() as u64 * u64::from(width)
    }

    /// The approximation with these words, if its nets are not too wide.
    fn finished(&self, widths: &Widths, words: Words) -> Option<Piecewise> {
        let Seen { result: polynomial, whole, .. } = self.seen;
        let function = whole.map_or(self.seen.function, |it| it.0);
        let coefficients = self.formats(widths, &words);
        // A word that no operand of the domain reads has what stands before or behind it.
        let mut before = words.iter().flatten().next()?.clone();
        let words: Vec<Vec<i64>> = words
            .into_iter()
            .map(|word| {
                before = word.unwrap_or_else(|| before.clone());
                before.clone()
            })
            .collect();
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
        let widest = found
            .steps
            .iter()
            .zip(&found.sums[1..])
            .map(|(step, sum)| sum.width() + 1 + step.offset);
        let narrow = widest.max().unwrap_or(0) < MAX_WIDTH;
        narrow.then_some(found)
    }
}

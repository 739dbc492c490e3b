//! Searches for the cheapest piecewise polynomial that approximates a function. It tries degrees, segments and bit widths, and
//! finds the coefficients for each.

use super::reduction::KEY;
use super::seen::AllowedResults;
use super::table::{BITS_A_CELL, Table, Widths};
use super::{
    Curve, Identity, Layout, MOST_BITS, Numbering, Piecewise, Reduction, Refusal, Segments,
    TargetFunction,
};
use glint_base::fixed::MAX_WIDTH;

/// The choices that the user has made for an approximation. The search is free in all other choices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Wish {
    /// The degree of the polynomials, or `None` for the cheapest.
    pub degree: Option<u32>,
    /// The layout of the segments, or `None` for the cheapest.
    pub layout: Option<Layout>,
    /// The identity that the range reduction uses, for example f(−x) = f(x).
    pub identity: Identity,
    /// The number of words by which a shorter table is counted. A look-up table of four inputs holds 16 words of a bit, and is
    /// used whole if there are fewer.
    pub least_words: usize,
}

/// The degree that a polynomial may have at most.
const DEGREES: u32 = 3;

/// The number of bits that the number of a word may have.
const ADDRESS: u32 = 16;

/// The most operands by which degree, segments and widths are chosen.
const CHOOSING: usize = 1 << 16;

/// The most operands by which widths are widened, before all have their say.
const WIDENING: usize = 1 << 20;

/// The number of bits that the number of an operand may have.
const WIDEST: u32 = 46;

/// How much stricter the search is if it does not look at every operand. Each number is a fraction of the allowed error minus
/// the rounding of the result (half a unit). If a proof fails, the search tries the next number.
const STRICTER: [f64; 5] = [0.02, 0.1, 0.25, 0.5, 0.75];

/// The cost of a step of Horner's rule beside the table, in look-up tables: a sum, and a multiplier's wiring.
const STEP: f64 = 50.0;

/// The cost of an octave: a row of the muxes that bring offsets into their place.
const OCTAVE: f64 = 12.0;

/// The errors to try if the allowed error is out of reach. The message names the smallest one that is reached.
const NEAREST: [f64; 14] =
    [0.51, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 64.0, 256.0];

/// Finds the cheapest approximation of `function` that `wish` allows, and proves its error bound.
///
/// # Errors
/// Fails if the domain has too many operands, or if no approximation that keeps the error is found and proved. The error
/// names a key and a remedy.
pub(super) fn search(function: &TargetFunction, wish: Wish) -> Result<Piecewise, Refusal> {
    let span = function.domain.1.abs_diff(function.domain.0);
    if span >> WIDEST != 0 {
        let bits = u64::BITS - span.leading_zeros();
        return Err(Refusal::new(
            "operand.fraction",
            format!("operands of the domain have {bits} bits, more than {WIDEST}"),
            format!("at most {}", function.operand.frac - (bits - WIDEST) as i32),
        ));
    }
    if matches!(function.curve, Curve::Samples(_)) && function.is_wide() {
        let message =
            format!("of samples every operand is computed, and there are more than 2^{MOST_BITS}");
        return Err(Refusal::new("operand.fraction", message, "fewer operand.fraction bits"));
    }
    if let Some(found) = attempt(function, wish)? {
        return Ok(found);
    }
    let count_missed = NEAREST.partition_point(|error| {
        let larger = TargetFunction { error: *error, ..function.clone() };
        *error <= function.error || !matches!(attempt(&larger, wish), Ok(Some(_)))
    });
    let reached = NEAREST.get(count_missed);
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
fn attempt(function: &TargetFunction, wish: Wish) -> Result<Option<Piecewise>, Refusal> {
    if wish.identity != Identity::None {
        return attempt_reduced(function, wish);
    }
    for numbering in function.numberings(wish.layout) {
        if let Some(found) = attempt_numbered(function, wish, numbering)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// Gives the approximation of least cost, proved, with these numbers of the operands, if there is one.
fn attempt_numbered(
    function: &TargetFunction,
    wish: Wish,
    numbering: Numbering,
) -> Result<Option<Piecewise>, Refusal> {
    let mut unproved = None;
    for stricter in STRICTER {
        let stricter = stricter * (function.error - 0.5);
        let Some(seen) = AllowedResults::new(function, stricter, numbering)? else { break };
        let Some(found) = cheapest(&seen, wish) else { break };
        match found.prove(function) {
            Ok(bound) => return Ok(Some(Piecewise { bound, ..found })),
            Err(refusal) if seen.stride == 1 => return Err(refusal),
            Err(refusal) => unproved = Some(refusal),
        }
    }
    unproved.map_or(Ok(None), Err)
}

/// Returns the forms of a polynomial to try in turn if operands are reduced. A form is the number of fraction bits in addition
/// to the fraction bits of the result, and whether the largest size has a number of its own.
fn variants(identity: Identity) -> &'static [(u32, bool)] {
    match identity {
        Identity::Odd | Identity::Even => &[(0, false), (0, true)],
        Identity::Octaves | Identity::Exponent => {
            &[(0, false), (2, false), (4, false), (6, false), (8, false)]
        }
        Identity::Quadrants | Identity::None => &[(0, false)],
    }
}

/// Gives the first approximation, proved, that one of the [`variants`] of reduced operands has, if there is one.
fn attempt_reduced(function: &TargetFunction, wish: Wish) -> Result<Option<Piecewise>, Refusal> {
    if function.is_wide() {
        let message = format!("the domain has more than 2^{MOST_BITS} operands to be computed");
        return Err(Refusal::new(KEY, message, "\"none\", or fewer operand.fraction bits"));
    }
    for &(guard, wider) in variants(wish.identity) {
        let (reduction, inner) = Reduction::of(wish.identity, function, guard, wider)?;
        for numbering in inner.numberings(wish.layout) {
            let seen = AllowedResults::reduced(function, &reduction, &inner, numbering)?;
            if let Some(found) = seen.and_then(|seen| cheapest(&seen, wish)) {
                return found.prove(function).map(|bound| Some(Piecewise { bound, ..found }));
            }
        }
    }
    Ok(None)
}

/// Gives the approximation of least cost that is right at every operand that is looked at.
fn cheapest(seen: &AllowedResults, wish: Wish) -> Option<Piecewise> {
    let few = seen.thinned(CHOOSING);
    let mut found: Vec<(f64, Segments, Widths, Widths)> = Vec::new();
    let mut least = f64::INFINITY;
    // Those first that are rarely far from the best, so that others are seldom searched to their end.
    for degree in [2, 3, 1, 0] {
        if wish.degree.is_some_and(|wanted| wanted != degree) {
            continue;
        }
        for cut in cuts(&few, degree, wish.layout, most_words(seen, degree, least)) {
            let base = STEP * f64::from(degree) + OCTAVE * f64::from(cut.octaves);
            if cut.words() > most_words(seen, degree, least) {
                continue;
            }
            let table = Table::new(&few, cut);
            let mut generous = Some(table.generous(degree as usize));
            while let Some(most) = generous
                && let Some((widths, words)) = table.narrowest(&most)
            {
                let cost = base + table.cost(&widths, &words, wish.least_words);
                least = least.min(cost);
                generous = table.within_factors(&most, &widths, &words);
                found.push((cost, cut, widths, most));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let more = seen.thinned(WIDENING);
    found.into_iter().find_map(|(_, cut, chosen, most)| {
        let table = Table::new(&more, cut);
        let (mut widened, words) = table.settled(chosen.clone(), &most)?;
        if widened != chosen {
            (widened, _) = table.lowered(widened, words);
        }
        let table = Table::new(seen, cut);
        let (widths, words) = table.settled(widened, &most)?;
        table.finished(&widths, words)
    })
}

/// Returns the most words that a table may have to cost no more than `least`: the constant alone has as many bits as the result.
fn most_words(seen: &AllowedResults, degree: u32, least: f64) -> usize {
    let word = f64::from(seen.result.width()) / BITS_A_CELL;
    (((least - STEP * f64::from(degree)) / word).max(0.0) as usize).min(1 << ADDRESS)
}

/// Returns the ways to cut the domain, into no more than `most` segments, that are fine enough for polynomials of the degree,
/// before anything is rounded.
fn cuts(seen: &AllowedResults, degree: u32, layout: Option<Layout>, most: usize) -> Vec<Segments> {
    let mut search = CutSearch { seen, degree, most, worst: None };
    let mut cuts: Vec<Segments> = Vec::new();
    if layout.is_none_or(|wanted| wanted == Layout::Uniform) {
        cuts.extend(search.coarsest(Layout::Uniform, 0));
    }
    let uniform = cuts.first().map_or(most, Segments::words);
    for own in [Layout::Octaves, Layout::Halving] {
        if layout.is_some_and(|wanted| wanted != own) {
            continue;
        }
        let mut least = if layout.is_some() { usize::MAX } else { uniform };
        for octaves in 1..seen.bits.min(MOST_BITS) {
            let Some(cut) = search.coarsest(own, octaves) else { continue };
            if cut.words() < least {
                least = cut.words();
                cuts.push(cut);
            } else if octaves > 4 && cut.words() > least {
                // More octaves have more words from here on.
                break;
            }
        }
    }
    for cut in cuts.clone() {
        let finer = Segments { prefix: cut.prefix + 1, ..cut };
        if search.is_possible(&finer) {
            cuts.push(finer);
        }
    }
    cuts.sort_by_key(Segments::words);
    cuts
}

/// The search for the ways to cut a domain that are fine enough for polynomials of a degree.
struct CutSearch<'s> {
    seen: &'s AllowedResults<'s>,
    degree: u32,
    /// The most segments.
    most: usize,
    /// An operand in a segment that was too long.
    worst: Option<i64>,
}

impl CutSearch<'_> {
    /// Returns whether a cut has few enough segments, and enough bits for the offsets in them.
    fn is_possible(&self, cut: &Segments) -> bool {
        cut.words() <= self.most.min(1 << ADDRESS)
            && cut.octaves + cut.prefix + u32::from(self.degree > 0) <= self.seen.bits
            && cut.holds_overhang()
    }

    /// Returns the cut with the fewest segments of a layout that is fine enough, if there is one.
    fn coarsest(&mut self, layout: Layout, octaves: u32) -> Option<Segments> {
        let least = u32::from(octaves == 0);
        for prefix in least..=ADDRESS {
            let AllowedResults { bits, overhang, .. } = *self.seen;
            let cut = Segments { bits, layout, octaves, prefix, overhang };
            if !self.is_possible(&cut) {
                return None;
            }
            if Table::may_fit(self.seen, cut, self.degree, &mut self.worst) {
                return Some(cut);
            }
        }
        None
    }
}

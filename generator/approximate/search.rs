//! Searches for the cheapest piecewise polynomial that approximates a function. The search tries some combinations of degree,
//! segments and bit widths, so a cheaper polynomial may exist. Costs are in look-up tables with four inputs.

use super::seen::AllowedResults;
use super::table::{BITS_A_CELL, Table, Widths};
use super::{
    Curve, Identity, Layout, MOST_BITS, Numbering, Piecewise, Reduction, Refusal, RefusalKind,
    Segments, TargetFunction, UnsuitedReduction,
};
use glint_base::fixed::MAX_WIDTH;

/// The user's choices for an approximation. The search makes all others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Wish {
    /// The degree of the polynomials; `None` for the cheapest.
    pub degree: Option<u32>,
    /// The layout of the segments; `None` for the cheapest.
    pub layout: Option<Layout>,
    /// The number of segments of a uniform layout as a power of two; `None` for the cheapest.
    pub prefix: Option<u32>,
    /// The identity of the range reduction, for example f(−x) = f(x).
    pub identity: Identity,
    /// The largest number of look-up tables that an approximation may take, or `None` without a limit. The search finds nothing if
    /// only dearer approximations keep the error. A caller that compares approximations saves time with the cost of the cheapest
    /// one so far.
    pub most_cells: Option<u32>,
    /// The smallest number of words with which a table enters the cost. A look-up table with four inputs stores 16 words of a
    /// bit, so a table of 5 words may cost as much as one of 16 words.
    pub least_words: usize,
}

const DEGREES: u32 = 3;

/// A table has at most 2^16 words.
const ADDRESS: u32 = 16;

/// The approximate number of operands with which degree, segments and bit widths are chosen.
const CHOOSING: usize = 1 << 16;

/// The approximate number of operands with which the chosen bit widths are widened, before the search uses all its operands.
const WIDENING: usize = 1 << 20;

/// The first and the last raw operand of a domain must differ by less than 2 to this power.
const WIDEST: u32 = 46;

/// The search subtracts these margins, one after the other until a proof succeeds, from the allowed error if it does not evaluate
/// every operand. A margin is a fraction of the allowed error minus half a unit, the rounding of the result.
const STRICTER: [f64; 5] = [0.02, 0.1, 0.25, 0.5, 0.75];

/// The cost of a step of Horner's rule without the table, in look-up tables: an adder, and the wiring of a multiplier.
pub(super) const STEP: f64 = 50.0;

/// The cost of an octave, in look-up tables: one more row of multiplexers in the shifter that aligns the offsets.
const OCTAVE: f64 = 12.0;

/// The errors to try if the allowed error cannot be reached, in units of the result's last bit.
pub(super) const NEAREST: [f64; 14] =
    [0.51, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 64.0, 256.0];

/// Finds the cheapest approximation of `function` under the choices `wish`, and proves its error bound.
///
/// # Errors
/// Fails if the operands of the domain differ by 2^46 or more, or if there are more than 2^26 operands of samples. Fails if the
/// function has no value at an operand, the identity of `wish` does not hold, or no approximation with the allowed error is found
/// and proved.
pub(super) fn search(function: &TargetFunction, wish: Wish) -> Result<Piecewise, Refusal> {
    let span = function.domain.1.abs_diff(function.domain.0);
    if span >> WIDEST != 0 {
        let bits = u64::BITS - span.leading_zeros();
        return Err(Refusal::new(
            RefusalKind::OperandBits { most: function.operand.frac - (bits - WIDEST) as i32 },
            format!("operands of the domain have {bits} bits, more than {WIDEST}"),
        ));
    }
    if matches!(function.curve, Curve::Samples(_)) && function.is_wide() {
        let message = format!(
            "with samples, Glint computes every operand, and the domain has more than 2^{MOST_BITS} operands"
        );
        return Err(Refusal::new(RefusalKind::ManyOperandsOfSamples, message));
    }
    if let Some(found) = attempt(function, wish)? {
        return Ok(found);
    }
    let keeps = match wish.degree {
        Some(degree) => format!("degree {degree} does not keep"),
        None => format!("no degree up to {DEGREES} keeps"),
    };
    Err(Refusal::new(
        RefusalKind::Error,
        format!(
            "{keeps} an error of {} units within 2^{ADDRESS} words and nets of {MAX_WIDTH} bits",
            function.error
        ),
    ))
}

/// Returns an error above the allowed error of `function` that polynomials keep, in units of the result's last bit. The search
/// tries only a few such errors. This takes as long as several searches, and helps a user whose error cannot be kept.
pub fn reachable_error(function: &TargetFunction, wish: Wish) -> Option<f64> {
    let count_missed = NEAREST.partition_point(|error| {
        let larger = TargetFunction { error: *error, ..function.clone() };
        *error <= function.error || !matches!(attempt(&larger, wish), Ok(Some(_)))
    });
    NEAREST.get(count_missed).copied()
}

/// Returns the cheapest approximation with a proved bound, for the first numbering of the operands that has one.
///
/// # Errors
/// Fails if the function has no value at an operand, or if a found approximation cannot be proved. With an identity in `wish`,
/// also fails if the domain has more than 2^26 operands, or if the identity does not hold.
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

/// Returns the cheapest approximation with a proved bound, for this numbering of the operands. Fails if the function has no value
/// at an operand, or if no found approximation can be proved.
pub(super) fn attempt_numbered(
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

/// Returns the variants that the search tries in turn. A variant is the number of additional fraction bits of the polynomial, and
/// whether the largest |x| of an odd or even function has a number of its own.
fn variants(identity: Identity) -> &'static [(u32, bool)] {
    match identity {
        Identity::Odd | Identity::Even => &[(0, false), (0, true)],
        Identity::Octaves | Identity::Exponent => {
            &[(0, false), (2, false), (4, false), (6, false), (8, false)]
        }
        Identity::Quadrants | Identity::None => &[(0, false)],
    }
}

/// Returns the cheapest approximation with a proved bound for the first of the [`variants`] that has one.
///
/// # Errors
/// Fails if the domain has more than 2^26 operands, or the identity does not hold. Also fails if the function has no value at an
/// operand, or the approximation cannot be proved.
fn attempt_reduced(function: &TargetFunction, wish: Wish) -> Result<Option<Piecewise>, Refusal> {
    if function.is_wide() {
        let message = format!(
            "with a reduction, Glint computes every operand, and the domain has more than 2^{MOST_BITS} \
             operands"
        );
        return Err(Refusal::of_reduction(UnsuitedReduction::ManyOperands, message));
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

/// Returns the cheapest approximation that the search finds, with an allowed result at every operand in `seen`. Its bound is not
/// yet proved.
fn cheapest(seen: &AllowedResults, wish: Wish) -> Option<Piecewise> {
    let few = seen.thinned(CHOOSING);
    let mut found: Vec<(f64, Segments, Widths, Widths)> = Vec::new();
    let mut least = wish.most_cells.map_or(f64::INFINITY, f64::from);
    // Degrees that are often the cheapest come first, so that the search can end early for the others.
    for degree in [2, 3, 1, 0] {
        if wish.degree.is_some_and(|wanted| wanted != degree) {
            continue;
        }
        for cut in cuts(&few, degree, wish, most_words(seen, degree, least)) {
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

/// Returns the number of words of a table whose cost does not exceed `least`, at most 2^16. The estimate counts the constant
/// coefficient alone, which has as many bits as the result.
fn most_words(seen: &AllowedResults, degree: u32, least: f64) -> usize {
    let word = f64::from(seen.result.width()) / BITS_A_CELL;
    (((least - STEP * f64::from(degree)) / word).max(0.0) as usize).min(1 << ADDRESS)
}

/// Returns divisions of the domain into at most `most` segments that are fine enough for polynomials of degree `degree`, in order
/// of rising numbers of segments. A division is fine enough if polynomials with unrounded coefficients keep the error. For each
/// layout and number of octaves, the list has the coarsest such division, and the division with twice as many segments. A number
/// of octaves is left out if fewer octaves give a division at least as coarse.
fn cuts(seen: &AllowedResults, degree: u32, wish: Wish, most: usize) -> Vec<Segments> {
    let layout = wish.layout;
    let mut search = CutSearch { seen, degree, most, prefix: wish.prefix, worst: None };
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
                // With more octaves, the number of words only grows.
                break;
            }
        }
    }
    if wish.prefix.is_some() {
        return cuts;
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

/// Searches for divisions that are fine enough for polynomials of one degree.
struct CutSearch<'s> {
    seen: &'s AllowedResults<'s>,
    degree: u32,
    most: usize,
    /// The only prefix to try, or `None`.
    prefix: Option<u32>,
    /// An operand in a segment that was too long in an earlier division.
    worst: Option<i64>,
}

impl CutSearch<'_> {
    /// Returns whether a division has few enough segments, leaves enough bits for offsets, and has room for the overhang in its
    /// last segment.
    fn is_possible(&self, cut: &Segments) -> bool {
        cut.words() <= self.most.min(1 << ADDRESS)
            && cut.octaves + cut.prefix + u32::from(self.degree > 0) <= self.seen.bits
            && cut.holds_overhang()
    }

    /// Returns the division with the fewest segments for this layout and number of octaves that is fine enough; `None` without
    /// one.
    fn coarsest(&mut self, layout: Layout, octaves: u32) -> Option<Segments> {
        let least = u32::from(octaves == 0);
        let prefixes = self.prefix.map_or(least..=ADDRESS, |prefix| prefix..=prefix);
        for prefix in prefixes {
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

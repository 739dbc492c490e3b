//! Draws the candidates from which `directed` chooses the computations of a test bench.
//!
//! The pool depends only on the device's contract. It has the corners of the domain, random computations, computations that read
//! ROM words, and long lines for devices that compute lines of points.

use crate::cosim::{PointSource, Random};
use glint_golden::{Contract, Highlight};

/// The number of points that are drawn in the same way as the points of the default test.
const DRAWN: usize = 1024;

/// Points with the other operands such that they are seen. Of three one is drawn evenly and reads words far from the peak,
/// one by its distance from the ends of the domains, since tables have a word for each octave of it, and one is near the
/// peak for operands from anywhere in their formats.
const SHOWN: usize = 3840;

/// Every value of an operand without a fraction is a point, and the edges of the highlight there, if it has no more
/// values than this.
const MOST_VALUES: u64 = 4096;

/// The values above the lowest, of operands that choose a table, for which lines go through the highlight, and the
/// bits of their lengths.
const FIRST_VALUES: [i64; 6] = [0, 1, 2, 3, 7, 15];
const LINE_BITS: std::ops::RangeInclusive<u32> = 8..=12;

/// The number of intervals that a line among the drawn points may have.
const LONGEST: i64 = 1023;

/// Where the formula is seen best.
const VALUE: f64 = 0.6;

/// The control operands are combined at the ends of their formats too if that gives no more points than this.
const MOST_CORNERS: usize = 128;

/// The length of a line there.
const CORNER_LENGTH: i64 = 2;

/// The candidates from which the computations of a test bench are chosen.
pub struct Pool {
    /// Computations in which every operand that determines `f` is at an end of its domain or of its format.
    pub corners: Vec<Vec<i64>>,
    /// Random computations. The search records all features that they exercise.
    pub drawn: Vec<Vec<i64>>,
    /// Further random computations. The search records only the ROM words that they read.
    pub readers: Vec<Vec<i64>>,
    /// Computations that read a ROM from its beginning to its end. Devices that compute a line of points after one `start` have
    /// them.
    pub sweeps: Vec<Vec<i64>>,
}

/// Draws the candidates for a contract. The same contract always gets the same candidates.
pub fn pool(contract: &dyn Contract) -> Pool {
    let mut random = Random::new(1);
    let mut points = PointSource::new(contract);
    points.shorten(LONGEST);
    let count = points.operands().len();
    let mut drawn = vec![vec![0; count]; DRAWN];
    let mut readers = Vec::new();
    let mut sweeps = Vec::new();
    for values in &mut drawn {
        points.draw(&mut random, values, u64::MAX);
    }
    let control = points.operands().iter().filter(|operand| !operand.colour).count();
    if contract.length().is_none() {
        for number in 0..SHOWN {
            let mut values = points.evenly(&mut random);
            match number % 3 {
                0 => {}
                1 => near_ends(&points, &mut random, &mut values),
                _ => anywhere(&points, &mut random, &mut values),
            }
            brighten(&points, &mut values);
            points.show(&mut values[..control]);
            readers.push(values);
        }
    }
    if let Some((length, highlight)) = points.length().zip(contract.highlight()) {
        sweeps = lines(highlight, &points, length);
    }
    for at in 0..control {
        let operand = &points.operands()[at];
        let (low, high) = operand.domain;
        let is_length = contract.length() == Some(operand.name.as_str());
        if operand.format.frac > 0 || is_length || low.abs_diff(high) >= MOST_VALUES {
            continue;
        }
        for value in low..=high {
            let mut values = points.evenly(&mut random);
            brighten(&points, &mut values);
            values[at] = value;
            if let Some(length) = points.length() {
                values[length] = random.within(0, 2);
            }
            for edge in points.edge(&values[..control]).into_iter().flatten() {
                readers.push([&edge, &values[control..]].concat());
            }
            points.to_value(&mut values[..control], VALUE);
            readers.push(values);
        }
    }
    // The simulator runs computations in its lanes together, so computations of similar length should be neighbours.
    if let Some(length) = points.length() {
        drawn.sort_by_key(|values| values[length]);
        readers.sort_by_key(|values| values[length]);
    }
    Pool { corners: corners(&points), drawn, readers, sweeps }
}

/// Sets the colours to their largest values. They come after the control operands.
fn brighten(points: &PointSource<'_>, values: &mut [i64]) {
    let operands = points.operands();
    let control = operands.iter().filter(|operand| !operand.colour).count();
    for (value, operand) in values.iter_mut().zip(operands).skip(control) {
        *value = operand.domain.1;
    }
}

/// Moves operands with a fraction toward the ends of their domains, most of them to the upper end. A cosine there belongs to
/// no angle.
fn near_ends(points: &PointSource<'_>, random: &mut Random, values: &mut [i64]) {
    for (value, operand) in values.iter_mut().zip(points.operands()) {
        let (low, high) = operand.domain;
        let off = random.magnitude(high.abs_diff(low)) as i64;
        match random.below(4) {
            _ if operand.format.frac <= 0 => {}
            0 | 1 => *value = high.saturating_sub(off),
            2 => *value = low.saturating_add(off),
            _ => {}
        }
    }
}

/// Draws operands from their formats, beyond the domains too, and moves them to where the formula has some value. A word
/// that is read far from the peak alone within the domain is read near it there, and counts for more.
fn anywhere(points: &PointSource<'_>, random: &mut Random, values: &mut [i64]) {
    let control = points.operands().iter().filter(|operand| !operand.colour).count();
    for (value, operand) in values[..control].iter_mut().zip(points.operands()) {
        let format = operand.format;
        *value = random.within(format.min_raw() as i64, format.max_raw() as i64);
    }
    points.to_value(&mut values[..control], random.unit());
}

/// Returns every combination of the ends of the control operands' domains, and of their formats if those are not too many.
fn corners(points: &PointSource<'_>) -> Vec<Vec<i64>> {
    let mut ends = corner_values(points, true);
    if combinations(&ends) > MOST_CORNERS {
        ends = corner_values(points, false);
    }
    let mut corners: Vec<Vec<i64>> = Vec::new();
    // By their numbers: all of them would take more memory than there is where operands are many.
    for number in 0..combinations(&ends).min(MOST_CORNERS) {
        let mut corner = vec![0; ends.len()];
        let mut rest = number;
        for (value, ends) in corner.iter_mut().zip(&ends).rev() {
            *value = ends[rest % ends.len()];
            rest /= ends.len();
        }
        brighten(points, &mut corner);
        corners.push(corner);
    }
    corners
}

/// Returns the values of each operand in the corners: the ends of its domain, and of its format if that is wanted.
fn corner_values(points: &PointSource<'_>, with_format: bool) -> Vec<Vec<i64>> {
    let mut all = Vec::new();
    for (at, operand) in points.operands().iter().enumerate() {
        let (low, high) = operand.domain;
        let mut ends = if operand.colour {
            vec![high]
        } else if points.length() == Some(at) {
            vec![high.min(CORNER_LENGTH)]
        } else if with_format {
            let format = operand.format;
            vec![low, high, format.min_raw() as i64, format.max_raw() as i64]
        } else {
            vec![low, high]
        };
        ends.sort_unstable();
        ends.dedup();
        all.push(ends);
    }
    all
}

/// Returns the number of combinations of one value for each operand.
fn combinations(values: &[Vec<i64>]) -> usize {
    let mut product: usize = 1;
    for values in values {
        product = product.saturating_mul(values.len());
    }
    product
}

/// Draws lines from the peak to the edge of the highlight, which read the words of a table one after another: for the
/// first values of each other operand, and for each power of two of intervals, or the end of the domain if that is
/// less. The longest are first.
fn lines(highlight: &Highlight, points: &PointSource, length: usize) -> Vec<Vec<i64>> {
    let mut random = Random::new(2);
    let mut lines = Vec::new();
    let operands = points.operands();
    let free =
        |at: &usize| !operands[*at].colour && *at != length && operands[*at].format.frac <= 0;
    let others: Vec<usize> = (0..operands.len()).filter(free).collect();
    for (bits, first) in LINE_BITS.rev().flat_map(|bits| FIRST_VALUES.map(|first| (bits, first))) {
        let mut values = points.evenly(&mut random);
        brighten(points, &mut values);
        for &at in &others {
            let (low, high) = operands[at].domain;
            values[at] = (low + first).min(high);
        }
        let control = values.len() - highlight.outputs().len();
        let Some([_, edge]) = points.edge(&values[..control]) else { continue };
        let mut peak = values[..control].to_vec();
        points.to_value(&mut peak, f64::INFINITY);
        let most = highlight.operands()[length].domain.1;
        peak[length] = ((1 << bits) - 1).min(most);
        lines.push([&highlight.line(&peak, &edge), &values[control..]].concat());
    }
    lines
}

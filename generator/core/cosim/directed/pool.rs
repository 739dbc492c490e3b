//! Draws the candidates from which `directed` chooses the computations of a test bench.
//!
//! The pool depends only on the device's contract.

use crate::cosim::{PointSource, Random};
use glint_golden::{Contract, Highlight};

/// The number of random computations in [`Pool::drawn`], which are drawn like the points of the default test.
const DRAWN: usize = 1024;

/// The number of random computations in [`Pool::readers`] of a device without lines, drawn in three ways in turn. The first way
/// draws evenly, and reads words far from the peak of the highlight. The second draws near the ends of the domains, at
/// distances of every magnitude, since tables have a word for each octave. The third draws from the whole formats, and moves
/// operands to where the formula has a random value. All other operands are chosen so that results are seldom 0.
const SHOWN: usize = 3840;

/// The largest number of values of an operand without fraction bits for which [`Pool::readers`] has points at each value, and
/// at the edges of the highlight.
const MOST_VALUES: u64 = 4096;

/// Distances from the lowest value of the operands without fraction bits. These operands choose a table. A line through the
/// highlight is drawn for each distance and each number of bits of the line's length.
const FIRST_VALUES: [i64; 6] = [0, 1, 2, 3, 7, 15];
const LINE_BITS: std::ops::RangeInclusive<u32> = 8..=12;

/// The largest length operand of a line among the drawn points.
const LONGEST: i64 = 1023;

/// The value of the formula at which a wrong word shows best in the results.
const VALUE: f64 = 0.6;

/// The largest number of corners. The ends of the operands' formats are used only if this number is not exceeded.
const MOST_CORNERS: usize = 128;

const CORNER_LENGTH: i64 = 2;

/// The candidates from which the computations of a test bench are chosen.
pub struct Pool {
    /// At most 128 computations with every operand that determines `f` at an end of its domain or, if this limit allows it, of
    /// its format. The length operand of a line is at most 2.
    pub corners: Vec<Vec<i64>>,
    /// Random computations, whose features are all recorded.
    pub drawn: Vec<Vec<i64>>,
    /// Further random computations. The pool records only their ROM words.
    pub readers: Vec<Vec<i64>>,
    /// Lines from the peak to the edge of the highlight, which read the words of a table one after another. Empty for a device
    /// without lines.
    pub sweeps: Vec<Vec<i64>>,
}

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
    // The simulator runs computations in its lanes together. Computations of similar length should therefore be neighbours.
    if let Some(length) = points.length() {
        drawn.sort_by_key(|values| values[length]);
        readers.sort_by_key(|values| values[length]);
    }
    Pool { corners: corners(&points), drawn, readers, sweeps }
}

/// Sets the colours, which follow the control operands, to their largest values.
fn brighten(points: &PointSource<'_>, values: &mut [i64]) {
    let operands = points.operands();
    let control = operands.iter().filter(|operand| !operand.colour).count();
    for (value, operand) in values.iter_mut().zip(operands).skip(control) {
        *value = operand.domain.1;
    }
}

/// Moves operands with fraction bits toward the ends of their domains, by a distance of random magnitude. Half of them move to
/// the upper end, and a quarter to the lower end.
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

/// Draws the control operands from their whole formats, and moves them to where the formula has a random value from 0 to 1. A
/// ROM word that the domain reads only far from the peak is then read near the peak, and shows more in the results.
fn anywhere(points: &PointSource<'_>, random: &mut Random, values: &mut [i64]) {
    let control = points.operands().iter().filter(|operand| !operand.colour).count();
    for (value, operand) in values[..control].iter_mut().zip(points.operands()) {
        let format = operand.format;
        *value = random.within(format.min_raw() as i64, format.max_raw() as i64);
    }
    points.to_value(&mut values[..control], random.unit());
}

/// Returns at most [`MOST_CORNERS`] combinations of the ends of the control operands' domains, with the largest colours. The
/// ends of the operands' formats are included if all these combinations are few enough.
fn corners(points: &PointSource<'_>) -> Vec<Vec<i64>> {
    let mut ends = corner_values(points, true);
    if combinations(&ends) > MOST_CORNERS {
        ends = corner_values(points, false);
    }
    let mut corners: Vec<Vec<i64>> = Vec::new();
    // The combinations are made from their numbers, because a list of all would take too much memory if the operands are many.
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

/// Returns the values of each operand in the corners: the ends of its domain, and also of its format if `with_format` is true.
/// A colour has only its largest value, and the length of a line at most [`CORNER_LENGTH`].
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

fn combinations(values: &[Vec<i64>]) -> usize {
    let mut product: usize = 1;
    for values in values {
        product = product.saturating_mul(values.len());
    }
    product
}

/// Draws lines from the peak to the edge of the highlight, the longest first. There is a line for each value in
/// [`FIRST_VALUES`] and each number of bits in [`LINE_BITS`], unless the formula does not fall on the line. A length beyond
/// its domain becomes the end of the domain.
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

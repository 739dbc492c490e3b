//! Computations to choose from.

use crate::cosim::{Points, Random};
use crate::golden::{Contract, Highlight};

/// Points that are drawn as those of the default test are.
const DRAWN: usize = 1024;

/// Points drawn evenly, with the other operands such that they are seen: they read words far from the peak.
const SHOWN: usize = 1536;

/// Every value of an operand without a fraction is a point, and the edges of the highlight there, if it has no more
/// values than this.
const MOST_VALUES: u64 = 4096;

/// Of the operands that choose a table the values above the lowest for which lines go through the highlight, and how
/// many bits their lengths have.
const FIRST_VALUES: [i64; 6] = [0, 1, 2, 3, 7, 15];
const LINE_BITS: std::ops::RangeInclusive<u32> = 8..=12;

/// The longest line, in intervals.
const LONGEST: i64 = 1023;

/// Where the formula is seen best.
const VALUE: f64 = 0.6;

/// Computations to choose from.
pub struct Pool {
    /// Those that are watched in all that they do.
    pub drawn: Vec<Vec<i64>>,
    /// Those that read words.
    pub readers: Vec<Vec<i64>>,
    /// Lines that read a table from its beginning to its end.
    pub sweeps: Vec<Vec<i64>>,
}

/// The pool for a contract; a function of it alone.
pub fn pool(contract: &dyn Contract) -> Pool {
    let mut random = Random::new(1);
    let mut points = Points::new(contract);
    if let Some(length) = contract.length() {
        points.limit(length, LONGEST);
    }
    let count = points.operands().len();
    let mut drawn = vec![vec![0; count]; DRAWN];
    let mut readers = Vec::new();
    let mut sweeps = Vec::new();
    for values in &mut drawn {
        points.draw(&mut random, values, u64::MAX);
    }
    let control = points.operands().iter().filter(|operand| !operand.colour).count();
    let bright = |values: &mut [i64]| {
        for (value, operand) in values.iter_mut().zip(points.operands()).skip(control) {
            *value = operand.domain.1;
        }
    };
    if contract.length().is_none() {
        for _ in 0..SHOWN {
            let mut values = points.evenly(&mut random);
            bright(&mut values);
            points.show(&mut values[..control]);
            readers.push(values);
        }
    }
    if let Some((length, highlight)) = points.length().zip(contract.highlight()) {
        sweeps = lines(highlight, &points, length, &bright);
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
            bright(&mut values);
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
    // Together in the lanes of a simulator run those that are of a length.
    if let Some(length) = points.length() {
        drawn.sort_by_key(|values| values[length]);
        readers.sort_by_key(|values| values[length]);
    }
    Pool { drawn, readers, sweeps }
}

/// Lines from the peak to the edge of the highlight, which read the words of a table one after another: for the first
/// values of each other operand, and for each power of two of intervals.
fn lines(
    highlight: &Highlight,
    points: &Points,
    length: usize,
    bright: &dyn Fn(&mut [i64]),
) -> Vec<Vec<i64>> {
    let mut random = Random::new(2);
    let mut lines = Vec::new();
    let operands = points.operands();
    let free =
        |at: &usize| !operands[*at].colour && *at != length && operands[*at].format.frac <= 0;
    let others: Vec<usize> = (0..operands.len()).filter(free).collect();
    for (bits, first) in LINE_BITS.rev().flat_map(|bits| FIRST_VALUES.map(|first| (bits, first))) {
        let mut values = points.evenly(&mut random);
        bright(&mut values);
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

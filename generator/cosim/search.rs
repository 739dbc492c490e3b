//! The largest error of an output that can be found: climbed to, and not drawn.
//!
//! Random points seldom meet what rounds unluckily in every step. From points that the stimulus draws each operand, and each
//! pair of those with a fraction, is moved by powers of two as long as the error grows: of a highlight first that of `f`,
//! and then that of an output, with its worst colour. What is found is a lower limit of the largest error, and no proof.

use rayon::prelude::*;

use super::points::Points;
use super::random::Random;
use crate::base::fixed::exp2;
use crate::golden::{Contract, Highlight, nearer};

/// Colours of more bits than this are tried at their upper end alone.
const MOST_COLOURS: i64 = 256;

/// Operands are moved by powers of two below this.
const MOST_BITS: u32 = 24;

/// An error of an output, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// In output units.
    pub units: f64,
    /// The raw operands, in the order of the contract.
    pub operands: Vec<i64>,
    /// The output, by its position in the contract.
    pub output: usize,
    /// What the output is, in its units, and what the formula says.
    pub raw: i64,
    pub exact: f64,
}

impl Reached {
    /// The largest error of an output at raw operands; `None` without an output.
    pub fn at(contract: &dyn Contract, operands: Vec<i64>) -> Option<Self> {
        let (mut raw, mut exact) = (Vec::new(), Vec::new());
        contract.results(&operands, 0, &mut raw);
        contract.exact(&operands, 0, &mut exact);
        let outputs = contract.outputs().iter().zip(&raw).zip(exact).enumerate();
        let errors = outputs.map(|(output, ((it, &raw), exact))| {
            let unit = exp2(-it.format.frac);
            let exact = exact.map(|value| value / unit);
            let near = |value: f64| (raw as f64 - value).abs();
            let exact = if near(exact[1]) < near(exact[0]) { exact[1] } else { exact[0] };
            Self { units: near(exact), operands: operands.clone(), output, raw, exact }
        });
        errors.reduce(larger)
    }
}

/// The first of two, unless the error of the second is larger.
fn larger(a: Reached, b: Reached) -> Reached {
    if b.units > a.units { b } else { a }
}

/// The largest error that is reached from `starts` starts, drawn by a seed: the same on any number of threads. `progress`
/// is called after each. `None` for no start.
pub fn worst(
    contract: &dyn Contract,
    starts: u64,
    seed: u64,
    progress: &(dyn Fn() + Sync),
) -> Option<Reached> {
    let points = Points::new(contract);
    let climber = Climber::new(contract);
    let reached = (0..starts).into_par_iter().filter_map(|start| {
        let mut random = Random::new(seed ^ start.wrapping_mul(0xd134_2543_de82_ef95));
        let operands = climber.from(points.of_domain(&mut random));
        progress();
        Some((start, Reached::at(contract, operands)?))
    });
    // Of errors that are equal that of the first start, whatever the order in which they come.
    let reached = reached.reduce_with(|(a, first), (b, second)| {
        let second_is_larger = match second.units.total_cmp(&first.units) {
            std::cmp::Ordering::Equal => b < a,
            order => order.is_gt(),
        };
        if second_is_larger { (b, second) } else { (a, first) }
    });
    reached.map(|(_, reached)| reached)
}

struct Climber<'a> {
    contract: &'a dyn Contract,
    /// The domains of the operands that are moved.
    domains: Vec<(i64, i64)>,
    /// Operands that are moved together, with their signs.
    moves: Vec<Vec<(usize, i64)>>,
    /// The colours of a highlight.
    colours: std::ops::RangeInclusive<i64>,
}

impl<'a> Climber<'a> {
    fn new(contract: &'a dyn Contract) -> Self {
        let moved: Vec<_> = contract.operands().iter().filter(|it| !it.colour).collect();
        let mut moves: Vec<Vec<(usize, i64)>> = Vec::new();
        for (a, first) in moved.iter().enumerate() {
            moves.extend([vec![(a, 1)], vec![(a, -1)]]);
            for (b, second) in moved.iter().enumerate().skip(a + 1) {
                if first.format.frac > 0 && second.format.frac > 0 {
                    let signs = [(1, 1), (-1, -1), (1, -1), (-1, 1)];
                    moves.extend(signs.map(|(one, other)| vec![(a, one), (b, other)]));
                }
            }
        }
        let mut colours = contract.operands().iter().filter(|it| it.colour);
        let (low, high) = colours.next().map_or((1, 1), |it| it.domain);
        Self {
            contract,
            domains: moved.iter().map(|it| it.domain).collect(),
            moves,
            colours: low.max(high - MOST_COLOURS)..=high,
        }
    }

    /// The operands of the largest error that is reached from some.
    fn from(&self, mut operands: Vec<i64>) -> Vec<i64> {
        let Some(highlight) = self.contract.highlight() else {
            self.climb(&mut operands, |operands| self.contract.largest_error(operands));
            return operands;
        };
        // Control operands come first.
        let mut control = operands;
        control.truncate(self.domains.len());
        self.climb(&mut control, |control| of_f(highlight, control));
        self.climb(&mut control, |control| self.of_output(highlight, control).0);
        let (_, colour) = self.of_output(highlight, &control);
        control.resize(highlight.operands().len(), colour);
        control
    }

    /// Moves operands as long as that makes `of` larger.
    fn climb(&self, operands: &mut Vec<i64>, of: impl Fn(&[i64]) -> f64) {
        let mut height = of(operands);
        loop {
            let before = height;
            for bit in (0..MOST_BITS).rev() {
                for each in &self.moves {
                    let mut next = operands.clone();
                    for &(at, sign) in each {
                        let (low, high) = self.domains[at];
                        next[at] = next[at].saturating_add(sign << bit).clamp(low, high);
                    }
                    if next == *operands {
                        continue;
                    }
                    let there = of(&next);
                    if there > height {
                        (height, *operands) = (there, next);
                    }
                }
            }
            if height <= before {
                return;
            }
        }
    }

    /// The largest error of an output, in units, and its colour.
    fn of_output(&self, highlight: &Highlight, control: &[i64]) -> (f64, i64) {
        let point = highlight.point(control, 0);
        let (f, right) = (highlight.f(&point), highlight.references(&point));
        let errors = self.colours.clone().map(|colour| {
            let output = highlight.colour(f, colour) as f64;
            (nearer(output, right.map(|right| right * colour as f64)), colour)
        });
        errors.fold((-1.0, 0), |most, next| if next.0 > most.0 { next } else { most })
    }
}

/// The error of `f`.
fn of_f(highlight: &Highlight, control: &[i64]) -> f64 {
    let point = highlight.point(control, 0);
    let f = highlight.f_format().to_f64(i128::from(highlight.f(&point)));
    nearer(f, highlight.references(&point))
}

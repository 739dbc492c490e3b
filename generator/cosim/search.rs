//! The largest error of an output that can be found: climbed to, and not drawn.
//!
//! Random points seldom meet what rounds unluckily in every step. From points of the highlight each operand, and each
//! pair of those with a fraction, is moved by powers of two as long as the error of `f` grows, and then as long as that
//! of an output grows. What is found is a lower limit of the largest error, and no proof.

use rayon::prelude::*;

use super::points::Points;
use super::random::Random;
use crate::golden::{Contract, Highlight, nearer};

/// Colours of more bits than this are tried at their upper end alone.
const MOST_COLOURS: i64 = 256;

/// An error of an output, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// In output units.
    pub units: f64,
    /// The raw control operands.
    pub control: Vec<i64>,
    /// The raw colour operand.
    pub colour: i64,
}

/// The largest error that is reached from `starts` starts, drawn by a seed: the same on any number of threads. `None`
/// for no start.
pub fn worst(highlight: &Highlight, starts: u64, seed: u64) -> Option<Reached> {
    let points = Points::new(highlight);
    let climber = Climber::new(highlight);
    let reached = (0..starts).into_par_iter().map(|start| {
        let mut random = Random::new(seed ^ start.wrapping_mul(0xd134_2543_de82_ef95));
        let mut control = points.of_domain(&mut random);
        control.truncate(climber.domains.len());
        climber.climb(&mut control, |control| climber.of_f(control));
        climber.climb(&mut control, |control| climber.of_output(control).0);
        let (units, colour) = climber.of_output(&control);
        Reached { units, control, colour }
    });
    let larger = |a: Reached, b: Reached| if b.units > a.units { b } else { a };
    reached.collect::<Vec<_>>().into_iter().reduce(larger)
}

/// The error of the output for raw operands, in output units.
pub fn error(highlight: &Highlight, control: &[i64], colour: i64) -> f64 {
    let mut operands = highlight.operands().iter();
    let ulp = operands.find(|it| it.colour).map_or(1.0, |it| it.format.to_f64(1));
    let point = highlight.point(control, 0);
    let right = highlight.references(&point).map(|f| f * colour as f64 * ulp);
    nearer(highlight.colour(highlight.f(&point), colour) as f64 * ulp, right)
}

struct Climber<'a> {
    highlight: &'a Highlight,
    /// The domains of the control operands.
    domains: Vec<(i64, i64)>,
    /// Operands that are moved together, with their signs.
    moves: Vec<Vec<(usize, i64)>>,
    colours: std::ops::RangeInclusive<i64>,
}

impl<'a> Climber<'a> {
    fn new(highlight: &'a Highlight) -> Self {
        let control: Vec<_> = highlight.operands().iter().filter(|it| !it.colour).collect();
        let mut moves: Vec<Vec<(usize, i64)>> = Vec::new();
        for (a, first) in control.iter().enumerate() {
            moves.extend([vec![(a, 1)], vec![(a, -1)]]);
            for (b, second) in control.iter().enumerate().skip(a + 1) {
                if first.format.frac > 0 && second.format.frac > 0 {
                    let signs = [(1, 1), (-1, -1), (1, -1), (-1, 1)];
                    moves.extend(signs.map(|(one, other)| vec![(a, one), (b, other)]));
                }
            }
        }
        let mut colours = highlight.operands().iter().filter(|it| it.colour);
        let (low, high) = colours.next().map_or((1, 1), |it| it.domain);
        Self {
            highlight,
            domains: control.iter().map(|it| it.domain).collect(),
            moves,
            colours: low.max(high - MOST_COLOURS)..=high,
        }
    }

    /// Moves control operands as long as that makes `of` larger.
    fn climb(&self, control: &mut Vec<i64>, of: impl Fn(&[i64]) -> f64) {
        let mut height = of(control);
        loop {
            let before = height;
            for bit in (0..24).rev() {
                for each in &self.moves {
                    let mut next = control.clone();
                    for &(at, sign) in each {
                        let (low, high) = self.domains[at];
                        next[at] = next[at].saturating_add(sign << bit).clamp(low, high);
                    }
                    let there = of(&next);
                    if there > height {
                        (height, *control) = (there, next);
                    }
                }
            }
            if height <= before {
                return;
            }
        }
    }

    fn of_f(&self, control: &[i64]) -> f64 {
        let point = self.highlight.point(control, 0);
        let f = self.highlight.f_format().to_f64(i128::from(self.highlight.f(&point)));
        nearer(f, self.highlight.references(&point))
    }

    /// The largest error of an output, and its colour.
    fn of_output(&self, control: &[i64]) -> (f64, i64) {
        let errors =
            self.colours.clone().map(|colour| (error(self.highlight, control, colour), colour));
        errors.fold((-1.0, 0), |most, next| if next.0 > most.0 { next } else { most })
    }
}

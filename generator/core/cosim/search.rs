//! Searches for the operands with the largest output error by hill climbing, because at random points the roundings rarely all
//! err in the same direction.
//!
//! The search starts from random points and changes one operand, or a pair of operands with fraction bits, by powers of two
//! while the error grows. For a highlight, the search first climbs the error of `f`, and then the error of an output, with the
//! worst colour. Near the largest errors, rounding makes the steps too irregular to climb, so the search tries all nearby
//! values of each pair of operands. The largest error that the search finds is a lower bound of the true maximum, not a proof.

use rayon::prelude::*;

use super::outcome::ROUNDING_OF_F64;
use super::points::PointSource;
use super::random::Random;
use glint_base::fixed::exp2;
use glint_golden::{Contract, Highlight, nearer};

/// The largest distance from the largest colour at which a colour is tried.
const MOST_COLOURS: i64 = 256;

/// Operands are moved by powers of two below 2^`MOST_BITS`.
const MOST_BITS: u32 = 24;

/// The number of points with the largest errors around which the search tries all neighbours, and about the number of
/// combinations of operands that one round tries around each of these points.
const HIGHEST: usize = 16;
const AROUND: u64 = 1 << 18;

/// The number of combinations that are tried around a point of a device without a highlight, for all pairs of operands
/// together. Each combination takes a run of the model, clock by clock.
const MOST_AROUND: u64 = 1 << 16;

/// After this number of starts only the points with the largest errors are kept, so that memory does not grow.
const BATCH: u64 = 1 << 10;

/// An error that the search has found, with its operands and its output.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// The absolute error in output units; infinite if the formula has no value at the operands.
    pub units: f64,
    /// The error in units, multiplied by the weight of the output (`Bounds::weights`), by which errors of different outputs
    /// are compared.
    pub weighted: f64,
    /// The raw operands, in the order of `Contract::operands`.
    pub operands: Vec<i64>,
    /// The index of the output in `Contract::outputs`.
    pub output: usize,
    /// The computed output as a raw value, and the value of the formula in the same units.
    pub raw: i64,
    pub exact: f64,
}

impl Reached {
    /// Returns the largest error of an output in the first result of a computation with raw operands. Returns `None` if the
    /// contract has no output.
    fn at(contract: &dyn Contract, weights: &[f64], operands: Vec<i64>) -> Option<Self> {
        let (mut raw, mut exact) = (Vec::new(), Vec::new());
        contract.results(&operands, 0, &mut raw);
        contract.exact(&operands, 0, &mut exact);
        let mut largest: Option<Self> = None;
        for (output, it) in contract.outputs().iter().enumerate() {
            let raw = raw[output];
            let unit = exp2(-it.format.frac);
            let either = exact[output].map(|value| value / unit);
            let units = nearer(raw as f64, either);
            let [first, second] = either.map(|value| (raw as f64 - value).abs());
            let exact = if second < first { either[1] } else { either[0] };
            let weighted = units * weights[output];
            let error = Self { units, weighted, operands: operands.clone(), output, raw, exact };
            largest = Some(match largest {
                Some(known) => larger(known, error),
                None => error,
            });
        }
        largest
    }
}

fn larger(a: Reached, b: Reached) -> Reached {
    if b.weighted > a.weighted { b } else { a }
}

/// Returns the number of calls of `progress` by [`worst`] with the same `starts`.
pub fn steps(starts: u64) -> u64 {
    starts.saturating_add(starts.min(HIGHEST as u64))
}

/// Searches from `starts` random points, and then around the points with the largest errors. Returns `None` if `starts` is 0,
/// or if the contract has no output. The result depends on `seed` but not on the number of threads. The function calls
/// `progress` after each start and each later search.
pub fn worst(
    contract: &dyn Contract,
    starts: u64,
    seed: u64,
    progress: &(dyn Fn() + Sync),
) -> Option<Reached> {
    let points = PointSource::new(contract);
    let climber = Climber::new(contract);
    let reached = |operands: Vec<i64>| Reached::at(contract, &climber.weights, operands);
    let (mut climbed, mut highest) = (None, Vec::<ClimbResult>::new());
    let mut first = 0;
    while first < starts {
        let next = first.saturating_add(BATCH).min(starts);
        let climbs = (first..next).into_par_iter().map(|start| {
            let mut random = Random::new(seed ^ start.wrapping_mul(0xd134_2543_de82_ef95));
            let end = climber.from(points.of_domain(&mut random));
            progress();
            end
        });
        let ends: Vec<ClimbResult> = climbs.collect();
        // If errors are equal, the first start wins, whatever the order in which the threads end.
        let outputs = ends.iter().filter_map(|end| reached(end.operands.clone()));
        climbed = climbed.into_iter().chain(outputs).reduce(larger);
        highest.extend(ends);
        highest.sort_by(|one, other| other.height.total_cmp(&one.height));
        highest.truncate(HIGHEST);
        first = next;
    }
    let looks = highest.par_iter().map(|end| {
        let found = climber.look_around(end.highest.clone());
        progress();
        found
    });
    let around: Vec<Vec<i64>> = looks.collect();
    let found = around.into_iter().filter_map(reached);
    Some(found.fold(climbed?, larger))
}

struct ClimbResult {
    /// The largest error that the climb reached: of `f` for a highlight, in absolute terms, and otherwise of an output, in
    /// units. `highest` has the control operands with this error.
    height: f64,
    highest: Vec<i64>,
    /// The operands, with colours, at the end of the climb.
    operands: Vec<i64>,
}

struct Climber<'a> {
    contract: &'a dyn Contract,
    domains: Vec<(i64, i64)>,
    /// The moves: each has the indices of the operands that move together, and the signs of their steps.
    moves: Vec<Vec<(usize, i64)>>,
    /// The colours that are tried for a highlight. For other devices, the single value 1.
    colours: std::ops::RangeInclusive<i64>,
    /// The weights of the outputs (`Bounds::weights`).
    weights: Vec<f64>,
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
            weights: contract.bounds().weights(ROUNDING_OF_F64),
        }
    }

    /// Returns the largest error of an output, multiplied by the weight of the output.
    fn largest_error(&self, operands: &[i64]) -> f64 {
        let errors = self.contract.errors(operands);
        errors.iter().zip(&self.weights).map(|(error, weight)| error * weight).fold(0.0, f64::max)
    }

    fn from(&self, operands: Vec<i64>) -> ClimbResult {
        // Control operands come first.
        let mut highest = operands;
        highest.truncate(self.domains.len());
        let Some(highlight) = self.contract.highlight() else {
            let height = self.climb(&mut highest, |operands| self.largest_error(operands));
            return ClimbResult { height, operands: highest.clone(), highest };
        };
        let height = self.climb(&mut highest, |control| of_f(highlight, control));
        let mut control = highest.clone();
        self.climb(&mut control, |control| self.of_output(highlight, control).0);
        ClimbResult { height, highest, operands: self.with_colours(highlight, control) }
    }

    /// Returns the given control operands, followed by the worst colour for every colour operand.
    fn with_colours(&self, highlight: &Highlight, mut control: Vec<i64>) -> Vec<i64> {
        let (_, colour) = self.of_output(highlight, &control);
        control.resize(highlight.operands().len(), colour);
        control
    }

    /// Tries all nearby values of each pair of operands around the given control operands, moves to the largest error, and
    /// repeats this search there until the error no longer grows. For a device that is no highlight, the function stops after
    /// about 65536 combinations. Returns all operands of the largest error.
    fn look_around(&self, mut operands: Vec<i64>) -> Vec<i64> {
        let highlight = self.contract.highlight();
        let terms = self.contract.bounds().governing().terms.clone();
        let rounding = terms.iter().find(|term| term.key == "output.rounding");
        let (rounding, colour) = (rounding.map_or(1.0, |it| it.units), *self.colours.end() as f64);
        // The error of an output is at most the error of `f` for the largest colour, plus the output's own rounding. If that is
        // no more than the known error, the colours need not be tried.
        let error = |operands: &[i64], known: f64| match highlight {
            Some(it) if of_f(it, operands) * colour + rounding <= known => 0.0,
            Some(it) => self.of_output(it, operands).0,
            None => self.largest_error(operands),
        };
        let pairs = operands.len() * operands.len().saturating_sub(1) / 2;
        let all = if highlight.is_some() { AROUND } else { MOST_AROUND };
        let far = (all / pairs.max(1) as u64).isqrt() as i64 / 2;
        let mut left = if highlight.is_some() { u64::MAX } else { MOST_AROUND };
        let near = |at: usize, value: i64| {
            let (low, high) = self.domains[at];
            (value - far).max(low)..=(value + far).min(high)
        };
        let mut height = error(&operands, 0.0);
        loop {
            let before = height;
            for (a, b) in (0..operands.len()).flat_map(|b| (0..b).map(move |a| (a, b))) {
                let mut next = operands.clone();
                if left == 0 {
                    break;
                }
                for (one, other) in near(a, operands[a])
                    .flat_map(|one| near(b, operands[b]).map(move |other| (one, other)))
                    .collect::<Vec<_>>()
                {
                    (next[a], next[b]) = (one, other);
                    left = left.saturating_sub(1);
                    let there = error(&next, height);
                    if there > height {
                        (height, operands) = (there, next.clone());
                    }
                }
            }
            if height <= before {
                return highlight.map_or(operands.clone(), |it| self.with_colours(it, operands));
            }
        }
    }

    /// Moves operands as long as that makes the value of `of` larger. Returns the largest value.
    fn climb(&self, operands: &mut Vec<i64>, of: impl Fn(&[i64]) -> f64) -> f64 {
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
                return height;
            }
        }
    }

    /// Returns the largest error in units, and the colour with this error.
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

fn of_f(highlight: &Highlight, control: &[i64]) -> f64 {
    let point = highlight.point(control, 0);
    let f = highlight.f_format().to_f64(i128::from(highlight.f(&point)));
    nearer(f, highlight.references(&point))
}

//! Searches for the configuration with the smallest cost among those with an error, clock, rate and DSP blocks that meet a goal.
//!
//! The search moves from a configuration to a neighbour, which has a different value of one key. It first moves toward the goal,
//! and fails if no neighbour is nearer. Then it moves to smaller configurations that still meet the goal. If no change of one key
//! helps, it tries changes of two keys. The result may be a local minimum.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, Result, bail};
use rayon::prelude::*;

use super::model::Cost;
use super::space::SearchSpace;
use super::{ErrorUnit, Objective, TuningGoal};
use glint_config::{Config, Value};
use glint_core::registry::Device;
use glint_golden::{Bounds, Term};
use glint_show::evidence::comparison::{EXPONENT, clocks_per_point};

/// A configuration that `glint tune` has evaluated, with its error bound, its cost and its rate.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub config: Config,
    pub bounds: Bounds,
    pub cost: Cost,
    /// The number of clocks from one point to the next, as `glint synth` counts them; `None` if the device never shows a
    /// result.
    pub clocks: Option<f64>,
}

impl Candidate {
    /// Returns the rate in million points a second, at the estimated clock frequency.
    pub fn rate(&self) -> Option<f64> {
        self.clocks.map(|clocks| self.cost.mhz / clocks)
    }
}

/// The result of `glint tune`: the best configuration that it found, and the alternatives.
#[derive(Clone, Debug)]
pub struct Answer {
    pub best: Candidate,
    /// The Pareto front, by rising error: the configurations for which no other has both a smaller error and a smaller cost. It
    /// covers the configurations that the search has evaluated and that have the wanted clock, rate and DSP blocks.
    pub front: Vec<Candidate>,
    /// The keys that the search was allowed to change.
    pub free: Vec<&'static str>,
    pub looked_at: usize,
}

/// A search in progress. `seen` caches the candidates by the text of their configurations. An entry is `None` if the
/// configuration makes no design with the same interface.
pub struct Search<'a> {
    device: &'a Device,
    space: &'a SearchSpace,
    goal: &'a TuningGoal,
    progress: &'a (dyn Fn(usize) + Sync),
    seen: Mutex<BTreeMap<String, Option<Candidate>>>,
}

impl<'a> Search<'a> {
    pub fn new(
        device: &'a Device,
        space: &'a SearchSpace,
        goal: &'a TuningGoal,
        progress: &'a (dyn Fn(usize) + Sync),
    ) -> Self {
        Self { device, space, goal, progress, seen: Mutex::default() }
    }

    /// Searches from `base` until the goal is met, and then for smaller configurations.
    ///
    /// # Errors
    /// Fails if `base` makes no design, or if no neighbour comes nearer to the goal before it is met.
    pub fn run(&self, base: &Config) -> Result<Answer> {
        let base = self.look(base).context("no design can be made of the initial configuration")?;
        let mut best = self.reach(base)?;
        // Single changes first; pairs, which are many, only if no single change helps.
        while let Some(better) = self.descend(&best, 1).or_else(|| self.descend(&best, 2)) {
            best = better;
        }
        let seen = self.lock_seen();
        let mut possible = Vec::new();
        for candidate in seen.values().flatten() {
            if self.is_possible(candidate) {
                possible.push(candidate.clone());
            }
        }
        let (looked_at, free) = (seen.len(), self.space.free().to_vec());
        Ok(Answer { front: self.goal.front(possible), best, free, looked_at })
    }

    fn lock_seen(&self) -> MutexGuard<'_, BTreeMap<String, Option<Candidate>>> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Evaluates all combinations of values, and returns the configuration with the smallest cost that meets the goal.
    ///
    /// # Errors
    /// Fails if a key does not exist.
    pub fn exhaustive(
        &self,
        base: &Config,
        values: &[(&str, Vec<Value>)],
    ) -> Result<Option<Candidate>> {
        let mut all: Vec<Vec<(&'static str, Value)>> = vec![Vec::new()];
        for (name, values) in values {
            let known = self.space.schema().key(name);
            let key = known.with_context(|| format!("there is no key `{name}`"))?.name;
            let mut longer = Vec::new();
            for start in &all {
                for value in values {
                    longer.push([start.as_slice(), &[(key, value.clone())]].concat());
                }
            }
            all = longer;
        }
        let found: Vec<Candidate> = all
            .par_iter()
            .filter_map(|values| self.look(&self.space.with(base, values)?))
            .collect();
        Ok(self.smallest(found))
    }

    /// Returns a configuration's candidate, if possible from the cache. Returns `None` if the configuration makes no design with
    /// the same interface.
    fn look(&self, config: &Config) -> Option<Candidate> {
        let text = config.to_toml(self.space.schema());
        if let Some(known) = self.lock_seen().get(&text) {
            return known.clone();
        }
        let found = self.compute(config);
        let mut seen = self.lock_seen();
        seen.insert(text, found.clone());
        (self.progress)(seen.len());
        found
    }

    fn compute(&self, config: &Config) -> Option<Candidate> {
        let opened = self.device.open(config.clone()).ok()?;
        let contract = opened.contract();
        let design = opened.design().ok()?;
        // A single free key never changes the interface, but two free keys together may.
        if !self.space.holds(&design, contract.as_ref()) {
            return None;
        }
        Some(Candidate {
            config: config.clone(),
            bounds: contract.bounds(),
            cost: Cost::new(&design, self.goal.target),
            clocks: clocks_per_point(&design, contract.as_ref(), EXPONENT).ok(),
        })
    }

    fn error(&self, candidate: &Candidate) -> f64 {
        self.goal.error(candidate)
    }

    fn keeps(&self, candidate: &Candidate) -> bool {
        self.error(candidate) <= self.goal.error && self.is_possible(candidate)
    }

    fn is_possible(&self, candidate: &Candidate) -> bool {
        self.has_dsps(candidate) && candidate.cost.mhz >= self.wanted_mhz(candidate)
    }

    fn has_dsps(&self, candidate: &Candidate) -> bool {
        self.goal.most_dsps.is_none_or(|most| candidate.cost.dsps <= most)
    }

    /// Returns the clock that a candidate needs for the goal, in MHz. It is infinite if the goal has a rate and the candidate
    /// never shows a result. For example, 2 million points a second at 10 clocks a point need 20 MHz.
    fn wanted_mhz(&self, candidate: &Candidate) -> f64 {
        let of_rate = match (self.goal.rate, candidate.clocks) {
            (Some(rate), Some(clocks)) => rate * clocks,
            (Some(_), None) => f64::INFINITY,
            (None, _) => 0.0,
        };
        self.goal.clock.unwrap_or_default().max(of_rate)
    }

    /// Returns the costs of a candidate, the most important first, and the text of its configuration, which decides between
    /// candidates with equal costs.
    fn order(&self, candidate: &Candidate) -> ([f64; 5], String) {
        (self.goal.order(candidate), candidate.config.to_toml(self.space.schema()))
    }

    fn smallest(&self, candidates: Vec<Candidate>) -> Option<Candidate> {
        let mut kept = Vec::new();
        for candidate in candidates {
            if self.keeps(&candidate) {
                kept.push((self.order(&candidate), candidate));
            }
        }
        let smallest =
            kept.into_iter().min_by(|((costs, text), _), ((other_costs, other_text), _)| {
                let by_costs = costs.partial_cmp(other_costs).unwrap_or(Ordering::Equal);
                by_costs.then(text.cmp(other_text))
            });
        smallest.map(|(_, candidate)| candidate)
    }

    /// Returns the candidates that differ from `candidate` in `changes` keys, 1 or 2.
    fn around(&self, candidate: &Candidate, changes: usize) -> Vec<Candidate> {
        let moves = self.space.moves(&candidate.config);
        let mut changed: Vec<Vec<(&'static str, Value)>> = Vec::new();
        for (at, first) in moves.iter().enumerate() {
            if changes == 1 {
                changed.push(vec![first.clone()]);
                continue;
            }
            for second in &moves[at + 1..] {
                if second.0 != first.0 {
                    changed.push(vec![first.clone(), second.clone()]);
                }
            }
        }
        let all = changed.par_iter();
        all.filter_map(|values| self.look(&self.space.with(&candidate.config, values)?)).collect()
    }

    /// Moves from `base` to the neighbour that is nearest to the goal, repeatedly, until the goal is met. Fails if no neighbour
    /// is nearer.
    fn reach(&self, base: Candidate) -> Result<Candidate> {
        let mut here = base;
        while !self.keeps(&here) {
            let wants_error = self.error(&here) > self.goal.error;
            let mut least = self.distance(&here, wants_error) - 1e-9;
            let mut next = None;
            for candidate in self.around(&here, 1) {
                let distance = self.distance(&candidate, wants_error);
                if distance < least {
                    least = distance;
                    next = Some(candidate);
                }
            }
            match next {
                Some(next) => here = next,
                None if wants_error => return self.out_of_reach(&here),
                None if !self.has_dsps(&here) => return self.too_many_dsps(&here),
                None => return self.too_slow(&here),
            }
        }
        Ok(here)
    }

    /// Returns a number that is smaller for a candidate nearer to the goal. If `wants_error` is set, it is the error. Otherwise
    /// it is infinite if the error is too large, and the number of DSP blocks if they are too many. In all other cases it is
    /// minus the clock, as a share of the wanted clock.
    fn distance(&self, candidate: &Candidate, wants_error: bool) -> f64 {
        if wants_error {
            self.error(candidate)
        } else if self.error(candidate) > self.goal.error {
            f64::INFINITY
        } else if !self.has_dsps(candidate) {
            candidate.cost.dsps as f64
        } else {
            -candidate.cost.mhz / self.wanted_mhz(candidate)
        }
    }

    fn too_slow(&self, fastest: &Candidate) -> Result<Candidate> {
        let wanted = match (self.goal.rate, fastest.clocks) {
            (Some(rate), Some(clocks)) => {
                format!("for {rate} million points a second at {clocks} clocks a point")
            }
            _ => "for --clock".to_owned(),
        };
        bail!(
            "the fastest clock that was found with this error is {:.1} MHz by the estimate, but {:.1} MHz \
             are needed {wanted}; try `--set architecture=pipelined`, which computes a point every clock",
            fastest.cost.mhz,
            self.wanted_mhz(fastest)
        )
    }

    fn too_many_dsps(&self, fewest: &Candidate) -> Result<Candidate> {
        bail!(
            "the smallest number of DSP blocks that was found with this error is {}, but {} are allowed; a \
             longer pipeline.interval needs fewer DSP blocks",
            fewest.cost.dsps,
            self.goal.most_dsps.unwrap_or_default()
        )
    }

    /// Fails with the smallest error that was found, and names the largest term of the bound.
    fn out_of_reach(&self, nearest: &Candidate) -> Result<Candidate> {
        let unit = self.goal.unit;
        let mut largest: Option<&Term> = None;
        for term in &nearest.bounds.governing().terms {
            // The rounding of the outputs is no part of the error of f.
            let counts = unit == ErrorUnit::Output || term.key != "output.rounding";
            if counts && largest.is_none_or(|before| term.units.total_cmp(&before.units).is_ge()) {
                largest = Some(term);
            }
        }
        let way = match largest {
            Some(Term { what, key, units, .. }) => {
                format!("; its largest part is {what} (`{key}`), {units:.6} output units")
            }
            None => String::new(),
        };
        bail!(
            "no configuration has an error of at most {} {unit}; the smallest bound that was found is {} \
             {unit}{way}",
            self.goal.error,
            above(self.error(nearest), self.goal.error)
        )
    }

    /// Returns the smallest candidate that meets the goal and differs from `here` in `changes` keys, or `None` if it is not
    /// smaller than `here`.
    fn descend(&self, here: &Candidate, changes: usize) -> Option<Candidate> {
        let smallest = self.smallest(self.around(here, changes))?;
        let is_smaller = self.goal.order(&smallest) < self.goal.order(here);
        if is_smaller { Some(smallest) } else { None }
    }
}

impl TuningGoal {
    fn error(&self, candidate: &Candidate) -> f64 {
        self.unit.of(&candidate.bounds)
    }

    fn objective(&self, candidate: &Candidate) -> f64 {
        let cost = &candidate.cost;
        match self.objective {
            Objective::Area => cost.area(self.target),
            Objective::Luts => cost.luts,
            Objective::Dsps => cost.dsps as f64,
            Objective::Memory => cost.rom_bits as f64,
        }
    }

    /// Returns numbers by which candidates are compared, the most important first: fit to the chip, objective, area, error bound,
    /// and bits of ROM. A smaller number is better.
    pub(super) fn order(&self, candidate: &Candidate) -> [f64; 5] {
        let (cost, target) = (&candidate.cost, self.target);
        let excess = if cost.excess(target).is_empty() { 0.0 } else { 1.0 };
        let (first, second) = (self.objective(candidate), cost.area(target));
        [excess, first, second, self.error(candidate), cost.rom_bits as f64]
    }

    /// Returns the candidates for which no other candidate has both a smaller or equal error and a smaller or equal objective,
    /// by rising error.
    pub(super) fn front(&self, mut all: Vec<Candidate>) -> Vec<Candidate> {
        all.sort_by(|one, other| {
            let by_error = self.error(one).total_cmp(&self.error(other));
            by_error.then(self.objective(one).total_cmp(&self.objective(other)))
        });
        let mut front: Vec<Candidate> = Vec::new();
        for candidate in all {
            match front.last() {
                Some(last) if self.objective(&candidate) >= self.objective(last) => {}
                _ => front.push(candidate),
            }
        }
        front
    }
}

/// Returns `value` with at least six digits after the point, and with as many more as show that it is above `limit`. For example,
/// 0.5000001 with the limit 0.5 gives `0.5000001`, and 0.75 gives `0.750000`.
fn above(value: f64, limit: f64) -> String {
    for digits in 6..17 {
        let text = format!("{value:.digits$}");
        if let Ok(shown) = text.parse::<f64>()
            && shown > limit
        {
            return text;
        }
    }
    value.to_string()
}

//! Searches for the smallest configuration: first upward until the bound is kept, then downward as long as it is
//! kept.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::Mutex;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;

use super::model::Cost;
use super::space::SearchSpace;
use super::{ErrorUnit, Objective, TuningGoal};
use glint_config::{Config, Value};
use glint_core::registry::Device;
use glint_golden::{Bound, Term};
use glint_show::evidence::comparison::clocks_per_point;

/// The exponent at which the clocks of a point are counted if they depend on it.
const EXPONENT: f64 = 35.0;

/// A configuration, with its bound, its cost and its rate.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The configuration.
    pub config: Config,
    /// The proved bound.
    pub bound: Bound,
    /// The estimate of its cost.
    pub cost: Cost,
    /// Clocks from a point to the next, as `glint synth` counts them; `None` if the device shows none.
    pub clocks: Option<f64>,
}

impl Candidate {
    /// Returns million points a second at the estimated clock.
    pub fn rate(&self) -> Option<f64> {
        self.clocks.map(|clocks| self.cost.mhz / clocks)
    }
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The smallest configuration that was found.
    pub best: Candidate,
    /// The configurations that no other configuration betters both in error and in the objective, by rising error.
    /// Only configurations that the search has looked at are compared.
    pub front: Vec<Candidate>,
    /// The keys that were changed or could have been.
    pub free: Vec<&'static str>,
    /// How many configurations were looked at.
    pub looked_at: usize,
}

/// A search in progress. `seen` keeps the candidates by the text of their configurations: `None` is no device.
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

    /// Searches from `base` up to the goal, then down. The result may be a local minimum.
    pub fn run(&self, base: &Config) -> Result<Answer> {
        let base = self.look(base).context("the configuration to start from makes no design")?;
        let mut best = self.reach(base)?;
        // Single changes first; pairs, which are many, only if no single change helps.
        while let Some(better) = self.descend(&best, 1).or_else(|| self.descend(&best, 2)) {
            best = better;
        }
        let seen = self.seen.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let all = seen.values().flatten().filter(|it| self.is_possible(it)).cloned().collect();
        let (looked_at, free) = (seen.len(), self.space.free().to_vec());
        Ok(Answer { front: self.goal.front(all), best, free, looked_at })
    }

    /// Goes through all combinations of values; the smallest that keeps the goal.
    pub fn exhaustive(
        &self,
        base: &Config,
        values: &[(&str, Vec<Value>)],
    ) -> Result<Option<Candidate>> {
        let mut all: Vec<Vec<(&'static str, Value)>> = vec![Vec::new()];
        for (key, values) in values {
            let key = self.space.schema().key(key).with_context(|| format!("no key `{key}`"))?.name;
            let longer = |start: &Vec<(&'static str, Value)>| -> Vec<_> {
                values
                    .iter()
                    .map(|value| [start.as_slice(), &[(key, value.clone())]].concat())
                    .collect()
            };
            all = all.iter().flat_map(longer).collect();
        }
        let found: Vec<Candidate> = all
            .par_iter()
            .filter_map(|values| self.look(&self.space.with(base, values)?))
            .collect();
        Ok(self.smallest(found))
    }

    /// Returns the candidate of a configuration, or `None` if it makes no design with the same interface. It computes a
    /// candidate once.
    fn look(&self, config: &Config) -> Option<Candidate> {
        let text = config.to_toml(self.space.schema());
        let known = |seen: &BTreeMap<String, Option<Candidate>>| seen.get(&text).cloned();
        let lock = || self.seen.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(known) = known(&lock()) {
            return known;
        }
        let contract = (self.device.contract)(config);
        let design = self.device.design(config).ok();
        // A free key alone changes nothing in the interface, but two together may.
        let design = design.filter(|design| self.space.holds(design, contract.as_ref()));
        let found = design.map(|design| Candidate {
            config: config.clone(),
            bound: contract.bound(),
            cost: Cost::new(&design, self.goal.target),
            clocks: clocks_per_point(&design, contract.as_ref(), EXPONENT).ok(),
        });
        let mut seen = lock();
        seen.insert(text, found.clone());
        (self.progress)(seen.len());
        found
    }

    fn error(&self, candidate: &Candidate) -> f64 {
        self.goal.error(candidate)
    }

    fn keeps(&self, candidate: &Candidate) -> bool {
        self.error(candidate) <= self.goal.error && self.is_possible(candidate)
    }

    /// Returns whether the clock is fast enough, and there are no more DSP blocks than are allowed.
    fn is_possible(&self, candidate: &Candidate) -> bool {
        self.has_dsps(candidate) && candidate.cost.mhz >= self.wanted_mhz(candidate)
    }

    fn has_dsps(&self, candidate: &Candidate) -> bool {
        self.goal.most_dsps.is_none_or(|most| candidate.cost.dsps <= most)
    }

    /// Returns the clock that a candidate needs for the goal, in MHz. It is infinite if a rate is wanted and the
    /// candidate shows no point. For example, 2 million points a second at 10 clocks a point need 20 MHz.
    fn wanted_mhz(&self, candidate: &Candidate) -> f64 {
        let of_rate = self.goal.rate.map(|rate| match candidate.clocks {
            Some(clocks) => rate * clocks,
            None => f64::INFINITY,
        });
        self.goal.clock.unwrap_or_default().max(of_rate.unwrap_or_default())
    }

    /// Returns the costs, the most important first. Candidates of equal costs differ in their text.
    fn order(&self, candidate: &Candidate) -> ([f64; 5], String) {
        (self.goal.order(candidate), candidate.config.to_toml(self.space.schema()))
    }

    fn smallest(&self, candidates: Vec<Candidate>) -> Option<Candidate> {
        let kept = candidates.into_iter().filter(|candidate| self.keeps(candidate));
        kept.map(|one| (self.order(&one), one))
            .min_by(|(one, _), (other, _)| {
                one.0.partial_cmp(&other.0).unwrap_or(Ordering::Equal).then(one.1.cmp(&other.1))
            })
            .map(|(_, one)| one)
    }

    /// Returns the neighbours that differ by this number of changes.
    fn around(&self, candidate: &Candidate, changes: usize) -> Vec<Candidate> {
        let moves = self.space.moves(&candidate.config);
        let single = moves.iter().map(|one| vec![one.clone()]);
        let changed: Vec<Vec<(&'static str, Value)>> = if changes == 1 {
            single.collect()
        } else {
            let pairs = moves.iter().enumerate().flat_map(|(at, one)| {
                let others = moves[at + 1..].iter().filter(move |other| other.0 != one.0);
                others.map(move |other| vec![one.clone(), other.clone()])
            });
            pairs.collect()
        };
        let all = changed.par_iter();
        all.filter_map(|values| self.look(&self.space.with(&candidate.config, values)?)).collect()
    }

    /// Goes on to the neighbour with the smallest error until the goal is kept.
    fn reach(&self, base: Candidate) -> Result<Candidate> {
        let mut here = base;
        while !self.keeps(&here) {
            let wanted = self.error(&here) > self.goal.error;
            let measure = |candidate: &Candidate| match wanted {
                true => self.error(candidate),
                // The error is kept, and the clock or the number of DSP blocks is not.
                false if self.error(candidate) > self.goal.error => f64::INFINITY,
                false if !self.has_dsps(candidate) => candidate.cost.dsps as f64,
                false => -candidate.cost.mhz / self.wanted_mhz(candidate),
            };
            let next = self.around(&here, 1).into_iter();
            let next = next.min_by(|one, other| measure(one).total_cmp(&measure(other)));
            match next.filter(|next| measure(next) < measure(&here) - 1e-9) {
                Some(next) => here = next,
                None if wanted => return self.out_of_reach(&here),
                None if !self.has_dsps(&here) => return self.too_many_dsps(&here),
                None => return self.too_slow(&here),
            }
        }
        Ok(here)
    }

    /// Returns the clock that cannot be kept.
    fn too_slow(&self, fastest: &Candidate) -> Result<Candidate> {
        let wanted = match (self.goal.rate, fastest.clocks) {
            (Some(rate), Some(clocks)) => {
                format!("for {rate} million points a second at {clocks} clocks a point")
            }
            _ => "as --clock".to_owned(),
        };
        bail!(
            "the estimate of the fastest clock that keeps the error is {:.1} MHz, {:.1} MHz are wanted {wanted}; \
             `--set architecture=pipelined` computes a point a clock",
            fastest.cost.mhz,
            self.wanted_mhz(fastest)
        )
    }

    /// Returns the number of DSP blocks that cannot be kept.
    fn too_many_dsps(&self, fewest: &Candidate) -> Result<Candidate> {
        bail!(
            "the fewest DSP blocks that were found with the error are {}, {} are allowed; a longer pipeline.interval has fewer",
            fewest.cost.dsps,
            self.goal.most_dsps.unwrap_or_default()
        )
    }

    /// Returns the error that says that the goal cannot be kept, and which term is in the way.
    fn out_of_reach(&self, nearest: &Candidate) -> Result<Candidate> {
        let unit = self.goal.unit;
        // The rounding of the outputs is no part of the error of f.
        let counts = |term: &&Term| unit == ErrorUnit::Output || term.key != "output.rounding";
        let largest = nearest.bound.terms.iter().filter(counts);
        let largest = largest.max_by(|one, other| one.units.total_cmp(&other.units));
        let way = largest.map_or_else(String::new, |term| {
            format!("; in the way: {} (`{}`), {:.6} output units", term.what, term.key, term.units)
        });
        bail!(
            "no configuration keeps {} {unit}; the smallest bound that was found is {} {unit}{way}",
            self.goal.error,
            above(self.error(nearest), self.goal.error)
        )
    }

    /// Returns a smaller neighbour that keeps the goal.
    fn descend(&self, here: &Candidate, changes: usize) -> Option<Candidate> {
        let smallest = self.smallest(self.around(here, changes))?;
        (self.order(&smallest).0 < self.order(here).0).then_some(smallest)
    }
}

impl TuningGoal {
    fn error(&self, candidate: &Candidate) -> f64 {
        self.unit.of(&candidate.bound)
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

    /// Returns the costs, the most important first: fit to the chip, objective, area, error, and bits of ROM.
    pub(super) fn order(&self, candidate: &Candidate) -> [f64; 5] {
        let (cost, target) = (&candidate.cost, self.target);
        let excess = if cost.excess(target).is_empty() { 0.0 } else { 1.0 };
        let (first, second) = (self.objective(candidate), cost.area(target));
        [excess, first, second, self.error(candidate), cost.rom_bits as f64]
    }

    /// Returns the candidates that no other candidate betters both in error and in the objective, by rising error.
    pub(super) fn front(&self, mut all: Vec<Candidate>) -> Vec<Candidate> {
        all.sort_by(|one, other| {
            let by_error = self.error(one).total_cmp(&self.error(other));
            by_error.then(self.objective(one).total_cmp(&self.objective(other)))
        });
        let mut front: Vec<Candidate> = Vec::new();
        for candidate in all {
            let smaller =
                front.last().is_none_or(|last| self.objective(&candidate) < self.objective(last));
            if smaller {
                front.push(candidate);
            }
        }
        front
    }
}

/// Returns a value with as many digits as show that it is above a limit, and six at least. For example, 0.5000001 and
/// the limit 0.5 give `0.5000001`, and 0.75 gives `0.750000`.
fn above(value: f64, limit: f64) -> String {
    let shown = (6..17).map(|digits| format!("{value:.digits$}"));
    let is_above = |text: &String| text.parse::<f64>().is_ok_and(|shown| shown > limit);
    shown.into_iter().find(is_above).unwrap_or_else(|| value.to_string())
}

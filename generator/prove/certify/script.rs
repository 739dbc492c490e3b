//! Writes the text of a Gappa script: definitions, hypotheses, the goal, and hints for the prover.
//!
//! Gappa needs hints that relate terms of the formula to terms of the hardware. The module finds most of them by comparing the
//! terms' values at random points. A wrong hint cannot lead to a wrong proof: Gappa says so if it uses a hint that it cannot
//! prove, and `proof` then rejects the answer.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::exact::{self, Branch};
use super::hardware::Variables;
use super::terms::{RealTerm, RealTermId, RealTerms, number};
use glint_base::fixed::exp2;

/// The number of points at which terms are compared.
const SAMPLES: usize = 24;
const TRIES: usize = 2_000;

/// The parts that all Gappa scripts of one case have in common.
pub struct GappaScript<'a> {
    pub terms: &'a RealTerms,
    /// The number of terms that belong to the hardware. They come before the formula's terms.
    pub hardware_terms: usize,
    /// The script's variables, with their numbers of fraction bits.
    pub placed: &'a Variables,
    /// The intervals of terms that the script takes as hypotheses.
    pub presupposed: &'a BTreeMap<RealTermId, (f64, f64)>,
    /// The branches of the formula that apply in this case, one for each expression.
    pub ways: &'a [Branch],
}

impl GappaScript<'_> {
    /// Returns the script for one output: `out` and the formula `f` times `factor` differ by at most `bound`, in output units. If
    /// `bound` is `None`, the script asks Gappa for the bound.
    pub fn text(
        &self,
        out: RealTermId,
        factor: RealTermId,
        f: RealTermId,
        bound: Option<f64>,
    ) -> String {
        let mut terms = self.terms.clone();
        let exact = exact::folded(&mut terms, RealTerm::Mul(f, factor));
        let difference = terms.insert(RealTerm::Sub(out, exact), "difference");
        let goal = goal(&terms.name(difference), bound);
        self.statement(terms, difference, &goal, &[])
    }

    /// Returns the script that states `goal` about the term `about`. `hints` are lines in front of the hints that the module
    /// finds.
    pub fn statement(
        &self,
        mut terms: RealTerms,
        about: RealTermId,
        goal: &str,
        hints: &[String],
    ) -> String {
        let mut roots = vec![about];
        for way in self.ways {
            roots.extend(way.at_least.iter().chain(&way.at_most));
        }
        for &id in self.presupposed.keys() {
            if !is_variable(self.terms, id) {
                roots.push(id);
            }
        }
        let (equal, near) = self.hints(&mut terms, about, &mut roots);
        let needed = terms.needed(&roots);
        let mut text = terms.definitions(&needed);
        let statement = match self.hypotheses(&terms, &needed).join("\n  /\\ ").as_str() {
            "" => goal.to_owned(),
            hypotheses => format!("{hypotheses}\n  -> {goal}"),
        };
        let _ = write!(text, "\n{{ {statement} }}\n\n");
        for line in hints.iter().chain(&equal).chain(&near) {
            let _ = writeln!(text, "{line}");
        }
        text
    }

    /// Returns the hypotheses about terms that are `needed`: formats of variables, intervals of terms, and signs of differences.
    /// Examples are `@FIX(x,-4)`, `x in [0,1]` and `exact_9 >= 0`.
    fn hypotheses(&self, terms: &RealTerms, needed: &[bool]) -> Vec<String> {
        let mut hypotheses = Vec::new();
        for (name, scale) in self.placed {
            let is_needed = (0..terms.count())
                .any(|id| needed[id] && is_variable(terms, id) && terms.name(id) == *name);
            if is_needed {
                hypotheses.push(format!("@FIX({name},{})", -scale));
            }
        }
        for (&id, &(low, high)) in self.presupposed {
            // A variable with only one value does not occur in the terms, but the hypothesis about it is written too.
            let is_given = is_variable(terms, id) && low == high;
            if !is_number(terms, id) && (needed[id] || is_given) {
                let name = terms.name(id);
                hypotheses.push(format!("{name} in [{},{}]", number(low), number(high)));
            }
        }
        for way in self.ways {
            for (ids, sign) in [(&way.at_least, ">="), (&way.at_most, "<=")] {
                for &id in ids {
                    let hypothesis = format!("{} {sign} 0", terms.name(id));
                    if !is_number(terms, id) && !hypotheses.contains(&hypothesis) {
                        hypotheses.push(hypothesis);
                    }
                }
            }
        }
        hypotheses
    }

    /// Returns hints of four kinds: first a list of equalities, then a list of pairs of terms that are near each other. A sum a +
    /// (1 − a)·x gets a form that shows its range (`blend`). A term of the formula may be a factor times a term of the hardware,
    /// plus an offset. It may equal a term of the hardware without its roundings; such terms are added to `roots`. It may be near
    /// a term of the hardware with roundings. The comparison of samples finds the last three kinds, and Gappa proves each hint
    /// that it uses.
    fn hints(
        &self,
        terms: &mut RealTerms,
        about: RealTermId,
        roots: &mut Vec<RealTermId>,
    ) -> (Vec<String>, Vec<String>) {
        let needed = terms.needed(roots);
        let mut unrounded = HashMap::new();
        for id in (0..self.hardware_terms).filter(|&id| needed[id]) {
            terms.unrounded(id, &mut unrounded);
        }
        let samples = self.samples(terms);
        let mut equal: Vec<String> = Vec::new();
        for id in (0..about).filter(|&id| needed[id]) {
            equal.extend(blend(terms, id));
        }
        let mut hardware: Vec<(RealTermId, Vec<f64>)> = Vec::new();
        for id in (0..self.hardware_terms).filter(|&id| needed[id]) {
            let values = column(&samples, id);
            if is_compound(terms, id) && varies(&values) {
                hardware.push((id, values));
            }
        }
        let mut near: Vec<String> = Vec::new();
        let formula = self.hardware_terms..about.max(self.hardware_terms);
        for other in formula.filter(|&id| needed[id]) {
            let values = column(&samples, other);
            if !is_compound(terms, other) || !varies(&values) {
                continue;
            }
            let before = equal.len();
            for (id, column) in &hardware {
                if terms.is_exact(*id)
                    && let Some(line) = line_through(column, &values)
                {
                    equal.push(rewriting(terms, other, *id, line));
                }
            }
            if before == equal.len() {
                for (id, _) in &hardware {
                    if let Some(&twin) = unrounded.get(id)
                        && twin != other
                        && is_same(&column(&samples, twin), &values)
                    {
                        equal.push(rewriting(terms, other, twin, (1.0, 0.0)));
                        roots.push(twin);
                        break;
                    }
                }
            }
            for (id, column) in &hardware {
                if !terms.is_exact(*id) && is_near(column, &values) {
                    near.push(format!("{} ~ {};", terms.name(*id), terms.name(other)));
                }
            }
        }
        (equal, near)
    }

    /// Returns the values of all terms at random points: up to 24 points of this case, and then up to 24 other points of the
    /// domain.
    fn samples(&self, terms: &RealTerms) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let (mut samples, mut others) = (Vec::new(), Vec::new());
        for _ in 0..TRIES {
            let values = terms.evaluate(&self.random_variables(&mut random));
            if self.is_of_case(&values) {
                samples.push(values);
                if samples.len() == SAMPLES {
                    break;
                }
            } else if others.len() < SAMPLES {
                others.push(values);
            }
        }
        samples.extend(others);
        samples
    }

    fn random_variables(&self, random: &mut ChaCha8Rng) -> HashMap<String, f64> {
        let mut variables = HashMap::new();
        for (&id, &(low, high)) in self.presupposed {
            let RealTerm::Variable(name) = self.terms.get(id) else { continue };
            let unit = match self.placed.iter().find(|(other, _)| other == name) {
                Some((_, scale)) => exp2(*scale),
                None => 1.0,
            };
            let unit_share = (random.next_u32() as f64) / f64::from(u32::MAX);
            // Two thirds of the values are near an end of the interval.
            let share = match random.next_u32() % 3 {
                0 => unit_share,
                1 => unit_share.powi(8),
                _ => 1.0 - unit_share.powi(8),
            };
            let step = libm::floor(((high - low) * unit + 1.0) * share);
            variables.insert(name.clone(), (low + step / unit).min(high));
        }
        variables
    }

    /// Returns whether `values`, the values of all terms, satisfy the conditions of the formula's branches and the presupposed
    /// intervals.
    fn is_of_case(&self, values: &[f64]) -> bool {
        for way in self.ways {
            let is_way = way.at_least.iter().all(|&id| values[id] >= 0.0)
                && way.at_most.iter().all(|&id| values[id] <= 0.0);
            if !is_way {
                return false;
            }
        }
        self.presupposed.iter().all(|(&id, &(low, high))| (low..=high).contains(&values[id]))
    }
}

fn is_variable(terms: &RealTerms, id: RealTermId) -> bool {
    matches!(terms.get(id), RealTerm::Variable(_))
}

fn is_number(terms: &RealTerms, id: RealTermId) -> bool {
    matches!(terms.get(id), RealTerm::Number(_))
}

fn is_compound(terms: &RealTerms, id: RealTermId) -> bool {
    !is_number(terms, id) && !is_variable(terms, id)
}

fn column(samples: &[Vec<f64>], id: RealTermId) -> Vec<f64> {
    samples.iter().map(|values| values[id]).collect()
}

fn varies(values: &[f64]) -> bool {
    values.iter().any(|value| *value != values[0])
}

/// Writes the hint that a + (1 − a)·x is 1 − (1 − a)·(1 − x), which shows that the value is between a and 1. For example, `f_9 ->
/// 1 - rest_4 * (1 - x);`.
fn blend(terms: &RealTerms, id: RealTermId) -> Option<String> {
    let RealTerm::Add(first, second) = *terms.get(id) else { return None };
    let (product, a) = match terms.get(first) {
        RealTerm::Number(_) => (second, first),
        _ => (first, second),
    };
    let RealTerm::Mul(b, c) = *terms.get(product) else { return None };
    let (rest, x) = if is_rest(terms, b, a) { (b, c) } else { (c, b) };
    if !is_rest(terms, rest, a) {
        return None;
    }
    let [name, rest_name, x_name] = [id, rest, x].map(|id| terms.name(id));
    Some(format!("{name} -> 1 - {rest_name} * (1 - {x_name});"))
}

fn is_rest(terms: &RealTerms, id: RealTermId, a: RealTermId) -> bool {
    match *terms.get(id) {
        RealTerm::Sub(one, other) => *terms.get(one) == RealTerm::Number(1.0) && other == a,
        _ => false,
    }
}

/// Writes the hint that the term `left` is `factor` times the term `right`, plus `offset`. For example, the factor −1 and the
/// offset 0.5 give `f_9 -> 0.5 - cut_3;`.
fn rewriting(
    terms: &RealTerms,
    left: RealTermId,
    right: RealTermId,
    (factor, offset): (f64, f64),
) -> String {
    let name = terms.name(right);
    // Gappa simplifies a plain difference, but not a product by −1.
    let line = match (offset, factor) {
        (0.0, 1.0) => name,
        (_, 1.0) => format!("{} + {name}", number(offset)),
        (_, -1.0) => format!("{} - {name}", number(offset)),
        (0.0, _) => format!("({}) * {name}", number(factor)),
        _ => format!("{} + ({}) * {name}", number(offset), number(factor)),
    };
    format!("{} -> {line};", terms.name(left))
}

fn largest_size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Returns whether `x` and `y` differ by at most 1/64 of the largest absolute value in `x`.
fn is_near(x: &[f64], y: &[f64]) -> bool {
    let limit = largest_size(x) / 64.0;
    let mut apart: f64 = 0.0;
    for (x, y) in x.iter().zip(y) {
        apart = apart.max((x - y).abs());
    }
    apart <= limit
}

/// Returns whether `x` and `y` differ only by the rounding of f64.
fn is_same(x: &[f64], y: &[f64]) -> bool {
    let limit = largest_size(y) * exp2(-44);
    x.iter().zip(y).all(|(x, y)| (x - y).abs() <= limit)
}

/// Returns a factor and an offset, rounded to 16 and 44 fraction bits, so `y` is the factor times `x` plus the offset. For
/// example, 0, 1, 2 and 1, 3, 5 give the factor 2 and the offset 1. Returns `None` if `y` is not linear in `x`, or if the factor
/// is 0.
fn line_through(x: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let other = x.iter().position(|value| *value != x[0])?;
    let factor = rounded((y[other] - y[0]) / (x[other] - x[0]), 16);
    let offset = rounded(y[0] - factor * x[0], 44);
    if factor == 0.0 {
        return None;
    }
    for (x, y) in x.iter().zip(y) {
        let size = (factor * x).abs() + offset.abs() + y.abs();
        let fits = (factor * x + offset - y).abs() <= size * exp2(-46);
        if !fits {
            return None;
        }
    }
    Some((factor, offset))
}

fn rounded(value: f64, bits: i32) -> f64 {
    libm::round(value * exp2(bits)) / exp2(bits)
}

/// Returns the goal that the difference is within `bound`, for example `|difference_7| <= 0.5`. If `bound` is `None`, returns the
/// question for the bound: `|difference_7| in ?`.
pub fn goal(difference: &str, bound: Option<f64>) -> String {
    match bound {
        Some(bound) => format!("|{difference}| <= {}", number(bound)),
        None => format!("|{difference}| in ?"),
    }
}

/// Replaces the names of a script by `n0`, `n1`, … in the order of their first use, so scripts that state the same become equal.
/// For example, `sum_2 = 0.5 + x;` becomes `n0 = 0.5 + n1;`.
pub fn nameless(script: &str) -> String {
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
    let mut text = String::new();
    let mut rest = script;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| is_part(c) != is_part(first)).unwrap_or(rest.len());
        let (part, others) = rest.split_at(end);
        rest = others;
        let is_name = is_part(first) && !first.is_ascii_digit();
        if is_name && !["fixed", "dn", "na", "in", "FIX"].contains(&part) {
            let next = numbers.len();
            let _ = write!(text, "n{}", numbers.entry(part).or_insert(next));
        } else {
            text.push_str(part);
        }
    }
    text
}

//! Finds a point at which all hypotheses of a Gappa script hold.
//!
//! Such a point shows that the statement is not vacuous: hypotheses that contradict each other would prove anything. The search
//! begins at 64 random points, and moves each step by step while the violation becomes smaller. If it finds no point, a point may
//! exist nevertheless.

use std::collections::HashMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::terms::{RealTerm, RealTermId, RealTerms, RoundingDirection, number};
use glint_base::fixed::exp2;
use glint_formula::{Expression, Function, Kind, Operator, parse};

/// The number of random points from which a search begins.
const STARTS: usize = 64;

/// The number of fraction bits of a variable without a format in the script.
const CONTINUOUS: i32 = 20;

/// The largest absolute value that is tried for a variable without an interval.
const FREE: f64 = 1024.0;

/// A goal that is never true. Gappa proves it only if the hypotheses contradict each other.
const NEVER: &str = "1 in [2,3] }";

/// The text between the hypotheses and the goal.
const IMPLIES: &str = "\n  -> ";

/// Returns the script with a goal that Gappa can prove only if the hypotheses contradict each other. For example, the goal
/// `|square| <= 1` becomes `1 in [2,3]`. Returns `None` for a script without hypotheses.
pub fn contradiction(script: &str) -> Option<String> {
    let (hypotheses, rest) = script.split_once(IMPLIES)?;
    let (_, hints) = rest.split_once('}')?;
    Some(format!("{hypotheses}{IMPLIES}{NEVER}{hints}"))
}

/// A variable. Its values are `unit` times the integers from `low` to `high`.
struct Variable {
    name: String,
    unit: f64,
    low: i64,
    high: i64,
}

struct Hypotheses {
    terms: RealTerms,
    variables: Vec<Variable>,
    /// For each hypothesis about a term, the interval in which the term must lie.
    intervals: Vec<(RealTermId, f64, f64)>,
}

impl Hypotheses {
    /// Parses the hypotheses of `script`. Returns `None` if a part of the text has an unknown form.
    fn of(script: &str) -> Option<Self> {
        let (definitions, statement) = script.split_once("\n{ ")?;
        let mut terms = RealTerms::default();
        let mut names: HashMap<String, RealTermId> = HashMap::new();
        for line in definitions.lines().filter(|line| !line.starts_with('#')) {
            let Some((name, right)) = line.trim_end_matches(';').split_once(" = ") else {
                continue;
            };
            let id = expression(right, &mut terms, &names)?;
            names.insert(name.to_owned(), id);
        }
        let (mut places, mut intervals) = (HashMap::new(), Vec::new());
        let (hypotheses, _) = statement.split_once(IMPLIES)?;
        for hypothesis in hypotheses.split("\n  /\\ ") {
            if let Some(fixed) = hypothesis.strip_prefix("@FIX(") {
                let (name, place) = fixed.trim_end_matches(')').split_once(',')?;
                places.insert(name.to_owned(), -place.parse::<i32>().ok()?);
            } else if let Some((left, ends)) = hypothesis.split_once(" in [") {
                let (low, high) = ends.trim_end_matches(']').split_once(',')?;
                let id = expression(left, &mut terms, &names)?;
                intervals.push((id, low.parse().ok()?, high.parse().ok()?));
            } else if let Some((left, right)) = hypothesis.split_once(" >= ") {
                let id = expression(left, &mut terms, &names)?;
                intervals.push((id, right.parse().ok()?, f64::INFINITY));
            } else {
                let (left, right) = hypothesis.split_once(" <= ")?;
                let id = expression(left, &mut terms, &names)?;
                intervals.push((id, f64::NEG_INFINITY, right.parse().ok()?));
            }
        }
        let variables = (0..terms.count()).filter_map(|id| {
            let RealTerm::Variable(name) = terms.get(id) else { return None };
            let unit = exp2(-places.get(name).copied().unwrap_or(CONTINUOUS));
            let is_whole = |(of, low, high): &&(RealTermId, f64, f64)| {
                *of == id && low.is_finite() && high.is_finite()
            };
            let (_, low, high) = *intervals.iter().find(is_whole).unwrap_or(&(id, -FREE, FREE));
            // An interval of a single number is this number, even if the number is no multiple of the unit.
            let (unit, low, high) = match low == high && low != 0.0 {
                true => (low, 1, 1),
                false => (unit, (low / unit).ceil() as i64, (high / unit).floor() as i64),
            };
            Some(Variable { name: name.clone(), unit, low, high: high.max(low) })
        });
        Some(Self { variables: variables.collect(), terms, intervals })
    }

    /// Returns how far the hypotheses are from holding at `point`: 0 if all hold, and infinity if a term is not a number.
    fn violation(&self, point: &[i64]) -> f64 {
        let variables = self.variables.iter().zip(point);
        let variables = variables.map(|(it, &raw)| (it.name.clone(), raw as f64 * it.unit));
        let values = self.terms.evaluate(&variables.collect());
        let away = |&(id, low, high): &(RealTermId, f64, f64)| {
            let ends = [low, high].into_iter().filter(|end| end.is_finite());
            let size = ends.fold(1.0, |most: f64, end| most.max(end.abs()));
            match values[id].is_nan() {
                true => f64::INFINITY,
                false => (low - values[id]).max(values[id] - high).max(0.0) / size,
            }
        };
        self.intervals.iter().map(away).sum()
    }

    /// Moves `point` step by step while the violation becomes smaller. Returns whether all hypotheses hold at the end.
    fn descend(&self, point: &mut [i64]) -> bool {
        let mut away = self.violation(point);
        while away > 0.0 {
            let before = away;
            for bit in (0..40).rev() {
                for (at, sign) in (0..point.len()).flat_map(|at| [(at, 1), (at, -1)]) {
                    let (variable, kept) = (&self.variables[at], point[at]);
                    point[at] = kept.saturating_add(sign << bit).clamp(variable.low, variable.high);
                    let there = self.violation(point);
                    if there < away {
                        away = there;
                    } else {
                        point[at] = kept;
                    }
                }
            }
            if away >= before {
                return false;
            }
        }
        true
    }
}

/// Returns a point at which all hypotheses hold, for example `x = -0.5, y = 3`, or `every point` for a script without
/// hypotheses. Returns `None` if the search finds none, or if the script has an unknown form.
pub fn witness(script: &str) -> Option<String> {
    if !script.contains(IMPLIES) {
        return Some("every point".to_owned());
    }
    let hypotheses = Hypotheses::of(script)?;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..STARTS {
        let mut point: Vec<i64> = Vec::new();
        for variable in &hypotheses.variables {
            let share = f64::from(random.next_u32()) / f64::from(u32::MAX);
            // Two thirds of the values are near an end of the interval.
            let share = match random.next_u32() % 3 {
                0 => share,
                1 => share.powi(8),
                _ => 1.0 - share.powi(8),
            };
            let span = (variable.high - variable.low) as f64;
            point.push((variable.low + (span * share) as i64).clamp(variable.low, variable.high));
        }
        if hypotheses.descend(&mut point) {
            let values = hypotheses.variables.iter().zip(point);
            let values =
                values.map(|(it, raw)| format!("{} = {}", it.name, number(raw as f64 * it.unit)));
            return Some(values.collect::<Vec<_>>().join(", "));
        }
    }
    None
}

/// Parses `text` into `terms`. A name is the term in `names`, or else a new variable. Returns `None` for an unknown form.
fn expression(
    text: &str,
    terms: &mut RealTerms,
    names: &HashMap<String, RealTermId>,
) -> Option<RealTermId> {
    if let Some(rounded) = text.strip_prefix("fixed<") {
        let (how, of) = rounded.split_once(">(")?;
        let (place, direction) = how.split_once(',')?;
        let direction = match direction {
            "dn" => RoundingDirection::Down,
            "na" => RoundingDirection::Nearest,
            _ => return None,
        };
        let of = expression(of.strip_suffix(')')?, terms, names)?;
        let fraction = -place.parse::<i32>().ok()?;
        return Some(terms.insert(RealTerm::Round { of, fraction, direction }, ""));
    }
    term(&parse(text).ok()?, terms, names)
}

fn term(
    formula: &Expression,
    terms: &mut RealTerms,
    names: &HashMap<String, RealTermId>,
) -> Option<RealTermId> {
    let (make, a, b): (fn(RealTermId, RealTermId) -> RealTerm, _, _) = match &formula.kind {
        Kind::Number(literal) => return Some(terms.number(literal.nearest())),
        // Every name in a script is a name of the script, even if it is a constant such as `pi` in formulas.
        Kind::Operand(_) | Kind::Constant(..) => {
            let name = formula.python();
            let known = names.get(&name).copied();
            return Some(
                known.unwrap_or_else(|| terms.insert(RealTerm::Variable(name.clone()), &name)),
            );
        }
        Kind::Unary(Function::Negate, a) => {
            let (zero, a) = (terms.number(0.0), term(a, terms, names)?);
            return Some(terms.insert(RealTerm::Sub(zero, a), ""));
        }
        Kind::Binary(Operator::Add, a, b) => (RealTerm::Add, a, b),
        Kind::Binary(Operator::Sub, a, b) => (RealTerm::Sub, a, b),
        Kind::Binary(Operator::Mul, a, b) => (RealTerm::Mul, a, b),
        Kind::Binary(Operator::Div, a, b) => (RealTerm::Div, a, b),
        _ => return None,
    };
    let (a, b) = (term(a, terms, names)?, term(b, terms, names)?);
    Some(terms.insert(make(a, b), ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hypotheses allow quarters with x² ≥ 1/4 that are −1 when rounded down: x is −1/2, −3/4 or −1. With x ≥ 1/4 in
    /// addition, no x is left.
    #[test]
    fn a_witness_satisfies_the_hypotheses() {
        let script = |more: &str| {
            format!(
                "# A line.\nsquare = x * x;\ncut = fixed<0,dn>(x);\n\n{{ @FIX(x,-2)\n  /\\ x in [-1,1]\n  /\\ square - 0.25 >= 0\n  \
                 /\\ cut <= -1{more}\n  -> |square| <= 1 }}\n\nsquare ~ x;\n"
            )
        };
        let found = witness(&script("")).expect("a point");
        assert!(["x = -0.5", "x = -0.75", "x = -1"].contains(&found.as_str()), "{found}");
        assert_eq!(witness(&script("\n  /\\ x >= 0.25")), None);
        let asked = contradiction(&script("")).expect("hypotheses");
        assert!(asked.contains("-> 1 in [2,3] }\n\nsquare ~ x;"), "{asked}");
        assert_eq!(contradiction("{ |x| <= 1 }"), None);
    }
}

//! Stores expressions over the real numbers, of a formula and of the hardware. The module writes them in the syntax of Gappa, and
//! evaluates them in f64.

use std::collections::HashMap;
use std::fmt::Write as _;

use glint_base::cone;

pub type RealTermId = usize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RoundingDirection {
    /// Hardware that drops bits rounds down.
    Down,
    /// Rounds to the nearest, halves away from 0. Only values that are not negative are rounded to the nearest, so halves go up.
    Nearest,
}

/// An expression over the real numbers for a Gappa script. Its operands are terms.
#[derive(Clone, Debug, PartialEq)]
pub enum RealTerm {
    Variable(String),
    Number(f64),
    Add(RealTermId, RealTermId),
    Sub(RealTermId, RealTermId),
    Mul(RealTermId, RealTermId),
    Div(RealTermId, RealTermId),
    /// The operand, rounded to a multiple of 2^-`fraction`.
    Round {
        of: RealTermId,
        /// The number of fraction bits that are kept; negative if integer bits are dropped.
        fraction: i32,
        direction: RoundingDirection,
    },
}

/// A collection of terms, each stored once, with the names of their definitions in a script.
#[derive(Clone, Debug, Default)]
pub struct RealTerms {
    terms: Vec<(RealTerm, String)>,
    /// Each term's variables, and its degree in them.
    shapes: Vec<(Vec<RealTermId>, u32)>,
    known: HashMap<String, RealTermId>,
}

impl RealTerms {
    /// Adds `term`, if it is new, and returns its number. The name of its definition in a script is `name` and the number: term 2
    /// with the name `sum` is `sum_2`.
    ///
    /// The operands of sums and products are sorted, so hardware and formula have them in the same order. Gappa compares two
    /// products factor by factor.
    pub fn insert(&mut self, term: RealTerm, name: &str) -> RealTermId {
        let term = match term {
            RealTerm::Add(a, b) if self.is_after(a, b) => RealTerm::Add(b, a),
            RealTerm::Mul(a, b) if self.is_after(a, b) => RealTerm::Mul(b, a),
            term => term,
        };
        let key = format!("{term:?}");
        if let Some(&id) = self.known.get(&key) {
            return id;
        }
        let id = self.terms.len();
        let name = match term {
            RealTerm::Variable(_) => name.to_owned(),
            _ => format!("{name}_{id}"),
        };
        self.terms.push((term, name));
        self.shapes.push(self.shape(id));
        self.known.insert(key, id);
        id
    }

    /// Returns whether `a` comes after `b`. Numbers come first and variables last. All other terms are ordered by their
    /// variables and degree.
    fn is_after(&self, a: RealTermId, b: RealTermId) -> bool {
        let kind = |id: RealTermId| match self.get(id) {
            RealTerm::Number(_) => 0,
            RealTerm::Variable(_) => 2,
            _ => 1,
        };
        let order = |id: RealTermId| (kind(id), &self.shapes[id], id);
        order(a) > order(b)
    }

    fn shape(&self, id: RealTermId) -> (Vec<RealTermId>, u32) {
        let operands = self.operands(id);
        let mut variables: Vec<RealTermId> =
            operands.iter().flat_map(|&id| self.shapes[id].0.iter().copied()).collect();
        let degrees = operands.iter().map(|&id| self.shapes[id].1);
        let degree = match self.get(id) {
            RealTerm::Variable(_) => {
                variables.push(id);
                1
            }
            RealTerm::Mul(..) => degrees.sum(),
            _ => degrees.max().unwrap_or(0),
        };
        variables.sort_unstable();
        variables.dedup();
        (variables, degree)
    }

    pub fn number(&mut self, value: f64) -> RealTermId {
        self.insert(RealTerm::Number(value), "number")
    }

    pub fn get(&self, id: RealTermId) -> &RealTerm {
        &self.terms[id].0
    }

    /// Returns the text of a term in the script, for example `sum_2`, `x` or `(-0.5)`.
    pub fn name(&self, id: RealTermId) -> String {
        match self.get(id) {
            RealTerm::Number(value) if *value < 0.0 => format!("({})", number(*value)),
            RealTerm::Number(value) => number(*value),
            _ => self.terms[id].1.clone(),
        }
    }

    pub fn count(&self) -> usize {
        self.terms.len()
    }

    pub fn is_exact(&self, id: RealTermId) -> bool {
        let of =
            |id: &RealTermId| self.is_exact(*id) || matches!(self.get(*id), RealTerm::Number(_));
        match self.get(id) {
            RealTerm::Variable(_) => true,
            RealTerm::Number(_) | RealTerm::Round { .. } => false,
            RealTerm::Add(a, b)
            | RealTerm::Sub(a, b)
            | RealTerm::Mul(a, b)
            | RealTerm::Div(a, b) => of(a) && of(b),
        }
    }

    /// Returns the values of all terms. A variable without a value is NaN, and so is every term that depends on it.
    pub fn evaluate(&self, variables: &HashMap<String, f64>) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.terms.len());
        for (term, _) in &self.terms {
            let value = match term {
                RealTerm::Variable(name) => variables.get(name).copied().unwrap_or(f64::NAN),
                RealTerm::Number(value) => *value,
                RealTerm::Add(a, b) => values[*a] + values[*b],
                RealTerm::Sub(a, b) => values[*a] - values[*b],
                RealTerm::Mul(a, b) => values[*a] * values[*b],
                RealTerm::Div(a, b) => values[*a] / values[*b],
                RealTerm::Round { of, fraction, direction } => {
                    let unit = libm::exp2(f64::from(*fraction));
                    let scaled = values[*of] * unit;
                    match direction {
                        RoundingDirection::Down => libm::floor(scaled) / unit,
                        RoundingDirection::Nearest => libm::floor(scaled + 0.5) / unit,
                    }
                }
            };
            values.push(value);
        }
        values
    }

    /// Returns for each term whether it is one of `roots`, or one of `roots` depends on it.
    pub fn needed(&self, roots: &[RealTermId]) -> Vec<bool> {
        cone::needed(self.terms.len(), roots.iter().copied(), |id| self.operands(id))
    }

    /// Adds the expression `id` without its roundings, if it is new. `known` caches the results of earlier calls.
    pub fn unrounded(
        &mut self,
        id: RealTermId,
        known: &mut HashMap<RealTermId, RealTermId>,
    ) -> RealTermId {
        if let Some(&twin) = known.get(&id) {
            return twin;
        }
        let twin = match self.get(id).clone() {
            RealTerm::Round { of, .. } => self.unrounded(of, known),
            RealTerm::Variable(_) | RealTerm::Number(_) => id,
            RealTerm::Add(a, b) => self.without(RealTerm::Add, (a, b), known),
            RealTerm::Sub(a, b) => self.without(RealTerm::Sub, (a, b), known),
            RealTerm::Mul(a, b) => self.without(RealTerm::Mul, (a, b), known),
            RealTerm::Div(a, b) => self.without(RealTerm::Div, (a, b), known),
        };
        known.insert(id, twin);
        twin
    }

    fn without(
        &mut self,
        make: fn(RealTermId, RealTermId) -> RealTerm,
        (a, b): (RealTermId, RealTermId),
        known: &mut HashMap<RealTermId, RealTermId>,
    ) -> RealTermId {
        let (a, b) = (self.unrounded(a, known), self.unrounded(b, known));
        self.insert(make(a, b), "unrounded")
    }

    /// Returns the lines of a script that define the `needed` terms, in order. For example, a sum and its rounding to 4
    /// fraction bits are `sum_2 = 0.5 + x;` and `cut_3 = fixed<-4,dn>(sum_2);`.
    pub fn definitions(&self, needed: &[bool]) -> String {
        let mut text = String::new();
        for (id, (term, name)) in self.terms.iter().enumerate() {
            let of = |id: &RealTermId| self.name(*id);
            let right = match term {
                _ if !needed[id] => continue,
                RealTerm::Variable(_) | RealTerm::Number(_) => continue,
                RealTerm::Add(a, b) => format!("{} + {}", of(a), of(b)),
                RealTerm::Sub(a, b) => format!("{} - {}", of(a), of(b)),
                RealTerm::Mul(a, b) => format!("{} * {}", of(a), of(b)),
                RealTerm::Div(a, b) => format!("{} / {}", of(a), of(b)),
                RealTerm::Round { of: a, fraction, direction } => {
                    let direction = match direction {
                        RoundingDirection::Down => "dn",
                        RoundingDirection::Nearest => "na",
                    };
                    format!("fixed<{},{direction}>({})", -fraction, of(a))
                }
            };
            let _ = writeln!(text, "{name} = {right};");
        }
        text
    }

    fn operands(&self, id: RealTermId) -> Vec<RealTermId> {
        match self.get(id) {
            RealTerm::Variable(_) | RealTerm::Number(_) => Vec::new(),
            RealTerm::Add(a, b)
            | RealTerm::Sub(a, b)
            | RealTerm::Mul(a, b)
            | RealTerm::Div(a, b) => vec![*a, *b],
            RealTerm::Round { of, .. } => vec![*of],
        }
    }
}

/// Writes `value` with all digits and no exponent. For example, 2⁻²⁰ is `0.00000095367431640625`.
pub fn number(value: f64) -> String {
    let text = format!("{value:.1100}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "" | "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_whole() {
        assert_eq!([0.5, -3.0, 0.0, 1e3].map(number), ["0.5", "-3", "0", "1000"]);
        assert_eq!(number(libm::exp2(-20.0)), "0.00000095367431640625");
    }

    #[test]
    fn only_what_is_needed_is_defined() {
        let mut terms = RealTerms::default();
        let x = terms.insert(RealTerm::Variable("x".to_owned()), "x");
        let half = terms.number(0.5);
        let sum = terms.insert(RealTerm::Add(x, half), "sum");
        let cut = terms.insert(
            RealTerm::Round { of: sum, fraction: 4, direction: RoundingDirection::Down },
            "cut",
        );
        let _unneeded = terms.insert(RealTerm::Mul(x, x), "square");
        assert_eq!(terms.insert(RealTerm::Add(x, half), "again"), sum);
        assert_eq!(
            terms.definitions(&terms.needed(&[cut])),
            "sum_2 = 0.5 + x;\ncut_3 = fixed<-4,dn>(sum_2);\n"
        );
        let values = terms.evaluate(&HashMap::from([("x".to_owned(), 0.3)]));
        assert_eq!((values[cut], values[sum]), (0.75, 0.8));
        assert!(terms.is_exact(sum) && !terms.is_exact(cut));
    }
}

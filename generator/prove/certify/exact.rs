//! Translates a contract's formula to real expressions for the prover Gappa.
//!
//! A formula with `max`, `min` or `if` becomes several branches, each with conditions under which it applies. For example,
//! `max(a, b)` has two branches: `a` where a − b ≥ 0, and `b` where a − b ≤ 0. The module fails for any other function, such as
//! `sqrt`, for a constant such as `pi`, and for the operator `%`. It also fails for a number that no `f64` represents, such as
//! 0.1, and for a varying exponent.

use std::collections::{BTreeMap, HashMap};

use super::terms::{RealTerm, RealTermId, RealTerms};
use glint_base::fixed::exp2;
use glint_formula::{Comparison, Expression, Function, Kind, Literal, Operator};
use glint_golden::Operand;

/// The largest exponent of a power that can be translated.
const MOST_EXPONENT: f64 = 1000.0;

/// One branch of a formula: a term, and the conditions under which this term is the formula's value.
#[derive(Clone, Debug, Default)]
pub struct Branch {
    /// Terms that must be at least 0 for the branch to apply.
    pub at_least: Vec<RealTermId>,
    /// Terms that must be at most 0 for the branch to apply.
    pub at_most: Vec<RealTermId>,
    pub term: RealTermId,
    /// Whether each condition that the branch has decided holds. The key is the term that is compared with 0, and the kind of
    /// comparison.
    chosen: BTreeMap<(RealTermId, Choice), bool>,
}

/// The kind of a comparison of a term with 0. A branch decides the same kind for the same term only once, so two uses of `max(a,
/// b)` in a formula take the same side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Choice {
    Larger,
    Positive,
    NotNegative,
}

impl Branch {
    /// Returns whether a constant violates a condition of the branch, so the branch never applies.
    pub fn is_never(&self, terms: &RealTerms) -> bool {
        for &id in &self.at_least {
            if matches!(terms.get(id), RealTerm::Number(value) if *value < 0.0) {
                return true;
            }
        }
        for &id in &self.at_most {
            if matches!(terms.get(id), RealTerm::Number(value) if *value > 0.0) {
                return true;
            }
        }
        false
    }

    /// Returns a branch with the conditions of `self` and `other` and the term of `other`. Returns `None` if the two branches
    /// decide a condition differently.
    pub fn and(&self, other: &Self) -> Option<Self> {
        let mut both = self.clone();
        both.term = other.term;
        for (&choice, &taken) in &other.chosen {
            if *both.chosen.entry(choice).or_insert(taken) != taken {
                return None;
            }
        }
        for &id in &other.at_least {
            if !self.at_least.contains(&id) {
                both.at_least.push(id);
            }
        }
        for &id in &other.at_most {
            if !self.at_most.contains(&id) {
                both.at_most.push(id);
            }
        }
        Some(both)
    }

    /// Adds the condition that `difference` is at least 0 (if `taken`) or at most 0. Returns `None` if the branch has already
    /// decided this condition differently.
    fn choosing(&self, difference: RealTermId, choice: Choice, taken: bool) -> Option<Self> {
        let mut condition = Self { term: self.term, ..Self::default() };
        condition.chosen.insert((difference, choice), taken);
        if taken {
            condition.at_least.push(difference);
        } else {
            condition.at_most.push(difference);
        }
        self.and(&condition)
    }
}

/// The names and values of a case that the translation of a formula needs.
pub struct FormulaContext<'a> {
    /// For each operand, the name of its variable in the script, and the power of two by which the operand is divided. For
    /// example, the variable `exponent_over_8` has the power 3.
    pub variables: &'a HashMap<String, (String, i32)>,
    /// The smallest and the largest value of each operand in this case.
    pub ranges: &'a HashMap<String, (f64, f64)>,
    /// For each ROM, by its name, the values of its words.
    pub words: &'a HashMap<String, Vec<f64>>,
    pub operands: &'a [Operand],
}

/// Names the variable for a word of the ROM `rom`. `variable` addresses the ROM. For example, the ROM `coefficient` at
/// `exponent` has the variable `coefficient_at_exponent`.
pub fn word_variable(rom: &str, variable: &str) -> String {
    format!("{rom}_at_{variable}")
}

/// Stores in `found`, for each operand, the power of two by which `formula` divides the operand. The power is 0 if it is not the
/// same everywhere. For example, `exponent` has 0 in `exponent / 8 + exponent`.
pub fn divisors(formula: &Expression, found: &mut HashMap<String, Option<i32>>) {
    if let Some((name, power)) = quotient(formula) {
        return note_divisor(name, power, found);
    }
    match &formula.kind {
        Kind::Operand(name) => note_divisor(name, 0, found),
        // The address of a table word is not part of the arithmetic.
        Kind::Word(..) => {}
        _ => {
            for part in formula.parts() {
                divisors(part, found);
            }
        }
    }
}

/// Stores `power` for the operand `name`, or 0 if a different power is already stored.
fn note_divisor(name: &str, power: i32, found: &mut HashMap<String, Option<i32>>) {
    let noted = found.entry(name.to_owned()).or_insert(Some(power));
    if *noted != Some(power) {
        *noted = Some(0);
    }
}

/// Returns the operand and the power if `formula` is an operand divided by a power of two from 2⁰ to 2³⁰. For example, `exponent
/// / 8` gives `exponent` and 3.
fn quotient(formula: &Expression) -> Option<(&str, i32)> {
    let Kind::Binary(Operator::Div, a, b) = &formula.kind else { return None };
    let (Kind::Operand(name), Kind::Number(by)) = (&a.kind, &b.kind) else { return None };
    Some((name, power_of_two(by.nearest())?))
}

fn power_of_two(value: f64) -> Option<i32> {
    (0..=30).find(|&power| exp2(power) == value)
}

pub fn untranslated(function: Function) -> String {
    format!("the function `{}` cannot be written for Gappa", function.name())
}

/// Translates `formula` to branches. A formula without conditions has one branch.
///
/// # Errors
///
/// Fails if the formula has a part without a translation, an unknown operand or table, or an exponent that varies in this case.
/// A number that no `f64` represents, such as 0.1, has no translation. A power needs a natural exponent, or the base 2.
pub fn branches(
    formula: &Expression,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<Vec<Branch>, String> {
    if let Some((name, power @ 1..)) = quotient(formula)
        && let Some((variable, divisor)) = setting.variables.get(name)
        && *divisor == power
    {
        return Ok(unconditional(variable_of(name, variable, power, setting, terms)));
    }
    match &formula.kind {
        Kind::Number(literal) if literal.is_exact() => {
            Ok(unconditional(terms.number(literal.nearest())))
        }
        Kind::Number(literal) => Err(format!(
            "the number `{}` is not a binary fraction and cannot be written for Gappa",
            literal.digits()
        )),
        Kind::Operand(name) => Ok(unconditional(operand(name, setting, terms)?)),
        Kind::Word(rom, place) => Ok(unconditional(word(rom, place, setting, terms)?)),
        Kind::Constant(name, _) => {
            Err(format!("the constant `{name}` cannot be written for Gappa"))
        }
        Kind::Unary(Function::Negate, a) => {
            let zero = Expression::new(Kind::Number(Literal::zero()), formula.span.clone());
            operation([&zero, a], RealTerm::Sub, setting, terms)
        }
        Kind::Unary(function, _) => Err(untranslated(*function)),
        Kind::Binary(Operator::Add, a, b) => operation([a, b], RealTerm::Add, setting, terms),
        Kind::Binary(Operator::Sub, a, b) => operation([a, b], RealTerm::Sub, setting, terms),
        Kind::Binary(Operator::Mul, a, b) => operation([a, b], RealTerm::Mul, setting, terms),
        Kind::Binary(Operator::Div, a, b) => operation([a, b], RealTerm::Div, setting, terms),
        Kind::Binary(Operator::Power, base, exponent) => {
            let exponent = constant(exponent, setting)
                .ok_or("a power with a varying exponent cannot be written for Gappa")?;
            if let Some(power) = scaling(constant(base, setting), exponent) {
                return Ok(unconditional(terms.number(power)));
            }
            let is_natural = exponent.fract() == 0.0 && (0.0..=MOST_EXPONENT).contains(&exponent);
            if !is_natural {
                return Err(format!(
                    "a power with the exponent {exponent} cannot be written for Gappa"
                ));
            }
            let mut found = branches(base, setting, terms)?;
            for branch in &mut found {
                branch.term = power(terms, branch.term, exponent as u32);
            }
            Ok(found)
        }
        Kind::Binary(Operator::Mod, ..) => {
            Err("the operator `%` cannot be written for Gappa".to_owned())
        }
        Kind::Binary(Operator::Atan2, ..) => {
            Err("the function `atan2` cannot be written for Gappa".to_owned())
        }
        Kind::Binary(operator @ (Operator::Max | Operator::Min), a, b) => {
            let mut found = Vec::new();
            for (branch, left, right) in pairs([a, b], setting, terms)? {
                let difference = folded(terms, RealTerm::Sub(left, right));
                let is_max = *operator == Operator::Max;
                for (taken, term) in [(is_max, left), (!is_max, right)] {
                    let side = Branch { term, ..branch.clone() };
                    found.extend(side.choosing(difference, Choice::Larger, taken));
                }
            }
            Ok(found)
        }
        Kind::If(comparison, yes, no) => {
            let decided = decided(comparison, setting);
            let mut found = Vec::new();
            for (taken, side) in [(true, yes), (false, no)] {
                if decided == Some(!taken) {
                    continue;
                }
                let sides = branches(side, setting, terms)?;
                if decided.is_some() {
                    found.extend(sides);
                    continue;
                }
                for condition in conditions(comparison, taken, setting, terms)? {
                    found.extend(sides.iter().filter_map(|side| condition.and(side)));
                }
            }
            Ok(found)
        }
    }
}

fn unconditional(term: RealTermId) -> Vec<Branch> {
    vec![Branch { term, ..Branch::default() }]
}

/// Combines each branch of `a` with each branch of `b`, unless they decide a condition differently. A combination has the
/// conditions of both branches, the term of `a` and the term of `b`.
fn pairs(
    [a, b]: [&Expression; 2],
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<Vec<(Branch, RealTermId, RealTermId)>, String> {
    let (first, second) = (branches(a, setting, terms)?, branches(b, setting, terms)?);
    let mut pairs = Vec::new();
    for one in &first {
        for other in &second {
            if let Some(both) = one.and(other) {
                pairs.push((both, one.term, other.term));
            }
        }
    }
    Ok(pairs)
}

/// Returns the branches of an operation with two operands. `make` makes the operation's term.
fn operation(
    operands: [&Expression; 2],
    make: fn(RealTermId, RealTermId) -> RealTerm,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<Vec<Branch>, String> {
    let mut found = Vec::new();
    for (branch, left, right) in pairs(operands, setting, terms)? {
        let term = folded(terms, make(left, right));
        found.push(Branch { term, ..branch });
    }
    Ok(found)
}

/// Returns the branches in which the comparison is true (if `taken`) or false.
fn conditions(
    comparison: &Comparison,
    taken: bool,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<Vec<Branch>, String> {
    let choice = if comparison.or_equal { Choice::NotNegative } else { Choice::Positive };
    let mut conditions = Vec::new();
    for (branch, left, right) in pairs([&comparison.left, &comparison.right], setting, terms)? {
        let difference = folded(terms, RealTerm::Sub(left, right));
        conditions.extend(branch.choosing(difference, choice, taken));
    }
    Ok(conditions)
}

/// Returns the word of the table `rom` at the address `place`. The word is a number if it is the same at all addresses of this
/// case, and otherwise a variable.
///
/// # Errors
///
/// Fails if the address is neither a number nor an operand without fraction bits, or if the table has no such word.
fn word(
    rom: &str,
    place: &Expression,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<RealTermId, String> {
    let words = setting.words.get(rom).ok_or_else(|| format!("there is no table `{rom}`"))?;
    let (name, range) = match &place.kind {
        Kind::Operand(name) => (name.as_str(), setting.ranges.get(name).copied()),
        Kind::Number(literal) => ("", Some((literal.nearest(), literal.nearest()))),
        _ => return Err(format!("the formula reads `{rom}` at a computed address")),
    };
    let (low, high) = range.ok_or_else(|| format!("there is no operand `{name}`"))?;
    if setting.operands.iter().any(|operand| operand.name == name && operand.format.frac != 0) {
        return Err(format!(
            "the formula reads `{rom}` at an operand with fraction bits, `{name}`"
        ));
    }
    let Some(read) = words.get(low as usize..=high as usize) else {
        return Err(format!("there is no word {high} in `{rom}`"));
    };
    if read.iter().all(|word| *word == read[0]) {
        return Ok(terms.number(read[0]));
    }
    let operand = match setting.variables.get(name) {
        Some((variable, _)) => variable.as_str(),
        None => "",
    };
    let variable = word_variable(rom, operand);
    Ok(terms.insert(RealTerm::Variable(variable.clone()), &variable))
}

fn operand(
    name: &str,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> Result<RealTermId, String> {
    let Some((variable, divisor)) = setting.variables.get(name) else {
        return Err(format!("there is no operand `{name}`"));
    };
    let divided = variable_of(name, variable, *divisor, setting, terms);
    if *divisor == 0 {
        return Ok(divided);
    }
    let factor = terms.number(exp2(*divisor));
    Ok(folded(terms, RealTerm::Mul(divided, factor)))
}

fn variable_of(
    name: &str,
    variable: &str,
    divisor: i32,
    setting: &FormulaContext,
    terms: &mut RealTerms,
) -> RealTermId {
    match setting.ranges.get(name) {
        Some((low, high)) if low == high => terms.number(low * exp2(-divisor)),
        _ => terms.insert(RealTerm::Variable(variable.to_owned()), variable),
    }
}

/// Returns the power if `base` is 2 and `exponent` is an integer from −1000 to 1000: an `f64` represents such a power exactly.
/// Returns `None` for any other power.
fn scaling(base: Option<f64>, exponent: f64) -> Option<f64> {
    let is_power_of_two =
        base == Some(2.0) && exponent.fract() == 0.0 && exponent.abs() <= MOST_EXPONENT;
    is_power_of_two.then(|| exp2(exponent as i32))
}

/// Returns the value of a number, or of an operand that has a single value in this case; either may have a minus in front.
fn constant(formula: &Expression, setting: &FormulaContext) -> Option<f64> {
    let (low, high) = known_range(formula, setting)?;
    if low == high { Some(low) } else { None }
}

/// Returns the smallest and the largest value of a number or an operand in this case; either may have a minus in front. A number
/// that no `f64` represents, such as 0.1, gives `None`.
fn known_range(formula: &Expression, setting: &FormulaContext) -> Option<(f64, f64)> {
    match &formula.kind {
        Kind::Number(literal) if literal.is_exact() => Some((literal.nearest(), literal.nearest())),
        Kind::Operand(name) => setting.ranges.get(name).copied(),
        Kind::Unary(Function::Negate, a) => {
            let (low, high) = known_range(a, setting)?;
            Some((-high, -low))
        }
        _ => None,
    }
}

/// Returns whether a comparison of numbers and operands is true or false for all values of this case. Returns `None` if it is
/// undecided. For example, `x < 4` is true if x is from 0 to 3, and undecided if x is from 0 to 5.
fn decided(comparison: &Comparison, setting: &FormulaContext) -> Option<bool> {
    let left = known_range(&comparison.left, setting)?;
    let right = known_range(&comparison.right, setting)?;
    if left.0 > right.1 || comparison.or_equal && left.0 >= right.1 {
        return Some(true);
    }
    if left.1 < right.0 || !comparison.or_equal && left.1 <= right.0 {
        return Some(false);
    }
    None
}

/// Multiplies by repeated squaring, as the hardware computes the power. For example, x⁵ is x times (x²)².
fn power(terms: &mut RealTerms, base: RealTermId, exponent: u32) -> RealTermId {
    let mut result = None;
    let (mut square, mut rest) = (base, exponent);
    while rest > 0 {
        if rest % 2 == 1 {
            result = Some(match result {
                None => square,
                Some(result) => folded(terms, RealTerm::Mul(result, square)),
            });
        }
        rest /= 2;
        if rest > 0 {
            square = folded(terms, RealTerm::Mul(square, square));
        }
    }
    result.unwrap_or_else(|| terms.number(1.0))
}

/// Adds a term in simplified form: `x + 0` becomes `x`, and an operation on constants becomes its value if an f64 can
/// represent it exactly.
pub fn folded(terms: &mut RealTerms, term: RealTerm) -> RealTermId {
    match term {
        RealTerm::Add(a, b) | RealTerm::Sub(a, b) if is_number(terms, b, 0.0) => return a,
        RealTerm::Add(a, b) if is_number(terms, a, 0.0) => return b,
        RealTerm::Mul(a, b) if is_number(terms, a, 0.0) || is_number(terms, b, 0.0) => {
            return terms.number(0.0);
        }
        RealTerm::Mul(a, b) if is_number(terms, a, 1.0) => return b,
        RealTerm::Mul(a, b) | RealTerm::Div(a, b) if is_number(terms, b, 1.0) => return a,
        _ => {}
    }
    match exact_value(terms, &term) {
        Some(value) => terms.number(value),
        None => terms.insert(term, "exact"),
    }
}

fn number_of(terms: &RealTerms, id: RealTermId) -> Option<f64> {
    match terms.get(id) {
        RealTerm::Number(value) => Some(*value),
        _ => None,
    }
}

fn is_number(terms: &RealTerms, id: RealTermId, value: f64) -> bool {
    number_of(terms, id) == Some(value)
}

/// Returns the value of an operation on numbers, if an f64 can represent it exactly.
fn exact_value(terms: &RealTerms, term: &RealTerm) -> Option<f64> {
    let (RealTerm::Add(a, b) | RealTerm::Sub(a, b) | RealTerm::Mul(a, b) | RealTerm::Div(a, b)) =
        *term
    else {
        return None;
    };
    let (a, b) = (number_of(terms, a)?, number_of(terms, b)?);
    let (value, is_exact) = match term {
        RealTerm::Add(..) => (a + b, is_exact_sum(a, b)),
        RealTerm::Sub(..) => (a - b, is_exact_sum(a, -b)),
        RealTerm::Mul(..) => (a * b, a.mul_add(b, -(a * b)) == 0.0),
        _ => (a / b, (a / b).mul_add(b, -a) == 0.0),
    };
    if is_exact { Some(value) } else { None }
}

fn is_exact_sum(a: f64, b: f64) -> bool {
    let sum = a + b;
    sum - a == b && sum - b == a
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_formula::parse;

    /// Returns the error message for a formula of the operand `x`, or `None` if the formula has a translation.
    fn error(text: &str) -> Option<String> {
        let variables = HashMap::from([("x".to_owned(), ("x".to_owned(), 0))]);
        let ranges = HashMap::from([("x".to_owned(), (0.0, 1.0))]);
        let words = HashMap::new();
        let setting =
            FormulaContext { variables: &variables, ranges: &ranges, words: &words, operands: &[] };
        let formula = parse(text).expect("a formula");
        branches(&formula, &setting, &mut RealTerms::default()).err()
    }

    /// A translation must have the formula's value, because Gappa proves the translation's bound.
    #[test]
    fn only_exact_numbers_and_natural_powers_are_translated() {
        for text in ["x ** 3", "x ** 0", "0.5 * x", "2 ** -14 * x", "3 ** 2 * x", "1e0 - x"] {
            assert_eq!(error(text), None, "{text}");
        }
        for (text, part) in [
            ("x ** 0.5", "the exponent 0.5"),
            ("x ** 1001", "the exponent 1001"),
            ("3 ** -1 * x", "the exponent -1"),
            ("2 ** 0.5 * x", "the exponent 0.5"),
            ("0.1 * x", "the number `0.1`"),
        ] {
            let message = error(text);
            assert!(message.as_deref().is_some_and(|it| it.contains(part)), "{text}: {message:?}");
        }
    }
}

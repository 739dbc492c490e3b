//! Finds limits that interval arithmetic misses, because it treats two occurrences of the same part of a formula as independent.
//!
//! A number minus a maximum that includes it is never above 0: with m = `max(v0, v1)`, `v0 - m` ≤ 0. One of `v0 - m` and
//! `v1 - m` is 0, so `exp(v0 - m) + exp(v1 - m)` ≥ 1. A mixture `x + (y - x) * t` of x, y ≥ 0 with t from 0 to 1 is not below
//! the smaller of x and y.

use std::sync::Arc;

use glint_formula::{Enclosure, Expression, Kind, Operator};

/// The most numbers of a maximum or a minimum, and the most terms of a sum.
const MOST_NUMBERS: usize = 32;

/// The most parts of a sum that is examined.
const MOST_PARTS: u32 = 4000;

/// The name of the operand that replaces a difference in a term. A user's operand has no blank in its name.
const DIFFERENCE: &str = "the difference";

/// Returns limits of the values of `part` that hold for all operands. `operands` has limits of the operands. The limits are infinite
/// if nothing is known.
pub(super) fn limits(part: &Expression, operands: &[(&str, Enclosure)]) -> Enclosure {
    let mut limits = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);
    if part.has(&|kind| matches!(kind, Kind::If(..))) {
        // Rounding can make two nodes of the same choice take different cases.
        return limits;
    }
    match &part.kind {
        Kind::Binary(Operator::Sub, a, b) => {
            if is_at_least(b, a) {
                limits.high = 0.0;
            }
            if is_at_least(a, b) {
                limits.low = 0.0;
            }
        }
        Kind::Binary(Operator::Add, ..) => {
            let least = least_sum(part, operands).or_else(|| least_of_mixture(part, operands));
            if let Some(least) = least {
                limits.low = least;
            }
        }
        _ => {}
    }
    limits
}

pub(super) fn has_limits(part: &Expression, operands: &[(&str, Enclosure)]) -> bool {
    let limits = limits(part, operands);
    limits.low.is_finite() || limits.high.is_finite()
}

/// Returns the formula `rewritten`, which equals `part`, with a minimum or a maximum that keeps its enclosure within the limits
/// of `part`. The operands in `part` must be the operands of the statement. Returns `None` without limits.
pub(super) fn clamped(
    part: &Expression,
    rewritten: &Arc<Expression>,
    operands: &[(&str, Enclosure)],
) -> Option<Arc<Expression>> {
    let limits = limits(part, operands);
    let with = |operator, limit: f64| {
        // The decimal number may be above the binary one by less than half a unit.
        let limit = if limit.fract() == 0.0 { limit } else { limit.next_down() };
        let limit = glint_formula::parse(&format!("{limit:e}")).ok()?;
        let kind = Kind::Binary(operator, rewritten.clone(), Arc::new(limit));
        Some(Arc::new(Expression::new(kind, part.span.clone())))
    };
    match (limits.low.is_finite(), limits.high.is_finite()) {
        (true, _) => with(Operator::Max, limits.low),
        (_, true) => with(Operator::Min, limits.high),
        _ => None,
    }
}

/// Returns whether `a` is not below `b` for any operands: a maximum and one of its numbers, a number and a minimum with it, or a maximum
/// and a minimum with a common number.
fn is_at_least(a: &Expression, b: &Expression) -> bool {
    let least = leaves_of(b, Operator::Min);
    leaves_of(a, Operator::Max).iter().any(|number| least.contains(number))
}

/// Returns whether `part` is a maximum (or a minimum) of several numbers that include `number`.
fn has_number(part: &Expression, operator: Operator, number: &Expression) -> bool {
    numbers_of(part, operator).is_some_and(|numbers| numbers.contains(&number))
}

/// Returns the numbers of a maximum (or a minimum): `max(max(x, y), z)` gives x, y and z. Returns `None` for another formula.
fn numbers_of(part: &Expression, operator: Operator) -> Option<Vec<&Expression>> {
    let leaves = leaves_of(part, operator);
    (2..=MOST_NUMBERS).contains(&leaves.len()).then_some(leaves)
}

/// Returns the formulas that a chain of one operator joins: `a + (b + c)` gives a, b and c. Another formula gives itself.
fn leaves_of(part: &Expression, operator: Operator) -> Vec<&Expression> {
    match &part.kind {
        Kind::Binary(own, a, b) if *own == operator => {
            let mut leaves = leaves_of(a, operator);
            if leaves.len() <= MOST_NUMBERS {
                leaves.extend(leaves_of(b, operator));
            }
            leaves
        }
        _ => vec![part],
    }
}

/// Returns a lower limit of a sum whose terms are not below 0. Each term must be a function of the difference between another number
/// and the same maximum. Each number of the maximum must have a term, so that one of the differences is 0. Returns `None` for
/// another sum.
fn least_sum(sum: &Expression, operands: &[(&str, Enclosure)]) -> Option<f64> {
    if sum.size() > MOST_PARTS {
        return None;
    }
    let terms = leaves_of(sum, Operator::Add);
    if terms.len() > MOST_NUMBERS {
        return None;
    }
    let first = difference_in(terms[0])?;
    let Kind::Binary(Operator::Sub, _, largest) = &first.kind else { return None };
    let mut numbers = numbers_of(largest, Operator::Max)?;
    let mut least = f64::INFINITY;
    for term in &terms {
        let difference = difference_in(term)?;
        let Kind::Binary(Operator::Sub, number, own_largest) = &difference.kind else {
            return None;
        };
        if own_largest != largest {
            return None;
        }
        numbers.retain(|it| **it != **number);
        let of_difference =
            term.substitute(difference, &Expression::operand(DIFFERENCE), &term.span);
        let value_for = |difference: Enclosure| {
            let mut values = operands.to_vec();
            values.push((DIFFERENCE, difference));
            of_difference.enclose(&values).ok()
        };
        let smallest = difference.enclose(operands).ok()?.low.min(0.0);
        if value_for(Enclosure::between(smallest, 0.0))?.low < 0.0 {
            return None;
        }
        least = least.min(value_for(Enclosure::exactly(0.0))?.low);
    }
    (numbers.is_empty() && least.is_finite()).then_some(least)
}

/// Returns whether a formula is a mixture `x + (y - x) * t`.
pub(super) fn is_mixture(kind: &Kind) -> bool {
    mixture_of(kind).is_some()
}

/// Returns x, y and t of a mixture `x + (y - x) * t`. Returns `None` for another formula.
fn mixture_of(kind: &Kind) -> Option<[&Expression; 3]> {
    let Kind::Binary(Operator::Add, first, product) = kind else { return None };
    let Kind::Binary(Operator::Mul, difference, share) = &product.kind else { return None };
    let Kind::Binary(Operator::Sub, second, subtracted) = &difference.kind else { return None };
    (subtracted == first).then_some([first, second, share])
}

/// Returns a lower limit of a mixture `x + (y - x) * t`, with x and y not below 0 and t from 0 to 1. Returns `None` for another sum.
fn least_of_mixture(sum: &Expression, operands: &[(&str, Enclosure)]) -> Option<f64> {
    let [first, second, share] = mixture_of(&sum.kind)?;
    let share = share.enclose(operands).ok()?;
    let ends = first.enclose(operands).ok()?.hull(second.enclose(operands).ok()?);
    (ends.low >= 0.0 && share.low >= 0.0 && share.high <= 1.0).then_some(ends.low)
}

/// Returns the first part of a term that is the difference of a number and a maximum with this number.
fn difference_in(term: &Expression) -> Option<&Expression> {
    if let Kind::Binary(Operator::Sub, number, largest) = &term.kind
        && has_number(largest, Operator::Max, number)
    {
        return Some(term);
    }
    term.parts().into_iter().find_map(|part| difference_in(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPERANDS: [(&str, Enclosure); 4] = [
        ("difference", Enclosure::between(-4.0, 4.0)),
        ("a", Enclosure::between(-4.0, 4.0)),
        ("b", Enclosure::between(-4.0, 4.0)),
        ("c", Enclosure::between(-4.0, 4.0)),
    ];

    fn limits_of(formula: &str) -> Enclosure {
        limits(&glint_formula::parse(formula).expect("a formula"), &OPERANDS)
    }

    #[test]
    fn a_difference_from_a_maximum_is_not_above_0() {
        assert_eq!(limits_of("b - max(a, b, c)").high, 0.0);
        assert_eq!(limits_of("max(a, max(b, c)) - c").low, 0.0);
        assert_eq!(limits_of("b - min(a, b)").low, 0.0);
        assert_eq!(limits_of("min(a, b) - a").high, 0.0);
        assert_eq!(limits_of("c - max(a, b)").high, f64::INFINITY);
        assert_eq!(limits_of("max(a, b, c) - min(c, b)").low, 0.0);
        assert_eq!(limits_of("min(a, b) - max(b, c)").high, 0.0);
        assert_eq!(limits_of("max(a, b) - min(c, 2)").low, f64::NEG_INFINITY);
    }

    #[test]
    fn a_mixture_lies_between_its_ends() {
        let share = "(a + 4) / 8";
        assert_eq!(limits_of(&format!("b^2 + (c^2 - b^2) * ({share})")).low, 0.0);
        assert_eq!(limits_of(&format!("(b^2 + 2) + (3 - (b^2 + 2)) * ({share})")).low, 2.0);
        // An end below 0, a share above 1, and another number in the difference state nothing.
        let nothing = f64::NEG_INFINITY;
        assert_eq!(limits_of(&format!("b + (c^2 - b) * ({share})")).low, nothing);
        assert_eq!(limits_of("b^2 + (c^2 - b^2) * ((a + 5) / 8)").low, nothing);
        assert_eq!(limits_of(&format!("b^2 + (c^2 - a^2) * ({share})")).low, nothing);
    }

    /// Returns whether a lower limit is `exact`, or just below it.
    fn is_near(limit: f64, exact: f64) -> bool {
        (exact - 1e-12..=exact).contains(&limit)
    }

    #[test]
    fn a_sum_over_all_numbers_of_a_maximum_has_the_term_of_the_largest() {
        let all = "exp(a - max(a, b, c)) + (exp(b - max(a, b, c)) + exp(c - max(a, b, c)))";
        assert!(is_near(limits_of(all).low, 1.0));
        let scaled = "3 * exp((a - max(a, b)) * (c + 5)) + 2 * exp((b - max(a, b)) * (c + 5))";
        assert!(is_near(limits_of(scaled).low, 2.0));
        // A number without a term, and terms that can be below 0, state nothing.
        let nothing = f64::NEG_INFINITY;
        assert_eq!(limits_of("exp(a - max(a, b, c)) + exp(b - max(a, b, c))").low, nothing);
        assert_eq!(limits_of("(1 + (a - max(a, b))) + exp(b - max(a, b))").low, nothing);
        assert_eq!(limits_of("exp(a - max(a, b)) + exp(b - max(b, c))").low, nothing);
        let own = "difference * exp(a - max(a, b)) + difference * exp(b - max(a, b))";
        assert_eq!(limits_of(own).low, nothing);
        // The terms are below 0 for a difference below −7, which these operands have.
        assert_eq!(limits_of("(7 + (a - max(a, b))) + (7 + (b - max(a, b)))").low, nothing);
    }
}

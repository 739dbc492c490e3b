//! Encloses the values of a formula under the conditions of its use. For example, where `hi > lo` holds, `hi - lo` has a lower
//! limit above 0 ([`super::facts`]), and so `1 / (hi - lo)` has an upper limit. In `if(x > 1, 1 / x, 0)` the comparison limits
//! the `x` of the first case.

use std::collections::HashMap;
use std::ptr;
use std::sync::Arc;

use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator};

use super::facts::{Fact, LimitedPart, facts_of, limited, with_signs};
use super::order;
use super::polynomial::ANYTHING;
use super::projection;
use super::statement::ExpressionStatement;
use super::uses::PartUses;

/// The most cases of choices in a formula whose conditions are read as facts.
const MOST_CASES: usize = 64;

/// A part of a formula about which facts hold, and the name of the operand that replaces it.
#[derive(Clone, Debug)]
struct GuardedPart {
    name: String,
    part: Expression,
    facts: Vec<LimitedPart>,
    /// Whether the facts hold wherever the formula matters, and not only in a case of a choice.
    is_always: bool,
}

impl GuardedPart {
    /// Returns an interval that contains the values of the part, wherever its facts hold. Returns `None` if the formula matters for
    /// none of the operands within the limits.
    fn values(&self, operands: &[(&str, Enclosure)]) -> Option<Enclosure> {
        let values = self.part.enclose(operands).unwrap_or(ANYTHING);
        let mut stated = ANYTHING;
        for fact in &self.facts {
            let limits = fact.limits(operands);
            stated.low = stated.low.max(limits.low);
            stated.high = stated.high.min(limits.high);
        }
        let (low, high) = (values.low.max(stated.low), values.high.min(stated.high));
        match (low <= high, self.is_always) {
            (true, _) => Some(Enclosure::between(low, high)),
            (false, true) => None,
            // The case with the part is taken for none of these operands, so that any value will do. A stated limit is a value with
            // which the case has a value of its own: no divisor is 0.
            (false, false) => {
                let limit = if stated.low.is_finite() { stated.low } else { stated.high };
                Some(Enclosure::exactly(limit))
            }
        }
    }
}

/// A formula whose value matters only under some conditions. An operand replaces each part about which they state a fact, so that
/// the evaluation uses the limits of the part.
#[derive(Clone, Debug)]
pub struct GuardedFormula {
    formula: Arc<Expression>,
    parts: Vec<GuardedPart>,
}

impl GuardedFormula {
    /// Finds the parts of a formula about which the conditions of its uses, or choices within the formula, state a fact.
    pub(super) fn new(
        statement: &ExpressionStatement,
        uses: &PartUses,
        formula: &Expression,
    ) -> Self {
        let facts = facts_of(statement, uses);
        let is_guarded = |kind: &Kind| {
            let is_extreme =
                matches!(kind, Kind::Binary(Operator::Max | Operator::Min, a, _) if a.varies());
            is_extreme
                || matches!(kind, Kind::If(..))
                || order::is_mixture(kind)
                || projection::is_projection(kind)
        };
        let is_plain = facts.is_empty() && !formula.has(&is_guarded);
        if is_plain {
            return Self { formula: Arc::new(formula.clone()), parts: Vec::new() };
        }
        let domain = statement.domain();
        let operands = statement.enclosed_operands(&domain);
        let mut rewriting = GuardRewriting { statement, operands, parts: Vec::new(), cases: 0 };
        let formula = rewriting.rewritten(formula, &facts, false, &mut HashMap::new());
        Self { formula, parts: rewriting.parts }
    }

    /// Returns an interval that contains the values of the formula for operands within limits, under the conditions. Returns `None`
    /// if the conditions hold for none of these operands.
    pub(super) fn values(&self, operands: &[(&str, Enclosure)]) -> Option<Enclosure> {
        let mut all = operands.to_vec();
        for part in &self.parts {
            let values = part.values(&all)?;
            all.push((&part.name, values));
        }
        Some(self.formula.enclose(&all).unwrap_or(ANYTHING))
    }
}

/// The parts of a formula that were rewritten under the same facts, by their addresses.
type RewrittenParts = HashMap<*const Expression, Arc<Expression>>;

/// The rewriting of a formula, in which operands replace the parts with facts.
struct GuardRewriting<'s> {
    statement: &'s ExpressionStatement,
    /// The operands with the limits of their domains.
    operands: Vec<(&'s str, Enclosure)>,
    parts: Vec<GuardedPart>,
    /// The number of cases of choices so far.
    cases: usize,
}

impl GuardRewriting<'_> {
    /// Returns a part in which operands replace the parts with facts. `is_case` says whether the facts hold only in a case of a
    /// choice. `known` has the parts that were rewritten under the same facts.
    fn rewritten(
        &mut self,
        part: &Expression,
        facts: &[Fact],
        is_case: bool,
        known: &mut RewrittenParts,
    ) -> Arc<Expression> {
        if let Some(known) = known.get(&ptr::from_ref(part)) {
            return known.clone();
        }
        let rewritten = self.newly_rewritten(part, facts, is_case, known);
        known.insert(ptr::from_ref(part), rewritten.clone());
        rewritten
    }

    fn newly_rewritten(
        &mut self,
        part: &Expression,
        facts: &[Fact],
        is_case: bool,
        known: &mut RewrittenParts,
    ) -> Arc<Expression> {
        let limits = limited(self.statement, facts, part);
        if !limits.is_empty() {
            // Facts about the numbers of a minimum or a maximum limit it, too.
            let part = match &part.kind {
                Kind::Binary(operator @ (Operator::Min | Operator::Max), a, b) => {
                    let a = self.rewritten(a, facts, is_case, known);
                    let b = self.rewritten(b, facts, is_case, known);
                    Expression::new(Kind::Binary(*operator, a, b), part.span.clone())
                }
                _ => part.clone(),
            };
            // No operand of a user has such a name.
            let name = format!("part {}", self.parts.len());
            let operand = Arc::new(Expression::operand(&name));
            let is_always = !is_case;
            self.parts.push(GuardedPart { name, part, facts: limits, is_always });
            return operand;
        }
        let kind = match &part.kind {
            Kind::Number(_) | Kind::Constant(..) | Kind::Operand(_) | Kind::Word(..) => {
                return Arc::new(part.clone());
            }
            Kind::Unary(function, a) => {
                Kind::Unary(*function, self.rewritten(a, facts, is_case, known))
            }
            Kind::Binary(operator, a, b) => {
                let a = self.rewritten(a, facts, is_case, known);
                Kind::Binary(*operator, a, self.rewritten(b, facts, is_case, known))
            }
            Kind::If(comparison, yes, no) => {
                if let Ok(Some(outcome)) = comparison.holds(&self.operands) {
                    // No operand takes the other case.
                    let case = if outcome { yes } else { no };
                    return self.rewritten(case, facts, is_case, known);
                }
                let left = self.rewritten(&comparison.left, facts, is_case, known);
                let right = self.rewritten(&comparison.right, facts, is_case, known);
                let yes = self.case(yes, facts, (comparison, true), is_case, known);
                let no = self.case(no, facts, (comparison, false), is_case, known);
                let or_equal = comparison.or_equal;
                Kind::If(Comparison { left, right, or_equal }, yes, no)
            }
        };
        let rewritten = Arc::new(Expression::new(kind, part.span.clone()));
        if let Some(square) = projection::square_of_limit(&part.kind) {
            let square = self.rewritten(&square, facts, is_case, &mut HashMap::new());
            return within_root(&rewritten, square);
        }
        order::clamped(part, &rewritten, &self.operands).unwrap_or(rewritten)
    }

    /// Returns a case of a choice, in which the facts of the comparison's outcome hold too. The facts of further cases are left out
    /// after [`MOST_CASES`] cases.
    fn case(
        &mut self,
        case: &Expression,
        facts: &[Fact],
        (comparison, outcome): (&Comparison, bool),
        is_case: bool,
        known: &mut RewrittenParts,
    ) -> Arc<Expression> {
        let own = Fact::all_of(comparison, outcome, self.statement);
        if own.is_empty() || self.cases == MOST_CASES {
            return self.rewritten(case, facts, is_case, known);
        }
        self.cases += 1;
        let all = with_signs([facts, &own].concat(), self.statement);
        self.rewritten(case, &all, true, &mut HashMap::new())
    }
}

/// Returns `part`, whose absolute value does not exceed the root of `square`, as a formula that is limited to this root. Its
/// value is equal, but its enclosure is narrower.
fn within_root(part: &Arc<Expression>, square: Arc<Expression>) -> Arc<Expression> {
    let new = |kind: Kind| Arc::new(Expression::new(kind, part.span.clone()));
    let most = new(Kind::Unary(Function::Sqrt, square));
    let least = new(Kind::Unary(Function::Negate, most.clone()));
    let not_above = new(Kind::Binary(Operator::Min, part.clone(), most));
    new(Kind::Binary(Operator::Max, not_above, least))
}

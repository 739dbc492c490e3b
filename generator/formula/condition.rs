//! Defines conditions that join comparisons, and rewrites them as choices and as single comparisons.

use std::ops::Range;
use std::sync::Arc;

use super::literal::Literal;
use super::{Comparison, Expression, Function, Kind, Operator, TextSpan};

/// A comparison, or two conditions that are joined by `and` or `or`.
#[derive(Clone)]
pub(super) enum JoinedCondition {
    Is(Comparison),
    Both(Box<Self>, Box<Self>),
    Either(Box<Self>, Box<Self>),
}

impl Comparison {
    /// Returns the comparison that holds exactly if this comparison does not. For example, `x > y` gives `y >= x`.
    #[must_use]
    pub fn negated(&self) -> Self {
        let Self { left, right, or_equal } = self.clone();
        Self { left: right, right: left, or_equal: !or_equal }
    }

    /// Returns a comparison that holds exactly if this comparison and `other` hold. For example, `x > 0` and `y > 0` give `min(x,
    /// y) > 0`.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        JoinedCondition::Both(
            Box::new(JoinedCondition::Is(self)),
            Box::new(JoinedCondition::Is(other)),
        )
        .comparison()
    }
}

impl JoinedCondition {
    pub(super) fn negated(self) -> Self {
        match self {
            Self::Is(comparison) => Self::Is(comparison.negated()),
            Self::Both(a, b) => Self::Either(Box::new(a.negated()), Box::new(b.negated())),
            Self::Either(a, b) => Self::Both(Box::new(a.negated()), Box::new(b.negated())),
        }
    }

    /// Returns the formula that is `yes` if the condition holds, and otherwise `no`. The formula gets the location `span`.
    pub(super) fn choice(
        &self,
        yes: Arc<Expression>,
        no: Arc<Expression>,
        span: Range<usize>,
    ) -> Expression {
        let of = |condition: &Self, yes: &Arc<Expression>, no: &Arc<Expression>| {
            Arc::new(condition.choice(yes.clone(), no.clone(), span.clone()))
        };
        match self {
            Self::Is(comparison) => {
                Expression::new(Kind::If(comparison.clone(), yes, no), span.clone())
            }
            Self::Both(a, b) => a.choice(of(b, &yes, &no), no, span.clone()),
            Self::Either(a, b) => a.choice(yes.clone(), of(b, &yes, &no), span.clone()),
        }
    }

    /// Returns a single comparison that holds exactly if the condition holds. For example, `x > 0 and y > 0` gives `min(x, y) >
    /// 0`.
    pub(super) fn comparison(&self) -> Comparison {
        let (first, second, least) = match self {
            Self::Is(comparison) => return comparison.clone(),
            Self::Both(a, b) => (a.comparison(), b.comparison(), true),
            Self::Either(a, b) => (a.comparison(), b.comparison(), false),
        };
        let zero = number(Literal::zero(), &first.left.span);
        if first.or_equal == second.or_equal {
            let operator = if least { Operator::Min } else { Operator::Max };
            let kind = Kind::Binary(operator, difference(&first), difference(&second));
            let left = Arc::new(Expression::new(kind, first.left.span.clone()));
            return Comparison { left, right: zero, or_equal: first.or_equal };
        }
        // The strict comparison decides if the comparison with equality does not.
        let (strict, other) = if first.or_equal { (second, first) } else { (first, second) };
        let one = number(Literal::one(), &strict.left.span);
        let decided = match least {
            true => {
                let kind = Kind::Unary(Function::Negate, one);
                Kind::If(
                    other,
                    difference(&strict),
                    Arc::new(Expression::new(kind, strict.left.span.clone())),
                )
            }
            false => Kind::If(other, one, difference(&strict)),
        };
        let left = Arc::new(Expression::new(decided, strict.left.span.clone()));
        Comparison { left, right: zero, or_equal: false }
    }
}

fn difference(comparison: &Comparison) -> Arc<Expression> {
    let Comparison { left, right, .. } = comparison;
    let is_zero = right.rational().is_some_and(|value| value.is_zero());
    if !right.varies() && is_zero {
        return left.clone();
    }
    let kind = Kind::Binary(Operator::Sub, left.clone(), right.clone());
    Arc::new(Expression::new(kind, left.span.clone()))
}

fn number(literal: Literal, span: &TextSpan) -> Arc<Expression> {
    Arc::new(Expression::new(Kind::Number(literal), span.clone()))
}

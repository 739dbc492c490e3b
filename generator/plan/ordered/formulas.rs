//! Shows from the formulas of a list that the order of its values is the order of operands.

use std::ops::Range;
use std::sync::Arc;

use glint_formula::{Enclosure, Expression, Function, Kind, Operator, TextSpan};

use super::Change;
use crate::refusal::PlanRefusal;
use crate::statement::ExpressionStatement;

/// Two formulas of a list, and the operands in which they differ.
struct FormulaPair<'s> {
    /// The limits of all operands.
    operands: Vec<(&'s str, Enclosure)>,
    /// The own operands of the two formulas, as soon as they are known.
    own: Option<[String; 2]>,
    /// The first part of the first formula that is not known to rise or to fall, with the reason.
    obstacle: Option<(TextSpan, &'static str)>,
}

/// A list of results whose values have the order of operands, or the reverse order.
pub(super) struct OrderedList {
    /// The indices of the results.
    pub(super) results: Range<usize>,
    /// The own operand of each number, in the order of the results.
    pub(super) own: Vec<String>,
    /// Whether the values rise or fall with their own operands, the same for all.
    pub(super) change: Change,
}

/// Returns the own operands of the numbers of a list, and whether the values rise or fall with them.
///
/// # Errors
/// Fails if two formulas are not alike, or if a part of them neither rises nor falls.
pub(super) fn ordered_list(
    statement: &ExpressionStatement,
    list: &Range<usize>,
) -> Result<OrderedList, PlanRefusal> {
    let first = list.start;
    let mut own = Vec::new();
    let mut common = Change::Constant;
    for second in first + 1..list.end {
        let (change, [of_first, of_second]) = change_of_pair(statement, first, second)?;
        if own.is_empty() {
            own.push(of_first);
            common = change;
        } else if own[0] != of_first || common != change {
            return Err(refusal(first, None, "two of them change with different operands"));
        }
        own.push(of_second);
    }
    Ok(OrderedList { results: list.clone(), own, change: common })
}

/// Returns in which direction the results `first` and `second` change with the one operand in which their formulas differ, and
/// this operand of each: `exp(v0 - m)` and `exp(v1 - m)` give `Rises`, `v0` and `v1`. Fails if the formulas are the same or not
/// alike, or if the result neither rises nor falls.
fn change_of_pair(
    statement: &ExpressionStatement,
    first: usize,
    second: usize,
) -> Result<(Change, [String; 2]), PlanRefusal> {
    let formula = |number: usize| Arc::new(statement.results[number].target().clone());
    let mut pair = FormulaPair {
        operands: statement.enclosed_operands(&statement.domain()),
        own: None,
        obstacle: None,
    };
    let change = pair.change(&formula(first), &formula(second));
    match (change, pair.own, pair.obstacle) {
        (Change::Rises | Change::Falls, Some(own), _) => Ok((change, own)),
        (_, _, Some((place, reason))) => Err(refusal(first, Some(place), reason)),
        _ => Err(refusal(first, None, "two of them have the same formula")),
    }
}

fn refusal(result: usize, place: Option<TextSpan>, reason: &str) -> PlanRefusal {
    let message =
        format!("`ordered` needs numbers that rise or fall with their own operands: {reason}");
    let remedy = "write a formula in which each number has one operand of its own, such as softmax(v) or v / sum(v), \
                  or remove `ordered`";
    let refusal = PlanRefusal::new(message, remedy).of_result(result);
    match place {
        Some(place) => refusal.at(&place),
        None => refusal,
    }
}

impl FormulaPair<'_> {
    /// Returns the change of `a`, a part of the first formula, while `b` is the same part of the second formula.
    fn change(&mut self, a: &Arc<Expression>, b: &Arc<Expression>) -> Change {
        if a == b {
            return Change::Constant;
        }
        match (&a.kind, &b.kind) {
            (Kind::Operand(x), Kind::Operand(y)) => {
                let these = [x.clone(), y.clone()];
                if *self.own.get_or_insert_with(|| these.clone()) == these {
                    return Change::Rises;
                }
                self.obstacle(a, "it has more than one operand of its own")
            }
            (Kind::Unary(function, p), Kind::Unary(other, q)) if function == other => {
                let change = self.change(p, q);
                self.of_function(*function, a, [p, q], change)
            }
            (Kind::Binary(operator, p, q), Kind::Binary(other, r, s)) if operator == other => {
                let changes = [self.change(p, r), self.change(q, s)];
                self.of_operator(*operator, a, [[p, r], [q, s]], changes)
            }
            (Kind::If(condition, p, q), Kind::If(other, r, s)) if condition == other => {
                let changes = [self.change(p, r), self.change(q, s)];
                changes[0].with(changes[1])
            }
            (Kind::If(..), Kind::If(..)) => {
                self.obstacle(a, "its condition is not the same for all numbers")
            }
            _ => self.obstacle(a, "the formulas of two numbers differ here"),
        }
    }

    fn obstacle(&mut self, part: &Expression, reason: &'static str) -> Change {
        self.obstacle.get_or_insert((part.span.clone(), reason));
        Change::Unknown
    }

    /// Returns the change of `whole`, a function of arguments with the change `change`, one in each formula.
    fn of_function(
        &mut self,
        function: Function,
        whole: &Arc<Expression>,
        arguments: [&Arc<Expression>; 2],
        change: Change,
    ) -> Change {
        let result = match function {
            Function::Negate => change.reversed(),
            Function::Sqrt
            | Function::Exp
            | Function::Exp2
            | Function::Ln
            | Function::Log2
            | Function::Atan
            | Function::Tanh
            | Function::Erf => change,
            Function::Abs => change.times(self.is_negative(&arguments)),
            Function::Sin | Function::Cos | Function::Tan => Change::Unknown,
        };
        self.checked(whole, [change; 2], result)
    }

    /// Returns the change of `whole`. `changes` has the changes of its two inputs, and `inputs` each input in both formulas.
    fn of_operator(
        &mut self,
        operator: Operator,
        whole: &Arc<Expression>,
        inputs: [[&Arc<Expression>; 2]; 2],
        changes: [Change; 2],
    ) -> Change {
        let [left, right] = changes;
        let result = match operator {
            Operator::Add | Operator::Min | Operator::Max => left.with(right),
            Operator::Sub => left.with(right.reversed()),
            Operator::Mul => {
                let by_right = left.times(self.is_negative(&inputs[1]));
                let by_left = right.times(self.is_negative(&inputs[0]));
                by_right.with(by_left)
            }
            Operator::Div => {
                let divisor = self.is_negative(&inputs[1]);
                let by_right = left.times(divisor);
                // 1/s falls where s rises, on each side of 0.
                let inverse = if divisor.is_some() { right.reversed() } else { right.times(None) };
                by_right.with(inverse.times(self.is_negative(&inputs[0])))
            }
            Operator::Power => {
                let is_constant = right == Change::Constant;
                let base = self.is_negative(&inputs[0]);
                let exponent = self.is_negative(&inputs[1]);
                if is_constant && base == Some(false) {
                    left.times(exponent)
                } else {
                    Change::Unknown
                }
            }
            Operator::Mod | Operator::Atan2 => Change::Unknown,
        };
        self.checked(whole, changes, result)
    }

    /// Returns `result`. If it is unknown although the inputs' changes are known, `whole` becomes the obstacle.
    fn checked(&mut self, whole: &Expression, inputs: [Change; 2], result: Change) -> Change {
        let is_constant = inputs == [Change::Constant; 2];
        match result {
            Change::Unknown if !inputs.contains(&Change::Unknown) => {
                self.obstacle(whole, "this part is not known to rise or to fall")
            }
            Change::Constant if !is_constant => Change::Unknown,
            _ => result,
        }
    }

    /// Returns whether a part is at most 0 in both formulas (`true`), or at least 0 (`false`); `None` if it has both signs or no
    /// value.
    fn is_negative(&self, parts: &[&Arc<Expression>; 2]) -> Option<bool> {
        let mut signs = Vec::new();
        for part in parts {
            let value = part.enclose(&self.operands).ok()?;
            signs.push(match (value.low >= 0.0, value.high <= 0.0) {
                (true, _) => false,
                (_, true) => true,
                (false, false) => return None,
            });
        }
        (signs[0] == signs[1]).then_some(signs[0])
    }
}

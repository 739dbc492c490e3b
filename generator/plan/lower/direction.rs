//! Rewrites `atan2(y, x)`, the direction of a point as an angle, as operations of a plan.
//!
//! A table covers one octant of the circle. In this octant, the angle is the arc tangent of the smaller coordinate divided by
//! the larger one, a number from 0 to 1. The other octants are mirror images of this octant, at the diagonal, the y axis and
//! the x axis.

use std::sync::Arc;

use glint_base::fixed::{Format, exp2};
use glint_formula::{Enclosure, Expression, Function, Kind, Operator};

use super::Lowering;
use super::quotient::{Dividend, DividendRounding, DivisorKind};
use super::root::holding;
use super::shape::number;
use crate::facts::has_fact;
use crate::guarded::GuardedFormula;
use crate::node::{CaseAgreement, NodeId};
use crate::refusal::PlanRefusal;

/// A constant by which a direction is multiplied or divided.
pub(super) struct Scaling {
    operator: Operator,
    constant: Expression,
}

impl Scaling {
    /// Makes the scaling by 1.
    pub(super) fn none() -> Self {
        Self { operator: Operator::Mul, constant: number("1") }
    }

    /// Returns the formula, multiplied or divided by the constant.
    fn of(&self, formula: Expression) -> Expression {
        let (formula, constant) = (Arc::new(formula), Arc::new(self.constant.clone()));
        Expression::new(Kind::Binary(self.operator, formula, constant), 0..0)
    }
}

impl Lowering<'_> {
    /// Returns the node of a direction times a constant. `core` must be the direction, and `function` the whole formula in which
    /// x replaces `core`. The constant then becomes a part of the table. Returns `None` for any other formula. Fails if the plan
    /// cannot compute a part.
    pub(super) fn scaled_direction(
        &mut self,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Kind::Binary(Operator::Atan2, y, x) = &core.kind else { return Ok(None) };
        let operand = Expression::operand("x");
        let is_operand = |part: &Expression| *part == operand;
        let Kind::Binary(operator @ (Operator::Mul | Operator::Div), a, b) = &function.kind else {
            return Ok(None);
        };
        let constant = match (is_operand(a), is_operand(b), operator) {
            (true, false, _) => b,
            (false, true, Operator::Mul) => a,
            _ => return Ok(None),
        };
        if constant.varies() {
            return Ok(None);
        }
        let scaling = Scaling { operator: *operator, constant: (**constant).clone() };
        self.direction(y, x, &scaling).map(Some)
    }

    /// Returns the node of the direction of the point (x, y), an angle in radians times the constant in `scaling`. Fails if the
    /// plan cannot compute a part.
    pub(super) fn direction(
        &mut self,
        y: &Expression,
        x: &Expression,
        scaling: &Scaling,
    ) -> Result<NodeId, PlanRefusal> {
        let [y_node, x_node] = [self.part(y)?, self.part(x)?];
        let [y_size, x_size] = [("y_size", y_node), ("x_size", x_node)]
            .map(|(name, node)| self.plan.absolute(name, node));
        let (y_size, x_size) = (y_size?, x_size?);
        let larger = self.plan.maximum("larger", x_size, y_size)?;
        let sizes = self.plan.node(larger);
        let most = sizes.format.to_f64(sizes.range.1);
        let least = self.least_of_larger(y, x, larger)?;
        let sizes = Enclosure::between(least, most);
        let larger = match least > 0.0 {
            true => self.plan.limited("larger_guarded", larger, sizes)?,
            false => larger,
        };
        let octave = self.octave(larger, sizes, false)?;
        // The smaller coordinate is added after the normalising of the larger one, because this limits both in the proof.
        let smaller = self.plan.minimum("smaller", x_size, y_size)?;
        let divisor = self.divisor_in_octave(octave, DivisorKind::Word)?;
        let dividend = Dividend {
            node: smaller,
            largest_quotient: 1.0,
            rounding: DividendRounding::NeverLarger,
            limits: None,
        };
        let ratio = self.ratio(&dividend, &divisor)?;
        let finest = self.finest;
        // A tangent is at most 1. After it is shortened, it is at most half a unit larger.
        let tangent = self.rounding(finest + 2, |own, frac| {
            if own.plan.node(ratio).format.frac <= frac {
                return Ok(ratio);
            }
            let kept = holding(Enclosure::between(0.0, 1.0), frac);
            let format = Format { frac: frac + 1, ..kept };
            own.plan.middle("tangent", ratio, format)
        })?;
        let arc = scaling.of(Expression::new(
            Kind::Unary(Function::Atan, Arc::new(Expression::operand("x"))),
            0..0,
        ));
        let tangents = Enclosure::between(0.0, 1.0 + exp2(-finest));
        let in_octant = self.function("octant", tangent, &arc, tangents)?;
        let is_steep = self.plan.less("is_steep", x_size, y_size)?;
        let quarter = self.number(&scaling.of(number("pi / 2")))?;
        let mirrored = self.plan.subtract("octant_mirrored", quarter, in_octant)?;
        let in_quadrant = self.plan.choose("quadrant", is_steep, [in_octant, mirrored])?;
        // Let t be the smaller coordinate divided by the larger one. On both sides of the diagonal the angles differ by
        // π/2 − 2 · atan(t), which is at most 2 · (1 − t). On both sides of an axis they differ by at most twice the angle from the
        // axis, which is at most π · t.
        let agreement = self.agreement(y, x, scaling, "2");
        self.plan.state_agreement(in_quadrant, agreement);
        let in_half = self.mirrored_where_negative("half", in_quadrant, x_node, Some(scaling))?;
        let is_right_half = in_half == in_quadrant;
        let at_axis = self.agreement(y, x, scaling, "pi");
        if !is_right_half {
            self.plan.state_agreement(in_half, at_axis.clone());
        }
        let whole = self.mirrored_where_negative("direction", in_half, y_node, None)?;
        if is_right_half && whole != in_half {
            // At the negative x axis the direction jumps.
            self.plan.state_agreement(whole, at_axis);
        }
        Ok(whole)
    }

    /// Returns a lower limit of the larger coordinate of the point (x, y), which has the node `larger`, from a condition on the
    /// length of the point. The limit is 0 without such a condition, for rounded coordinates, and if both coordinates are
    /// operands, because boxes then limit them.
    fn least_of_larger(
        &self,
        y: &Expression,
        x: &Expression,
        larger: NodeId,
    ) -> Result<f64, PlanRefusal> {
        let is_operand = |part: &Expression| matches!(part.kind, Kind::Operand(_));
        if is_operand(y) && is_operand(x) || !self.is_exact(larger) {
            return Ok(0.0);
        }
        let binary = |operator, a: &Expression, b: &Expression| {
            let kind = Kind::Binary(operator, Arc::new(a.clone()), Arc::new(b.clone()));
            Expression::new(kind, 0..0)
        };
        let [y_squared, x_squared] = [y, x].map(|part| binary(Operator::Mul, part, part));
        let squared_length = binary(Operator::Add, &y_squared, &x_squared);
        if !has_fact(self.statement, &self.uses, &squared_length) {
            return Ok(0.0);
        }
        // The square of the larger coordinate is at least half of the squared length.
        let least = self.range(&squared_length)?.low / 2.0;
        Ok(least.max(0.0).sqrt().next_down().max(0.0))
    }

    /// Returns how near the angles on both sides of a diagonal or an axis are. They differ by at most `slope`, a number, times
    /// the distance of the compared coordinates, divided by the larger coordinate of the point (x, y). Returns `None` if the
    /// constant in `scaling` has no value.
    fn agreement(
        &self,
        y: &Expression,
        x: &Expression,
        scaling: &Scaling,
        slope: &str,
    ) -> Option<CaseAgreement> {
        let slope = scaling.of(number(slope)).enclose(&[]).ok()?;
        let size = |part: &Expression| {
            Arc::new(Expression::new(Kind::Unary(Function::Abs, Arc::new(part.clone())), 0..0))
        };
        let larger = Expression::new(Kind::Binary(Operator::Max, size(x), size(y)), 0..0);
        let scale = Arc::new(GuardedFormula::new(self.statement, &self.uses, &larger));
        Some(CaseAgreement { slope: slope.high.abs().max(slope.low.abs()), scale })
    }

    /// Returns the node of an angle that is mirrored if `coordinate` is negative. With `scaling`, the mirrored angle is half a
    /// turn minus the angle. Without `scaling`, it is the negative angle. Returns `angle` itself if `coordinate` is never
    /// negative. Fails if a node has too many bits.
    fn mirrored_where_negative(
        &mut self,
        name: &str,
        angle: NodeId,
        coordinate: NodeId,
        scaling: Option<&Scaling>,
    ) -> Result<NodeId, PlanRefusal> {
        if self.plan.node(coordinate).range.0 >= 0 {
            return Ok(angle);
        }
        let frac = self.plan.node(coordinate).format.frac;
        let zero = self.plan.constant("zero", 0, frac)?;
        let is_negative = self.plan.less(&format!("{name}_is_mirrored"), coordinate, zero)?;
        let mirrored = match scaling {
            Some(scaling) => {
                let half_turn = self.number(&scaling.of(number("pi")))?;
                self.plan.subtract(&format!("{name}_mirrored"), half_turn, angle)?
            }
            None => self.plan.negate(&format!("{name}_mirrored"), angle)?,
        };
        self.plan.choose(name, is_negative, [angle, mirrored])
    }
}

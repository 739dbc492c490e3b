//! Rewrites sines and cosines such as `sin(2 * pi * x)` as operations of a plan, so that a table of one quadrant serves all four.
//!
//! The angle in quarter turns is q + w, with an integer q and w from 0 to below 1. The sine is the table's value at w if q is
//! even, and at 1 − w if q is odd; in the third and the fourth quadrant it is negative. The cosine is the sine of the angle plus
//! a quarter turn.

use glint_base::fixed::Format;
use glint_formula::{Expression, Function, Kind, Operator, RBig};

use super::{Lowering, number};
use crate::node::NodeId;
use crate::refusal::PlanRefusal;

/// The fewest bits of an angle within a quadrant for which the quadrants are worth their muxes.
const FEWEST_BITS: i32 = 5;

/// The most bits of an angle within a quadrant.
const MOST_BITS: i32 = 20;

/// Returns the power of two by which x is multiplied to give quarter turns, where `function` is the sine or the cosine of a
/// multiple of x. For example, `sin(2 * pi * x)` gives 2: x is in turns, and 4·x in quarter turns.
fn quarter_turns(function: &Expression) -> Option<(Function, i32)> {
    let Kind::Unary(kind @ (Function::Sin | Function::Cos), angle) = &function.kind else {
        return None;
    };
    if !is_multiple(angle) {
        return None;
    }
    let at_one = angle.substitute(&Expression::operand("x"), &number("1"), &angle.span);
    let quarter = Box::new(number("pi / 2"));
    let turns = Kind::Binary(Operator::Div, Box::new(at_one), quarter);
    let turns = Expression::new(turns, angle.span.clone()).rational()?;
    for power in -MOST_BITS..=MOST_BITS {
        if turns == RBig::from(2).pow(power as isize) {
            return Some((*kind, power));
        }
    }
    None
}

/// Returns whether a formula is a constant times x.
fn is_multiple(formula: &Expression) -> bool {
    match &formula.kind {
        Kind::Operand(_) => true,
        Kind::Binary(Operator::Mul, a, b) => {
            is_multiple(a) && b.operands().is_empty() || a.operands().is_empty() && is_multiple(b)
        }
        Kind::Binary(Operator::Div, a, b) => is_multiple(a) && b.operands().is_empty(),
        _ => false,
    }
}

impl Lowering<'_> {
    /// Returns the node of a sine or a cosine of whole turns; `None` for any other function, and where a quadrant has few
    /// angles or too many.
    pub(super) fn wave(
        &mut self,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let Some((kind, power)) = quarter_turns(function) else { return Ok(None) };
        let node = self.part(core)?;
        let bits = self.plan.node(node).format.frac - power;
        if !(FEWEST_BITS..=MOST_BITS).contains(&bits) {
            return Ok(None);
        }
        let quarters = self.plan.scale("quarters", node, power)?;
        let [quadrant, way] = self.plan.split("angle", quarters)?;
        let quadrant = match kind {
            Function::Cos => {
                let one = self.plan.constant("one", 1, 0)?;
                self.plan.add("quadrant_ahead", quadrant, one)?
            }
            _ => quadrant,
        };
        let is_odd = self.plan.bit("is_odd_quadrant", quadrant, 0)?;
        let one = self.plan.constant("quarter", 1, 0)?;
        let back = self.plan.subtract("angle_back", one, way)?;
        // At 1 itself the sine is flat, so that the nearest angle below has nearly the same sine, and the table needs no word more.
        let back = self.plan.saturate("angle_back_kept", back, Format::unsigned(0, bits))?;
        let angle = self.plan.choose("angle_in_quadrant", is_odd, [way, back])?;
        let finest = self.finest;
        let domain = (0, (1i64 << bits) - 1);
        let table = number("sin(pi / 2 * x)");
        let size = self.rounding(finest + 1, |own, frac| {
            own.approximation("wave", angle, &table, domain, frac)
        })?;
        let is_negative = self.plan.bit("is_negative", quadrant, 1)?;
        let negated = self.plan.negate("wave_negated", size)?;
        self.plan.choose("wave_with_sign", is_negative, [size, negated]).map(Some)
    }
}

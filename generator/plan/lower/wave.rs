//! Rewrites sines and cosines such as `sin(2 * pi * x)` as operations of a plan, so that a short table serves the whole circle.
//! The angle in quarter turns must be a number times a power of two, with 5 to 20 bits within a quadrant.
//!
//! If the formulas have only the sine or only the cosine of an angle, a table of the sine covers a quadrant. If the formulas have
//! both, tables of the sine and the cosine cover an octant, and each result chooses between these tables.

use std::sync::Arc;

use glint_formula::{Expression, Function, Kind, Operator, RBig};

use super::Lowering;
use super::shape::{core_of, number};
use crate::node::NodeId;
use crate::refusal::PlanRefusal;

/// The smallest number of bits of an angle within a quadrant for which quadrants save more than their muxes cost.
const FEWEST_BITS: i32 = 5;

/// The largest number of bits of an angle within a quadrant.
const MOST_BITS: i32 = 20;

/// Returns `Sin` or `Cos` and an exponent, if `function` is the sine or the cosine of a multiple of x. The angle in quarter turns
/// is x times 2 to this exponent: `sin(2 * pi * x)` gives 2, because x is in turns. Returns `None` for any other function.
fn quarter_turns(function: &Expression) -> Option<(Function, i32)> {
    let Kind::Unary(kind @ (Function::Sin | Function::Cos), angle) = &function.kind else {
        return None;
    };
    if !is_multiple(angle) {
        return None;
    }
    let at_one = angle.substitute(&Expression::operand("x"), &number("1"), &angle.span);
    let quarter = Arc::new(number("pi / 2"));
    let turns = Kind::Binary(Operator::Div, Arc::new(at_one), quarter);
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
            is_multiple(a) && !b.varies() || !a.varies() && is_multiple(b)
        }
        Kind::Binary(Operator::Div, a, b) => is_multiple(a) && !b.varies(),
        _ => false,
    }
}

/// The sine and the cosine of an angle that is reduced to the first octant, with the nodes that restore the results for the
/// whole angle.
pub(super) struct OctantWaves {
    /// The node from which the angle is computed.
    angle: NodeId,
    /// The exponent: the node times 2 to this power is the angle in quarter turns.
    power: i32,
    /// The sine and the cosine of the reduced angle.
    waves: [NodeId; 2],
    /// 1 in the octants in which the absolute value of the sine is the cosine of the reduced angle.
    is_swapped: NodeId,
    /// Two bits: whether the sine is negative, and whether the cosine is negative.
    signs: [NodeId; 2],
}

impl Lowering<'_> {
    /// Returns the node of a sine or a cosine. `function` must be the formula with x in the place of `core`. Returns `None` if x
    /// times a power of two is not the angle in quarter turns, or if a quadrant has fewer than 5 or more than 20 bits of the
    /// angle. Fails if the plan cannot compute a part.
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
        if self.has_sine_and_cosine(core, power) {
            return self.wave_by_octants(kind, node, power).map(Some);
        }
        self.wave_by_quadrants(kind, node, power).map(Some)
    }

    /// Returns the node of a sine or a cosine (`kind`), computed by a table of the sine in a quadrant. `node` times 2^`power` is
    /// the angle in quarter turns, q + w with an integer q. The table is read at w if q is even, and at 1 − w if q is odd. The
    /// cosine is the sine of the angle plus a quarter turn. Fails if the plan cannot compute a part.
    fn wave_by_quadrants(
        &mut self,
        kind: Function,
        node: NodeId,
        power: i32,
    ) -> Result<NodeId, PlanRefusal> {
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
        let angle = self.folded("quadrant", is_odd, way)?;
        let size = self.wave_of_angle("wave", angle, "sin(pi / 2 * x)")?;
        let is_negative = self.plan.bit("is_negative", quadrant, 1)?;
        self.with_sign("wave", size, is_negative)
    }

    /// Returns the node of a sine or a cosine (`kind`), computed by tables of the sine and the cosine in an octant. `node` times
    /// 2^`power` is the angle in quarter turns. A sine and a cosine of the same angle share the tables. Fails if the plan cannot
    /// compute a part.
    ///
    /// In the octants 0 to 3, the absolute value of the sine is the sine, the cosine, the cosine and the sine of the reduced
    /// angle. The absolute value of the cosine is the other value in each octant. The octants 4 to 7 repeat this pattern. The
    /// sine is negative in the octants 4 to 7, and the cosine in the octants 2 to 5.
    fn wave_by_octants(
        &mut self,
        kind: Function,
        node: NodeId,
        power: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let is_known = |it: &OctantWaves| it.angle == node && it.power == power;
        let known = match self.octants.iter().position(is_known) {
            Some(known) => known,
            None => {
                let waves = self.octant_waves(node, power)?;
                self.octants.push(waves);
                self.octants.len() - 1
            }
        };
        let OctantWaves { waves: [sine, cosine], is_swapped, signs, .. } = self.octants[known];
        match kind {
            Function::Cos => {
                let size = self.plan.choose("cosine_size", is_swapped, [cosine, sine])?;
                self.with_sign("cosine", size, signs[1])
            }
            _ => {
                let size = self.plan.choose("sine_size", is_swapped, [sine, cosine])?;
                self.with_sign("sine", size, signs[0])
            }
        }
    }

    /// Adds the tables of the sine and the cosine in an octant, and the nodes that restore the results for the whole angle.
    /// Returns these nodes. `node` times 2^`power` is the angle in quarter turns. Fails if the plan cannot compute a part.
    fn octant_waves(&mut self, node: NodeId, power: i32) -> Result<OctantWaves, PlanRefusal> {
        let eighths = self.plan.scale("eighths", node, power + 1)?;
        let [octant, way] = self.plan.split("angle", eighths)?;
        let is_odd = self.plan.bit("is_odd_octant", octant, 0)?;
        let angle = self.folded("octant", is_odd, way)?;
        let sine = self.wave_of_angle("octant_sine", angle, "sin(pi / 4 * x)")?;
        let cosine = self.wave_of_angle("octant_cosine", angle, "cos(pi / 4 * x)")?;
        let one = self.plan.constant("one", 1, 0)?;
        let next = self.plan.add("next_octant", octant, one)?;
        let is_swapped = self.plan.bit("is_swapped", next, 1)?;
        let two = self.plan.constant("two", 2, 0)?;
        let after_next = self.plan.add("quadrant_ahead", octant, two)?;
        let is_sine_negative = self.plan.bit("is_sine_negative", octant, 2)?;
        let is_cosine_negative = self.plan.bit("is_cosine_negative", after_next, 2)?;
        Ok(OctantWaves {
            angle: node,
            power,
            waves: [sine, cosine],
            is_swapped,
            signs: [is_sine_negative, is_cosine_negative],
        })
    }

    /// Returns the node of the reduced angle within a quadrant or an octant, a number from 0 to 1. The angle is `way` if the
    /// number of the quadrant or octant is even, and 1 − `way` if the number is odd. Fails if a node has too many bits.
    fn folded(&mut self, name: &str, is_odd: NodeId, way: NodeId) -> Result<NodeId, PlanRefusal> {
        let one = self.plan.constant("whole", 1, 0)?;
        let back = self.plan.subtract("angle_back", one, way)?;
        self.plan.choose(&format!("angle_in_{name}"), is_odd, [way, back])
    }

    /// Returns the node of a table of a sine or a cosine, which `formula` states, for a reduced angle from 0 to 1, both
    /// included. Fails if a node has too many bits.
    fn wave_of_angle(
        &mut self,
        name: &str,
        angle: NodeId,
        formula: &str,
    ) -> Result<NodeId, PlanRefusal> {
        let finest = self.finest;
        let domain = (0, 1i64 << self.plan.node(angle).format.frac);
        self.rounding(finest + 1, |own, frac| {
            let frac = frac.max(own.least_table_fraction(0));
            own.approximation(name, angle, &number(formula), domain, frac)
        })
    }

    /// Returns the node of `size`, negated if the bit `is_negative` is 1. Fails if a node has too many bits.
    fn with_sign(
        &mut self,
        name: &str,
        size: NodeId,
        is_negative: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let negated = self.plan.negate(&format!("{name}_negated"), size)?;
        self.plan.choose(&format!("{name}_with_sign"), is_negative, [size, negated])
    }

    /// Returns whether the formulas of the results contain both the sine and the cosine of one angle, so that both can share
    /// two tables. The angle in quarter turns is `core` times 2^`power`. For example, `sin(2 * pi * x)` and `cos(2 * pi * x)`
    /// have the `core` x and the `power` 2.
    fn has_sine_and_cosine(&self, core: &Expression, power: i32) -> bool {
        let has = |kind: Function| {
            let wanted = (kind, power);
            let mut results = self.statement.results.iter();
            results.any(|result| has_wave(&result.formula, core, wanted))
        };
        has(Function::Sin) && has(Function::Cos)
    }
}

/// Returns whether a formula contains the wave `wanted`: the sine or the cosine of an angle that is `core` times 2 to the given
/// power in quarter turns.
fn has_wave(formula: &Expression, core: &Expression, wanted: (Function, i32)) -> bool {
    let is_wanted = |part: &Expression| {
        if core_of(part) != core {
            return false;
        }
        let function = part.substitute(core, &Expression::operand("x"), &part.span);
        quarter_turns(&function) == Some(wanted)
    };
    formula.count(&is_wanted) > 0
}

//! Estimates the area of a plan, so that the planner can choose among several plans for the same formulas.
//!
//! The unit is the look-up table of four inputs. An adder, a choice and a comparison take one for each bit. A table of polynomials
//! takes one for 16 words of a bit, and the sums of Horner's rule. Products take multipliers, and look-up tables only for the bits
//! that a multiplier of 18 by 18 bits does not have.

use super::node::{NodeId, Operation, PlanNode, normalising_shifts};
use super::plan::ExpressionPlan;
use glint_approximate::Piecewise;
use glint_base::fixed::Rounding;

/// The words of a bit that a look-up table holds.
const WORDS_OF_CELL: usize = 16;

/// The bits of a multiplier's factor.
const FACTOR_BITS: u32 = 18;

/// The look-up tables for each pair of bits that a multiplier does not have.
const CELLS_OF_BIT_PAIR: f64 = 1.5;

impl ExpressionPlan {
    /// Returns an estimate of the look-up tables that the whole plan takes.
    pub(super) fn total_cells(&self) -> f64 {
        (0..self.nodes.len()).map(|at| self.cells(NodeId(at))).sum()
    }

    /// Returns an estimate of the look-up tables of four inputs that a node takes. It is 0 for an operand, a constant, and for an
    /// operation that only selects bits.
    pub fn cells(&self, id: NodeId) -> f64 {
        let node = self.node(id);
        let width = f64::from(node.format.width());
        let width_of = |id: &NodeId| self.node(*id).format.width();
        match &node.operation {
            Operation::Operand(_)
            | Operation::Constant { .. }
            | Operation::Scale(_)
            | Operation::Narrow(_, Rounding::Truncate)
            | Operation::Middle(_)
            | Operation::Bit(..)
            | Operation::IntegerPart(_)
            | Operation::FractionPart(..)
            | Operation::Places(_) => 0.0,
            Operation::Narrow(a, Rounding::Nearest) => {
                let drops_bits = self.node(*a).format.frac > node.format.frac;
                if drops_bits { width } else { 0.0 }
            }
            Operation::Add(..) | Operation::Subtract(..) | Operation::Choose { .. } => width,
            Operation::Absolute(_) => 2.0 * width,
            // The comparison of the same two values serves the other one as well.
            Operation::Minimum(..) => width,
            Operation::Maximum(..) => 2.0 * width,
            Operation::Less(a, b) => f64::from(width_of(a).max(width_of(b))),
            Operation::NonZero(a) => f64::from(width_of(a)) / 3.0,
            Operation::Multiply(a, b) => cells_of_product(self.node(*a), self.node(*b)),
            Operation::Normalise { word, by_pairs } => {
                let stages = normalising_shifts(width_of(word), *by_pairs).len();
                width * (stages as f64 + 0.5)
            }
            Operation::ShiftLeft(_, places) | Operation::ShiftRight(_, places) => {
                width * f64::from(width_of(places))
            }
            Operation::Lookup { words, .. } => width * words.len().div_ceil(WORDS_OF_CELL) as f64,
            Operation::Polynomial(_, approximation) => {
                approximation.polynomials.as_deref().map_or(0.0, cells_of_polynomials)
            }
        }
    }

    /// Returns the number of products that a node computes. A table of polynomials of degree 2 computes two.
    pub fn products(&self, id: NodeId) -> usize {
        match &self.node(id).operation {
            Operation::Multiply(..) => 1,
            Operation::Polynomial(_, approximation) => {
                approximation.polynomials.as_deref().map_or(0, Piecewise::degree)
            }
            _ => 0,
        }
    }
}

/// Returns the look-up tables for the bits of two factors that a multiplier does not have.
fn cells_of_product(a: &PlanNode, b: &PlanNode) -> f64 {
    let signed_width = |node: &PlanNode| node.format.width() + u32::from(!node.format.signed);
    let [a, b] = [a, b].map(signed_width);
    let excess = |own: u32, other: u32| f64::from(own.saturating_sub(FACTOR_BITS) * other);
    CELLS_OF_BIT_PAIR * (excess(a, b) + excess(b, a))
}

/// Returns the look-up tables of a table of coefficients and of the sums.
fn cells_of_polynomials(it: &Piecewise) -> f64 {
    let sums: u32 = it.sums[..it.degree()].iter().map(|sum| sum.width()).sum();
    it.rom_cells() + f64::from(sums)
}

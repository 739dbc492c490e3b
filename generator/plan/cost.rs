//! Estimates the area of a plan, so that the planner can choose among several plans for the same formulas.
//!
//! The unit is the look-up table of four inputs. An adder, a choice and a comparison take one for each bit. A table of
//! polynomials takes one for each 16 words of a bit, and more for the sums of Horner's rule. Products take multipliers, and
//! look-up tables only for the bits that exceed a multiplier of 18 by 18 bits.

use super::memory::TableMemory;
use super::node::{NodeId, Operation, PlanNode, normalising_shifts};
use super::plan::ExpressionPlan;
use std::collections::HashMap;
use std::sync::Arc;

use glint_approximate::{Piecewise, TargetFunction};
use glint_base::fixed::{Format, Rounding};

/// The number of words of one bit that a look-up table can store.
const WORDS_OF_CELL: usize = 16;

/// The number of bits of a multiplier's input.
const FACTOR_BITS: u32 = 18;

/// The look-up tables for each degree of a polynomial: the sum, and the delays of values that wait for it.
const CELLS_OF_A_DEGREE: f64 = 50.0;

/// The look-up tables for each octave that has its own length of segments: a row of muxes that select the bits of the offset.
const CELLS_OF_AN_OCTAVE: f64 = 12.0;

/// The largest table in bits that stays in look-up tables on most families. A larger one goes into a block memory, which
/// delivers a word too late for 150 MHz.
const MOST_BITS_OF_FAST_TABLE: u64 = 2048;

/// The extra cost, in look-up tables, of a table that goes into a block memory.
const CELLS_IN_PLACE_OF_BLOCK: f64 = 300.0;

/// The look-up tables for each bit of a table's value, before the polynomials are known.
const CELLS_OF_A_TABLE_BIT: f64 = 12.0;

/// The bits of a block memory, if block memories are to be used.
const BITS_OF_A_BLOCK: u64 = 1 << 14;

/// The cost of a block memory in look-up tables, if block memories are to be used.
const CELLS_OF_A_BLOCK: f64 = 30.0;

/// The look-up tables for each pair of bits that exceeds the multiplier.
const CELLS_OF_BIT_PAIR: f64 = 1.5;

impl ExpressionPlan {
    /// Returns an estimate of the number of look-up tables of four inputs that the whole plan takes. Nodes with the same value count once,
    /// because the hardware computes such a value once.
    pub(super) fn total_cells(&self) -> f64 {
        let first = self.first_of_equal_nodes();
        let different = (0..self.nodes().len()).map(NodeId).filter(|node| first[node.0] == *node);
        different.map(|node| self.cells(node)).sum()
    }

    /// Returns for each node the first node that certainly has the same value: the node itself, or an earlier one that computes the same
    /// function of the same inputs.
    pub(super) fn first_of_equal_nodes(&self) -> Vec<NodeId> {
        let mut first: Vec<NodeId> = Vec::with_capacity(self.nodes().len());
        let mut by_inputs: HashMap<(Format, Vec<NodeId>), Vec<NodeId>> = HashMap::new();
        for (at, node) in self.nodes().iter().enumerate() {
            let inputs: Vec<NodeId> =
                node.operation.inputs().iter().map(|input| first[input.0]).collect();
            let earlier = by_inputs.entry((node.format, inputs)).or_default();
            let is_operand = matches!(node.operation, Operation::Operand(_));
            let equal = earlier.iter().find(|other| self.node(**other).is_alike(node));
            match equal {
                Some(equal) if !is_operand => first.push(*equal),
                _ => {
                    earlier.push(NodeId(at));
                    first.push(NodeId(at));
                }
            }
        }
        first
    }

    /// Returns an estimate of the number of look-up tables of four inputs that a node takes. The number is 0 for an operand, a
    /// constant, an operation that only selects bits, a comparison `a < 0`, and a function whose polynomials are not known yet.
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
            | Operation::Reverse(_)
            | Operation::Places(_) => 0.0,
            Operation::Narrow(a, Rounding::Nearest) => {
                let drops_bits = self.node(*a).format.frac > node.format.frac;
                if drops_bits { width } else { 0.0 }
            }
            Operation::Add(..) | Operation::Subtract(..) | Operation::Choose { .. } => width,
            Operation::Absolute(_) => 2.0 * width,
            // A maximum of the same two values uses the comparison of the minimum.
            Operation::Minimum(..) => width,
            Operation::Maximum(..) => 2.0 * width,
            // The sign bit says whether a number is below 0.
            Operation::Less(_, b) if self.is_zero(*b) => 0.0,
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
                let found = approximation.polynomials.as_ref();
                let cells =
                    |found| cells_of_function(&approximation.function, found, self.memory());
                found.map_or(0.0, cells)
            }
        }
    }

    fn is_zero(&self, id: NodeId) -> bool {
        matches!(self.node(id).operation, Operation::Constant { raw: 0, .. })
    }

    pub(super) fn count_products(&self) -> usize {
        (0..self.nodes().len()).map(|at| self.products(NodeId(at))).sum()
    }

    /// Returns the number of products that a node computes. For example, a table of polynomials of degree 2 computes two.
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

impl ExpressionPlan {
    /// Returns an estimate of the number of look-up tables that the plan takes, before its polynomials are known.
    pub(super) fn cells_without_polynomials(&self) -> f64 {
        let mut cells = self.total_cells();
        for node in self.nodes() {
            if matches!(node.operation, Operation::Polynomial(..)) {
                cells += CELLS_OF_A_TABLE_BIT * f64::from(node.format.width());
            }
        }
        cells
    }

    /// Returns the factors of products that have more bits than a multiplier's input.
    pub(super) fn wide_factors(&self) -> Vec<NodeId> {
        let mut wide = Vec::new();
        for node in self.nodes() {
            if let Operation::Multiply(a, b) = node.operation {
                let widths = factor_widths(self.node(a), self.node(b));
                for (factor, width) in [a, b].into_iter().zip(widths) {
                    if width > FACTOR_BITS {
                        wide.push(factor);
                    }
                }
            }
        }
        wide
    }
}

/// Returns the bits of both factors of a product. If one factor has a sign, the multiplier takes signed numbers, and the other factor gets
/// a bit for its sign.
fn factor_widths(a: &PlanNode, b: &PlanNode) -> [u32; 2] {
    let has_sign = a.format.signed || b.format.signed;
    [a, b].map(|node| node.format.width() + u32::from(has_sign && !node.format.signed))
}

/// Returns the number of look-up tables for the bits of two factors that exceed a multiplier.
fn cells_of_product(a: &PlanNode, b: &PlanNode) -> f64 {
    let [a, b] = factor_widths(a, b);
    let excess = |own: u32, other: u32| f64::from(own.saturating_sub(FACTOR_BITS) * other);
    CELLS_OF_BIT_PAIR * (excess(a, b) + excess(b, a))
}

/// Returns an estimate of the number of look-up tables that a function takes in a pipeline, including the operations of its
/// range reduction. The estimate is infinite if one of these operations has too many bits.
pub(super) fn cells_of_function(
    function: &TargetFunction,
    found: &Arc<Piecewise>,
    memory: TableMemory,
) -> f64 {
    if found.reduction.is_some() {
        let plan = ExpressionPlan::of_function(function, found);
        return match plan {
            Ok(plan) => plan.with_memory(memory).total_cells(),
            Err(_) => f64::INFINITY,
        };
    }
    let is_in_block = found.rom_bits() > MOST_BITS_OF_FAST_TABLE;
    let of_table = match memory {
        TableMemory::Logic if is_in_block => found.rom_cells() + CELLS_IN_PLACE_OF_BLOCK,
        TableMemory::Block if is_in_block => {
            CELLS_OF_A_BLOCK * found.rom_bits().div_ceil(BITS_OF_A_BLOCK) as f64
        }
        _ => found.rom_cells(),
    };
    let of_degree = CELLS_OF_A_DEGREE * found.degree() as f64;
    let of_octaves = CELLS_OF_AN_OCTAVE * f64::from(found.segments.octaves);
    of_table + of_degree + of_octaves
}

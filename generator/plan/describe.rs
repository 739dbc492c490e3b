//! Describes in words what the nodes of a plan compute, for pages that people read.

use super::node::{Approximation, NodeId, Operation};
use super::plan::ExpressionPlan;
use glint_approximate::Curve;
use glint_base::fixed::Rounding;

impl ExpressionPlan {
    /// Returns a phrase about the computation of a node, in terms of the names of other nodes. For example, `the size of x`, `a
    /// · b`, or `1 / x for x = mantissa, by 16 polynomials of degree 2, 39 bits each`.
    pub fn words(&self, id: NodeId) -> String {
        let name = |id: &NodeId| self.reference(*id);
        match &self.node(id).operation {
            Operation::Operand(_) => "an operand".to_owned(),
            Operation::Constant { .. } => "a constant".to_owned(),
            Operation::Add(a, b) => format!("{} + {}", name(a), name(b)),
            Operation::Subtract(a, b) => format!("{} − {}", name(a), name(b)),
            Operation::Multiply(a, b) if a == b => format!("{}²", name(a)),
            Operation::Multiply(a, b) => format!("{} · {}", name(a), name(b)),
            Operation::Absolute(a) => format!("the size of {}", name(a)),
            Operation::Minimum(a, b) => format!("the smaller of {} and {}", name(a), name(b)),
            Operation::Maximum(a, b) => format!("the larger of {} and {}", name(a), name(b)),
            Operation::Less(a, b) => format!("1 where {} < {}", name(a), name(b)),
            Operation::NonZero(a) => format!("1 where {} is not 0", name(a)),
            Operation::Choose { condition, cases: [zero, one] } => {
                format!("{} where {} is 1, else {}", name(one), name(condition), name(zero))
            }
            Operation::Scale(a) if self.node(id).deviation > 0.0 => {
                format!("{}, whose constants are rounded", name(a))
            }
            Operation::Scale(a) => format!("{} times a power of two", name(a)),
            Operation::Narrow(a, Rounding::Nearest) => format!("{}, rounded to nearest", name(a)),
            Operation::Narrow(a, Rounding::Truncate) => format!("{}, without low bits", name(a)),
            Operation::Middle(a) => format!("{}, its low bits replaced by a 1", name(a)),
            Operation::Bit(a, number) => format!("bit {number} of {}", name(a)),
            Operation::IntegerPart(a) => format!("the integer part of {}", name(a)),
            Operation::FractionPart(a, _) => format!("the fraction of {}", name(a)),
            Operation::Normalise { word, .. } => {
                format!("{} without its leading zeros", name(word))
            }
            Operation::Places(normalised) => format!("the leading zeros of {}", name(normalised)),
            Operation::ShiftLeft(a, places) => format!("{} · 2^{}", name(a), name(places)),
            Operation::ShiftRight(a, places) => format!("{} / 2^{}", name(a), name(places)),
            Operation::Reverse(a) => format!("{} with its bits reversed", name(a)),
            Operation::Lookup { address, words } => {
                format!("one of {} constants, by {}", words.len(), name(address))
            }
            Operation::Polynomial(a, approximation) => table_words(approximation, &name(a)),
        }
    }

    /// Returns the text by which other nodes refer to a node: the value of a constant, and the name of any other node.
    fn reference(&self, id: NodeId) -> String {
        let node = self.node(id);
        match node.operation {
            Operation::Constant { raw, .. } => node.format.to_f64(raw).to_string(),
            _ => node.name.clone(),
        }
    }
}

/// The most parts of a formula that is written out.
const MOST_PARTS: u32 = 200;

/// Returns a phrase with the function of a table and the size of the table. `operand` is the name of the function's operand.
fn table_words(approximation: &Approximation, operand: &str) -> String {
    let function = match &approximation.function.curve {
        Curve::Formula(formula) if formula.size() > MOST_PARTS => {
            format!("a function of x with {} parts", formula.size())
        }
        Curve::Formula(formula) => formula.python(),
        Curve::Samples(_) => "samples".to_owned(),
    };
    let Some(found) = &approximation.polynomials else {
        return format!("{function} for x = {operand}");
    };
    let words = found.words.len();
    let bits = found.rom_bits() / words as u64;
    let degree = found.degree();
    format!(
        "{function} for x = {operand}, by {words} polynomials of degree {degree}, {bits} bits each"
    )
}

//! Narrows factors of a plan, so that the multiplier of a unit fits one multiplier block.
//!
//! A table of reciprocals of fractions from 1/2 on has values from 1 to 2. The value 2 alone needs the top bit, and a sign makes the factor one
//! bit wider than the other factors. With v = 1 + r, the product v · b is b + r · b, and r has one bit less than v. Its bits are bits of v.

use glint_base::interval::Interval;

use crate::node::{NodeId, Operation, PlanNode};
use crate::plan::{ExpressionPlan, PlanBuilder};
use crate::refusal::PlanRefusal;

/// The widest factor of a multiplier block without its sign. The blocks of ECP5, Gowin and Nexus have 18 bits with the sign.
const WIDEST_FACTOR: u32 = 17;

/// A table with more operands is not searched for its smallest and its largest value.
const MOST_OPERANDS: i64 = 1 << 18;

/// Returns a plan with the same results, in which factors from tables are as narrow as [this module](self) describes.
///
/// # Errors
/// Fails if an operation has too many bits.
pub(super) fn with_narrow_factors(plan: &ExpressionPlan) -> Result<ExpressionPlan, PlanRefusal> {
    let mut narrow = PlanBuilder::like(plan);
    let mut nodes: Vec<NodeId> = Vec::with_capacity(plan.nodes().len());
    for node in plan.nodes() {
        let by_table = match node.operation {
            Operation::Multiply(a, b) if has_wide_top(plan, a) => Some([a, b]),
            Operation::Multiply(a, b) if has_wide_top(plan, b) => Some([b, a]),
            _ => None,
        };
        nodes.push(match by_table {
            Some(factors) => {
                let factors = factors.map(|factor| nodes[factor.0]);
                product_of_rest(&mut narrow, node, factors)?
            }
            None => {
                let operation = node.operation.with_inputs(&|input: NodeId| nodes[input.0]);
                narrow.push_copy(node, operation)
            }
        });
    }
    for (result, proved) in plan.results().iter().zip(plan.proved()) {
        narrow.add_result(nodes[result.0], nodes[proved.0]);
    }
    narrow.finish()
}

/// Returns whether a factor is too wide for a multiplier block, and only its largest value needs the top bit.
fn has_wide_top(plan: &ExpressionPlan, factor: NodeId) -> bool {
    let format = plan.node(factor).format;
    if format.signed || format.width() <= WIDEST_FACTOR {
        return false;
    }
    let half = 1i128 << (format.width() - 2);
    table_values(plan, factor).is_some_and(|(least, most)| least >= half && most == 2 * half)
}

/// Returns the smallest and the largest raw value in a table of polynomials, for a node that reads the table, or that only moves
/// the binary point of its value. Returns `None` for other nodes, and for a table of more than 2^18 entries.
pub(super) fn table_values(plan: &ExpressionPlan, node: NodeId) -> Option<Interval> {
    match &plan.node(node).operation {
        Operation::Scale(before) => table_values(plan, *before),
        Operation::Polynomial(_, approximation) => {
            let polynomials = approximation.polynomials.as_ref()?;
            let (first, last) = polynomials.domain;
            if last - first >= MOST_OPERANDS {
                return None;
            }
            let values = || (first..=last).map(|raw| i128::from(polynomials.result(raw)));
            Some((values().min()?, values().max()?))
        }
        _ => None,
    }
}

/// Adds a product v · b as b + r · b, where v is 1 + r in units of half of the largest v, and returns its node in the format of `product`.
fn product_of_rest(
    plan: &mut PlanBuilder,
    product: &PlanNode,
    [v, b]: [NodeId; 2],
) -> Result<NodeId, PlanRefusal> {
    let PlanNode { format, ref name, .. } = *plan.node(v);
    let (name, width) = (name.clone(), format.width() as i32);
    let integer = plan.scale(&format!("{name}_integer"), v, format.frac)?;
    let top = plan.bit(&format!("{name}_top"), integer, format.width() - 1)?;
    let above = plan.scale(&format!("{name}_above"), top, width - 2)?;
    let halves = plan.scale(&format!("{name}_halves"), integer, 2 - width)?;
    let [_, fraction] = plan.split(&format!("{name}_halves"), halves)?;
    let below = plan.scale(&format!("{name}_below"), fraction, width - 2)?;
    let rest = plan.add(&format!("{name}_rest"), above, below)?;
    let rest = plan.scale(&format!("{name}_rest"), rest, -format.frac)?;
    let of_rest = plan.multiply(&product.name, rest, b)?;
    let of_one = plan.scale(&format!("{}_of_one", product.name), b, width - 2 - format.frac)?;
    let sum = plan.add(&format!("{}_sum", product.name), of_one, of_rest)?;
    plan.low_bits(&format!("{}_kept", product.name), sum, product.format)
}

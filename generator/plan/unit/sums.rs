//! Writes the result of a function as a sum ±v + base, so that one adder of a unit can compute the results of all functions.
//!
//! For example, a result that rounds v to the nearest has half a unit as base, and the angle of a direction in one of eight octants has a
//! base and a sign for each octant.

use glint_base::fixed::Rounding;

use crate::mirror::MirrorChain;
use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;

/// A result ±v + base, without its fraction bits below the result's last bit.
#[derive(Clone, Debug)]
pub(super) struct ResultSum {
    /// The node of v, which may have more fraction bits.
    pub(super) value: NodeId,
    /// The sign is negative if an odd number of these nodes is 1.
    pub(super) conditions: Vec<NodeId>,
    /// The constant part of the base for each combination of the conditions, in units of the result's last bit times 2 to the power of
    /// −`frac`. Bit 0 of the index is the first condition.
    pub(super) bases: Vec<i128>,
    /// A node that is another part of the base.
    pub(super) addend: Option<NodeId>,
    /// The number of fraction bits of v and of the base below the result's last bit.
    pub(super) frac: i32,
}

impl ResultSum {
    /// Returns a result of a plan as a sum.
    pub(super) fn of(plan: &ExpressionPlan, result: NodeId) -> Self {
        let result_frac = plan.node(result).format.frac;
        let held = vec![false; plan.nodes().len()];
        if let Some(chain) = MirrorChain::ending_at(plan, result, &held)
            && chain.addend.is_none()
        {
            let frac = chain.fraction_bits(plan).max(result_frac);
            return Self {
                value: chain.start,
                conditions: chain.mirrors.iter().map(|mirror| mirror.condition).collect(),
                bases: chain.bases(plan, frac),
                addend: None,
                frac: frac - result_frac,
            };
        }
        let rounded = match plan.node(result).operation {
            Operation::Narrow(rounded, Rounding::Nearest) => rounded,
            _ => result,
        };
        let is_rounded = plan.node(rounded).format.frac > result_frac;
        let before_rounding = if is_rounded { rounded } else { result };
        let (value, addend) = match plan.node(before_rounding).operation {
            // The last bit of the addend has at least the weight of the result's last bit.
            Operation::Add(addend, value) if plan.node(addend).format.frac <= result_frac => {
                (value, Some(addend))
            }
            _ => (before_rounding, None),
        };
        // Below the last bit of the result, only the half unit of v matters.
        let (bases, frac) = if is_rounded { (vec![1], 1) } else { (vec![0], 0) };
        Self { value, conditions: Vec::new(), bases, addend, frac }
    }

    /// Returns whether the result needs an adder.
    pub(super) fn has_adder(&self) -> bool {
        !self.conditions.is_empty() || self.addend.is_some() || self.bases != [0]
    }
}

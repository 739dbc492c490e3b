//! Defines the plan of an expression. A [`PlanBuilder`] makes a plan, and nothing changes it afterwards.

mod builder;
mod consistency;

pub(super) use builder::PlanBuilder;

use glint_base::fixed::Format;
use glint_formula::Enclosure;

use super::memory::TableMemory;
use super::node::{Approximation, NodeId, Operation, PlanNode};

/// The limits of a node's value before the rewriting of the formula has stated any.
const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

/// The plan of an expression: a list of fixed-point operations that computes all results.
#[derive(Clone, Debug, Default)]
pub struct ExpressionPlan {
    nodes: Vec<PlanNode>,
    results: Vec<NodeId>,
    proved: Vec<NodeId>,
    is_shared: bool,
    memory: TableMemory,
}

impl ExpressionPlan {
    /// Returns the operations. Each reads only operations before it.
    pub fn nodes(&self) -> &[PlanNode] {
        &self.nodes
    }

    /// Returns the node of each result, in the order of the statement.
    pub fn results(&self) -> &[NodeId] {
        &self.results
    }

    /// Returns for each result the node whose error is proved. This is the node in [`Self::results`], except for a result that
    /// wraps: for such a result it is the node before the high bits are dropped.
    pub fn proved(&self) -> &[NodeId] {
        &self.proved
    }

    /// Returns whether several functions share the operations, so that an opcode selects their inputs.
    pub fn is_shared(&self) -> bool {
        self.is_shared
    }

    /// Returns the memory for the tables of polynomials. The estimates of look-up tables depend on it.
    pub(super) fn memory(&self) -> TableMemory {
        self.memory
    }

    /// Returns the plan with its tables in `memory`.
    pub(super) fn with_memory(self, memory: TableMemory) -> Self {
        Self { memory, ..self }
    }

    /// Returns a copy of the plan with another operation in place of a node's, for tests that plant faults.
    #[cfg(test)]
    pub(super) fn with_fault(&self, id: NodeId, operation: Operation) -> Self {
        let mut plan = self.clone();
        plan.nodes[id.0].operation = operation;
        plan
    }

    /// Returns the node with this index.
    pub fn node(&self, id: NodeId) -> &PlanNode {
        &self.nodes[id.0]
    }

    /// Returns for each node whether the proved value of result number `result` depends on it.
    pub fn needed_for(&self, result: usize) -> Vec<bool> {
        self.needed_by(self.proved[result])
    }

    /// Returns for each node whether the node `id` depends on it. A node depends on itself.
    pub(super) fn needed_by(&self, id: NodeId) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        needed[id.0] = true;
        for at in (0..self.nodes.len()).rev() {
            if needed[at] {
                for input in self.nodes[at].operation.inputs() {
                    needed[input.0] = true;
                }
            }
        }
        needed
    }

    /// Returns for each node whether the hardware of a result reads it. Operands count as read, because they are ports.
    ///
    /// A node can be without a reader. For example, nothing reads the places of a shift if the function covers one octave and
    /// needs no shift back.
    pub fn read_nodes(&self) -> Vec<bool> {
        let mut is_read = vec![false; self.nodes.len()];
        for result in &self.results {
            is_read[result.0] = true;
        }
        for at in (0..self.nodes.len()).rev() {
            let operation = &self.nodes[at].operation;
            is_read[at] |= matches!(operation, Operation::Operand(_));
            if is_read[at] {
                for input in operation.hardware_inputs() {
                    is_read[input.0] = true;
                }
            }
        }
        is_read
    }

    /// Returns the widths of the two inputs of one multiplier that can compute all products of the plan, including the products
    /// in polynomials. If any factor has a sign, both widths have room for one.
    pub(super) fn multiplier_widths(&self) -> [u32; 2] {
        let mut factors: Vec<[Format; 2]> = Vec::new();
        for node in &self.nodes {
            match &node.operation {
                Operation::Multiply(a, b) => {
                    factors.push([self.node(*a).format, self.node(*b).format]);
                }
                Operation::Polynomial(a, approximation) => {
                    let Some(found) = &approximation.polynomials else { continue };
                    let operand = Format { signed: true, ..self.node(*a).format };
                    factors.extend(found.sums.iter().skip(1).map(|sum| [*sum, operand]));
                }
                _ => {}
            }
        }
        let is_signed = factors.iter().flatten().any(|factor| factor.signed);
        let mut widths = [0; 2];
        for pair in factors {
            for (width, factor) in widths.iter_mut().zip(pair) {
                let with_sign = factor.width() + u32::from(is_signed && !factor.signed);
                *width = with_sign.max(*width);
            }
        }
        widths
    }

    /// Returns the prefix of the names of all nets that belong to a node's table: the name of the node and an underscore, so
    /// that each table has nets of its own. The prefix is empty in a plan with the single operand `x` and a single table.
    pub fn table_prefix(&self, id: NodeId) -> String {
        let mut operands = Vec::new();
        for node in &self.nodes {
            if matches!(node.operation, Operation::Operand(_)) {
                operands.push(node.name.as_str());
            }
        }
        let is_single = operands == ["x"] && self.approximations().len() == 1;
        if is_single { String::new() } else { format!("{}_", self.node(id).name) }
    }

    /// Returns the names of the registers for a node's polynomial. The first register is for the polynomial itself, and the
    /// others are for the partial sums of Horner's rule. For example, a node `curve` has `curve`, `curve_sum1` and
    /// `curve_sum2`.
    pub fn sum_names(&self, id: NodeId) -> [String; 3] {
        let prefix = self.table_prefix(id);
        [self.node(id).name.clone(), format!("{prefix}sum1"), format!("{prefix}sum2")]
    }

    /// Returns the name of the register for the highest coefficient of a node's polynomial.
    pub fn highest_name(&self, id: NodeId) -> String {
        format!("{}highest", self.table_prefix(id))
    }

    /// Returns whether a − b inverts the bits of b, because a is a constant whose bits are all 1. For example, 7 − 2 is 5, and the
    /// bits of 2, which are 010, become 101.
    pub fn is_inversion(&self, a: NodeId, b: NodeId) -> bool {
        let [all, subtrahend] = [a, b].map(|id| self.node(id));
        let Operation::Constant { raw, .. } = all.operation else { return false };
        let (own, other) = (all.format, subtrahend.format);
        let are_unsigned = !own.signed && !other.signed;
        let is_as_wide = own.frac == other.frac && other.width() <= own.width();
        are_unsigned && is_as_wide && raw == own.max_raw()
    }

    /// Returns the number of the rounding operation that gives the node `id` its fraction bits, so that the planner can make a
    /// factor narrower. The operation is the node itself, or an earlier node whose bits the node only scales or limits. Returns
    /// `None` if the value is exact or has several inputs.
    pub(super) fn rounding_before(&self, id: NodeId) -> Option<usize> {
        let node = self.node(id);
        if node.source.is_some() && node.deviation == 0.0 {
            return node.source;
        }
        let before = match node.operation {
            Operation::Scale(a) | Operation::Narrow(a, _) | Operation::Absolute(a) => a,
            Operation::Maximum(a, b) | Operation::Minimum(a, b) => {
                let is_constant =
                    |id: NodeId| matches!(self.node(id).operation, Operation::Constant { .. });
                match (is_constant(a), is_constant(b)) {
                    (false, true) => a,
                    (true, false) => b,
                    _ => return None,
                }
            }
            _ => return None,
        };
        self.rounding_before(before)
    }

    /// Returns for each node how often operations read it. A square counts its input twice.
    pub fn readers(&self) -> Vec<usize> {
        let mut readers = vec![0; self.nodes.len()];
        for node in &self.nodes {
            for input in node.operation.inputs() {
                readers[input.0] += 1;
            }
        }
        readers
    }

    /// Returns the functions that the plan computes by tables of polynomials, in the order of their nodes.
    pub fn approximations(&self) -> Vec<&Approximation> {
        let mut all = Vec::new();
        for node in &self.nodes {
            if let Operation::Polynomial(_, approximation) = &node.operation {
                all.push(&**approximation);
            }
        }
        all
    }
}

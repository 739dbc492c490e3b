//! Proves that the merged plan of a unit has the results of each function's own plan, for all operands.
//!
//! The proof goes through the nodes of a function's plan in their order, each with its node of the merged plan. If the inputs of
//! a node have the right values in the merged plan, so has the node itself in these cases:
//!
//! - The merged plan has the same operation on the nodes of the inputs.
//! - Both nodes are products of equal factors.
//! - Both values are equal for every combination of the inputs' values. For sums and roundings of a long input, two periods are
//!   enough ([`super::periods`]).
//!
//! The opcode is a constant in the proof, so that a choice by the opcode is the case that it selects. Low bits that no reader of
//! a node needs do not count. Combinations count whether or not their values can occur together. Values may differ only where a
//! value of the function alone exceeds its format, which the proof of the function's error excludes.

use glint_base::fixed::Rounding;
use glint_base::interval::{self, Interval};

use super::factors::table_values;
use super::periods::{all_fit, fit_before_end, period_bits};
use super::unread::{bits_unread_by, unread_bits};
use crate::node::{NodeId, Operation};
use crate::plan::ExpressionPlan;

/// The plan of a function, and where its values are in the merged plan.
#[derive(Clone, Debug)]
pub(super) struct MergedFunction {
    /// The plan of the function, with narrow factors.
    pub(super) plan: ExpressionPlan,
    /// For each node of the plan, the node of the merged plan; `None` for a polynomial that the merged plan reads with another one.
    pub(super) merged: Vec<Option<NodeId>>,
}

/// The most combinations of values for which the proof computes a node, in a unit of a user.
pub(super) const MOST_COMBINATIONS: u128 = 1 << 22;

/// The outcome of the proof that a unit has the results of one of its functions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UnitEquality {
    /// The results are equal for all operands. The number counts the combinations of values that were computed.
    Proved { combinations: u64 },
    /// The proof fails at the node with this name. The results may still be equal.
    Open { node: String },
}

/// The proof for one function.
pub(super) struct FunctionProof<'u> {
    merged: &'u ExpressionPlan,
    own: &'u MergedFunction,
    /// The values of the merged nodes that depend on the opcode alone.
    constants: Vec<Option<i128>>,
    /// For each node of the function's plan, the number of low bits in which the merged node may differ.
    unequal_bits: Vec<i32>,
    /// The most combinations of values for which the proof computes a node.
    most_combinations: u128,
    combinations: u64,
}

/// Two nodes whose values are compared.
#[derive(Clone, Copy)]
struct NodeComparison {
    /// The nodes of the function's plan before this index are proved.
    end: usize,
    own: NodeId,
    merged: NodeId,
    /// The number of low bits that do not count.
    unread: i32,
}

/// The nodes from which two values are computed: the nodes of the function's plan that the values depend on, and the nodes between.
struct Cones {
    inputs: Vec<ConeInput>,
    own: Vec<NodeId>,
    merged: Vec<NodeId>,
}

/// A proved node of the function's plan, from which a value is computed.
struct ConeInput {
    node: NodeId,
    /// The nodes of the merged plan with the same raw value.
    merged: Vec<NodeId>,
}

impl<'u> FunctionProof<'u> {
    pub(super) fn new(
        merged: &'u ExpressionPlan,
        own: &'u MergedFunction,
        opcode: usize,
        most_combinations: u128,
    ) -> Self {
        let mut proof = Self {
            merged,
            own,
            constants: Vec::new(),
            unequal_bits: vec![0; own.plan.nodes().len()],
            most_combinations,
            combinations: 0,
        };
        for at in 0..merged.nodes().len() {
            let constant = proof.constant(NodeId(at), opcode as i64);
            proof.constants.push(constant);
        }
        proof
    }

    /// Proves the nodes that the results read, and the results. `word` gives the word of a result at its port, from its number and its raw
    /// value in the function's plan; a function may have fewer results than the unit. `operand` gives the raw value of an operand, from its
    /// number and the word at its port.
    pub(super) fn prove(
        mut self,
        operand: &dyn Fn(usize, i128) -> i128,
        word: &dyn Fn(usize, i128) -> i128,
    ) -> UnitEquality {
        let own = &self.own.plan;
        let is_read = own.read_nodes();
        for at in (0..own.nodes().len()).filter(|at| is_read[*at]) {
            let node = NodeId(at);
            let Some(merged) = self.own.merged[at] else { continue };
            let is_proved = match own.node(node).operation {
                Operation::Operand(number) => {
                    self.is_operand(node, merged, &|word| operand(number, word))
                }
                _ => self.is_equal(node, merged),
            };
            if !is_proved {
                return self.open(node);
            }
        }
        for (number, merged) in self.merged.results().to_vec().into_iter().enumerate() {
            let is_proved = match own.results().get(number) {
                Some(result) => self.is_result(*result, merged, &|raw| word(number, raw)),
                None => self.constants[merged.0] == Some(0),
            };
            if !is_proved {
                return self.open(own.results().get(number).copied().unwrap_or(NodeId(0)));
            }
        }
        UnitEquality::Proved { combinations: self.combinations }
    }

    /// Returns for each node of the merged plan whether the function reads it.
    pub(super) fn read_nodes(&self) -> Vec<bool> {
        let mut is_read = vec![false; self.merged.nodes().len()];
        let mut open = self.merged.results().to_vec();
        while let Some(node) = open.pop() {
            if !is_read[node.0] {
                is_read[node.0] = true;
                open.extend(self.merged_inputs(node));
            }
        }
        is_read
    }

    fn open(&self, node: NodeId) -> UnitEquality {
        UnitEquality::Open { node: self.own.plan.node(node).name.clone() }
    }

    /// Returns the value of a node of the merged plan if it depends on the opcode alone. All nodes before it must have their
    /// entries in `constants`.
    fn constant(&self, id: NodeId, opcode: i64) -> Option<i128> {
        let node = self.merged.node(id);
        match node.operation {
            Operation::Operand(number) => (number == 0).then_some(opcode.into()),
            Operation::Polynomial(..) => None,
            _ => {
                let inputs = self.merged_inputs(id);
                if inputs.iter().any(|input| self.constants[input.0].is_none()) {
                    return None;
                }
                let known = |input: NodeId| self.constants[input.0].unwrap_or(0);
                Some(self.merged.value(id, &[opcode], &known))
            }
        }
    }

    /// Returns the nodes on which the value of a node of the merged plan depends, with the known opcode.
    fn merged_inputs(&self, id: NodeId) -> Vec<NodeId> {
        if self.constants.get(id.0).is_some_and(Option::is_some) {
            return Vec::new();
        }
        if let Operation::Choose { condition, cases } = self.merged.node(id).operation
            && let Some(chosen) = self.constants[condition.0]
        {
            return vec![cases[chosen as usize]];
        }
        value_inputs(self.merged, id)
    }

    /// Returns whether the merged node has the value of an operand, for each word at the port.
    fn is_operand(&mut self, own: NodeId, merged: NodeId, value: &dyn Fn(i128) -> i128) -> bool {
        let Operation::Operand(number) = self.own.plan.node(own).operation else { return false };
        let mut cone = Vec::new();
        let mut port = None;
        let mut open = vec![merged];
        while let Some(node) = open.pop() {
            if cone.contains(&node) || self.constants[node.0].is_some() {
                continue;
            }
            cone.push(node);
            if let Operation::Operand(of_unit) = self.merged.node(node).operation {
                // Operand 0 of the unit is the opcode.
                if of_unit != number + 1 {
                    return false;
                }
                port = Some(node);
            }
            open.extend(self.merged_inputs(node));
        }
        cone.sort_by_key(|node| node.0);
        let Some(port) = port else { return false };
        if self.merged.node(merged).format != self.own.plan.node(own).format {
            return false;
        }
        let (first, last) = self.merged.node(port).format.range();
        if last - first >= self.most_combinations.cast_signed() {
            // The low bits of a word, in the format of the operand.
            return cone.iter().all(|node| {
                let operation = &self.merged.node(*node).operation;
                *node == port
                    || matches!(operation, Operation::Scale(_))
                    || matches!(operation, Operation::Narrow(_, Rounding::Truncate))
            });
        }
        cone.retain(|node| *node != port);
        let mut values = self.known_values();
        for word in first..=last {
            values[port.0] = word;
            compute(self.merged, &cone, &mut values);
            self.combinations += 1;
            if values[merged.0] != value(word) {
                return false;
            }
        }
        true
    }

    /// Returns whether a node of the merged plan has the value of a node of the function's plan, apart from low bits that nothing reads.
    fn is_equal(&mut self, own: NodeId, merged: NodeId) -> bool {
        if self.is_copy(own, merged)
            && let Some(unequal) = self.unequal_bits_of_copy(own)
        {
            self.unequal_bits[own.0] = unequal;
            return true;
        }
        let [own_node, merged_node] = [self.own.plan.node(own), self.merged.node(merged)];
        if own_node.format.frac != merged_node.format.frac {
            return false;
        }
        if let Operation::Multiply(a, b) = own_node.operation {
            return self.is_product(own, merged, [a, b]);
        }
        let unread = unread_bits(&self.own.plan, own);
        [0, unread].into_iter().any(|unread| {
            self.unequal_bits[own.0] = unread;
            let nodes = NodeComparison { end: own.0, own, merged, unread };
            self.are_equal(nodes, &|own, merged| own >> unread == merged >> unread)
        })
    }

    /// Returns whether the merged node has the operation of the function's node, on the nodes of its inputs.
    fn is_copy(&self, own: NodeId, merged: NodeId) -> bool {
        let [own_node, merged_node] = [self.own.plan.node(own), self.merged.node(merged)];
        let own_inputs = own_node.operation.inputs();
        let inputs = merged_node.operation.inputs();
        let mut pairs = own_inputs.iter().zip(&inputs);
        // Equal words can have been shifted by different numbers of places.
        let is_places = matches!(own_node.operation, Operation::Places(_));
        !is_places
            && own_node.is_alike(merged_node)
            && own_inputs.len() == inputs.len()
            && pairs.all(|(own, merged)| self.own.merged[own.0] == Some(*merged))
    }

    /// Returns the number of low bits in which a node may differ from its copy in the merged plan. Returns `None` if low bits of
    /// an input can change the other bits.
    fn unequal_bits_of_copy(&self, own: NodeId) -> Option<i32> {
        let node = self.own.plan.node(own);
        let inputs = node.operation.inputs();
        let of_inputs = inputs.iter().map(|input| self.unequal_bits[input.0]).max().unwrap_or(0);
        match node.operation {
            _ if of_inputs == 0 => Some(0),
            Operation::Scale(_) => Some(of_inputs),
            Operation::Narrow(input, rounding) => {
                let dropped = self.own.plan.node(input).format.frac - node.format.frac;
                match rounding {
                    Rounding::Truncate => Some((of_inputs - dropped).max(0)),
                    // A rounding to the nearest reads the highest bit that it drops.
                    Rounding::Nearest => (of_inputs < dropped).then_some(0),
                }
            }
            _ => None,
        }
    }

    /// Returns whether the merged node has all bits of a product, whose factors have the values of the nodes `factors`.
    fn is_product(&mut self, own: NodeId, merged: NodeId, factors: [NodeId; 2]) -> bool {
        let range = self.own.plan.node(own).range;
        let mut product = merged;
        let [a, b] = loop {
            let node = self.merged.node(product);
            let is_kept = interval::fits(range, node.format);
            product = match node.operation {
                Operation::Multiply(a, b) => break [a, b],
                Operation::Scale(before) if is_kept => before,
                Operation::Narrow(before, _)
                    if is_kept && self.merged.node(before).format.frac == node.format.frac =>
                {
                    before
                }
                _ => return false,
            };
        };
        let same_raw = |own: i128, merged: i128| own == merged;
        let compared = |factor: NodeId, merged: NodeId| NodeComparison {
            end: own.0,
            own: factor,
            merged,
            unread: 0,
        };
        let mut have_values = |[first, second]: [NodeId; 2]| {
            self.are_equal(compared(first, a), &same_raw)
                && self.are_equal(compared(second, b), &same_raw)
        };
        have_values(factors) || have_values([factors[1], factors[0]])
    }

    fn is_result(&mut self, own: NodeId, merged: NodeId, word: &dyn Fn(i128) -> i128) -> bool {
        let end = self.own.plan.nodes().len();
        let nodes = NodeComparison { end, own, merged, unread: 0 };
        self.are_equal(nodes, &|own, merged| word(own) == merged)
    }

    /// Returns whether `compare` holds for the raw values of a node of the function's plan and of a node of the merged plan.
    /// Computes these for every combination of the values of proved nodes before them.
    fn are_equal(&mut self, nodes: NodeComparison, compare: &dyn Fn(i128, i128) -> bool) -> bool {
        let NodeComparison { own, merged, .. } = nodes;
        let Some(cones) = self.cones(nodes.end, own, merged) else { return false };
        let mut values_of_inputs = Vec::new();
        for input in &cones.inputs {
            let Some(values) = self.values_of(input, &cones) else { return false };
            values_of_inputs.push(values);
        }
        let count = |values: &[InputValues]| {
            values.iter().fold(1u128, |product, it| product.saturating_mul(it.count()))
        };
        let has_periods = count(&values_of_inputs) > self.most_combinations;
        if has_periods {
            for (input, values) in cones.inputs.iter().zip(&mut values_of_inputs) {
                if let Some(bits) = self.period_bits(input, &cones) {
                    values.keep_two_periods(bits + nodes.unread);
                }
            }
        }
        let combinations = count(&values_of_inputs);
        if combinations > self.most_combinations {
            return false;
        }
        let mut of_own = vec![0; self.own.plan.nodes().len()];
        let mut of_merged = self.known_values();
        for combination in 0..combinations {
            let mut rest = combination;
            for (input, values) in cones.inputs.iter().zip(&values_of_inputs) {
                let raw = values.get(rest % values.count());
                rest /= values.count();
                of_own[input.node.0] = raw;
                for merged in &input.merged {
                    of_merged[merged.0] = raw;
                }
            }
            compute(&self.own.plan, &cones.own, &mut of_own);
            compute(self.merged, &cones.merged, &mut of_merged);
            let is_equal = compare(of_own[own.0], of_merged[merged.0]);
            let are_whole = !has_periods
                || all_fit(&self.own.plan, &cones.own, &of_own)
                    && fit_before_end(self.merged, merged, &cones.merged, &of_merged);
            if !are_whole || !is_equal && fit_formats(&self.own.plan, &cones.own, &of_own) {
                return false;
            }
        }
        self.combinations += combinations as u64;
        true
    }

    /// Returns k if both cones have the period 2^k in an input ([`super::periods`]); `None` if a cone has no period.
    fn period_bits(&self, input: &ConeInput, cones: &Cones) -> Option<i32> {
        let of_own = period_bits(&self.own.plan, &[input.node], &cones.own)?;
        let of_merged = period_bits(self.merged, &input.merged, &cones.merged)?;
        Some(of_own.max(of_merged))
    }

    /// Returns the values of the merged nodes that depend on the opcode alone, and 0 for the others.
    fn known_values(&self) -> Vec<i128> {
        self.constants.iter().map(|constant| constant.unwrap_or(0)).collect()
    }

    /// Returns the nodes from which a node of the function's plan and a node of the merged plan are computed. Returns `None` if the merged
    /// node reads a port.
    fn cones(&self, end: usize, own: NodeId, merged: NodeId) -> Option<Cones> {
        let mut inputs: Vec<ConeInput> = Vec::new();
        let mut merged_cone = Vec::new();
        let mut open = vec![merged];
        while let Some(node) = open.pop() {
            if merged_cone.contains(&node) || self.constants[node.0].is_some() {
                continue;
            }
            if let Some(own_node) = self.own_before(end, node) {
                match inputs.iter_mut().find(|input| input.node == own_node) {
                    Some(input) if input.merged.contains(&node) => {}
                    Some(input) => input.merged.push(node),
                    None => inputs.push(ConeInput { node: own_node, merged: vec![node] }),
                }
                continue;
            }
            if let Operation::Operand(_) = self.merged.node(node).operation {
                return None;
            }
            merged_cone.push(node);
            open.extend(self.merged_inputs(node));
        }
        let mut own_cone = Vec::new();
        let mut open = vec![own];
        while let Some(node) = open.pop() {
            let is_input = inputs.iter().any(|input| input.node == node);
            if own_cone.contains(&node) || is_input {
                continue;
            }
            match self.own.plan.node(node).operation {
                Operation::Operand(_) => inputs.push(ConeInput { node, merged: Vec::new() }),
                _ => {
                    own_cone.push(node);
                    open.extend(value_inputs(&self.own.plan, node));
                }
            }
        }
        own_cone.sort_by_key(|node| node.0);
        merged_cone.sort_by_key(|node| node.0);
        Some(Cones { inputs, own: own_cone, merged: merged_cone })
    }

    /// Returns the node of the function's plan before `end` whose raw value a merged node has, perhaps with another binary point.
    fn own_before(&self, end: usize, merged: NodeId) -> Option<NodeId> {
        let before = &self.own.merged[..end];
        let bits = self.without_scales(merged);
        let same = before.iter().position(|node| *node == Some(merged));
        let with_same_bits = || {
            before.iter().position(|node| node.is_some_and(|it| self.without_scales(it) == bits))
        };
        same.or_else(with_same_bits).map(NodeId)
    }

    /// Returns the merged node from which a node differs only by its binary point.
    fn without_scales(&self, mut merged: NodeId) -> NodeId {
        while let Operation::Scale(before) = self.merged.node(merged).operation {
            merged = before;
        }
        merged
    }

    /// Returns the values that an input can have. Returns `None` if a cone reads bits of the input in which the merged node may differ.
    fn values_of(&self, input: &ConeInput, cones: &Cones) -> Option<InputValues> {
        let ConeInput { node: input, ref merged } = *input;
        let node = self.own.plan.node(input);
        let mut dropped = bits_unread_by(&self.own.plan, input, &cones.own);
        for node in merged {
            dropped = dropped.min(bits_unread_by(self.merged, *node, &cones.merged));
        }
        if dropped < self.unequal_bits[input.0] {
            return None;
        }
        let mut range = table_values(&self.own.plan, input).unwrap_or(node.range);
        for reader in &cones.own {
            if let Operation::Polynomial(operand, approximation) =
                &self.own.plan.node(*reader).operation
                && *operand == input
            {
                // The function promises nothing for operands beyond the domain of its table.
                let (first, last) = approximation.function.domain;
                range = (range.0.max(first.into()), range.1.min(last.into()));
            }
        }
        let dropped = dropped.min(i32::try_from(node.format.width()).unwrap_or(0)) as u32;
        let range = (range.0 >> dropped, range.1 >> dropped);
        Some(InputValues { range, last: None, dropped })
    }
}

/// Computes the values of nodes, in their order, from the values of the nodes before them.
fn compute(plan: &ExpressionPlan, nodes: &[NodeId], values: &mut [i128]) {
    for node in nodes {
        values[node.0] = plan.value(*node, &[], &|input: NodeId| values[input.0]);
    }
}

/// Returns whether the values of nodes fit their formats. The proof of the function's error shows that they do, for all operands for which the
/// function promises a result. A fraction is the low bits of a number, and a choice can leave out a value that does not fit.
fn fit_formats(plan: &ExpressionPlan, nodes: &[NodeId], values: &[i128]) -> bool {
    let is_choice = |node: &NodeId| matches!(plan.node(*node).operation, Operation::Choose { .. });
    nodes.iter().any(is_choice)
        || nodes.iter().all(|node| {
            let value = plan.whole_value(*node, &[], &|input: NodeId| values[input.0]);
            let is_fraction = matches!(plan.node(*node).operation, Operation::FractionPart(..));
            is_fraction || plan.node(*node).format.holds(value)
        })
}

/// The raw values of an input that the proof computes: all multiples of a power of two within a range, and perhaps one more.
struct InputValues {
    range: Interval,
    /// A multiple beyond the range, the last one that the input has.
    last: Option<i128>,
    dropped: u32,
}

impl InputValues {
    fn count(&self) -> u128 {
        let within = (self.range.1 - self.range.0 + 1).max(0).cast_unsigned();
        within + u128::from(self.last.is_some())
    }

    fn get(&self, number: u128) -> i128 {
        let multiple = self.range.0 + number.cast_signed();
        let beyond = self.last.filter(|_| multiple > self.range.1);
        beyond.unwrap_or(multiple) << self.dropped
    }

    /// Keeps the values of two periods of 2^`bits`, and the last value.
    fn keep_two_periods(&mut self, bits: i32) {
        let period = 1i128 << (bits - self.dropped as i32).clamp(0, 100);
        let (first, last) = self.range;
        if last - first > 2 * period {
            self.range = (first, first + 2 * period - 1);
            self.last = Some(last);
        }
    }
}

/// Returns the nodes that the value of a node depends on. The places of a shift depend on the word before it was shifted.
fn value_inputs(plan: &ExpressionPlan, id: NodeId) -> Vec<NodeId> {
    match plan.node(id).operation {
        Operation::Places(normalised) => plan.node(normalised).operation.inputs(),
        _ => plan.node(id).operation.inputs(),
    }
}

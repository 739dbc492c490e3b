//! Decides which values of a plan have registers.
//!
//! Results, products and polynomials always have registers, and so has the word that [`Operation::Normalise`] shifts to its top
//! bit. In a sequential unit, the register of the table's operand takes this word. In a sequential core, any other value also has
//! a register if the logic that reads it would otherwise take too long ([`super::depth`]).

use super::depth::{longest_to, own_times, selects_by_opcode};
use super::node::{NodeId, Operation};
use super::placement::StepPlacement;

/// Returns for each node whether it has a register. `start` must not have placed any node yet; `computed` are the nodes that a result
/// reads.
pub(super) fn held_nodes(start: &StepPlacement, computed: &[NodeId]) -> Vec<bool> {
    let plan = start.plan;
    let is_read = plan.read_nodes();
    let mut is_input = vec![false; plan.nodes().len()];
    for node in plan.nodes() {
        for input in node.operation.inputs() {
            is_input[input.0] = true;
        }
    }
    let mut holder = RegisterSearch {
        start,
        computed,
        own: own_times(plan),
        held: vec![false; plan.nodes().len()],
        times: Vec::new(),
    };
    for &node in computed {
        if !start.is_pipelined {
            holder.hold_late_inputs(node);
        }
        match plan.node(node).operation {
            Operation::Multiply(..) => holder.held[start.targets[node.0].0] = true,
            // In a sequential unit, the word goes to the register of the table's operand in the same clock.
            Operation::Places(_) if plan.is_shared() && !start.is_pipelined => {}
            Operation::Places(normalised) => {
                holder.held[start.targets[normalised.0].0] = true;
                // The results of a function that covers one octave need no shift back.
                holder.held[node.0] |= is_read[node.0];
            }
            Operation::Polynomial(..) => holder.held[node.0] = true,
            Operation::ShiftLeft(..) | Operation::ShiftRight(..) if plan.is_shared() => {
                holder.held[node.0] = !start.is_pipelined;
            }
            _ => {}
        }
        holder.held[node.0] |= start.schedule.register_sharers(node).len() > 1;
        // Later microinstructions read the register of a result, so it is loaded before them.
        holder.held[node.0] |= plan.results().contains(&node) && is_input[node.0];
    }
    for result in plan.results() {
        holder.held[result.0] = true;
    }
    holder.held
}

/// Finds values that need a register, node after node.
struct RegisterSearch<'p> {
    start: &'p StepPlacement<'p>,
    computed: &'p [NodeId],
    /// The time of each node's own logic, in nanoseconds.
    own: Vec<f64>,
    held: Vec<bool>,
    /// For the nodes so far, the time of the logic between the registers before the node and its value; 0 for a node with a register.
    times: Vec<f64>,
}

impl RegisterSearch<'_> {
    /// Gives registers to values in front of `node` until its logic takes no longer than it may.
    fn hold_late_inputs(&mut self, node: NodeId) {
        let operation = &self.start.plan.node(node).operation;
        if matches!(operation, Operation::Places(_)) {
            // It is computed together with the normalised word.
            return;
        }
        self.extend_times(node);
        let most = longest_to(self.start.plan, node) - self.own[node.0];
        while let Some(late) = self.latest_input(node).filter(|late| self.times[late.0] > most) {
            match self.cut_without_delay(node, late, most) {
                Some(cut) => self.hold(cut, node),
                None => break,
            }
        }
        if self.latest_input(node).is_some_and(|late| self.times[late.0] > most) {
            for input in operation.hardware_inputs() {
                if self.times[input.0] > 0.0 {
                    let cut = self.before_choices_by_opcode(input);
                    self.hold(cut, node);
                }
            }
        }
    }

    /// Returns the value behind which there are only choices by the opcode up to the node `end`. With a register there, the other functions
    /// of a unit do not wait for this value. Returns `end` itself if several values of such a choice are late.
    fn before_choices_by_opcode(&self, end: NodeId) -> NodeId {
        let plan = self.start.plan;
        let mut cut = end;
        while let Operation::Choose { condition, cases } = plan.node(cut).operation {
            let mut late = cases.into_iter().filter(|case| self.times[case.0] > 0.0);
            let (Some(only), None) = (late.next(), late.next()) else { return end };
            if !selects_by_opcode(plan, condition) {
                break;
            }
            cut = only;
        }
        cut
    }

    fn hold(&mut self, node: NodeId, end: NodeId) {
        self.held[node.0] = true;
        if let Operation::Normalise { .. } = self.start.plan.node(node).operation {
            // The places belong to the word in the register, not to the next one.
            self.held[node.0 + 1] = true;
        }
        self.times.truncate(node.0);
        self.extend_times(end);
    }

    fn extend_times(&mut self, end: NodeId) {
        for at in self.times.len()..end.0 {
            let time = match self.held[at] {
                true => 0.0,
                false => {
                    let before =
                        self.latest_input(NodeId(at)).map_or(0.0, |input| self.times[input.0]);
                    before + self.own[at]
                }
            };
            self.times.push(time);
        }
    }

    /// Returns the input of a node whose value arrives last.
    fn latest_input(&self, node: NodeId) -> Option<NodeId> {
        let inputs = self.start.plan.node(node).operation.hardware_inputs();
        inputs.into_iter().max_by(|a, b| self.times[a.0].total_cmp(&self.times[b.0]))
    }

    /// Returns a value on the slowest path to `late`, an input of `node`, that can have a register without a further
    /// microinstruction, because `node` waits for another value anyway. With this register, the path takes at most `most`.
    fn cut_without_delay(&self, node: NodeId, late: NodeId, most: f64) -> Option<NodeId> {
        let ready = self.ready(node);
        let inputs = self.start.plan.node(node).operation.hardware_inputs();
        let when = inputs.iter().map(|input| ready[input.0]).max()?;
        let mut cut = late;
        while self.times[cut.0] > 0.0 && self.times[late.0] - self.times[cut.0] <= most {
            if ready[cut.0] < when {
                return Some(cut);
            }
            cut = self.latest_input(cut)?;
        }
        None
    }

    /// Returns for each node before `end` the first microinstruction that can read its value, with the registers so far.
    fn ready(&self, end: NodeId) -> Vec<usize> {
        let mut placement = self.start.clone();
        placement.schedule.held.clone_from(&self.held);
        for node in self.computed.iter().take_while(|node| node.0 < end.0) {
            placement.place(*node);
        }
        placement.ready
    }
}

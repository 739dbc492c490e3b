//! Assigns each node of a computation to a stage of the pipeline, with the fewest register bits.
//!
//! A node must be in a later stage than its operand if a block memory lies between them, or too much logic for the clock. A value
//! takes one register bit for each of its bits and for each boundary between stages up to its last use. All constraints are on
//! differences of two stages, so a linear program finds an integer solution. (The method is from Cong and Zhang, "An efficient
//! and versatile scheduling algorithm based on SDC formulation", 2006.) Products that share multipliers (`sharing`) get their
//! stages before the linear program runs.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};

use super::delay;
use super::graph::{Cell, Graph, Node, NodeId, NodeOp};
use super::sharing::{self, MultiplierUnit, ProductGroup};
use glint_base::target::{Registered, Timing};

/// The stage of every node, and the clock period that the stages reach.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The stage of each node; meaningless for constants, for extensions that are no results, and for nodes on which no result
    /// depends.
    pub stage: Vec<usize>,
    /// The number of register rows from the operands to the results: the latency in clocks.
    pub latency: usize,
    /// The clock period in nanoseconds.
    pub period: f64,
    /// The delay of the logic in each stage, in nanoseconds, without registers.
    pub logic: Vec<f64>,
}

/// The reason why the scheduler returns no schedule.
#[derive(Clone, Debug)]
pub enum ScheduleRefusal {
    /// The requested clock period is too short for a single operation.
    Unreachable(Unreachable),
    /// The solver failed, or its solution violates a constraint: the reason, and the node in a wrong stage, if known.
    Unsolved(String, Option<NodeId>),
}

/// The operation that limits the clock period.
#[derive(Clone, Debug)]
pub struct Unreachable {
    /// The slowest node.
    pub limiting: NodeId,
    /// The shortest clock period that this node allows, in nanoseconds.
    pub period: f64,
}

/// Assigns the nodes of a computation to stages, given their dependences and their delays on an FPGA target.
pub struct ScheduleProblem<'a> {
    graph: &'a Graph,
    target: &'a Timing,
    /// The nodes to schedule, each after its operands, without constants and extensions that are no results.
    live: Vec<NodeId>,
    results: &'a [NodeId],
    /// For each node, the scheduled nodes that read it, directly or through extensions; none for constants.
    users: Vec<Vec<NodeId>>,
    delay: Vec<f64>,
    /// For each node, the additional setup time of a register behind it, in nanoseconds.
    setup: Vec<f64>,
    /// For each mux between a value and a constant, its select, if the register behind the mux can make the choice by its reset.
    reset_by: Vec<Option<NodeId>>,
    /// For each node that a rising edge computes, its timing.
    clocked: Vec<Option<ClockedNode>>,
    interval: usize,
    /// The products that share multipliers.
    kinds: Vec<ProductGroup>,
}

/// The timing of a node that gets its value at a rising edge. The node is a word of a block memory, a product in the register
/// of a multiplier, or a product of a shared multiplier.
#[derive(Clone, Copy, Debug)]
struct ClockedNode {
    /// The time from the operands to the rising edge in nanoseconds, as far as it exceeds the path to an ordinary register.
    operands: f64,
    /// The delay of the multiplier between its operand registers and its output register, in nanoseconds; 0 without operand
    /// registers.
    inside: f64,
    /// The number of stage boundaries from the operands to the node: 2 for a shared multiplier, otherwise 1.
    apart: usize,
}

/// Returns the clock frequency for a `period` in nanoseconds, in MHz. The frequency is rounded down to one decimal, so that it
/// can be reached: 7 ns give 142.8 MHz.
pub fn megahertz(period: f64) -> f64 {
    (10_000.0 / period).floor() / 10.0
}

/// Returns whether an operation is a carry chain or a product, whose cells cannot include a mux in front of it.
fn takes_no_logic(cell: &Cell) -> bool {
    matches!(
        cell,
        Cell::Op(NodeOp::Add { .. } | NodeOp::Sub(..) | NodeOp::Less(..) | NodeOp::Mul(..))
    )
}

/// `(from, to, apart)`: the stage of node `to` is at least `apart` stages after the stage of node `from`.
type StageDifference = (NodeId, NodeId, usize);

/// The stages of the products that share multipliers, which are chosen before all other stages.
type Taken = BTreeMap<NodeId, usize>;

/// Returns the inverters that are factors of products in `live`, directly or through wiring.
fn inverted_factors(graph: &Graph, live: &[NodeId]) -> Vec<NodeId> {
    let mut open: Vec<NodeId> = Vec::new();
    for &id in live {
        if let Cell::Op(NodeOp::Mul(a, b)) = graph.node(id).cell {
            open.extend([a, b]);
        }
    }
    let mut inverters = Vec::new();
    while let Some(id) = open.pop() {
        match &graph.node(id).cell {
            Cell::Op(NodeOp::Not(_)) => inverters.push(id),
            cell if cell.is_wiring() => open.extend(cell.operands()),
            _ => {}
        }
    }
    inverters
}

/// Returns whether a node only extends or renames another node. Each stage makes such a node again, so that the registers between
/// stages store the narrower operand.
pub fn is_extension(graph: &Graph, id: NodeId) -> bool {
    matches!(graph.node(id).cell, Cell::Op(NodeOp::Extend(_) | NodeOp::Relabel(_)))
}

/// Returns the node that registers store for the readers of `id`: the node below its extensions, unless `id` is a result.
fn held(graph: &Graph, results: &[NodeId], mut id: NodeId) -> NodeId {
    while is_extension(graph, id) && !results.contains(&id) {
        id = graph.node(id).cell.operands()[0];
    }
    id
}

/// Returns the delay of a node in nanoseconds, and its timing if a rising edge computes it. `shares` says whether the node is a
/// product of a multiplier that several products share.
fn node_timing(
    graph: &Graph,
    target: &Timing,
    registered: Option<Registered>,
    shares: bool,
    interval: usize,
    id: NodeId,
) -> (f64, Option<ClockedNode>) {
    let multiplier = match graph.node(id).cell {
        Cell::Op(NodeOp::Mul(..)) => registered,
        _ => None,
    };
    if shares {
        let operands = delay::of_choice(target, interval);
        let (delay, inside) = match multiplier {
            Some(multiplier) => (multiplier.output, multiplier.product),
            None => (0.0, target.product),
        };
        return (delay, Some(ClockedNode { operands, inside, apart: 2 }));
    }
    if let Some(multiplier) = multiplier {
        let operands = multiplier.product;
        return (multiplier.output, Some(ClockedNode { operands, inside: 0.0, apart: 1 }));
    }
    let delay = delay::node_delay(target, graph, id);
    if delay::is_block(target, graph, id) {
        let operands = target.address;
        return (delay, Some(ClockedNode { operands, inside: 0.0, apart: 1 }));
    }
    (delay, None)
}

impl<'a> ScheduleProblem<'a> {
    /// `interval` is the number of clocks from one point to the next. `registered` has the delays of multipliers with output
    /// registers, if products use them.
    pub fn new(
        graph: &'a Graph,
        target: &'a Timing,
        registered: Option<Registered>,
        interval: usize,
        results: &'a [NodeId],
    ) -> Self {
        let mut live = graph.cone(results.iter().copied());
        live.retain(|id| {
            graph.constant_of(*id).is_none() && (results.contains(id) || !is_extension(graph, *id))
        });
        let mut users = vec![Vec::new(); graph.nodes.len()];
        for &id in &live {
            let mut operands = BTreeSet::new();
            for operand in graph.node(id).cell.operands() {
                operands.insert(held(graph, results, operand));
            }
            for operand in operands {
                if graph.constant_of(operand).is_none() {
                    users[operand.index()].push(id);
                }
            }
        }
        let kinds = sharing::kinds(graph, target, &live, interval);
        let (mut delay, mut clocked) = (Vec::new(), Vec::new());
        let (mut setup, mut reset_by) = (Vec::new(), Vec::new());
        for at in 0..graph.nodes.len() {
            let id = NodeId(at as u32);
            let shares = kinds.iter().any(|kind| kind.products.contains(&id));
            let (after, clock) = node_timing(graph, target, registered, shares, interval, id);
            delay.push(after);
            clocked.push(clock);
            setup.push(delay::setup(target, graph, id));
            let select = delay::reset_by(graph, id);
            reset_by.push(select.map(|select| held(graph, results, select)));
        }
        // Look-up tables and adders include an inverter without extra delay; a multiplier does not. With registered multipliers,
        // the inverter's delay counts even if other operations read the inverter too, because a second inverter would not be
        // worth its cost.
        for id in inverted_factors(graph, &live) {
            let for_products_alone = users[id.index()].iter().all(|user| {
                let cell = &graph.node(*user).cell;
                cell.is_wiring() || matches!(cell, Cell::Op(NodeOp::Mul(..)))
            });
            if registered.is_some() || for_products_alone {
                delay[id.index()] = target.logic;
            }
        }
        Self {
            graph,
            target,
            live,
            results,
            users,
            delay,
            setup,
            reset_by,
            clocked,
            interval,
            kinds,
        }
    }

    /// Returns the number of multipliers that all products together take on the FPGA target.
    pub fn multipliers(&self) -> usize {
        let mut multipliers = sharing::products(self.graph, self.target, &self.live).len();
        for kind in &self.kinds {
            multipliers -= kind.products.len() - kind.units;
        }
        multipliers
    }

    /// Returns the operation that limits the clock period most. Operands of the design do not count.
    pub fn fastest(&self) -> Option<Unreachable> {
        let mut limiting: Option<(NodeId, f64)> = None;
        for &id in &self.live {
            let is_settled = match self.graph.node(id) {
                Node { cell: Cell::Operand(_), .. } => true,
                // A memory whose words are all the same limits nothing: synthesis makes a constant of it.
                Node { cell: Cell::Read { .. }, range, .. } => range.0 == range.1,
                _ => false,
            };
            if is_settled {
                continue;
            }
            let alone = self.delay_alone(id);
            if limiting.is_none_or(|(_, most)| alone.total_cmp(&most).is_ge()) {
                limiting = Some((id, alone));
            }
        }
        let (limiting, alone) = limiting?;
        Some(Unreachable { limiting, period: alone + self.target.register })
    }

    /// Returns the nanoseconds that a node alone takes between two registers, without the registers.
    fn delay_alone(&self, id: NodeId) -> f64 {
        let logic = self.delay[id.index()] + self.setup[id.index()];
        match self.clocked[id.index()] {
            Some(clocked) => logic.max(clocked.operands.max(clocked.inside)),
            None => logic.max(0.0),
        }
    }

    /// Returns the schedule for a clock period in nanoseconds. The schedule has as few stages as possible, and then the fewest
    /// register bits; some muxes count as bits too (`solve`). Products that share multipliers get their stages first. The
    /// schedule may then have more stages or bits than necessary.
    ///
    /// # Errors
    /// Fails if an operation takes longer than the period, or if the solver fails.
    pub fn for_period(&self, period: f64) -> Result<Schedule, ScheduleRefusal> {
        if let Some(unreachable) = self.fastest()
            && unreachable.period > period + 1e-9
        {
            return Err(ScheduleRefusal::Unreachable(unreachable));
        }
        self.solve(period, 0)
    }

    /// Returns the schedule with the shortest clock period for this number of stages. If no period allows so few stages, the
    /// schedule has more stages. The slowest operation limits the period. Fails if the solver fails.
    pub fn for_stages(&self, stages: usize) -> Result<Schedule, ScheduleRefusal> {
        let fastest = self.fastest_period();
        let all = self.delay.iter().chain(&self.setup).sum::<f64>();
        let mut low = fastest;
        let mut high = match self.least_stages(fastest) <= stages {
            true => fastest,
            false => self.target.register + all + 1.0,
        };
        // Down to a picosecond.
        while high - low > 0.001 {
            let middle = f64::midpoint(low, high);
            if self.least_stages(middle) <= stages {
                high = middle;
            } else {
                low = middle;
            }
        }
        self.solve(high, stages)
    }

    /// Returns the largest useful number of stages: with more, the slowest operation still limits the clock period.
    pub fn most_stages(&self) -> usize {
        self.least_stages(self.fastest_period())
    }

    /// Returns the period of [`Self::fastest`] in nanoseconds, or 0.
    fn fastest_period(&self) -> f64 {
        match self.fastest() {
            Some(unreachable) => unreachable.period,
            None => 0.0,
        }
    }

    fn least_stages(&self, period: f64) -> usize {
        let differences = self.differences(period);
        self.latency(&differences, &self.taken(&differences))
    }

    /// Returns the number of register rows that must lie between the operands of node `user` and its value: 0 for combinational
    /// logic, 1 for a word of a block memory or a product with a register, and 2 for a product of a shared multiplier.
    pub fn apart(&self, user: NodeId) -> usize {
        match self.clocked[user.index()] {
            Some(clocked) => clocked.apart,
            None => 0,
        }
    }

    /// Returns the number of register rows between the nodes `from` and `user`, whose path takes longer than the `most`
    /// nanoseconds of a stage. The number is 2 if even the wire from a block memory to a multiplier takes too long. Memory and
    /// multiplier lie in separate columns of the chip, and one register is placed near each.
    fn registers_between(&self, from: NodeId, user: NodeId, most: f64) -> usize {
        let product = matches!(self.graph.node(user).cell, Cell::Op(NodeOp::Mul(..)));
        let far = product && delay::is_block(self.target, self.graph, from);
        1 + usize::from(far && self.delay[user.index()] + self.target.logic > most)
    }

    /// Returns the nanoseconds until the setup of a register behind `user`, if the operand `from` arrives after `after`
    /// nanoseconds. If the register makes the choice of a mux by its reset, only the select takes the delay of the mux.
    fn until_register(&self, from: NodeId, user: NodeId, after: f64) -> f64 {
        match self.reset_by[user.index()] {
            Some(select) if select != from => after,
            _ => after + self.delay[user.index()] + self.setup[user.index()],
        }
    }

    /// Returns the least difference of the stages of each pair of dependent nodes for a clock period in nanoseconds, sorted, each
    /// pair once.
    fn differences(&self, period: f64) -> Vec<StageDifference> {
        let most = period - self.target.register + 1e-9;
        let mut differences = Vec::new();
        let mut longest = vec![0.0f64; self.graph.nodes.len()];
        let mut reached = vec![NodeId(u32::MAX); self.graph.nodes.len()];
        for &from in &self.live {
            for &user in &self.users[from.index()] {
                differences.push((from, user, self.apart(user)));
            }
            // From each node, the search follows the logic forward until the path takes longer than the clock period.
            let mut pending = BTreeSet::from([from]);
            // The delay of an operand counts at most as a full clock period, so that it never makes the period unreachable.
            longest[from.index()] = self.delay[from.index()].min(most);
            reached[from.index()] = from;
            while let Some(at) = pending.pop_first() {
                for &user in &self.users[at.index()] {
                    if let Some(ClockedNode { operands, apart, .. }) = self.clocked[user.index()] {
                        // If the time does not suffice, a register must lie between the logic and the memory or the multiplier.
                        if longest[at.index()] + operands > most {
                            differences.push((from, user, apart + 1));
                        }
                        continue;
                    }
                    let through = longest[at.index()] + self.delay[user.index()];
                    if self.until_register(at, user, longest[at.index()]) > most {
                        differences.push((from, user, self.registers_between(from, user, most)));
                    } else if reached[user.index()] != from || longest[user.index()] < through {
                        reached[user.index()] = from;
                        longest[user.index()] = through;
                        pending.insert(user);
                    }
                }
            }
        }
        differences.sort_unstable();
        differences.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 = kept.2.max(next.2);
            }
            same
        });
        differences
    }

    /// Returns the smallest possible latency in clocks: the longest chain of differences up to a result, plus the register row
    /// behind the results.
    fn latency(&self, differences: &[StageDifference], taken: &Taken) -> usize {
        let earliest = self.earliest(differences, taken);
        let mut latency = 1;
        for &id in self.results {
            if self.graph.constant_of(id).is_none() {
                latency = latency.max(earliest[id.index()] + 1);
            }
        }
        latency
    }

    /// Returns the earliest stage of each node, in one sweep. `differences` must be sorted by their first node, and a node must
    /// have a higher number than its operands.
    fn earliest(&self, differences: &[StageDifference], taken: &Taken) -> Vec<usize> {
        let mut earliest = vec![0; self.graph.nodes.len()];
        for (id, stage) in taken {
            earliest[id.index()] = *stage;
        }
        for &(from, to, apart) in differences {
            earliest[to.index()] = earliest[to.index()].max(earliest[from.index()] + apart);
        }
        earliest
    }

    /// Gives the products that share multipliers their stages, one after another. The product that can have the earliest stage
    /// comes first, and among several such products the one that the most stages must follow.
    fn taken(&self, differences: &[StageDifference]) -> Taken {
        let mut after = vec![0; self.graph.nodes.len()];
        for &(from, to, apart) in differences.iter().rev() {
            after[from.index()] = after[from.index()].max(after[to.index()] + apart);
        }
        let mut taken = Taken::new();
        let mut used = vec![vec![0; self.interval]; self.kinds.len()];
        let mut open: Vec<(usize, NodeId)> = Vec::new();
        for (kind, group) in self.kinds.iter().enumerate() {
            for &id in &group.products {
                open.push((kind, id));
            }
        }
        while !open.is_empty() {
            let earliest = self.earliest(differences, &taken);
            let next = (0..open.len()).min_by_key(|&at| {
                (earliest[open[at].1.index()], Reverse(after[open[at].1.index()]))
            });
            let (kind, id) = open.remove(next.unwrap_or(0));
            let mut stage = earliest[id.index()];
            while used[kind][stage % self.interval] == self.kinds[kind].units {
                stage += 1;
            }
            used[kind][stage % self.interval] += 1;
            taken.insert(id, stage);
        }
        taken
    }

    /// Returns the last stage that a node may have. Operands are available from the beginning, and a register row follows the
    /// results.
    fn last_stage(&self, id: usize, latency: usize) -> usize {
        if matches!(self.graph.nodes[id].cell, Cell::Operand(_)) { 0 } else { latency - 1 }
    }

    /// Checks the solver's stages against every constraint, because the solver computes with floating-point numbers. Fails with
    /// the first violated constraint.
    fn verify(
        &self,
        differences: &[StageDifference],
        stage: &[usize],
        latency: usize,
    ) -> Result<(), ScheduleRefusal> {
        let name = |id: NodeId| &self.graph.node(id).label.name;
        for &id in &self.live {
            let (at, last) = (stage[id.index()], self.last_stage(id.index(), latency));
            if at > last {
                let message = format!(
                    "`{}` is in stage {at}, but its last possible stage is {last}",
                    name(id)
                );
                return Err(ScheduleRefusal::Unsolved(message, Some(id)));
            }
        }
        for &(from, to, apart) in differences {
            let (first, second) = (stage[from.index()], stage[to.index()]);
            if second < first + apart {
                let message = format!(
                    "`{}` is in stage {second}, and depends on `{}` in stage {first}: the least distance is \
                     {apart} stages",
                    name(to),
                    name(from)
                );
                return Err(ScheduleRefusal::Unsolved(message, Some(to)));
            }
        }
        for kind in &self.kinds {
            let mut used = vec![0; self.interval];
            for &id in &kind.products {
                let slot = stage[id.index()] % self.interval;
                used[slot] += 1;
                if used[slot] > kind.units {
                    let units = kind.units;
                    let message = format!(
                        "`{}` is one product too many for {units} multipliers in slot {slot}",
                        name(id)
                    );
                    return Err(ScheduleRefusal::Unsolved(message, Some(id)));
                }
            }
        }
        Ok(())
    }

    /// Returns the schedule with the fewest register bits for a period in nanoseconds, with at least `least` stages. A mux that
    /// takes look-up tables, because its register cannot choose by a reset, counts as many bits as its width. Fails if the solver
    /// finds no solution, or a solution that violates a constraint.
    fn solve(&self, period: f64, least: usize) -> Result<Schedule, ScheduleRefusal> {
        let differences = self.differences(period);
        let taken = self.taken(&differences);
        let latency = least.max(self.latency(&differences, &taken));
        let mut problem = Problem::new(OptimizationDirection::Minimize);
        let last = latency as f64;
        let mut stage = Vec::new();
        for (at, node) in self.graph.nodes.iter().enumerate() {
            let bounds = match taken.get(&NodeId(at as u32)) {
                Some(&stage) => (stage as f64, stage as f64),
                None => (0.0, self.last_stage(at, latency) as f64),
            };
            // Among schedules with equally many register bits, late products are better, because operands of products have
            // registers of their own.
            let weight = match node.cell {
                Cell::Op(NodeOp::Mul(..)) => -1e-3,
                _ => 0.0,
            };
            stage.push(problem.add_var(weight, bounds));
        }
        for &(from, to, apart) in &differences {
            let (from, to) = (stage[from.index()], stage[to.index()]);
            problem.add_constraint([(to, 1.0), (from, -1.0)], ComparisonOp::Ge, apart as f64);
        }
        for &id in &self.live {
            let bits = f64::from(self.graph.width(id));
            let held = problem.add_var(bits, (0.0, last));
            for &user in &self.users[id.index()] {
                let terms = [(held, 1.0), (stage[user.index()], -1.0), (stage[id.index()], 1.0)];
                problem.add_constraint(terms, ComparisonOp::Ge, -(self.apart(user) as f64));
            }
            if self.results.contains(&id) {
                let terms = [(held, 1.0), (stage[id.index()], 1.0)];
                problem.add_constraint(terms, ComparisonOp::Ge, last);
            }
        }
        // A mux that a register makes by its reset takes one look-up table a bit if a node in its own stage reads it.
        for &id in &self.live {
            if self.reset_by[id.index()].is_none() {
                continue;
            }
            let bits = f64::from(self.graph.width(id));
            let in_tables = problem.add_var(bits, (0.0, 1.0));
            let users = self.beyond_wiring(id);
            if let [user] = users[..]
                && !takes_no_logic(&self.graph.node(user).cell)
            {
                continue;
            }
            for user in users {
                let terms =
                    [(in_tables, 1.0), (stage[user.index()], 1.0), (stage[id.index()], -1.0)];
                problem.add_constraint(terms, ComparisonOp::Ge, 1.0 + self.apart(user) as f64);
            }
        }
        let unsolved = |message: String| ScheduleRefusal::Unsolved(message, None);
        let solution = match problem.solve().map_err(|error| unsolved(error.to_string()))? {
            SolveOutcome::Solution(solution) => solution,
            _ => return Err(unsolved("the linear program has no solution".to_owned())),
        };
        let mut solved: Vec<usize> = Vec::new();
        for variable in stage {
            solved.push(solution.var_value(variable).round() as usize);
        }
        self.verify(&differences, &solved, latency)?;
        let logic = self.logic(&solved, latency);
        Ok(Schedule { stage: solved, latency, period, logic })
    }

    /// Returns the nodes that read node `id`, directly or through wiring.
    fn beyond_wiring(&self, id: NodeId) -> Vec<NodeId> {
        let (mut open, mut users) = (self.users[id.index()].clone(), Vec::new());
        while let Some(user) = open.pop() {
            if self.graph.node(user).cell.is_wiring() && !self.results.contains(&user) {
                open.extend(&self.users[user.index()]);
            } else {
                users.push(user);
            }
        }
        users.sort_unstable();
        users.dedup();
        users
    }

    /// Returns the delay of the slowest path through each stage's logic, in nanoseconds.
    fn logic(&self, stage: &[usize], latency: usize) -> Vec<f64> {
        let mut arrival = vec![0.0f64; self.graph.nodes.len()];
        let mut longest = vec![0.0f64; latency];
        for &id in &self.live {
            let at = stage[id.index()];
            // The operands in the same stage; all others come from registers.
            let mut before: Vec<NodeId> = Vec::new();
            if !self.is_clocked(id) {
                for operand in self.graph.node(id).cell.operands() {
                    let operand = held(self.graph, self.results, operand);
                    let is_constant = self.graph.constant_of(operand).is_some();
                    if stage[operand.index()] == at && !is_constant {
                        before.push(operand);
                    }
                }
            }
            let mut latest: f64 = 0.0;
            for operand in &before {
                latest = latest.max(arrival[operand.index()]);
            }
            arrival[id.index()] = latest + self.delay[id.index()];
            let mut is_held = self.results.contains(&id);
            for user in &self.users[id.index()] {
                if stage[user.index()] - self.apart(*user) > at {
                    is_held = true;
                } else if let Some(clocked) = self.clocked[user.index()] {
                    longest[at] = longest[at].max(arrival[id.index()] + clocked.operands);
                }
            }
            if is_held {
                longest[at] = longest[at].max(self.delay[id.index()] + self.setup[id.index()]);
                for operand in before {
                    let end = self.until_register(operand, id, arrival[operand.index()]);
                    longest[at] = longest[at].max(end);
                }
            }
            if let Some(clocked) = self.clocked[id.index()] {
                longest[at - 1] = longest[at - 1].max(clocked.inside);
            }
        }
        longest
    }

    /// Returns the nanoseconds of a clock period that registers take: clock-to-output delay, wire and setup.
    pub fn register_ns(&self) -> f64 {
        self.target.register
    }

    /// Returns the nodes that need a stage, each after its operands.
    pub fn live(&self) -> &[NodeId] {
        &self.live
    }

    /// Returns the last stage that reads each node's value, up to which registers must carry it. For a result, this is the
    /// latency.
    pub fn last_use(&self, schedule: &Schedule) -> Vec<usize> {
        let mut last = schedule.stage.clone();
        for &id in &self.live {
            for &user in &self.users[id.index()] {
                let at = schedule.stage[user.index()] - self.apart(user);
                last[id.index()] = last[id.index()].max(at);
            }
            if self.results.contains(&id) {
                last[id.index()] = schedule.latency;
            }
        }
        last
    }

    /// Returns the multipliers that serve several products, with the product of each slot.
    pub fn units(&self, schedule: &Schedule) -> Vec<MultiplierUnit> {
        let mut units = Vec::new();
        for kind in &self.kinds {
            let stage = &schedule.stage;
            units.extend(sharing::units(self.graph, self.target, kind, stage, self.interval));
        }
        units
    }

    /// Returns whether a node gets its value at a rising edge.
    pub fn is_clocked(&self, id: NodeId) -> bool {
        self.clocked[id.index()].is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsl::{fixture, step};
    use crate::pipeline::unroll;
    use glint_base::fixed::Format;

    #[test]
    fn a_schedule_that_breaks_a_constraint_is_refused() {
        let design = fixture::design(|d| {
            let a = d.operand("a", Format::unsigned(8, 0)).q();
            let square = d.mul("square", a, a);
            let fourth = d.mul("fourth", square, square);
            let y = d.register("y", fourth.format());
            y.takes(fourth);
            d.output("y_out", y.q());
            vec![step("load", [y.load()])]
        });
        let unrolled = unroll::unroll(&design).unwrap_or_else(|wrong| panic!("{wrong}"));
        let results: Vec<NodeId> = unrolled.results.iter().map(|&(_, value)| value).collect();
        let target = Timing::named("ecp5").expect("a target");
        let problems = ScheduleProblem::new(&unrolled.graph, target, None, 1, &results);
        let period = problems.fastest().expect("an operation").period;
        let schedule = problems.for_period(period).expect("a schedule");
        let differences = problems.differences(period);
        let refused = |node: NodeId, at: usize| {
            let mut stage = schedule.stage.clone();
            stage[node.index()] = at;
            match problems.verify(&differences, &stage, schedule.latency) {
                Err(ScheduleRefusal::Unsolved(why, place)) => Some((why, place)),
                _ => None,
            }
        };
        let apart: Vec<_> = differences.iter().filter(|(.., apart)| *apart > 0).collect();
        assert!(!apart.is_empty());
        for &&(from, to, apart) in &apart {
            assert!(refused(to, schedule.stage[to.index()]).is_none());
            let (why, place) = refused(to, schedule.stage[from.index()] + apart - 1).expect("why");
            let name = &unrolled.graph.node(to).label.name;
            assert!(place == Some(to) && why.contains(&format!("`{name}`")), "{why}");
        }
        for &id in problems.live() {
            let (_, place) = refused(id, schedule.latency).expect("behind the last stage");
            assert_eq!(place, Some(id));
        }
    }
}

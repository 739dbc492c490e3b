//! Unrolls a microprogram into a graph of values. For this, one computation is executed symbolically, with unknown operands,
//! from the clock that accepts `start` to the clock with the results.
//!
//! The fields of the control word are constants in each clock, so that muxes with a field as their select disappear. If a
//! condition depends on an operand, the execution follows both branches, and muxes choose the register contents behind them. A
//! loop is unrolled as often as it can run. If an operand selects among several microprograms (a dispatch), a computation is
//! executed for each value of the operand, and muxes choose the results.

mod clock;
mod cycle;
mod line;

use clock::{Clock, State, label};
pub use cycle::{Cycle, StateValues, any_cycle};
pub use line::{UnrolledLine, WalkRegister, unroll_line};

use super::graph::{Cell, Graph, Label, NodeId, NodeOp};
use super::possible;
use super::settle::settled;
use crate::netlist::{Design, Driver, Net, NetId, RegId, RegisterKind, Role, Sequence};
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, Diagnostics};
use glint_base::fixed::Format;

/// A longer computation is not worth a pipeline.
const MOST_CLOCKS: usize = 4096;

/// A graph without loops, from the operands of a design to the results of its microprogram.
#[derive(Debug)]
pub struct Unrolled {
    pub graph: Graph,
    /// The nets of the operand ports, in the order of the ports. `Cell::Operand` has positions in this list.
    pub operands: Vec<NetId>,
    /// The nets of output ports, each with its node. The outputs of the handshake are not among them, except in the graph of a
    /// `Cycle`, which has all outputs.
    pub results: Vec<(NetId, NodeId)>,
    /// The microinstructions in the order of execution. If the microprogram dispatches, those for the selector's value 0 come first.
    pub steps: Vec<UnrolledStep>,
    /// The results for each value of the selector, if the microprogram dispatches.
    pub dispatched: Option<DispatchedResults>,
}

/// The results of a microprogram that dispatches, for each value of the operand that selects the microinstructions.
#[derive(Clone, Debug)]
pub struct DispatchedResults {
    /// The node of the operand.
    pub selector: NodeId,
    /// For each value of the operand, the nets of output ports with their nodes, as in [`Unrolled::results`].
    pub of_values: Vec<Vec<(NetId, NodeId)>>,
}

/// An executed microinstruction.
#[derive(Clone, Debug)]
pub struct UnrolledStep {
    pub address: usize,
    /// The number of earlier executions of the same microinstruction in this computation.
    pub visit: usize,
    /// The nodes of operand registers and architectural registers, which the golden model predicts, while the microinstruction is
    /// executed. A register that no earlier microinstruction has loaded has an unknown value.
    pub registers: Vec<(RegId, NodeId)>,
}

/// The state before the microinstruction at `address`.
struct At {
    state: State,
    address: usize,
}

struct Executor<'a> {
    design: &'a Design,
    iterations: Iterations,
    unrolled: Unrolled,
    visits: Vec<usize>,
    /// The value of the selector for which the microprogram is executed; `None` if it does not dispatch.
    selected: Option<u64>,
    /// Each result or status port with its node; `None` until a microinstruction sets `valid`.
    shown: Option<Vec<(NetId, NodeId)>>,
}

/// Unrolls the microprogram of a design that the description language has accepted.
///
/// # Errors
/// Fails if a loop has no known bound because its condition depends on more than 16 bits. Fails if the computation takes more
/// than 4096 clocks. Fails if the microprogram ends or waits for `start` before it sets `valid`. Fails if `valid` depends on a
/// signal or is set under a condition. Fails if a result depends on a value that an earlier computation has left in a register.
pub fn unroll(design: &Design) -> Result<Unrolled, Diagnostics> {
    run(design, Iterations::OneByOne).map_err(|diagnostic| Diagnostics(vec![diagnostic]))
}

/// Unrolls as [`unroll`] does, but with fewer muxes for loops whose number of iterations depends on an operand. Such a loop
/// becomes blocks of 8, 4, 2 and 1 iterations, and one bit of the number enables each block. Single iterations remain if a loop
/// has at most four, if they are not alike, or if their number depends on several values or on more than 6 bits.
///
/// # Errors
/// Fails for the reasons that [`unroll`] lists.
pub fn unroll_in_powers(design: &Design) -> Result<Unrolled, Diagnostics> {
    run(design, Iterations::InPowers).map_err(|diagnostic| Diagnostics(vec![diagnostic]))
}

/// Unrolls as [`unroll_in_powers`] does, but returns only the first mistake. Fails also if the microprogram dispatches, because
/// all points of a pipeline pass the same stages.
pub(super) fn unroll_for_pipeline(design: &Design) -> Result<Unrolled, Diagnostic> {
    let executor = Executor::new(design, Iterations::InPowers);
    for (at, microinstruction) in design.control.microprogram.iter().enumerate() {
        if let Sequence::Dispatch { .. } = microinstruction.sequence {
            let why = "dispatches, and the points of a pipeline all pass the same stages: let choices by \
                       the operand select the values instead";
            return Err(executor.cannot(at, why));
        }
    }
    run(design, Iterations::InPowers)
}

/// How the iterations of a loop are executed if their number depends on an operand.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Iterations {
    /// Each iteration is executed under the condition that all iterations up to it take place.
    OneByOne,
    /// Blocks of 8, 4, 2 and 1 iterations are executed, if [`unroll_in_powers`] can make them.
    InPowers,
}

/// Returns a diagnostic if a result depends on a value that an earlier computation has left in a register or a memory output.
/// Returns `None` also for a microprogram that cannot be unrolled.
pub fn carried(design: &Design) -> Option<Diagnostic> {
    let (executor, results) = executed(design, Iterations::InPowers).ok()?;
    executor.determined(&results, "carries a state from one point to the next").err()
}

/// Unrolls, and checks that no result depends on a value of an earlier computation.
fn run(design: &Design, iterations: Iterations) -> Result<Unrolled, Diagnostic> {
    let (mut executor, results) = executed(design, iterations)?;
    executor.determined(&results, "cannot be a pipeline")?;
    executor.unrolled.results = results;
    Ok(executor.unrolled)
}

/// Executes the microprogram up to the clock with the results. Returns each result or status port with its node. Fails if the
/// microprogram cannot be unrolled, but lets results depend on an earlier computation.
fn executed(
    design: &Design,
    iterations: Iterations,
) -> Result<(Executor<'_>, Vec<(NetId, NodeId)>), Diagnostic> {
    let mut executor = Executor::new(design, iterations);
    let state = executor.power_up();
    let state = executor.start(&state);
    let selector = design.control.microprogram.iter().find_map(|it| match it.sequence {
        Sequence::Dispatch { selector, .. } => Some(selector),
        _ => None,
    });
    let results = match selector {
        Some(selector) => executor.results_by(selector, &state)?,
        None => executor.results_from(state)?,
    };
    Ok((executor, results))
}

impl<'a> Executor<'a> {
    fn new(design: &'a Design, iterations: Iterations) -> Self {
        let ports = design.ports.iter();
        let operands = ports.filter(|port| matches!(port.role, Role::Operand { .. }));
        Self {
            design,
            iterations,
            visits: vec![0; design.control.microprogram.len()],
            selected: None,
            unrolled: Unrolled {
                graph: Graph::default(),
                operands: operands.map(|port| port.net).collect(),
                results: Vec::new(),
                steps: Vec::new(),
                dispatched: None,
            },
            shown: None,
        }
    }

    fn power_up(&mut self) -> State {
        let design = self.design;
        let graph = &mut self.unrolled.graph;
        let registers = design
            .registers
            .iter()
            .map(|register| unknown(graph, design.net(register.q)))
            .collect();
        let roms = design.roms.iter().map(|rom| unknown(graph, design.net(rom.data))).collect();
        State { registers, roms }
    }

    /// Executes the clock that accepts `start` and writes all operands.
    fn start(&mut self, state: &State) -> State {
        Clock::new(self, state, Some(0), true).edge()
    }

    /// Executes the microprogram from its beginning. Returns each result or status port with its node.
    fn results_from(&mut self, state: State) -> Result<Vec<(NetId, NodeId)>, Diagnostic> {
        self.follow(At { state, address: 0 }, None)?;
        self.shown.take().ok_or_else(|| {
            let microprogram = &self.design.control.microprogram;
            let place = microprogram.last().map_or(self.design.nets[0].location, |it| it.location);
            let message = "no microinstruction sets `valid`, so the pipeline cannot know when the results \
                           are ready";
            Diagnostic::new(codes::UNROLL, message.to_owned(), place)
        })
    }

    /// Executes the microprogram for each value of the operand register `selector`. Muxes choose the results by the operand.
    fn results_by(
        &mut self,
        selector: NetId,
        start: &State,
    ) -> Result<Vec<(NetId, NodeId)>, Diagnostic> {
        let design = self.design;
        let net = design.net(selector);
        let Driver::Register(register) = net.driver else {
            unreachable!("the description language wants an operand's register")
        };
        let operand = start.registers[register.index()];
        let mut of_values: Vec<Vec<(NetId, NodeId)>> = Vec::new();
        for value in 0..1 << net.format.width() {
            let mut state = start.clone();
            state.registers[register.index()] =
                self.unrolled.graph.constant(value, net.format, &label(net));
            self.visits.fill(0);
            self.selected = Some(value);
            of_values.push(self.results_from(state)?);
        }
        let mut results = Vec::new();
        for (at, &(port, first)) in of_values[0].iter().enumerate() {
            let inputs: Vec<NodeId> = of_values.iter().map(|of_value| of_value[at].1).collect();
            let is_same = inputs.iter().all(|input| *input == first);
            let node = if is_same {
                first
            } else {
                let net = design.net(port);
                let mux = NodeOp::Mux { select: operand, inputs };
                self.unrolled.graph.op(mux, net.format, &label(net))
            };
            results.push((port, node));
        }
        self.unrolled.dispatched = Some(DispatchedResults { selector: operand, of_values });
        Ok(results)
    }

    /// Executes microinstructions from `at` on, up to the clock with the results, or until the microinstruction at `stop` comes
    /// next. Returns the state at `stop`, or `None` if the results came first and are in `self.shown`. Fails for the reasons
    /// that [`unroll`] lists.
    fn follow(&mut self, mut at: At, stop: Option<usize>) -> Result<Option<State>, Diagnostic> {
        let design = self.design;
        loop {
            if stop == Some(at.address) {
                return Ok(Some(at.state));
            }
            let microinstruction = &design.control.microprogram[at.address];
            let (after, condition) = self.execute(&at)?;
            if self.shown.is_some() {
                return Ok(None);
            }
            match microinstruction.sequence {
                Sequence::Next => at = At { state: after, address: at.address + 1 },
                Sequence::LoopWhile { to, .. } => {
                    let again = condition.expect("a loop has a condition");
                    match self.unrolled.graph.constant_of(again) {
                        Some(taken) => {
                            let address = if taken == 1 { to } else { at.address + 1 };
                            at = At { state: after, address };
                        }
                        None if to <= at.address => {
                            let free = at.state.registers.clone();
                            let state = self.iterations(after, again, (to, at.address), &free)?;
                            at = At { state, address: at.address + 1 };
                        }
                        None => {
                            let body = At { state: after.clone(), address: at.address + 1 };
                            let Some(executed) = self.follow(body, Some(to))? else {
                                let why = "shows results, but some points skip it";
                                return Err(self.cannot(at.address, why));
                            };
                            let state = self.either(again, &executed, &after);
                            at = At { state, address: to };
                        }
                    }
                }
                Sequence::Dispatch { ref to, .. } => {
                    let selected = self.selected.expect("the value of the selector") as usize;
                    at = At { state: after, address: to[selected] };
                }
                Sequence::WaitStart => {
                    return Err(
                        self.cannot(at.address, "waits for `start` in the middle of a computation")
                    );
                }
                Sequence::End => {
                    return Err(
                        self.cannot(at.address, "ends the microprogram before `valid` was set")
                    );
                }
            }
        }
    }

    /// Executes every iteration but the first of the loop from address `to` to address `last`. `condition` says whether the
    /// second iteration takes place, and `state` is the state after the first. The number of iterations must have a bound for any
    /// values of `free`, the register contents before the last microinstruction of the first iteration.
    ///
    /// Registers on which the loop's condition depends go from iteration to iteration as if every iteration took place. This
    /// saves muxes for a counter, and does no harm, because an iteration counts only if all iterations before it took place.
    ///
    /// # Errors
    /// Fails if the condition depends on more than 16 bits, if an iteration sets `valid`, or if a microinstruction cannot be
    /// unrolled.
    fn iterations(
        &mut self,
        mut state: State,
        mut condition: NodeId,
        (to, last): (usize, usize),
        free: &[NodeId],
    ) -> Result<State, Diagnostic> {
        let (first, mut entry) = (state.clone(), state.clone());
        let (mut conditions, mut counters) = (Vec::new(), vec![false; state.registers.len()]);
        loop {
            match possible::ever(&self.unrolled.graph, condition, free) {
                Some(false) => {
                    let mut taken = None;
                    if self.iterations == Iterations::InPowers {
                        taken = self.in_powers(&first, &conditions, &counters, (to, last), free);
                    }
                    let Some(mut after) = taken else { return Ok(state) };
                    for (at, _) in counters.iter().enumerate().filter(|(_, counts)| **counts) {
                        after.registers[at] = state.registers[at];
                    }
                    return Ok(after);
                }
                Some(true) => conditions.push(condition),
                None => {
                    return Err(self.cannot(
                        last,
                        "repeats a loop for which no largest trip count is found: the condition depends on \
                         more than 16 bits",
                    ));
                }
            }
            let at = At { state: entry.clone(), address: to };
            let Some(before) = self.follow(at, Some(last))? else {
                return Err(
                    self.cannot(last, "shows results, but is executed only under a condition")
                );
            };
            let (after, loop_condition) = self.execute(&At { state: before, address: last })?;
            let again = loop_condition.expect("a loop has a condition");
            state = self.either(condition, &after, &state);
            let asked = self.unrolled.graph.cone([again]);
            for (at, held) in entry.registers.iter_mut().enumerate() {
                let is_asked = asked.binary_search(held).is_ok();
                counters[at] |= is_asked;
                *held = if is_asked { after.registers[at] } else { state.registers[at] };
            }
            entry.roms.clone_from(&state.roms);
            let label = self.unrolled.graph.node(again).label.clone();
            condition = self.unrolled.graph.op(NodeOp::And(condition, again), Format::BIT, &label);
        }
    }

    /// Unrolls a loop as blocks of iterations: 8, 4, 2 and 1, or fewer or more for another largest number. The number of
    /// `conditions` that are 1 is the number of further iterations after `first`, the state behind the first iteration. One bit
    /// of this number enables each block. `counters` marks the registers that count iterations; their values in the returned
    /// state are wrong.
    ///
    /// Returns `None` if an iteration depends on these registers, changes a memory's output or cannot be executed. Returns
    /// `None` also with fewer than four conditions, or if the number depends on several nodes or on more than 6 bits.
    fn in_powers(
        &mut self,
        first: &State,
        conditions: &[NodeId],
        counters: &[bool],
        (to, last): (usize, usize),
        free: &[NodeId],
    ) -> Option<State> {
        let (count, iterations) = possible::count(&self.unrolled.graph, conditions, free)?;
        // With up to three iterations, blocks would need as many muxes as single iterations.
        let bits = conditions.len().checked_ilog2().filter(|&bits| bits > 1)? + 1;
        let (steps, visits) = (self.unrolled.steps.len(), self.visits.clone());
        let nodes = self.unrolled.graph.nodes.len();
        let unknown = self.power_up();
        let mut now = first.clone();
        forget(&mut now, counters, &unknown);
        for bit in (0..bits).rev() {
            let mut after = now.clone();
            for _ in 0..1 << bit {
                let before = self.follow(At { state: after, address: to }, Some(last)).ok()??;
                (after, _) = self.execute(&At { state: before, address: last }).ok()?;
                forget(&mut after, counters, &unknown);
                for held in &mut after.registers {
                    *held = settled(&mut self.unrolled.graph, *held);
                }
            }
            let graph = &mut self.unrolled.graph;
            let label = Label { named: false, ..graph.node(count).label.clone() };
            let taken = match bit_with_count(graph.width(count), &iterations, bit) {
                Some(low) => graph.op(NodeOp::Slice { of: count, low }, Format::BIT, &label),
                None => {
                    let mut inputs = Vec::new();
                    for iterations in &iterations {
                        let taken = iterations.unwrap_or(0) >> bit & 1;
                        inputs.push(graph.constant(taken as u64, Format::BIT, &label));
                    }
                    graph.op(NodeOp::Mux { select: count, inputs }, Format::BIT, &label)
                }
            };
            now = self.either(taken, &after, &now);
        }
        self.unrolled.steps.truncate(steps);
        self.visits = visits;
        for node in &mut self.unrolled.graph.nodes[nodes..] {
            node.step = steps - 1;
        }
        if now.roms != first.roms {
            return None;
        }
        let mut changed = Vec::new();
        for (at, &counts) in counters.iter().enumerate() {
            if !counts && now.registers[at] != first.registers[at] {
                changed.push(now.registers[at]);
            }
        }
        // No changed register may depend on the counter.
        let cone = self.unrolled.graph.cone(changed);
        for (at, &counts) in counters.iter().enumerate() {
            if counts && cone.binary_search(&unknown.registers[at]).is_ok() {
                return None;
            }
        }
        Some(now)
    }

    /// Executes the microinstruction at `at`. Returns the state after it, and the condition of a loop or jump. If the
    /// microinstruction sets `valid`, `self.shown` gets the results, and the state stays as it was. Fails if `valid` depends on a
    /// signal, or if the computation takes more than 4096 clocks.
    fn execute(&mut self, at: &At) -> Result<(State, Option<NodeId>), Diagnostic> {
        let design = self.design;
        if self.unrolled.steps.len() == MOST_CLOCKS {
            return Err(
                self.cannot(at.address, "is part of a computation of more than 4096 clocks")
            );
        }
        let mut registers = Vec::new();
        for (number, register) in design.registers.iter().enumerate() {
            if matches!(register.kind, RegisterKind::Architectural | RegisterKind::Operand) {
                registers.push((RegId(number as u32), at.state.registers[number]));
            }
        }
        let visit = self.visits[at.address];
        self.visits[at.address] += 1;
        self.unrolled.graph.step = self.unrolled.steps.len();
        self.unrolled.steps.push(UnrolledStep { address: at.address, visit, registers });
        let mut clock = Clock::new(self, &at.state, Some(at.address), false);
        let valid = design.port(|role| role == Role::Valid).map(|port| clock.value(port.net));
        if let Some(valid) = valid {
            match clock.graph().constant_of(valid) {
                Some(0) => {}
                Some(_) => {
                    let mut results = Vec::new();
                    for port in &design.ports {
                        if matches!(port.role, Role::Result | Role::Status) {
                            results.push((port.net, clock.value(port.net)));
                        }
                    }
                    self.shown = Some(results);
                    return Ok((at.state.clone(), None));
                }
                None => {
                    return Err(self.cannot(
                        at.address,
                        "is in a description with `valid_after`: a computation with several results cannot \
                         be unrolled",
                    ));
                }
            }
        }
        let condition = match design.control.microprogram[at.address].sequence {
            Sequence::LoopWhile { condition, .. } => Some(clock.value(condition)),
            _ => None,
        };
        Ok((clock.edge(), condition))
    }

    /// Merges two states by muxes: `yes` counts if `condition` is 1, otherwise `no`.
    fn either(&mut self, condition: NodeId, yes: &State, no: &State) -> State {
        let design = self.design;
        let graph = &mut self.unrolled.graph;
        let mut state = yes.clone();
        for (at, held) in state.registers.iter_mut().enumerate() {
            let net = design.net(design.registers[at].q);
            *held = choose(graph, condition, *held, no.registers[at], net);
        }
        for (at, held) in state.roms.iter_mut().enumerate() {
            let net = design.net(design.roms[at].data);
            *held = choose(graph, condition, *held, no.roms[at], net);
        }
        state
    }

    fn cannot(&self, address: usize, why: &str) -> Diagnostic {
        let microinstruction = &self.design.control.microprogram[address];
        let (design, own) = (&self.design.name, &microinstruction.name);
        let message =
            format!("`{design}` cannot be a pipeline: the microinstruction `{own}` {why}");
        Diagnostic::new(codes::UNROLL, message, microinstruction.location)
    }

    /// Checks that no result depends on a value that an earlier computation has left; the error names the result and the
    /// register. `what` is the predicate of the message, such as "cannot be a pipeline".
    fn determined(&self, results: &[(NetId, NodeId)], what: &str) -> Result<(), Diagnostic> {
        let graph = &self.unrolled.graph;
        for &(port, value) in results {
            for id in graph.cone([value]) {
                if let Cell::Unknown(register) = &graph.node(id).cell {
                    let (design, result) = (&self.design.name, &self.design.net(port).name);
                    let message = format!(
                        "`{design}` {what}: `{result}` depends on the value that `{register}` had before the \
                         computation; load `{register}` in each computation before it is read"
                    );
                    let place = graph.node(id).label.location;
                    return Err(Diagnostic::new(codes::UNROLL, message, place));
                }
            }
        }
        Ok(())
    }
}

/// Adds the unknown value that `net` has at power-up.
fn unknown(graph: &mut Graph, net: &Net) -> NodeId {
    let cell = Cell::Unknown(net.name.clone());
    graph.insert(cell, net.format, net.format.range(), &label(net))
}

/// Gives the registers that `counters` marks their unknown values at power-up.
fn forget(state: &mut State, counters: &[bool], unknown: &State) {
    for (at, &counts) in counters.iter().enumerate() {
        if counts {
            state.registers[at] = unknown.registers[at];
        }
    }
}

/// Returns the position of a bit in a node of `width` bits that always equals bit `bit` of a count, if there is one. `counts` has
/// the count for each value that the node can have. For example, the counts 0, 1, 2 and 3 for the values 0 to 3 and bit 1 give
/// position 1.
fn bit_with_count(width: u32, counts: &[Option<usize>], bit: u32) -> Option<u32> {
    (0..width).find(|place| {
        let mut values = counts.iter().enumerate();
        values.all(|(word, count)| count.is_none_or(|count| count >> bit & 1 == word >> place & 1))
    })
}

/// Returns a mux, or the node itself if `yes` and `no` are the same.
fn choose(graph: &mut Graph, condition: NodeId, yes: NodeId, no: NodeId, net: &Net) -> NodeId {
    if yes == no {
        return yes;
    }
    let mux = NodeOp::Mux { select: condition, inputs: vec![no, yes] };
    graph.op(mux, net.format, &label(net))
}

//! The microprogram executed on values that are not known yet.
//!
//! Every clock of one computation is gone through, from the one that takes `start` to the one in which
//! the results are on the outputs. Fields of the control word are constants then, muxes under them
//! disappear, and what a register takes is a new value. A synchronous ROM and a register without an
//! enable follow their inputs by a clock here too.
//!
//! A condition that is a constant decides where control goes. One that depends on an operand is
//! followed both ways: a loop is executed as often as it can be, each iteration under the conditions of
//! those before, and a jump ahead is executed with and without what it skips. Where the ways meet, each
//! register is chosen by the condition.

mod line;

use std::collections::HashMap;

pub use line::{Line, Walked, unroll_line};

use super::graph::{Cell, Graph, Label};
use super::possible;
use super::settle::settled;
use crate::base::diagnostic::{Diagnostic, Diagnostics};
use crate::base::fixed::Format;
use crate::hdl::netlist::{
    Design, Driver, Net, NetId, Op, RegId, RegisterKind, Role, RomId, Sequence, Topic,
};

/// More clocks than any microprogram takes that is worth a pipeline.
const MOST_CLOCKS: usize = 4096;

/// What one computation of a design is.
#[derive(Debug)]
pub struct Unrolled {
    /// All values.
    pub graph: Graph,
    /// The operands, as ports of the design.
    pub operands: Vec<NetId>,
    /// Each result with its value, by its port in the design.
    pub results: Vec<(NetId, NetId)>,
    /// The microinstructions in the order of execution.
    pub steps: Vec<Step>,
}

/// A microinstruction at a clock of the computation.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its place in the microprogram.
    pub address: usize,
    /// How often it was executed before.
    pub visit: usize,
    /// What the architectural registers hold while it is executed, as far as that is determined.
    pub registers: Vec<(RegId, NetId)>,
}

/// The state between two clocks.
#[derive(Clone)]
struct State {
    registers: Vec<NetId>,
    /// Words of synchronous ROMs; of others nothing that is used.
    roms: Vec<NetId>,
}

/// Where an execution stands.
struct At {
    state: State,
    address: usize,
}

struct Executor<'a> {
    design: &'a Design,
    iterations: Iterations,
    unrolled: Unrolled,
    visits: Vec<usize>,
    /// Set when the results are on the outputs.
    shown: Option<Vec<(NetId, NetId)>>,
}

/// Executes the microprogram of a design, which the DSL has accepted.
///
/// # Errors
/// A microprogram that has no fixed bound, waits for `start` on the way or gives several results; a
/// result that depends on what an earlier computation has left.
pub fn unroll(design: &Design) -> Result<Unrolled, Diagnostics> {
    run(design, Iterations::OneByOne).map_err(|diagnostic| Diagnostics(vec![diagnostic]))
}

/// The same with fewer values, where iterations of a loop can be taken together.
///
/// # Errors
/// Those of [`unroll`].
pub fn unroll_in_powers(design: &Design) -> Result<Unrolled, Diagnostics> {
    run(design, Iterations::InPowers).map_err(|diagnostic| Diagnostics(vec![diagnostic]))
}

/// How the iterations of a loop are executed of which operands decide the number.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Iterations {
    /// Each under the conditions of those before.
    OneByOne,
    /// Where the number is known by a few bits and the iterations are alike: 8, 4, 2 and 1, each under a bit of the number.
    InPowers,
}

/// The result that depends on what an earlier computation has left, in words; none where no result does, or where the
/// microprogram cannot be executed to its results so.
pub fn carried(design: &Design) -> Option<Diagnostic> {
    let (executor, results) = executed(design, Iterations::InPowers).ok()?;
    executor.determined(&results, "has a state between points, which nothing here speaks of").err()
}

fn run(design: &Design, iterations: Iterations) -> Result<Unrolled, Diagnostic> {
    let (mut executor, results) = executed(design, iterations)?;
    executor.determined(&results, "cannot be a pipeline")?;
    executor.unrolled.results = results;
    Ok(executor.unrolled)
}

/// The execution to the results, and these.
fn executed(
    design: &Design,
    iterations: Iterations,
) -> Result<(Executor<'_>, Vec<(NetId, NetId)>), Diagnostic> {
    let mut executor = Executor::new(design, iterations);
    let state = executor.power_up();
    let state = executor.start(&state);
    executor.follow(At { state, address: 0 }, None)?;
    let Some(results) = executor.shown.take() else {
        let place =
            design.control.microprogram.last().map_or(design.nets[0].location, |it| it.location);
        return Err(Diagnostic::new(
            "no microinstruction sets `valid`: a pipeline needs to know when the results are there"
                .to_owned(),
            place,
        ));
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
            unrolled: Unrolled {
                graph: Graph::default(),
                operands: operands.map(|port| port.net).collect(),
                results: Vec::new(),
                steps: Vec::new(),
            },
            shown: None,
        }
    }

    fn power_up(&mut self) -> State {
        let design = self.design;
        let graph = &mut self.unrolled.graph;
        let mut unknown = |net: &Net| {
            let cell = Cell::Unknown(net.name.clone());
            graph.leaf(cell, net.format, net.format.range(), &label(net))
        };
        State {
            registers: design.registers.iter().map(|it| unknown(design.net(it.q))).collect(),
            roms: design.roms.iter().map(|rom| unknown(design.net(rom.data))).collect(),
        }
    }

    /// The clock that takes `start`, with all operands.
    fn start(&mut self, state: &State) -> State {
        Clock::new(self, state, 0, true).edge()
    }

    /// Executes from `at` on until the results are shown or `stop` is about to be executed; returns the
    /// state there.
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
                    let condition = condition.expect("a loop has a condition");
                    match self.unrolled.graph.constant_of(condition) {
                        Some(taken) => {
                            let address = if taken == 1 { to } else { at.address + 1 };
                            at = At { state: after, address };
                        }
                        None if to <= at.address => {
                            let free = at.state.registers.clone();
                            let state =
                                self.iterations(after, condition, (to, at.address), &free)?;
                            at = At { state, address: at.address + 1 };
                        }
                        None => {
                            let body = At { state: after.clone(), address: at.address + 1 };
                            let Some(executed) = self.follow(body, Some(to))? else {
                                return Err(self.cannot(
                                    at.address,
                                    "is skipped by some points, and shows results",
                                ));
                            };
                            let state = self.either(condition, &executed, &after);
                            at = At { state, address: to };
                        }
                    }
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

    /// Every iteration but the first of the loop from `to` to `last`, of which `condition` says whether there
    /// is one; `state` is that after the first. The loop is bounded whatever the registers `free`, with
    /// which it begins, hold.
    ///
    /// What the condition is made of goes from iteration to iteration as if every iteration were taken: an iteration counts only where those
    /// before it were taken, and a counter needs no muxes then.
    fn iterations(
        &mut self,
        mut state: State,
        mut condition: NetId,
        (to, last): (usize, usize),
        free: &[NetId],
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
                        "goes on by a condition for which no bound is found: it depends on more than 16 bits",
                    ));
                }
            }
            let at = At { state: entry.clone(), address: to };
            let Some(before) = self.follow(at, Some(last))? else {
                return Err(self.cannot(last, "is executed under a condition, and shows results"));
            };
            let (after, again) = self.execute(&At { state: before, address: last })?;
            let again = again.expect("a loop has a condition");
            state = self.either(condition, &after, &state);
            let asked = self.unrolled.graph.cone([again]);
            for (at, held) in entry.registers.iter_mut().enumerate() {
                let is_asked = asked.binary_search(held).is_ok();
                counters[at] |= is_asked;
                *held = if is_asked { after.registers[at] } else { state.registers[at] };
            }
            entry.roms.clone_from(&state.roms);
            let label = self.unrolled.graph.node(again).label.clone();
            condition = self.unrolled.graph.op(Op::And(condition, again), Format::BIT, &label);
        }
    }

    /// The state after the iterations of a loop, of which there are as many as `conditions` hold, but for the registers that
    /// count them: 8, 4, 2 and 1 iterations, each under a bit of their number. None if an iteration depends on the registers that
    /// count them or on a memory, or the number on more than a few bits.
    fn in_powers(
        &mut self,
        first: &State,
        conditions: &[NetId],
        counters: &[bool],
        (to, last): (usize, usize),
        free: &[NetId],
    ) -> Option<State> {
        let (count, iterations) = possible::count(&self.unrolled.graph, conditions, free)?;
        // Three iterations are as many choices as two powers.
        let bits = conditions.len().checked_ilog2().filter(|&bits| bits > 1)? + 1;
        let (steps, visits) = (self.unrolled.steps.len(), self.visits.clone());
        let nodes = self.unrolled.graph.nodes.len();
        let unknown = self.power_up();
        let forget = |state: &mut State| {
            for (at, _) in counters.iter().enumerate().filter(|(_, counts)| **counts) {
                state.registers[at] = unknown.registers[at];
            }
        };
        let mut now = first.clone();
        forget(&mut now);
        for bit in (0..bits).rev() {
            let mut after = now.clone();
            for _ in 0..1 << bit {
                let before = self.follow(At { state: after, address: to }, Some(last)).ok()??;
                (after, _) = self.execute(&At { state: before, address: last }).ok()?;
                forget(&mut after);
                for held in &mut after.registers {
                    *held = settled(&mut self.unrolled.graph, *held);
                }
            }
            let graph = &mut self.unrolled.graph;
            let label = Label { named: false, ..graph.node(count).label.clone() };
            let bit_of = |iterations: usize| iterations >> bit & 1;
            let is_place = |place: &u32| {
                let mut values = iterations.iter().enumerate();
                values.all(|(at, it)| it.is_none_or(|it| bit_of(it) == at >> place & 1))
            };
            let taken = match (0..graph.width(count)).find(is_place) {
                Some(low) => graph.op(Op::Slice { of: count, low }, Format::BIT, &label),
                None => {
                    let bits = iterations.iter().map(|it| bit_of(it.unwrap_or(0)) as u64);
                    let inputs = bits.map(|it| graph.constant(it, Format::BIT, &label)).collect();
                    graph.op(Op::Mux { select: count, inputs }, Format::BIT, &label)
                }
            };
            now = self.either(taken, &after, &now);
        }
        self.unrolled.steps.truncate(steps);
        self.visits = visits;
        for node in &mut self.unrolled.graph.nodes[nodes..] {
            node.step = steps - 1;
        }
        let graph = &self.unrolled.graph;
        let pairs = || now.registers.iter().zip(&first.registers).enumerate();
        let changed = pairs().filter(|(at, (now, first))| !counters[*at] && now != first);
        let cone = graph.cone(changed.map(|(_, (now, _))| *now));
        let counted = counters.iter().zip(&unknown.registers).filter(|(counts, _)| **counts);
        let depends = counted.map(|(_, it)| it).any(|it| cone.binary_search(it).is_ok());
        (!depends && now.roms == first.roms).then_some(now)
    }

    /// One microinstruction: the state after it, and the condition of a loop.
    fn execute(&mut self, at: &At) -> Result<(State, Option<NetId>), Diagnostic> {
        let design = self.design;
        if self.unrolled.steps.len() == MOST_CLOCKS {
            return Err(
                self.cannot(at.address, "is part of a computation of more than 4096 clocks")
            );
        }
        let architectural =
            |kind| matches!(kind, RegisterKind::Architectural | RegisterKind::Operand);
        let registers = design.registers.iter().enumerate();
        let registers = registers
            .filter(|(_, register)| architectural(register.kind))
            .map(|(number, _)| (RegId(number as u32), at.state.registers[number]))
            .collect();
        let visit = self.visits[at.address];
        self.visits[at.address] += 1;
        self.unrolled.graph.step = self.unrolled.steps.len();
        self.unrolled.steps.push(Step { address: at.address, visit, registers });
        let mut clock = Clock::new(self, &at.state, at.address, false);
        if clock.shows()? {
            let results = clock.results()?;
            let state = at.state.clone();
            self.shown = Some(results);
            return Ok((state, None));
        }
        let condition = match design.control.microprogram[at.address].sequence {
            Sequence::LoopWhile { condition, .. } => Some(clock.value(condition)),
            _ => None,
        };
        Ok((clock.edge(), condition))
    }

    /// Each register as it is in `yes` where the condition holds, and else as in `no`.
    fn either(&mut self, condition: NetId, yes: &State, no: &State) -> State {
        let design = self.design;
        let graph = &mut self.unrolled.graph;
        let mut choose = |(&yes, &no): (&NetId, &NetId), net: &Net| {
            if yes == no {
                return yes;
            }
            let mux = Op::Mux { select: condition, inputs: vec![no, yes] };
            graph.op(mux, net.format, &label(net))
        };
        let registers = yes.registers.iter().zip(&no.registers);
        let roms = yes.roms.iter().zip(&no.roms);
        State {
            registers: registers
                .zip(&design.registers)
                .map(|(pair, register)| choose(pair, design.net(register.q)))
                .collect(),
            roms: roms
                .zip(&design.roms)
                .map(|(pair, rom)| choose(pair, design.net(rom.data)))
                .collect(),
        }
    }

    fn cannot(&self, address: usize, why: &str) -> Diagnostic {
        let microinstruction = &self.design.control.microprogram[address];
        Diagnostic::new(
            format!(
                "`{}` cannot be a pipeline: the microinstruction `{}` {why}",
                self.design.name, microinstruction.name
            ),
            microinstruction.location,
        )
    }

    /// No result depends on what an earlier computation has left.
    fn determined(&self, results: &[(NetId, NetId)], what: &str) -> Result<(), Diagnostic> {
        let graph = &self.unrolled.graph;
        for &(port, value) in results {
            for id in graph.cone([value]) {
                if let Cell::Unknown(register) = &graph.node(id).cell {
                    return Err(Diagnostic::new(
                        format!(
                            "`{}` {what}: `{}` depends on what `{register}` held before the computation; load \
                             `{register}` in each before it is read",
                            self.design.name,
                            self.design.net(port).name
                        ),
                        graph.node(id).label.location,
                    ));
                }
            }
        }
        Ok(())
    }
}

/// The nets of one clock.
struct Clock<'e, 'a> {
    executor: &'e mut Executor<'a>,
    state: &'e State,
    address: usize,
    /// The clock that takes `start`.
    first: bool,
    values: HashMap<NetId, NetId>,
}

impl<'e, 'a> Clock<'e, 'a> {
    fn new(executor: &'e mut Executor<'a>, state: &'e State, address: usize, first: bool) -> Self {
        Self { executor, state, address, first, values: HashMap::new() }
    }

    /// Whether `valid` is high.
    fn shows(&mut self) -> Result<bool, Diagnostic> {
        let Some(port) = self.executor.design.port(|role| role == Role::Valid) else {
            return Ok(false);
        };
        let net = port.net;
        let valid = self.value(net);
        match self.executor.unrolled.graph.constant_of(valid) {
            Some(bit) => Ok(bit == 1),
            None => Err(self.executor.cannot(
                self.address,
                "has `valid` follow a signal: a computation with several results is not unrolled",
            )),
        }
    }

    fn results(&mut self) -> Result<Vec<(NetId, NetId)>, Diagnostic> {
        let ports: Vec<NetId> = self
            .executor
            .design
            .ports
            .iter()
            .filter(|port| matches!(port.role, Role::Result | Role::Status))
            .map(|port| port.net)
            .collect();
        Ok(ports.into_iter().map(|port| (port, self.value(port))).collect())
    }

    /// The value of a net.
    fn value(&mut self, id: NetId) -> NetId {
        if let Some(&value) = self.values.get(&id) {
            return value;
        }
        let design = self.executor.design;
        let net = design.net(id);
        let label = label(net);
        let value = match &net.driver {
            Driver::Constant(bits) => self.constant(*bits, net.format, &label),
            Driver::Input => self.input(id, net, &label),
            Driver::Field(field) => {
                let bits = design.control.microprogram[self.address].values[field.index()];
                self.constant(bits, net.format, &label)
            }
            Driver::Register(register) if *register == design.control.run => {
                self.constant(u64::from(!self.first), net.format, &label)
            }
            Driver::Register(register) if *register == design.control.address => {
                self.constant(self.address as u64, net.format, &label)
            }
            Driver::Register(register) => self.state.registers[register.index()],
            Driver::Rom(rom) if design.rom(*rom).synchronous => self.state.roms[rom.index()],
            Driver::Rom(rom) => self.read(*rom),
            Driver::Op(op) => {
                let mut op = op.clone();
                // A mux under a field needs one of its inputs alone.
                if let Op::Mux { select, inputs } = &op {
                    let select = self.value(*select);
                    if let Some(chosen) = self.executor.unrolled.graph.constant_of(select) {
                        op = Op::Relabel(inputs[(chosen as usize).min(inputs.len() - 1)]);
                    }
                }
                for operand in op.operands_mut() {
                    *operand = self.value(*operand);
                }
                self.executor.unrolled.graph.op(op, net.format, &label)
            }
            Driver::Undriven => unreachable!("a checked design has no undriven net"),
        };
        self.values.insert(id, value);
        value
    }

    fn constant(&mut self, bits: u64, format: Format, label: &Label) -> NetId {
        self.executor.unrolled.graph.constant(bits, format, label)
    }

    fn input(&mut self, id: NetId, net: &Net, label: &Label) -> NetId {
        let design = self.executor.design;
        let role = design.ports.iter().find(|port| port.net == id).map(|port| port.role);
        match role {
            Some(Role::Start | Role::Strobe) => {
                self.constant(u64::from(self.first), net.format, label)
            }
            Some(Role::Reset) => self.constant(1, net.format, label),
            _ => {
                let operands = &self.executor.unrolled.operands;
                let at = operands.iter().position(|&operand| operand == id);
                let cell = match at {
                    Some(at) if self.first => Cell::Operand(at),
                    _ => Cell::Unknown(net.name.clone()),
                };
                self.executor.unrolled.graph.leaf(cell, net.format, net.range, label)
            }
        }
    }

    fn read(&mut self, rom: RomId) -> NetId {
        let design = self.executor.design;
        let address = self.value(design.rom(rom).address);
        let net = design.net(design.rom(rom).data);
        let words = &design.rom(rom).words;
        self.executor.unrolled.graph.read(rom, address, words, net.format, &label(net))
    }

    /// The rising edge: what registers and synchronous ROMs hold after it.
    fn edge(&mut self) -> State {
        let design = self.executor.design;
        let mut after = self.state.clone();
        for (number, register) in design.registers.iter().enumerate() {
            if register.kind == RegisterKind::Sequencer {
                continue;
            }
            let enable = register.enable.map(|enable| self.value(enable));
            let fixed = enable.map_or(Some(1), |it| self.executor.unrolled.graph.constant_of(it));
            if fixed == Some(0) {
                continue;
            }
            let data = self.value(register.data.expect("a checked design has no register without"));
            let net = design.net(register.q);
            let graph = &mut self.executor.unrolled.graph;
            let mut held = graph.op(Op::Relabel(data), net.format, &label(net));
            if let (Some(select), None) = (enable, fixed) {
                let inputs = vec![self.state.registers[number], held];
                held = graph.op(Op::Mux { select, inputs }, net.format, &label(net));
            }
            after.registers[number] = if register.kind == RegisterKind::Internal {
                held
            } else {
                graph.name_after(held, &label(net));
                graph.refine(held, net.range)
            };
        }
        for (number, rom) in design.roms.iter().enumerate() {
            if rom.synchronous {
                after.roms[number] = self.read(RomId(number as u32));
            }
        }
        after
    }
}

fn label(net: &Net) -> Label {
    Label {
        name: net.name.clone(),
        doc: if net.doc_topic == Topic::Device { net.doc.clone() } else { String::new() },
        block: net.block,
        named: net.named,
        part_of: None,
        location: net.location,
    }
}

//! A microprogram executed on values: from operands to results, without a clock.
//!
//! Every field of the control word is a constant in its clock, so multiplexers are wires and enables are
//! decided. A loop that counts a constant unrolls by itself. One that depends on an operand is executed as
//! often as its counter can ask for; what it leaves is chosen by the conditions of its iterations.

use anyhow::{Context, Result, bail, ensure};

use super::graph::{Graph, Node, State};
use crate::base::fixed::{Format, mask};
use crate::hdl::netlist::termination;
use crate::hdl::netlist::{Design, NetId, Op, RegId, Role, RomId, Sequence};

/// More values than any core has that somebody would call as a function.
const MOST_VALUES: usize = 200_000;

/// The results of a computation as values of its operands.
pub struct Straight {
    /// The values.
    pub graph: Graph,
    /// What is on the result outputs, in port order.
    pub results: Vec<NetId>,
    /// A heading for each section: the microinstruction that it stands for.
    pub sections: Vec<String>,
}

/// A clock of a core that runs, and what its registers hold before the first.
pub struct Stepped {
    /// Values of the operands: the state after the clock that takes `start`.
    pub first: Graph,
    /// See above.
    pub initial: State,
    /// Values of the state before a clock.
    pub each: Graph,
    /// What is on the nets in that clock.
    pub clock: Vec<NetId>,
    /// The state after it.
    pub next: State,
}

/// Results as values of operands, for a core with one result a computation.
///
/// # Errors
/// A core that has no result, waits for `start` in a microinstruction, goes on without a bound, or shows what it kept from an
/// earlier computation.
pub fn straight(design: &Design) -> Result<Straight> {
    let mut walk = Walk::new(design)?;
    let state = walk.started()?;
    let results = walk.results(state)?;
    let needed = walk.graph.needed(&results);
    for (value, _) in walk.graph.values.iter().zip(needed).filter(|(_, needed)| *needed) {
        let kept = match value.node {
            Node::State(register) => &design.net(design.register(register).q).name,
            Node::Read(rom) => &design.rom(rom).name,
            _ => continue,
        };
        bail!("the results of `{}` depend on what `{kept}` held before", design.name);
    }
    Ok(Straight { graph: walk.graph, results, sections: walk.sections })
}

/// One clock of a core with several results a computation.
///
/// # Errors
/// A loop in the netlist, or a net without a driver.
pub fn stepped(design: &Design) -> Result<Stepped> {
    let mut walk = Walk::new(design)?;
    let initial = walk.started()?;
    let first = std::mem::take(&mut walk.graph);
    let mut state = walk.unknown();
    // The loop of the model ends with the computation.
    let run = design.control.run;
    state.registers[run.index()] = walk.graph.constant(1, Format::BIT);
    let clock = walk.clock(&state, false)?;
    let next = walk.graph.after(design, &state, &clock)?;
    Ok(Stepped { first, initial, each: walk.graph, clock, next })
}

struct Walk<'d> {
    design: &'d Design,
    order: Vec<NetId>,
    graph: Graph,
    sections: Vec<String>,
    /// For each microinstruction the most iterations of its loop.
    left: Option<Vec<termination::Left>>,
}

impl<'d> Walk<'d> {
    fn new(design: &'d Design) -> Result<Self> {
        let order = design.levelise();
        let order = order.map_err(|_| anyhow::anyhow!("a combinational loop"))?;
        Ok(Self {
            design,
            order,
            graph: Graph::default(),
            sections: vec!["the clock that takes start".to_owned()],
            left: termination::remaining(design),
        })
    }

    /// Nothing is known of registers.
    fn unknown(&mut self) -> State {
        let registers = 0..self.design.registers.len() as u32;
        let registers = registers.map(|at| {
            let format = self.design.net(self.design.register(RegId(at)).q).format;
            self.graph.make(Node::State(RegId(at)), format)
        });
        let registers = registers.collect();
        let reads = 0..self.design.roms.len() as u32;
        let reads = reads.map(|at| {
            let format = self.design.net(self.design.rom(RomId(at)).data).format;
            self.graph.make(Node::Read(RomId(at)), format)
        });
        State { registers, reads: reads.collect() }
    }

    /// The state after the clock that takes `start` and all operands.
    fn started(&mut self) -> Result<State> {
        let mut state = self.unknown();
        for (at, register) in self.design.registers.iter().enumerate() {
            if let Some(bits) = register.reset {
                let format = self.design.net(register.q).format;
                state.registers[at] = self.graph.constant(bits, format);
            }
        }
        let clock = self.clock(&state, true)?;
        self.graph.after(self.design, &state, &clock)
    }

    fn clock(&mut self, state: &State, start: bool) -> Result<Vec<NetId>> {
        let design = self.design;
        self.graph.clock(design, &self.order, state, |graph, net| {
            let format = design.net(net).format;
            match design.ports.iter().find(|port| port.net == net).map(|port| port.role) {
                Some(Role::Reset) => graph.constant(1, format),
                Some(Role::Start | Role::Strobe) => graph.constant(u64::from(start), format),
                _ => graph.make(Node::Input(net), format),
            }
        })
    }

    /// What the outputs show when `valid` is high, from a state within the microprogram.
    fn results(&mut self, mut state: State) -> Result<Vec<NetId>> {
        let design = self.design;
        let valid = design.port(|role| role == Role::Valid).context("it has no output valid")?.net;
        loop {
            ensure!(self.graph.values.len() < MOST_VALUES, "it is too long to be unrolled");
            let address = self.address(&state)?;
            self.enter(address, "");
            let clock = self.clock(&state, false)?;
            match self.graph.constant_of(clock[valid.index()]) {
                Some(0) => {}
                Some(_) => {
                    let results = design.outputs().filter(|port| port.role == Role::Result);
                    return Ok(results.map(|port| clock[port.net.index()]).collect());
                }
                None => bail!(
                    "whether it is valid in microinstruction {address} depends on its operands"
                ),
            }
            let next = self.graph.after(design, &state, &clock)?;
            let following = next.registers[design.control.address.index()];
            if self.graph.constant_of(following).is_some() {
                let run = next.registers[design.control.run.index()];
                ensure!(self.graph.constant_of(run) == Some(1), "it ends without a result");
                state = next;
                continue;
            }
            let Sequence::LoopWhile { to, condition } =
                design.control.microprogram[address].sequence
            else {
                bail!("what follows microinstruction {address} depends on its operands");
            };
            if to == address {
                state = self.iterations(address, condition, clock, next)?;
            } else {
                ensure!(
                    to > address,
                    "the loop from microinstruction {address} back to {to} has no bound"
                );
                let select = clock[condition.index()];
                let on = self.at(&next, address + 1);
                let on = self.results(on)?;
                let over = self.at(&next, to);
                let over = self.results(over)?;
                let pairs = on.into_iter().zip(over);
                return pairs.map(|(on, over)| self.chosen(select, on, over)).collect();
            }
        }
    }

    /// The state after a loop of one microinstruction; `clock` and `next` are of its first iteration.
    fn iterations(
        &mut self,
        address: usize,
        condition: NetId,
        mut clock: Vec<NetId>,
        mut next: State,
    ) -> Result<State> {
        let design = self.design;
        let counter = self.left.as_ref().and_then(|left| left[address].counter);
        let counter = counter
            .with_context(|| format!("the loop in microinstruction {address} has no bound"))?;
        let most = mask(design.width(design.register(counter).q));
        let mut iterations = Vec::new();
        loop {
            let more = clock[condition.index()];
            let ended = self.at(&next, address + 1);
            iterations.push((more, ended));
            if iterations.len() as u64 > most || self.graph.constant_of(more) == Some(0) {
                break;
            }
            ensure!(self.graph.values.len() < MOST_VALUES, "it is too long to be unrolled");
            self.enter(address, &format!(", turn {}", iterations.len() + 1));
            let state = self.at(&next, address);
            clock = self.clock(&state, false)?;
            next = self.graph.after(design, &state, &clock)?;
        }
        self.enter(address, ", what it leaves");
        let (_, mut merged) = iterations.pop().context("a loop has an iteration")?;
        for (more, ended) in iterations.into_iter().rev() {
            for (at, merged) in merged.registers.iter_mut().enumerate() {
                *merged = self.chosen(more, ended.registers[at], *merged)?;
                let net = design.net(design.registers[at].q);
                self.graph.name(*merged, &net.name, true);
            }
            for (at, merged) in merged.reads.iter_mut().enumerate() {
                *merged = self.chosen(more, ended.reads[at], *merged)?;
            }
        }
        Ok(merged)
    }

    fn chosen(&mut self, select: NetId, at_0: NetId, at_1: NetId) -> Result<NetId> {
        let format = self.graph.value(at_0).format;
        self.graph.op(Op::Mux { select, inputs: vec![at_0, at_1] }, format)
    }

    /// The state with another microinstruction to come.
    fn at(&mut self, state: &State, next: usize) -> State {
        let address = self.design.control.address;
        let format = self.design.net(self.design.register(address).q).format;
        let mut state = state.clone();
        state.registers[address.index()] = self.graph.constant(next as u64, format);
        state
    }

    fn address(&self, state: &State) -> Result<usize> {
        let address = state.registers[self.design.control.address.index()];
        let address = self
            .graph
            .constant_of(address)
            .context("the address of the microinstruction is not known")?;
        let microprogram = &self.design.control.microprogram;
        let waits = microprogram.get(address as usize).map(|it| &it.sequence);
        ensure!(waits.is_some(), "there is no microinstruction {address}");
        ensure!(waits != Some(&Sequence::WaitStart), "microinstruction {address} waits for start");
        Ok(address as usize)
    }

    fn enter(&mut self, address: usize, iteration: &str) {
        let name = &self.design.control.microprogram[address].name;
        self.graph.section = self.sections.len();
        self.sections.push(format!("{address}: {name}{iteration}"));
    }
}

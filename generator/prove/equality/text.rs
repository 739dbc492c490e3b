//! Proves that the emitted Verilog of a pipeline and its netlist show the same results for every point (one set of operands). All
//! outputs except `in_ready` and `table_ready` are compared. The proof holds for any earlier contents of registers and memories,
//! except the slot counter.
//!
//! Yosys has read the Verilog, and the module executes netlist and Verilog on symbolic terms, with unknown registers and
//! memories at the beginning. [`Counters`] finds the slot counter, and proves that every memory is a delay line. The module
//! proves that a clock in which the pipeline waits for `out_ready` changes nothing, and then compares the clocks from a point
//! to its results. A register of the Verilog that equals a net takes the net's term, so a question concerns little more than
//! one clock.

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use anyhow::{Context, Result, anyhow, ensure};
use serde_json::Value;

use super::Open;
use super::cells::WireValues;
use super::delays::{Counters, Roles};
use super::module::{Module, Read, RegisterContents};
use super::solver::{Solver, SolverAnswer};
use super::split_products::samples;
use super::symbolic::{Execution, Product};
use super::term::{VectorTerm, VectorTermId, VectorTerms};
use glint_rtl::netlist::{Design, Port, Role};
use glint_tools::Tool;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextVerdict {
    Equal(TextProof),
    /// An output of the Verilog differs from the netlist, or a clock in which the pipeline waits changes a register or a
    /// memory of the Verilog. The string states the difference and the values of the inputs.
    Different(String),
    Open(Open),
    /// The Verilog contains something that this module cannot interpret, or one of its memories is no delay line.
    Unread(String),
}

/// The size of a proof that the emitted Verilog of a pipeline equals its netlist.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextProof {
    pub outputs: usize,
    /// The number of Verilog registers that are proved equal to a net of the netlist, counted for every clock of a point.
    pub registers: usize,
    /// The largest number of clocks from a write to a read, for each read port of each written memory.
    pub delays: Vec<usize>,
    /// The number of questions to the solver. An equality needs no question if both sides are the same term.
    pub questions: usize,
}

/// Proves that the emitted Verilog of a pipeline equals the pipeline's netlist, or finds a difference. `text` is the JSON of
/// [`glint_tools::elaborate`] for this Verilog. `limit` is the time limit of all answers of the solver together.
///
/// # Errors
/// Fails if the design is no pipeline. Fails if the Verilog lacks an output of the netlist or has an output of another width, or
/// if the solver cannot be run.
pub fn compare_text(
    design: &Design,
    text: &Value,
    solver: &Tool,
    limit: Duration,
) -> Result<TextVerdict> {
    let pipeline = design.pipeline.as_ref().context("the design is not a pipeline")?;
    let latency = pipeline.stages.len();
    let roles = design.ports.iter().map(|it| (design.net(it.net).name.clone(), it.role)).collect();
    let read = || -> Result<(Module, Counters)> {
        let module = Module::new(text)?;
        let counters = Counters::new(&module, &roles, pipeline.interval)?;
        Ok((module, counters))
    };
    let (module, counters) = match read() {
        Ok(read) => read,
        Err(error) => return Ok(TextVerdict::Unread(format!("{error:#}"))),
    };
    let mut comparison = TextComparison {
        design,
        module: &module,
        roles: &roles,
        counters: &counters,
        latency,
        terms: VectorTerms::default(),
        inputs: HashMap::new(),
        products: Vec::new(),
        unknown_registers: HashMap::new(),
        solver: Solver::new(solver, limit)?,
        proof: TextProof { delays: counters.longest_delays(), ..TextProof::default() },
    };
    match comparison.stays().and_then(|()| comparison.follows_a_point()) {
        Ok(()) => {
            comparison.proof.questions = comparison.solver.asked;
            Ok(TextVerdict::Equal(comparison.proof))
        }
        Err(EarlyEnd::Verdict(verdict)) => Ok(verdict),
        Err(EarlyEnd::Error(error)) => Err(error),
    }
}

/// The reason why a comparison ends before every output is compared.
enum EarlyEnd {
    Verdict(TextVerdict),
    Error(anyhow::Error),
}

impl From<anyhow::Error> for EarlyEnd {
    fn from(error: anyhow::Error) -> Self {
        Self::Error(error)
    }
}

impl From<TextVerdict> for EarlyEnd {
    fn from(verdict: TextVerdict) -> Self {
        Self::Verdict(verdict)
    }
}

struct TextComparison<'p> {
    design: &'p Design,
    module: &'p Module,
    roles: &'p Roles,
    counters: &'p Counters,
    latency: usize,
    terms: VectorTerms,
    /// The terms of the inputs. The key is the name and the clock.
    inputs: HashMap<(String, usize), VectorTermId>,
    products: Vec<Product>,
    /// For the term of each register of the netlist in the present clock, an unknown of the same width.
    unknown_registers: HashMap<VectorTermId, VectorTermId>,
    solver: Solver<'p>,
    proof: TextProof,
}

/// Returns the term of an input in clock number `clock`; the point enters in clock 0. The handshake is fixed: no reset,
/// `out_ready` is 1, and `in_valid` is 1 in clock 0. The remaining inputs are unknowns, one for each `name` and `clock`.
fn input(
    terms: &mut VectorTerms,
    inputs: &mut HashMap<(String, usize), VectorTermId>,
    name: &str,
    role: Option<Role>,
    width: u32,
    clock: usize,
) -> VectorTermId {
    match role {
        Some(Role::Reset | Role::OutReady) => terms.constant(1, width),
        Some(Role::InValid) if clock == 0 => terms.constant(1, width),
        _ => *inputs.entry((name.to_owned(), clock)).or_insert_with(|| terms.unknown(width)),
    }
}

impl TextComparison<'_> {
    /// Proves, for every value of the slot counter, that a clock in which the pipeline waits changes no register and no
    /// memory. A pipeline without `out_ready` never waits.
    fn stays(&mut self) -> Result<(), EarlyEnd> {
        let has = |role| self.roles.values().any(|it| *it == role);
        if has(Role::OutReady) {
            for slot in 0..self.counters.slots.len() {
                self.stays_in_slot(slot)?;
            }
        }
        Ok(())
    }

    /// Returns the registers with constants in the slot counter and unknowns in all other registers.
    fn registers_in_slot(&mut self, slot: usize) -> RegisterContents {
        let mut held = self.module.power_up(&mut self.terms);
        for (&register, &bits) in &self.counters.slots[slot] {
            let width = self.terms.width(held[register][0]);
            held[register] = vec![self.terms.constant(bits, width)];
        }
        held
    }

    /// Proves that a clock in the slot either moves all points or changes nothing. A clock that moves no point must change no
    /// register and no memory. A clock that moves the points must have the effect of a clock with `out_ready` = 1. With an
    /// interval of 1, the points move if `in_ready` is 1. With a longer interval, they move if the slot counter counts.
    fn stays_in_slot(&mut self, slot: usize) -> Result<(), EarlyEnd> {
        let module = self.module;
        let held = self.registers_in_slot(slot);
        let mut reads: HashMap<Read, Vec<VectorTermId>> = HashMap::new();
        let mut clock = |it: &mut Self,
                         out_ready: Option<u64>|
         -> Result<(WireValues, RegisterContents)> {
            let (roles, inputs) = (it.roles, &mut it.inputs);
            let input = |terms: &mut VectorTerms, name: &str, width: u32| match roles.get(name) {
                Some(Role::Reset) => terms.constant(1, width),
                Some(Role::OutReady) if out_ready.is_some() => terms.constant(1, width),
                // These inputs belong to no clock of the point.
                _ => *inputs
                    .entry((name.to_owned(), usize::MAX))
                    .or_insert_with(|| terms.unknown(width)),
            };
            let read = |terms: &mut VectorTerms, read: Read| {
                let any = || module.memories[read.memory].any(terms);
                reads.entry(read).or_insert_with(any).clone()
            };
            let values = module.settle(&mut it.terms, &held, input, read)?;
            let next = module.edge(&mut it.terms, &values);
            Ok((values, next))
        };
        let (any, after_any) = clock(self, None)?;
        let (taken, after_taken) = clock(self, Some(1))?;
        let ready = self.roles.iter().find(|(_, role)| **role == Role::InReady);
        let ready = ready.context("the pipeline has no output `in_ready`")?.0;
        let shown = [&any, &taken].map(|it| module.shown(&mut self.terms, it).get(ready).copied());
        let [Some(ready), Some(ready_if_taken)] = shown else {
            return Err(anyhow!("the emitted Verilog has no output `{ready}`").into());
        };
        let (moves, moved) = match self.counters.slots[slot].keys().next() {
            None => (ready, ready_if_taken),
            Some(&counter) => {
                let before = held[counter][0];
                let moves = self.counts(before, after_any[counter][0]);
                let takes = if slot == 0 { moves } else { self.terms.constant(0, 1) };
                self.must_equal(None, ready, takes, "`in_ready`")?;
                (moves, self.counts(before, after_taken[counter][0]))
            }
        };
        let one = self.terms.constant(1, 1);
        self.must_equal(None, moved, one, "a pipeline moves when its results are taken")?;
        let why = "a clock in which no point moves";
        for (before, after) in held.iter().flatten().zip(after_any.iter().flatten()) {
            self.must_equal(Some((moves, false)), *before, *after, why)?;
        }
        for memory in &module.memories {
            let ports = memory.control(&mut self.terms, &any);
            for &enable in &ports[1 + memory.reads.len()..] {
                let none = self.terms.constant(0, self.terms.width(enable));
                self.must_equal(Some((moves, false)), enable, none, why)?;
            }
        }
        let why = "a clock in which all points move";
        for (one, other) in after_any.iter().flatten().zip(after_taken.iter().flatten()) {
            self.must_equal(Some((moves, true)), *one, *other, why)?;
        }
        for memory in &module.memories {
            let [one, other] = [&any, &taken].map(|values| memory.control(&mut self.terms, values));
            // A read gives the same word in both only if the address is the same.
            let reads = 1..=memory.reads.len();
            if one[reads.clone()] != other[reads.clone()] {
                let why = "the read address of a memory in the emitted Verilog depends on more than registers";
                return Err(TextVerdict::Unread(why.to_owned()).into());
            }
            let enables = reads.end() + 1..one.len();
            for at in enables.clone() {
                self.must_equal(Some((moves, true)), one[at], other[at], why)?;
            }
            // A word that is not written has no address and no data that matter.
            if other[enables].iter().all(|&enable| self.terms.constant_of(enable) == Some(0)) {
                continue;
            }
            self.must_equal(Some((moves, true)), one[0], other[0], why)?;
            let [one, other] = [&any, &taken].map(|values| memory.written(&mut self.terms, values));
            for (one, other) in one.into_iter().zip(other) {
                self.must_equal(Some((moves, true)), one, other, why)?;
            }
        }
        Ok(())
    }

    /// Returns a one-bit term that is 1 if the value `after` a clock differs from the value `before`.
    fn counts(&mut self, before: VectorTermId, after: VectorTermId) -> VectorTermId {
        match *self.terms.term(after) {
            // The condition itself, so it can be replaced by its value in other terms.
            VectorTerm::Choice(condition, next, kept) if kept == before && next != before => {
                condition
            }
            _ => {
                let equal = self.terms.equal(before, after);
                self.terms.not(equal)
            }
        }
    }

    /// Proves that netlist and Verilog have the same outputs in the clock in which a point's results are shown.
    fn follows_a_point(&mut self) -> Result<(), EarlyEnd> {
        let nets = self.netlist()?;
        let module = self.module;
        let mut held = self.registers_in_slot(0);
        let mut written: Vec<Vec<Vec<VectorTermId>>> = Vec::new();
        for clock in 0..=self.latency {
            self.forget_registers(&nets[clock]);
            let (roles, inputs, counters) = (self.roles, &mut self.inputs, self.counters);
            let input = |terms: &mut VectorTerms, name: &str, width: u32| {
                input(terms, inputs, name, roles.get(name).copied(), width, clock)
            };
            let read = |terms: &mut VectorTerms, read: Read| {
                let delay = counters.delay(read, clock);
                match delay.and_then(|delay| clock.checked_sub(delay)) {
                    Some(before) => written[before][read.memory].clone(),
                    None => module.memories[read.memory].any(terms),
                }
            };
            let values = module.settle(&mut self.terms, &held, input, read)?;
            if clock == self.latency {
                return self.results(&values, &nets[clock]);
            }
            let terms = &mut self.terms;
            written.push(module.memories.iter().map(|it| it.written(terms, &values)).collect());
            held = module.edge(terms, &values);
            self.register(&mut held, &nets[clock + 1])?;
        }
        Ok(())
    }

    /// Returns the term of every net of the netlist in each clock, from the clock in which the point enters to the clock with its
    /// results.
    fn netlist(&mut self) -> Result<Vec<Vec<VectorTermId>>> {
        let design = self.design;
        let execution = Execution::new(&mut self.terms, design);
        let mut state = execution.power_up(&mut self.terms);
        let slot = design.pipeline.as_ref().and_then(|pipeline| pipeline.slot);
        for (register, held) in design.registers.iter().zip(&mut state.registers) {
            if Some(register.q) == slot {
                *held = self.terms.constant(0, design.width(register.q));
            }
        }
        let mut nets = Vec::new();
        for clock in 0..=self.latency {
            let inputs = &mut self.inputs;
            let values = execution.settle(
                &mut self.terms,
                &state,
                |terms, net, role| {
                    let (name, width) = (&design.net(net).name, design.width(net));
                    input(terms, inputs, name, Some(role), width, clock)
                },
                &mut self.products,
            );
            state = execution.edge(&mut self.terms, &state, &values);
            nets.push(values);
        }
        if let Some(ready) = design.port(|role| role == Role::InReady) {
            let taken = self.terms.constant_of(nets[0][ready.net.index()]);
            ensure!(taken == Some(1), "the netlist does not accept a point in slot 0");
        }
        Ok(nets)
    }

    /// Fills `unknown_registers` for the present clock, except for terms that are already constants or unknowns. `nets` are the
    /// terms of the nets in this clock.
    fn forget_registers(&mut self, nets: &[VectorTermId]) {
        self.unknown_registers.clear();
        for register in &self.design.registers {
            let held = nets[register.q.index()];
            let is_free =
                matches!(self.terms.term(held), VectorTerm::Unknown(_) | VectorTerm::Constant(_));
            if !is_free && !self.unknown_registers.contains_key(&held) {
                let unknown = self.terms.unknown(self.terms.width(held));
                self.unknown_registers.insert(held, unknown);
            }
        }
    }

    /// Replaces the terms in registers of the Verilog by terms of nets that the solver proves equal. `nets` are the terms of
    /// the netlist's nets in the same clock. A register without an equal net keeps its term.
    fn register(&mut self, held: &mut RegisterContents, nets: &[VectorTermId]) -> Result<()> {
        let known: HashSet<VectorTermId> = nets.iter().copied().collect();
        let cone = self.terms.cone(held.iter().flatten().chain(nets).copied());
        // Terms that do not depend on the point need no comparison.
        let mut ours: HashSet<VectorTermId> =
            self.inputs.iter().filter(|((_, clock), _)| *clock == 0).map(|(_, id)| *id).collect();
        for &id in &cone {
            if self.terms.term(id).operands().iter().any(|it| ours.contains(it)) {
                ours.insert(id);
            }
        }
        let is_open = |it: &VectorTermId| ours.contains(it) && !known.contains(it);
        let all = held.iter().flatten().filter(|it| ours.contains(it));
        self.proof.registers += all.filter(|it| known.contains(it)).count();
        if !held.iter().flatten().any(is_open) {
            return Ok(());
        }
        let values: Vec<HashMap<VectorTermId, u64>> = samples(&self.terms, &cone).collect();
        let key = |terms: &VectorTerms, id: VectorTermId| {
            let values: Vec<u64> = values.iter().map(|values| values[&id]).collect();
            (terms.width(id), values)
        };
        let mut alike = HashMap::new();
        for &net in nets {
            if ours.contains(&net) {
                alike.entry(key(&self.terms, net)).or_insert(net);
            }
        }
        for column in held.iter_mut().flatten().filter(|it| is_open(it)) {
            let Some(&net) = alike.get(&key(&self.terms, *column)) else { continue };
            let equal = self.terms.equal(*column, net);
            let differ = self.terms.not(equal);
            if let SolverAnswer::Unsatisfiable = self.ask(&[differ])? {
                *column = net;
                self.proof.registers += 1;
            }
        }
        Ok(())
    }

    fn results(&mut self, values: &WireValues, nets: &[VectorTermId]) -> Result<(), EarlyEnd> {
        let shown = self.module.shown(&mut self.terms, values);
        // The handshake's proof is about the other outputs.
        let is_result = |port: &&Port| !matches!(port.role, Role::InReady | Role::TableReady);
        for port in self.design.outputs().filter(is_result) {
            let name = &self.design.net(port.net).name;
            let own = shown
                .get(name)
                .with_context(|| format!("the emitted Verilog has no output `{name}`"))?;
            self.must_equal(None, *own, nets[port.net.index()], &format!("`{name}`"))?;
            self.proof.outputs += 1;
        }
        Ok(())
    }

    /// Proves that two terms are equal. With `condition`, a bit and its value, they need only be equal if the bit has this value.
    /// For example, a register must keep its value if `in_ready` is 0. `what` names the terms in a message.
    fn must_equal(
        &mut self,
        condition: Option<(VectorTermId, bool)>,
        one: VectorTermId,
        other: VectorTermId,
        what: &str,
    ) -> Result<(), EarlyEnd> {
        if self.terms.width(one) != self.terms.width(other) {
            return Err(anyhow!("{what} has another width in the netlist").into());
        }
        let mut both = [one, other];
        if let Some((bit, value)) = condition {
            self.terms.assuming(bit, value, &mut both);
        }
        if both[0] == both[1] {
            return Ok(());
        }
        let equal = self.terms.equal(both[0], both[1]);
        let mut wanted = vec![self.terms.not(equal)];
        if let Some((bit, value)) = condition {
            wanted.push(if value { bit } else { self.terms.not(bit) });
        }
        if let Some(difference) = self.difference(&wanted, both, what, &HashMap::new()) {
            return Err(TextVerdict::Different(difference).into());
        }
        match self.ask(&wanted)? {
            SolverAnswer::Unsatisfiable => Ok(()),
            SolverAnswer::Undecided(open) => Err(TextVerdict::Open(open).into()),
            SolverAnswer::Satisfiable(found) => {
                let found = found.into_iter().collect();
                match self.difference(&wanted, both, what, &found) {
                    Some(difference) => Err(TextVerdict::Different(difference).into()),
                    None => Err(TextVerdict::Open(Open::Unknown).into()),
                }
            }
        }
    }

    /// Asks the solver whether the one-bit terms `wanted` can all be 1. The first question has unknowns in place of the
    /// registers, so it concerns the logic of one clock alone. "Never" as an answer then holds for every value of the registers.
    /// The second question has the terms of the registers. The third also has the facts about partial products.
    fn ask(&mut self, wanted: &[VectorTermId]) -> Result<SolverAnswer> {
        let mut of_one_clock = wanted.to_vec();
        self.terms.replace(&self.unknown_registers, &mut of_one_clock);
        if of_one_clock != wanted
            && let SolverAnswer::Unsatisfiable =
                self.solver.ask(&mut self.terms, &of_one_clock, &self.products, false)?
        {
            return Ok(SolverAnswer::Unsatisfiable);
        }
        match self.solver.ask(&mut self.terms, wanted, &self.products, false)? {
            SolverAnswer::Unsatisfiable => Ok(SolverAnswer::Unsatisfiable),
            _ => self.solver.ask(&mut self.terms, wanted, &self.products, true),
        }
    }

    /// Finds values of the unknowns for which all `wanted` terms are 1, and describes how the two terms then differ. Returns
    /// `None` without such values.
    fn difference(
        &self,
        wanted: &[VectorTermId],
        [one, other]: [VectorTermId; 2],
        what: &str,
        found: &HashMap<VectorTermId, u64>,
    ) -> Option<String> {
        let cone = self.terms.cone(wanted.iter().copied().chain([one, other]));
        let number = |&id: &VectorTermId| match *self.terms.term(id) {
            VectorTerm::Unknown(number) => Some((number, found.get(&id).copied())),
            _ => None,
        };
        let found: HashMap<u32, Option<u64>> = cone.iter().filter_map(number).collect();
        let chosen = |number: u32| found.get(&number).copied().flatten();
        let solved = self.terms.values(&cone, |number| chosen(number).unwrap_or(0));
        let values = samples(&self.terms, &cone).chain([solved]);
        let values = values.into_iter().find(|values| wanted.iter().all(|it| values[it] == 1))?;
        let inputs = self
            .inputs
            .iter()
            .filter(|((_, clock), id)| [0, usize::MAX].contains(clock) && values.contains_key(id));
        let mut inputs: Vec<String> =
            inputs.map(|((name, _), id)| format!(" {name}={:#x}", values[id])).collect();
        inputs.sort();
        Some(format!(
            "{what}: {:#x} in the emitted Verilog and {:#x} in the netlist for{}",
            values[&one],
            values[&other],
            inputs.concat()
        ))
    }
}

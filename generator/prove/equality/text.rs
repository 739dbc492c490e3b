//! Proves that the emitted Verilog of a pipeline shows what its netlist shows, for every point and from any state.
//!
//! The netlist and the text, as Yosys reads it, are executed on terms, from registers and memories that hold anything.
//! A memory that is written must be a delay: a read gives the word of a fixed number of clocks before (`delays`). A
//! clock in which points stay changes nothing (`stays`), so that it is enough to follow a point while none stays. A
//! register of the text that is equal to a net takes the net's term, so that the solver sees one clock at a time.

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use super::Open;
use super::cells::WireValues;
use super::module::{Memory, Module, Read, RegisterContents};
use super::solver::{Solver, SolverAnswer};
use super::split_products::samples;
use super::symbolic::{Execution, Product};
use super::term::{VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Role};
use glint_tools::Tool;

/// The verdict on a text and its netlist.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextVerdict {
    /// Every output is the same for every point.
    Equal(TextProof),
    /// An output differs; for which values.
    Different(String),
    /// The solver does not decide it.
    Open(Open),
    /// The text contains something that is not known here, or one of its memories is no delay.
    Unread(String),
}

/// The parts of a proof.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextProof {
    /// Outputs that are equal.
    pub outputs: usize,
    /// Registers that hold a value of the netlist, counted in every clock of a point.
    pub registers: usize,
    /// Clocks from write to read of each memory that is written.
    pub delays: Vec<usize>,
    /// Questions to the solver; the rest are the same terms.
    pub questions: usize,
}

/// Compares the text of a pipeline, as [`glint_tools::elaborate`] reads it, with its netlist, within a time limit on the
/// solver.
///
/// # Errors
/// Fails if the design is no pipeline, or if the solver does not do its work.
pub fn compare_text(
    design: &Design,
    text: &Value,
    solver: &Tool,
    limit: Duration,
) -> Result<TextVerdict> {
    let pipeline = design.pipeline.as_ref().context("the design is no pipeline")?;
    let latency = pipeline.stages.len();
    if pipeline.interval > 1 {
        let why = "the text is followed for pipelines with pipeline.interval = 1 alone".to_owned();
        return Ok(TextVerdict::Unread(why));
    }
    let mut roles = Roles::new();
    for port in &design.ports {
        roles.insert(design.net(port.net).name.clone(), port.role);
    }
    let (module, delays) = match read_text(text, &roles) {
        Ok(read) => read,
        Err(error) => return Ok(TextVerdict::Unread(format!("{error:#}"))),
    };
    let mut comparison = TextComparison {
        design,
        module: &module,
        roles: &roles,
        delays: &delays,
        latency,
        terms: VectorTerms::default(),
        inputs: HashMap::new(),
        products: Vec::new(),
        solver: Solver::new(solver, limit)?,
        proof: TextProof { delays: delays.concat(), ..TextProof::default() },
    };
    match comparison.run() {
        Ok(()) => {
            comparison.proof.questions = comparison.solver.asked;
            Ok(TextVerdict::Equal(comparison.proof))
        }
        Err(error) => {
            let Ended(verdict) = error.downcast()?;
            Ok(verdict)
        }
    }
}

/// Reads the module of a text, and the clocks from write to read of each read port of its memories.
fn read_text(text: &Value, roles: &Roles) -> Result<(Module, Vec<Vec<usize>>)> {
    let module = Module::new(text)?;
    let delays = delays(&module, roles)?;
    Ok((module, delays))
}

/// Ends a comparison with its verdict.
#[derive(Debug)]
struct Ended(TextVerdict);

impl std::fmt::Display for Ended {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

impl std::error::Error for Ended {}

fn ended<T>(verdict: TextVerdict) -> Result<T> {
    Err(Ended(verdict).into())
}

type Roles = HashMap<String, Role>;

/// Registers with the constants that they hold, and the constants at the ports of each memory.
type Constants = (HashMap<usize, u64>, Vec<Option<Vec<u64>>>);

/// Finds for each memory the clocks from write to read, of each of its read ports, while all points move on. The number
/// must be the same for all values of the counter that addresses the memory.
fn delays(module: &Module, roles: &Roles) -> Result<Vec<Vec<usize>>> {
    let reset = constants(module, roles, 0, &HashMap::new())?.0;
    let mut delays = vec![None; module.memories.len()];
    for (&counter, &first) in &reset {
        let mut course: Vec<Vec<Option<Vec<u64>>>> = Vec::new();
        let mut value = first;
        let repeats = loop {
            let (next, control) = constants(module, roles, 1, &HashMap::from([(counter, value)]))?;
            course.push(control);
            match next.get(&counter) {
                Some(&again) if again == first => break true,
                Some(&next) if course.len() < MOST_SLOTS => value = next,
                _ => break false,
            }
        };
        if !repeats {
            continue;
        }
        for (memory, delay) in delays.iter_mut().enumerate() {
            let of_memory: Option<Vec<&[u64]>> =
                course.iter().map(|control| control[memory].as_deref()).collect();
            if let Some(of_memory) = of_memory {
                *delay = lags(&of_memory, module.memories[memory].reads.len());
            }
        }
    }
    let known: Option<Vec<_>> = delays.into_iter().collect();
    known.context("a memory of the text is no delay of a fixed number of clocks")
}

/// More values than a counter of slots has.
const MOST_SLOTS: usize = 1024;

/// Returns the clocks from write to read of each read port. `course` has the values at the write port and the read
/// ports in each clock of a period, which repeats. Returns `None` if a read port has no fixed number of clocks. For
/// example, write addresses 0, 1, 2, 3 and read addresses 2, 3, 0, 1 give 2 clocks.
fn lags(course: &[&[u64]], reads: usize) -> Option<Vec<usize>> {
    let mut lags = Vec::new();
    for read in 0..reads {
        let first = lag(course, read, 0)?;
        for now in 1..course.len() {
            if lag(course, read, now)? != first {
                return None;
            }
        }
        lags.push(first);
    }
    Some(lags)
}

/// Returns the least number of clocks before `now` at which the address that a port reads was written.
fn lag(course: &[&[u64]], read: usize, now: usize) -> Option<usize> {
    let period = course.len();
    let address = course[now][1 + read];
    (1..=period).find(|lag| course[(now + period - lag) % period][0] == address)
}

/// Finds the registers that hold a constant after a clock, and the constants at the ports of each memory in that
/// clock, if all bits are written. The clock is one of a reset, or one in which the results are taken. Some registers
/// are known before.
fn constants(
    module: &Module,
    roles: &Roles,
    rst_n: u64,
    known: &HashMap<usize, u64>,
) -> Result<Constants> {
    let mut terms = VectorTerms::default();
    let mut held = module.power_up(&mut terms);
    for (&at, &bits) in known {
        held[at] = vec![terms.constant(bits, terms.width(held[at][0]))];
    }
    let values = module.settle(
        &mut terms,
        &held,
        |terms, name, width| match roles.get(name) {
            Some(Role::Reset) => terms.constant(rst_n, width),
            Some(Role::OutReady) if rst_n == 1 => terms.constant(1, width),
            _ => terms.unknown(width),
        },
        |terms, read| module.memories[read.memory].any(terms),
    )?;
    let mut constants = HashMap::new();
    for (at, columns) in module.edge(&mut terms, &values).iter().enumerate() {
        if let [column] = columns[..]
            && let Some(bits) = terms.constant_of(column)
        {
            constants.insert(at, bits);
        }
    }
    let mut control = Vec::new();
    for memory in &module.memories {
        control.push(constant_addresses(&mut terms, memory, &values));
    }
    Ok((constants, control))
}

/// Returns the addresses of the write port and of each read port of a memory. Returns `None` if an address is no
/// constant, or if not all bits of the word are written.
fn constant_addresses(
    terms: &mut VectorTerms,
    memory: &Memory,
    values: &WireValues,
) -> Option<Vec<u64>> {
    let control = memory.control(terms, values);
    let (addresses, enables) = control.split_at(1 + memory.reads.len());
    for &enable in enables {
        if terms.constant_of(enable)? != mask(terms.width(enable)) {
            return None;
        }
    }
    addresses.iter().map(|&address| terms.constant_of(address)).collect()
}

struct TextComparison<'p> {
    design: &'p Design,
    module: &'p Module,
    roles: &'p Roles,
    delays: &'p [Vec<usize>],
    latency: usize,
    terms: VectorTerms,
    /// The values of the inputs, by name and clock.
    inputs: HashMap<(String, usize), VectorTermId>,
    products: Vec<Product>,
    solver: Solver<'p>,
    proof: TextProof,
}

/// Returns the term of an input in a clock. Operands come with a point, and all other inputs belong to the handshake.
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
    /// Shows that netlist and text are the same. Fails with [`Ended`] if they are not, or if it cannot be shown.
    fn run(&mut self) -> Result<()> {
        self.stays()?;
        self.follows_a_point()
    }

    /// Shows that a clock in which `in_ready` is low changes nothing, and one in which it is high is one in which
    /// `out_ready` is.
    fn stays(&mut self) -> Result<()> {
        if !self.roles.values().any(|role| *role == Role::OutReady) {
            return Ok(());
        }
        let module = self.module;
        let held = module.power_up(&mut self.terms);
        let mut reads = HashMap::new();
        let (any, after_any) = self.free_clock(&held, &mut reads, false)?;
        let (taken, after_taken) = self.free_clock(&held, &mut reads, true)?;
        let in_ready = self.roles.iter().find(|(_, role)| **role == Role::InReady);
        let (ready, _) = in_ready.context("the pipeline has no output `in_ready`")?;
        let ready_in_any = module.shown(&mut self.terms, &any).get(ready).copied();
        let ready_in_taken = module.shown(&mut self.terms, &taken).get(ready).copied();
        let (Some(moves), Some(moved)) = (ready_in_any, ready_in_taken) else {
            bail!("the text has no output `{ready}`")
        };
        let one = self.terms.constant(1, 1);
        self.must_equal(None, moved, one, "a pipeline moves when its results are taken")?;
        self.must_keep_state(moves, &held, &any, &after_any)?;
        self.must_move_alike(moves, [&any, &taken], [&after_any, &after_taken])
    }

    /// Executes a clock that belongs to no point. With `taken`, `out_ready` is 1, and otherwise it has any value.
    /// Returns the values of the clock, and the registers after it. Clocks with the same `reads` read the same words.
    fn free_clock(
        &mut self,
        held: &RegisterContents,
        reads: &mut HashMap<Read, Vec<VectorTermId>>,
        taken: bool,
    ) -> Result<(WireValues, RegisterContents)> {
        let (module, roles, inputs) = (self.module, self.roles, &mut self.inputs);
        let values = module.settle(
            &mut self.terms,
            held,
            |terms, name, width| match roles.get(name) {
                Some(Role::Reset) => terms.constant(1, width),
                Some(Role::OutReady) if taken => terms.constant(1, width),
                _ => *inputs
                    .entry((name.to_owned(), usize::MAX))
                    .or_insert_with(|| terms.unknown(width)),
            },
            |terms, read| {
                let word = reads.entry(read);
                word.or_insert_with(|| module.memories[read.memory].any(terms)).clone()
            },
        )?;
        let next = module.edge(&mut self.terms, &values);
        Ok((values, next))
    }

    /// Shows that registers and memories keep their contents in a clock in which `moves` is 0.
    fn must_keep_state(
        &mut self,
        moves: VectorTermId,
        held: &RegisterContents,
        values: &WireValues,
        next: &RegisterContents,
    ) -> Result<()> {
        let why = "a clock in which no point moves";
        for (before, after) in held.iter().flatten().zip(next.iter().flatten()) {
            self.must_equal(Some((moves, false)), *before, *after, why)?;
        }
        for memory in &self.module.memories {
            let control = memory.control(&mut self.terms, values);
            for &enable in &control[1 + memory.reads.len()..] {
                let none = self.terms.constant(0, self.terms.width(enable));
                self.must_equal(Some((moves, false)), enable, none, why)?;
            }
        }
        Ok(())
    }

    /// Shows that a clock with any `out_ready` in which `moves` is 1 does the same as the clock in which the results
    /// are taken.
    fn must_move_alike(
        &mut self,
        moves: VectorTermId,
        [any, taken]: [&WireValues; 2],
        [after_any, after_taken]: [&RegisterContents; 2],
    ) -> Result<()> {
        let why = "a clock in which all points move";
        for (one, other) in after_any.iter().flatten().zip(after_taken.iter().flatten()) {
            self.must_equal(Some((moves, true)), *one, *other, why)?;
        }
        for memory in &self.module.memories {
            let ports_in_any = self.memory_ports(memory, any);
            let ports_in_taken = self.memory_ports(memory, taken);
            for (one, other) in ports_in_any.into_iter().zip(ports_in_taken) {
                self.must_equal(Some((moves, true)), one, other, why)?;
            }
            // A read gives the same word in both only if the address is the same.
            let control_in_any = memory.control(&mut self.terms, any);
            let control_in_taken = memory.control(&mut self.terms, taken);
            let reads = 1..=memory.reads.len();
            if control_in_any[reads.clone()] != control_in_taken[reads] {
                let why = "a memory of the text is read by what is no register";
                return ended(TextVerdict::Unread(why.to_owned()));
            }
        }
        Ok(())
    }

    /// Returns the addresses and the enable of a memory, and the values that are written.
    fn memory_ports(&mut self, memory: &Memory, values: &WireValues) -> Vec<VectorTermId> {
        let mut ports = memory.control(&mut self.terms, values);
        ports.extend(memory.written(&mut self.terms, values));
        ports
    }

    /// Shows that the outputs of netlist and text are the same when the results of a point are shown.
    fn follows_a_point(&mut self) -> Result<()> {
        let nets = self.netlist();
        let module = self.module;
        let mut held = module.power_up(&mut self.terms);
        let mut written: Vec<Vec<Vec<VectorTermId>>> = Vec::new();
        for clock in 0..=self.latency {
            let (roles, inputs, delays) = (self.roles, &mut self.inputs, self.delays);
            let values = module.settle(
                &mut self.terms,
                &held,
                |terms, name, width| {
                    input(terms, inputs, name, roles.get(name).copied(), width, clock)
                },
                |terms, read| match clock.checked_sub(delays[read.memory][read.port]) {
                    Some(before) => written[before][read.memory].clone(),
                    None => module.memories[read.memory].any(terms),
                },
            )?;
            if clock == self.latency {
                return self.results(&values, &nets[clock]);
            }
            let mut words = Vec::new();
            for memory in &module.memories {
                words.push(memory.written(&mut self.terms, &values));
            }
            written.push(words);
            held = module.edge(&mut self.terms, &values);
            self.register(&mut held, &nets[clock + 1])?;
        }
        Ok(())
    }

    /// Returns the term of every net of the netlist in each clock of a point.
    fn netlist(&mut self) -> Vec<Vec<VectorTermId>> {
        let design = self.design;
        let execution = Execution::new(&mut self.terms, design);
        let mut state = execution.power_up(&mut self.terms);
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
        nets
    }

    /// Replaces the terms that registers of the text hold by equal terms of the netlist.
    fn register(&mut self, held: &mut RegisterContents, nets: &[VectorTermId]) -> Result<()> {
        let known: HashSet<VectorTermId> = nets.iter().copied().collect();
        let cone = self.terms.cone(held.iter().flatten().chain(nets).copied());
        // A term that does not depend on the point is of no use.
        let mut ours: HashSet<VectorTermId> = HashSet::new();
        for ((_, clock), id) in &self.inputs {
            if *clock == 0 {
                ours.insert(*id);
            }
        }
        for &id in &cone {
            if self.terms.term(id).operands().iter().any(|it| ours.contains(it)) {
                ours.insert(id);
            }
        }
        let mut open: Vec<&mut VectorTermId> = Vec::new();
        for column in held.iter_mut().flatten() {
            if !ours.contains(column) {
                continue;
            }
            if known.contains(column) {
                self.proof.registers += 1;
            } else {
                open.push(column);
            }
        }
        if open.is_empty() {
            return Ok(());
        }
        let sampled: Vec<HashMap<VectorTermId, u64>> = samples(&self.terms, &cone).collect();
        let mut alike = HashMap::new();
        for &net in nets {
            if ours.contains(&net) {
                alike.entry(self.signature(net, &sampled)).or_insert(net);
            }
        }
        for column in open {
            let Some(&net) = alike.get(&self.signature(*column, &sampled)) else { continue };
            let equal = self.terms.equal(*column, net);
            let differ = self.terms.not(equal);
            if let SolverAnswer::Unsatisfiable = self.ask(&[differ])? {
                *column = net;
                self.proof.registers += 1;
            }
        }
        Ok(())
    }

    /// Returns the width of a term, and its value in each sample. Terms that are equal have the same signature.
    fn signature(
        &self,
        id: VectorTermId,
        sampled: &[HashMap<VectorTermId, u64>],
    ) -> (u32, Vec<u64>) {
        let values = sampled.iter().map(|values| values[&id]).collect();
        (self.terms.width(id), values)
    }

    fn results(&mut self, values: &WireValues, nets: &[VectorTermId]) -> Result<()> {
        let shown = self.module.shown(&mut self.terms, values);
        for port in self.design.outputs().filter(|port| port.role != Role::InReady) {
            let name = &self.design.net(port.net).name;
            let Some(&output) = shown.get(name) else { bail!("the text has no output `{name}`") };
            self.must_equal(None, output, nets[port.net.index()], &format!("`{name}`"))?;
            self.proof.outputs += 1;
        }
        Ok(())
    }

    /// Ends the comparison unless two terms are equal whenever a bit has a value. For example, outputs must be equal
    /// whenever `out_valid` is 1.
    fn must_equal(
        &mut self,
        condition: Option<(VectorTermId, bool)>,
        one: VectorTermId,
        other: VectorTermId,
        what: &str,
    ) -> Result<()> {
        ensure!(self.terms.width(one) == self.terms.width(other), "{what} has another width");
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
            return ended(TextVerdict::Different(difference));
        }
        match self.ask(&wanted)? {
            SolverAnswer::Unsatisfiable => Ok(()),
            SolverAnswer::Undecided(open) => ended(TextVerdict::Open(open)),
            SolverAnswer::Satisfiable(found) => {
                match self.difference(&wanted, both, what, &found.into_iter().collect()) {
                    Some(difference) => ended(TextVerdict::Different(difference)),
                    None => ended(TextVerdict::Open(Open::Unknown)),
                }
            }
        }
    }

    fn ask(&mut self, wanted: &[VectorTermId]) -> Result<SolverAnswer> {
        match self.solver.ask(&mut self.terms, wanted, &self.products, false)? {
            SolverAnswer::Unsatisfiable => Ok(SolverAnswer::Unsatisfiable),
            _ => self.solver.ask(&mut self.terms, wanted, &self.products, true),
        }
    }

    /// Finds values of the unknowns for which the `wanted` terms are 1, and describes them in words. It tries random
    /// values and the values that the solver `found`.
    fn difference(
        &self,
        wanted: &[VectorTermId],
        [one, other]: [VectorTermId; 2],
        what: &str,
        found: &HashMap<VectorTermId, u64>,
    ) -> Option<String> {
        let cone = self.terms.cone(wanted.iter().copied().chain([one, other]));
        let mut found_by_number: HashMap<u32, u64> = HashMap::new();
        for id in &cone {
            if let VectorTerm::Unknown(number) = *self.terms.term(*id)
                && let Some(&value) = found.get(id)
            {
                found_by_number.insert(number, value);
            }
        }
        let solved =
            self.terms.values(&cone, |number| found_by_number.get(&number).copied().unwrap_or(0));
        let mut candidates = samples(&self.terms, &cone).chain([solved]);
        let values = candidates.find(|values| wanted.iter().all(|it| values[it] == 1))?;
        let mut inputs: Vec<String> = Vec::new();
        for ((name, clock), id) in &self.inputs {
            if [0, usize::MAX].contains(clock)
                && let Some(value) = values.get(id)
            {
                inputs.push(format!(" {name}={value:#x}"));
            }
        }
        inputs.sort();
        Some(format!(
            "{what}: {:#x} in the text and {:#x} in the netlist for{}",
            values[&one],
            values[&other],
            inputs.concat()
        ))
    }
}

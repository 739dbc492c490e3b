//! Proves with an SMT solver that a pipeline and its sequential core compute the same outputs for every point (one set of
//! operands). [`compare_text`] proves that the emitted Verilog of a pipeline and its netlist compute the same outputs.
//!
//! [`compare`] first simulates both designs at 400 random points. It then executes both netlists symbolically, clock by clock:
//! the core from `start` to its results, and the pipeline with one point between arbitrary other points. The solver knows
//! products and memory reads only as uninterpreted functions with some arithmetic facts (`facts`), so it may not decide: the
//! verdict is then [`Verdict::Open`].

mod cells;
mod delays;
mod facts;
mod module;
mod random_precheck;
mod solver;
mod split_products;
mod symbolic;
mod term;
#[cfg(test)]
mod tests;
mod text;
mod truncated_products;

use std::collections::HashMap;
use std::fmt;
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Role};
use glint_tools::Tool;
use random_precheck::DesignPair;
use solver::{Solver, SolverAnswer};
use split_products::Candidates;
use symbolic::{Execution, Product, SymbolicState};
use term::{VectorTerm, VectorTermId, VectorTerms};

pub use text::{TextProof, TextVerdict, compare_text};

/// The number of random points at which both designs are compared before anything is proved.
const TRIALS: usize = 400;

/// The largest number of clocks that a computation of the sequential core may take; beyond it, [`compare`] fails.
const MOST_CLOCKS: usize = 8192;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    Equal(EqualityProof),
    /// An output differs for the stated point.
    Different(OutputDifference),
    /// The solver does not decide the question, and no point with a different output was found.
    Open(Open),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Open {
    /// The solver answers `unknown`, or it answers with a counterexample that no simulated point confirms. Such a counterexample
    /// assumes values of products and memory words that no point has.
    Unknown,
    Limit,
}

/// The size of a proof that a pipeline equals its sequential core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EqualityProof {
    pub outputs: usize,
    /// The number of checkpoints that are proved equal, over all paths through the microprogram.
    pub registers: usize,
    /// The number of paths through the microprogram that the operands can select. For example, a jump that depends on an
    /// operand makes two paths.
    pub ways: usize,
    pub products: usize,
    /// The number of questions to the solver. An equality needs no question if both sides are the same term.
    pub questions: usize,
}

/// A point for which the cores compute different outputs. For example, as text: "`red_out` is 0x1f in the pipeline and 0x20 in
/// the sequential core for cos_gamma=0x3ff".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputDifference {
    /// The bit patterns of the operands, by name.
    pub operands: Vec<(String, u64)>,
    pub output: String,
    /// The bit pattern that the sequential core computes.
    pub sequential: u64,
    /// The bit pattern that the pipeline computes.
    pub pipeline: u64,
}

impl fmt::Display for OutputDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { output, sequential, pipeline, .. } = self;
        write!(
            f,
            "`{output}` is {pipeline:#x} in the pipeline and {sequential:#x} in the sequential core for"
        )?;
        for (name, bits) in &self.operands {
            write!(f, " {name}={bits:#x}")?;
        }
        Ok(())
    }
}

/// Proves that a pipeline computes the same outputs as its sequential core, or finds a point for which an output differs. `limit`
/// is the time limit of all answers of the solver together.
///
/// # Errors
/// Fails if `pipeline` is no pipeline, if the designs have different operands, or if the core lacks an output of the pipeline.
/// Fails if a design shows no result (the core within 8192 clocks), if a design has a combinational loop, or if the solver cannot
/// be run. Fails if operands decide about `valid` within a microinstruction, or if they decide the next microinstruction
/// otherwise than by a choice between two.
pub fn compare(
    sequential: &Design,
    pipeline: &Design,
    solver: &Tool,
    limit: Duration,
) -> Result<Verdict> {
    let pair = DesignPair::new(sequential, pipeline)?;
    if let Some(difference) = tried(&pair, None)? {
        return Ok(Verdict::Different(difference));
    }
    PipelineComparison::new(&pair, solver, limit)?.run()
}

/// Simulates both designs at 400 random points, and returns the first difference. `near` has the bit patterns of one point's
/// operands; each operand takes its value from `near` with a probability of one half.
fn tried(pair: &DesignPair<'_>, near: Option<&[u64]>) -> Result<Option<OutputDifference>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..TRIALS {
        let mut operands: Vec<u64> = Vec::new();
        for at in 0..pair.operands.len() {
            operands.push(match near {
                Some(near) if random.next_u32().is_multiple_of(2) => near[at],
                _ => drawn(&mut random),
            });
        }
        if let Some(difference) = differs(pair, &operands)? {
            return Ok(Some(difference));
        }
    }
    Ok(None)
}

/// Returns a random bit pattern. One pattern in four has any 64 bits. All other patterns are a power of two up to 2^23, plus or
/// minus a random number, because the value 1.0 of an operand is also a power of two.
fn drawn(random: &mut ChaCha8Rng) -> u64 {
    let bits = random.next_u64();
    let power = 1u64 << (random.next_u32() % 24);
    let off = bits.checked_shr(random.next_u32() % 65).unwrap_or(0);
    match random.next_u32() % 4 {
        0 => bits,
        1 => power.wrapping_add(off),
        _ => power.wrapping_sub(off),
    }
}

/// Returns the first output that differs at the point `operands`, which are bit patterns. Bits above an operand's width are
/// dropped.
fn differs(pair: &DesignPair<'_>, operands: &[u64]) -> Result<Option<OutputDifference>> {
    let mut masked: Vec<u64> = Vec::new();
    for (name, bits) in pair.operands.iter().zip(operands) {
        let width = match pair.pipeline.find(name) {
            Some(net) => pair.pipeline.width(net),
            None => 1,
        };
        masked.push(bits & mask(width));
    }
    let [sequential, pipeline] = pair.outputs(&masked)?;
    for (at, (output, ..)) in pair.outputs.iter().enumerate() {
        if sequential[at] != pipeline[at] {
            return Ok(Some(OutputDifference {
                operands: pair.operands.iter().cloned().zip(masked).collect(),
                output: output.clone(),
                sequential: sequential[at],
                pipeline: pipeline[at],
            }));
        }
    }
    Ok(None)
}

/// The sequential core on one path through the microprogram.
struct MicroprogramPath {
    /// The one-bit terms that decided the path at its jumps, each with the value that leads along this path.
    conditions: Vec<(VectorTermId, bool)>,
    state: SymbolicState,
    /// For each microinstruction, the number of its executions.
    visits: Vec<usize>,
    clocks: usize,
}

struct PipelineComparison<'p> {
    pair: &'p DesignPair<'p>,
    terms: VectorTerms,
    solver: Solver<'p>,
    products: Vec<Product>,
    /// The sum of parts for each product that a pipeline computes in parts. For example, a·b may be the sum of 16·(u·b) and l·b,
    /// if u has the upper bits of a and l the lowest 4 bits.
    divided: HashMap<VectorTermId, VectorTermId>,
    /// The products that the pipeline computes, whole or in parts, in ascending order.
    parts: Vec<VectorTermId>,
    /// The point's operands, as unknown terms.
    operands: Vec<VectorTermId>,
    proof: EqualityProof,
}

enum EqualityAnswer {
    Equal,
    Different(OutputDifference),
    Open(Open),
}

impl<'p> PipelineComparison<'p> {
    fn new(pair: &'p DesignPair<'p>, solver: &'p Tool, limit: Duration) -> Result<Self> {
        let mut terms = VectorTerms::default();
        let mut operands = Vec::new();
        for name in &pair.operands {
            let net = pair.pipeline.find(name).context("an operand is a port")?;
            operands.push(terms.unknown(pair.pipeline.width(net)));
        }
        Ok(Self {
            pair,
            terms,
            solver: Solver::new(solver, limit)?,
            products: Vec::new(),
            divided: HashMap::new(),
            parts: Vec::new(),
            operands,
            proof: EqualityProof::default(),
        })
    }

    fn run(mut self) -> Result<Verdict> {
        let stages = self.pipeline()?;
        self.divide(&stages)?;
        let core = Execution::new(&mut self.terms, self.pair.sequential);
        let mut ways = vec![self.start(&core)];
        while let Some(way) = ways.pop() {
            match self.follow(&core, way, &stages, &mut ways)? {
                EqualityAnswer::Equal => {}
                EqualityAnswer::Different(difference) => return Ok(Verdict::Different(difference)),
                EqualityAnswer::Open(open) => return Ok(Verdict::Open(open)),
            }
        }
        for id in self.terms.cone(self.results_of(&stages)) {
            if matches!(self.terms.term(id), VectorTerm::Product(..)) {
                self.proof.products += 1;
            }
        }
        self.proof.outputs = self.pair.outputs.len();
        self.proof.questions = self.solver.asked;
        Ok(Verdict::Equal(self.proof))
    }

    /// Returns the term of every net of the pipeline in each clock, from the clock in which the pipeline takes the point.
    fn pipeline(&mut self) -> Result<Vec<Vec<VectorTermId>>> {
        let pair = self.pair;
        let execution = Execution::new(&mut self.terms, pair.pipeline);
        let mut state = execution.power_up(&mut self.terms);
        let mut stages = Vec::new();
        for clock in 0..=pair.latency + 1 {
            // Clock 0 is a reset, and clock 1 takes the point.
            let point = clock == 1;
            let values = self.settle(
                &execution,
                &state,
                |role| match role {
                    Role::Reset => Some(u64::from(clock > 0)),
                    Role::InValid if point => Some(1),
                    Role::OutReady => Some(1),
                    _ => None,
                },
                point,
            );
            state = execution.edge(&mut self.terms, &state, &values);
            stages.push(values);
        }
        stages.remove(0);
        let valid = pair
            .pipeline
            .port(|role| role == Role::Valid)
            .context("the pipeline has no output `out_valid`")?;
        let shown = stages[pair.latency][valid.net.index()];
        ensure!(
            self.terms.constant_of(shown) == Some(1),
            "the pipeline shows no result {} clocks after a point",
            pair.latency
        );
        Ok(stages)
    }

    /// Returns the term of every net in a clock, at the net's index. An input for which `known` returns a number has this
    /// constant. If `point` is set, the operands have the point's terms. All remaining inputs are new unknowns.
    fn settle(
        &mut self,
        execution: &Execution<'_>,
        state: &SymbolicState,
        known: impl Fn(Role) -> Option<u64>,
        point: bool,
    ) -> Vec<VectorTermId> {
        let (pair, operands) = (self.pair, &self.operands);
        execution.settle(
            &mut self.terms,
            state,
            |terms, net, role| {
                let width = execution.design.width(net);
                if let Some(bits) = known(role) {
                    return terms.constant(bits, width);
                }
                let name = &execution.design.net(net).name;
                match pair.operands.iter().position(|operand| operand == name) {
                    Some(at) if point => operands[at],
                    _ => terms.unknown(width),
                }
            },
            &mut self.products,
        )
    }

    /// Returns the path of the core that begins with the clock in which it takes `start` and all operands.
    fn start(&mut self, core: &Execution<'_>) -> MicroprogramPath {
        let mut state = core.power_up(&mut self.terms);
        for point in [false, true] {
            let now = u64::from(point);
            let values = self.settle(
                core,
                &state,
                |role| match role {
                    Role::Reset => Some(now),
                    Role::Start | Role::Strobe => Some(now),
                    _ => None,
                },
                point,
            );
            state = core.edge(&mut self.terms, &state, &values);
        }
        let visits = vec![0; core.design.control.microprogram.len()];
        MicroprogramPath { conditions: Vec::new(), state, visits, clocks: 0 }
    }

    /// Executes the microprogram along the path `way`, until the results can be compared, or until a jump depends on operands. At
    /// such a jump, adds the paths that continue to `ways`. For example, a loop with a trip count that depends on an operand
    /// makes a path for each trip count.
    fn follow(
        &mut self,
        core: &Execution<'_>,
        mut way: MicroprogramPath,
        stages: &[Vec<VectorTermId>],
        ways: &mut Vec<MicroprogramPath>,
    ) -> Result<EqualityAnswer> {
        let control = &core.design.control;
        let sequencer = [control.address.index(), control.run.index()];
        let valid = core.design.handshake()?.valid;
        while way.clocks < MOST_CLOCKS {
            for register in sequencer {
                let held = way.state.registers[register];
                if self.terms.constant_of(held).is_none() {
                    return self.fork(way, held, ways);
                }
            }
            let decided = self.terms.constant_of(way.state.registers[control.address.index()]);
            let address = decided.unwrap_or_default() as usize;
            if let EqualityAnswer::Different(difference) =
                self.lemmas(core, &mut way, address, stages)?
            {
                return Ok(EqualityAnswer::Different(difference));
            }
            if let Some(visits) = way.visits.get_mut(address) {
                *visits += 1;
            }
            // The inputs are unknowns here, so the proof holds for all their values while the core is busy.
            let values =
                self.settle(core, &way.state, |role| (role == Role::Reset).then_some(1), false);
            match self.terms.constant_of(values[valid.index()]) {
                Some(1) => return self.results(&way, &values, stages),
                Some(_) => {}
                None => bail!("`valid` depends on operands within a microinstruction"),
            }
            way.state = core.edge(&mut self.terms, &way.state, &values);
            way.clocks += 1;
        }
        bail!("the sequential core shows no result")
    }

    /// Splits the path `way` at `undecided`, a value of the sequencer that depends on operands. Adds both continuations to
    /// `ways`, except one that the solver proves impossible. Always returns `Equal`: the continuations are compared later.
    ///
    /// # Errors
    ///
    /// Fails if the value is neither one bit nor a choice between two values.
    fn fork(
        &mut self,
        way: MicroprogramPath,
        undecided: VectorTermId,
        ways: &mut Vec<MicroprogramPath>,
    ) -> Result<EqualityAnswer> {
        let condition = match *self.terms.term(undecided) {
            VectorTerm::Choice(condition, ..) => condition,
            _ if self.terms.width(undecided) == 1 => undecided,
            _ => bail!("the sequencer depends on operands in another way than by a choice"),
        };
        for value in [false, true] {
            let mut conditions = way.conditions.clone();
            conditions.push((condition, value));
            let wanted = self.holding(&conditions);
            if let SolverAnswer::Unsatisfiable = self.ask(wanted)? {
                continue;
            }
            let mut state = way.state.clone();
            state.assume(&mut self.terms, condition, value);
            let visits = way.visits.clone();
            ways.push(MicroprogramPath { conditions, state, visits, clocks: way.clocks });
        }
        Ok(EqualityAnswer::Equal)
    }

    /// Returns one-bit terms that are all 1 if and only if each condition has its value.
    fn holding(&mut self, conditions: &[(VectorTermId, bool)]) -> Vec<VectorTermId> {
        let mut holding = Vec::new();
        for &(condition, value) in conditions {
            holding.push(if value { condition } else { self.terms.not(condition) });
        }
        holding
    }

    /// Proves the checkpoints of microinstruction number `address`: a register of the core equals a net of the pipeline when this
    /// microinstruction begins. Each register that is proved equal takes the pipeline's term; other registers are skipped.
    /// Returns `Different` if an output really differs, and otherwise `Equal`, even if a checkpoint was skipped.
    fn lemmas(
        &mut self,
        core: &Execution<'_>,
        way: &mut MicroprogramPath,
        address: usize,
        stages: &[Vec<VectorTermId>],
    ) -> Result<EqualityAnswer> {
        let Some(pipeline) = &self.pair.pipeline.pipeline else { return Ok(EqualityAnswer::Equal) };
        let visit = way.visits.get(address).copied().unwrap_or(0);
        for checkpoint in &pipeline.checkpoints {
            if checkpoint.address != address || checkpoint.visit != visit {
                continue;
            }
            let mut registers = core.design.registers.iter();
            let register =
                registers.position(|it| core.design.net(it.q).name == checkpoint.register);
            let Some(register) = register else { continue };
            let held = way.state.registers[register];
            let unsized_value = stages[pipeline.clock_of(checkpoint.net)][checkpoint.net.index()];
            let staged = self.terms.resized(unsized_value, self.terms.width(held));
            match self.equal(&way.conditions, held, staged)? {
                EqualityAnswer::Equal => {
                    way.state.registers[register] = staged;
                    self.proof.registers += 1;
                }
                EqualityAnswer::Different(difference) => {
                    return Ok(EqualityAnswer::Different(difference));
                }
                // The results may be equal even if the solver does not decide this question.
                EqualityAnswer::Open(_) => {}
            }
        }
        Ok(EqualityAnswer::Equal)
    }

    fn results(
        &mut self,
        way: &MicroprogramPath,
        values: &[VectorTermId],
        stages: &[Vec<VectorTermId>],
    ) -> Result<EqualityAnswer> {
        self.proof.ways += 1;
        for (_, of_pipeline, of_core) in &self.pair.outputs {
            let staged = stages[self.pair.latency][of_pipeline.index()];
            match self.equal(&way.conditions, values[of_core.index()], staged)? {
                EqualityAnswer::Equal => {}
                other => return Ok(other),
            }
        }
        Ok(EqualityAnswer::Equal)
    }

    fn results_of(&self, stages: &[Vec<VectorTermId>]) -> Vec<VectorTermId> {
        let last = &stages[self.pair.latency];
        self.pair.outputs.iter().map(|&(_, net, _)| last[net.index()]).collect()
    }

    /// Finds the products that the pipeline computes in parts, and stores their sums in `divided`. If a net of the pipeline
    /// provably has the low bits of such a sum, its term replaces these low bits.
    fn divide(&mut self, stages: &[Vec<VectorTermId>]) -> Result<()> {
        let mut roots = self.results_of(stages);
        if let Some(pipeline) = &self.pair.pipeline.pipeline {
            for checkpoint in &pipeline.checkpoints {
                let net = checkpoint.net;
                roots.push(stages[pipeline.clock_of(net)][net.index()]);
            }
        }
        let nets = self.terms.cone(roots);
        let divided = facts::divided(&mut self.terms, nets.iter().copied());
        self.parts = nets.iter().chain(divided.keys()).copied().collect();
        self.parts.retain(|&it| matches!(self.terms.term(it), VectorTerm::Product(..)));
        self.parts.sort();
        self.parts.dedup();
        let wholes = Candidates::new(&self.terms, &nets, divided.values());
        let mut pending: Vec<VectorTermId> = divided.keys().copied().collect();
        pending.sort();
        while let Some(&product) = pending.last() {
            if self.divided.contains_key(&product) {
                pending.pop();
                continue;
            }
            let sum = divided[&product];
            let cone = self.terms.cone([sum]);
            let mut parts = cone.iter().copied();
            if let Some(part) =
                parts.find(|it| divided.contains_key(it) && !self.divided.contains_key(it))
            {
                pending.push(part);
                continue;
            }
            pending.pop();
            let mut replaced = [sum];
            self.terms.replace(&self.divided, &mut replaced);
            let [mut whole] = replaced;
            if let Some(net) = wholes.of(sum) {
                // The equality says nothing about the bits above the net, which follow from the bounds of the factors.
                let width = self.terms.width(net);
                let low = self.terms.slice(whole, 0, width);
                let equal = self.terms.equal(low, net);
                let differ = self.terms.not(equal);
                let said = self.solver.ask(&mut self.terms, &[differ], &self.products, false)?;
                if let SolverAnswer::Unsatisfiable = said {
                    whole = self.terms.with_low(whole, net);
                }
            }
            self.divided.insert(product, whole);
        }
        Ok(())
    }

    /// Asks the solver whether the one-bit terms `wanted` can all be 1. The first question has the sums in `divided` in place of
    /// products. If its answer is not `SolverAnswer::Unsatisfiable`, a second question has the original products and all facts
    /// about partial products.
    fn ask(&mut self, wanted: Vec<VectorTermId>) -> Result<SolverAnswer> {
        self.divide_by_lowest(&wanted)?;
        let mut divided = wanted.clone();
        self.terms.replace(&self.divided, &mut divided);
        match self.solver.ask(&mut self.terms, &divided, &self.products, false)? {
            SolverAnswer::Unsatisfiable => Ok(SolverAnswer::Unsatisfiable),
            _ => self.solver.ask(&mut self.terms, &wanted, &self.products, true),
        }
    }

    fn equal(
        &mut self,
        conditions: &[(VectorTermId, bool)],
        one: VectorTermId,
        other: VectorTermId,
    ) -> Result<EqualityAnswer> {
        let equal = self.terms.equal(one, other);
        let differ = self.terms.not(equal);
        if self.terms.constant_of(differ) == Some(0) {
            return Ok(EqualityAnswer::Equal);
        }
        let mut wanted = self.holding(conditions);
        wanted.push(differ);
        match self.ask(wanted)? {
            SolverAnswer::Unsatisfiable => Ok(EqualityAnswer::Equal),
            SolverAnswer::Undecided(open) => Ok(EqualityAnswer::Open(open)),
            SolverAnswer::Satisfiable(values) => {
                let mut operands: Vec<u64> = Vec::new();
                for operand in &self.operands {
                    operands.push(match values.iter().find(|(id, _)| id == operand) {
                        Some((_, bits)) => *bits,
                        None => 0,
                    });
                }
                // The solver's counterexample may assume wrong products. Its operands may show a real difference nevertheless.
                let difference = match differs(self.pair, &operands)? {
                    None => tried(self.pair, Some(&operands))?,
                    found => found,
                };
                match difference {
                    Some(difference) => Ok(EqualityAnswer::Different(difference)),
                    None => Ok(EqualityAnswer::Open(Open::Unknown)),
                }
            }
        }
    }
}

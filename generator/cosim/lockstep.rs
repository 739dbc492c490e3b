//! Golden model and simulated hardware side by side, every signal compared on every clock.

use anyhow::{Context, Result, anyhow, ensure};

use super::stimulus::Stimulus;
use crate::emit::Vectors;
use crate::golden::{Contract, Model, nearer};
use crate::netlist::{Design, NetId, Role};
use crate::sim::Simulator;

/// What a run showed.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Results seen.
    pub points: u64,
    /// Clocks run, each compared.
    pub clocks: u64,
    /// Registers compared on every clock.
    pub registers: usize,
    /// Outputs compared on every clock.
    pub outputs: usize,
    /// The largest error of an output against the formula in f64.
    pub worst: Option<Worst>,
    /// The first difference, at which the run ended.
    pub mismatch: Option<Mismatch>,
}

/// The largest error against the formula, and where.
#[derive(Clone, Debug)]
pub struct Worst {
    /// In output units.
    pub units: f64,
    /// The output.
    pub output: String,
    /// Raw operands, by name.
    pub operands: Vec<(String, i64)>,
}

/// A signal on which model and hardware differ.
#[derive(Clone, Debug)]
pub struct Mismatch {
    /// Rising edges so far.
    pub clock: u64,
    /// Its name.
    pub signal: String,
    /// What the golden model says, a bit pattern.
    pub golden: u64,
    /// What the simulated hardware says.
    pub simulated: u64,
    /// The word of the microprogram that was executed at the edge.
    pub word: String,
}

/// Golden model and simulator of one design.
pub struct Lockstep<'a> {
    design: &'a Design,
    contract: &'a dyn Contract,
    model: Box<dyn Model>,
    simulator: Simulator,
    stimulus: Stimulus,
    outputs: Vec<NetId>,
    /// For each input of the model its position among the design's.
    order: Vec<usize>,
    compared: Vec<NetId>,
    model_inputs: Vec<u64>,
    busy: NetId,
    valid: NetId,
    /// The operands of the contract, as positions in the stimulus.
    operands: Vec<usize>,
    colours: usize,
    results: Vec<NetId>,
}

impl<'a> Lockstep<'a> {
    /// Pairs them by the names of ports and registers.
    ///
    /// # Errors
    /// A name of one side that the other does not have.
    pub fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
        simulator: Simulator,
        seed: u64,
    ) -> Result<Self> {
        let find = |name: &str| {
            design.find(name).ok_or_else(|| {
                anyhow!("the golden model speaks of `{name}`, which the design does not have")
            })
        };
        let inputs: Vec<NetId> = design.inputs().map(|port| port.net).collect();
        let outputs: Vec<NetId> = design.outputs().map(|port| port.net).collect();
        let order = model
            .inputs()
            .iter()
            .map(|name| {
                let id = find(name)?;
                let at = inputs.iter().position(|&input| input == id);
                at.with_context(|| format!("the golden model takes `{name}` for an input"))
            })
            .collect::<Result<Vec<_>>>()?;
        let compared = model
            .signals()
            .iter()
            .map(|name| find(name))
            .collect::<Result<Vec<_>>>()?;
        for id in outputs.iter().chain(&registers(design)) {
            let name = &design.net(*id).name;
            ensure!(
                compared.contains(id),
                "the golden model does not predict `{name}`"
            );
        }
        let mut stimulus = Stimulus::new(design, contract.operands(), seed);
        if let Some(length) = contract.length() {
            stimulus = stimulus.with_length(length);
        }
        let operands = contract
            .operands()
            .iter()
            .map(|operand| {
                let at = stimulus.position(&operand.name);
                at.with_context(|| format!("the contract speaks of operand `{}`", operand.name))
            })
            .collect::<Result<Vec<_>>>()?;
        let role = |wanted: fn(Role) -> bool| design.port(wanted).map(|port| port.net);
        let busy = role(|role| role == Role::Busy).context("the design has no output `busy`")?;
        let valid = role(|role| role == Role::Valid).context("the design has no output `valid`")?;
        let results = contract
            .outputs()
            .iter()
            .map(|name| find(name))
            .collect::<Result<Vec<_>>>()?;
        Ok(Self {
            design,
            contract,
            model_inputs: vec![0; order.len()],
            colours: contract
                .operands()
                .iter()
                .filter(|operand| operand.colour)
                .count(),
            model,
            simulator,
            stimulus,
            outputs,
            order,
            compared,
            busy,
            valid,
            operands,
            results,
        })
    }

    /// Runs until `points` results were seen or something differs.
    ///
    /// `recording` takes the inputs of every clock, and the outputs before its edge; `progress` is told the points so far now
    /// and then.
    ///
    /// # Errors
    /// A simulation that does not settle, or a VCD that cannot be written.
    pub fn run(
        &mut self,
        points: u64,
        mut recording: Option<&mut Vectors>,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Outcome> {
        let registers = registers(self.design).len();
        let mut outcome = Outcome {
            registers,
            outputs: self.outputs.len(),
            ..Outcome::default()
        };
        let mut busy = self.simulator.value(self.busy) == 1;
        // Results since the latest start.
        let mut index = 0;
        while outcome.points < points {
            let inputs = self.stimulus.next(busy);
            for (at, &bits) in inputs.iter().enumerate() {
                self.simulator.set(at, bits);
            }
            for (to, &from) in self.model_inputs.iter_mut().zip(&self.order) {
                *to = inputs[from];
            }
            if let Some(recording) = recording.as_deref_mut() {
                recording.inputs.push(inputs.to_vec());
                let values = self.outputs.iter().map(|&net| self.simulator.value(net));
                recording.expected.push(values.collect());
            }
            let word = self.simulator.value(self.address());
            self.simulator.clock()?;
            self.model.clock(&self.model_inputs);
            outcome.clocks += 1;
            if let Some(mismatch) = self.compare(outcome.clocks, word) {
                outcome.mismatch = Some(mismatch);
                return Ok(outcome);
            }
            let was_busy = std::mem::replace(&mut busy, self.simulator.value(self.busy) == 1);
            if busy && !was_busy {
                index = 0;
            }
            if self.simulator.value(self.valid) == 1 {
                if outcome.points == 0
                    && let Some(recording) = recording.as_deref_mut()
                {
                    recording.known_from = recording.expected.len();
                }
                outcome.points += 1;
                self.measure(index, &mut outcome);
                index += 1;
                if outcome.points.is_multiple_of(1024) {
                    progress(outcome.points);
                }
            }
        }
        progress(outcome.points);
        Ok(outcome)
    }

    /// From now on, writes a waveform.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn trace(&mut self, file: impl std::io::Write + Send + 'static) -> Result<()> {
        self.simulator.trace(file)
    }

    /// Ends the waveform.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end_trace(&mut self) -> Result<()> {
        self.simulator.end_trace()
    }

    fn address(&self) -> NetId {
        self.design.register(self.design.control.address).q
    }

    fn compare(&self, clock: u64, word: u64) -> Option<Mismatch> {
        for (at, (&net, &golden)) in self.compared.iter().zip(self.model.values()).enumerate() {
            let simulated = self.simulator.value(net);
            if simulated != golden {
                let words = &self.design.control.words;
                return Some(Mismatch {
                    clock,
                    signal: self.model.signals()[at].clone(),
                    golden,
                    simulated,
                    word: words
                        .get(word as usize)
                        .map_or_else(String::new, |word| word.name.clone()),
                });
            }
        }
        None
    }

    /// The error of the results that are on the outputs now, number `index` of their computation, where the
    /// operands are in the domain.
    fn measure(&self, index: u64, outcome: &mut Outcome) {
        let operands = self.contract.operands();
        let raw = |at: usize| self.stimulus.accepted(self.operands[at]);
        let inside = operands
            .iter()
            .enumerate()
            .all(|(at, operand)| (operand.domain.0..=operand.domain.1).contains(&raw(at)));
        if !inside {
            return;
        }
        let control = operands.len() - self.colours;
        let values: Vec<i64> = (0..control).map(raw).collect();
        let f = self
            .contract
            .references(&self.contract.point(&values, index));
        for (at, &net) in self.results.iter().enumerate() {
            let colour = &operands[control + at];
            let colour = colour.format.to_f64(i128::from(raw(control + at)));
            let format = self.design.net(net).format;
            let out = format.to_f64(format.raw(self.simulator.value(net)));
            let units = nearer(out, f.map(|f| f * colour));
            if outcome
                .worst
                .as_ref()
                .is_none_or(|worst| units > worst.units)
            {
                outcome.worst = Some(Worst {
                    units,
                    output: self.design.net(net).name.clone(),
                    operands: operands
                        .iter()
                        .enumerate()
                        .map(|(at, operand)| (operand.name.clone(), raw(at)))
                        .collect(),
                });
            }
        }
    }
}

/// The registers that a golden model must predict.
fn registers(design: &Design) -> Vec<NetId> {
    use crate::netlist::RegisterKind;
    design
        .registers
        .iter()
        .filter(|register| register.kind != RegisterKind::Internal)
        .map(|register| register.q)
        .collect()
}

//! The golden model's values for one point: its results, and its registers along the microprogram.

use anyhow::{Context, Result, anyhow};

use crate::golden::Model;
use crate::hdl::netlist::{Design, NetId, Pipeline, Role};

/// The most clocks of a computation.
const MOST_CLOCKS: usize = 8192;

/// The golden model of the sequential core, run a point at a time.
pub(super) struct Reference {
    model: Box<dyn Model>,
    inputs: Vec<u64>,
    reset: usize,
    start: usize,
    /// For each operand of the pipeline, data and strobe among the model's inputs.
    operands: Vec<(usize, usize)>,
    busy: usize,
    valid: usize,
    address: usize,
    /// The signals of the results.
    results: Vec<usize>,
    /// For each checkpoint, its signal.
    registers: Vec<usize>,
    /// For each microinstruction, the checkpoints in it: how often it was executed before, and which.
    due: Vec<Vec<(usize, usize)>>,
    visits: Vec<usize>,
}

/// The expected values of a point.
#[derive(Debug, Default)]
pub(super) struct Expected {
    /// The results, bit patterns.
    pub results: Vec<u64>,
    /// For each checkpoint the value of its register, if the point came there.
    pub registers: Vec<Option<u64>>,
}

impl Reference {
    /// # Errors
    /// A name of one side that the other does not have.
    pub(super) fn new(
        design: &Design,
        pipeline: &Pipeline,
        model: &dyn Model,
        results: &[NetId],
    ) -> Result<Self> {
        let input = |name: &str| {
            let at = model.inputs().iter().position(|other| other == name);
            at.with_context(|| format!("the golden model has no input `{name}`"))
        };
        let signal = |name: &str| {
            let at = model.signals().iter().position(|other| other == name);
            at.with_context(|| format!("the golden model does not predict `{name}`"))
        };
        let name = |net: NetId| design.net(net).name.as_str();
        let operands = design
            .ports
            .iter()
            .filter(|port| port.role == Role::Point)
            .map(|port| {
                let name = name(port.net);
                Ok((input(name)?, input(&format!("{name}_write"))?))
            })
            .collect::<Result<_>>()?;
        let checkpoints = &pipeline.checkpoints;
        let registers =
            checkpoints.iter().map(|it| signal(&it.register)).collect::<Result<Vec<_>>>()?;
        let length = checkpoints.iter().map(|it| it.address + 1).max().unwrap_or(0);
        let mut due = vec![Vec::new(); length];
        for (at, checkpoint) in checkpoints.iter().enumerate() {
            due[checkpoint.address].push((checkpoint.visit, at));
        }
        Ok(Self {
            inputs: vec![0; model.inputs().len()],
            reset: input("rst_n")?,
            start: input("start")?,
            operands,
            busy: signal("busy")?,
            valid: signal("valid")?,
            address: signal("word_address")?,
            results: results.iter().map(|&net| signal(name(net))).collect::<Result<_>>()?,
            registers,
            visits: vec![0; length],
            due,
            model: model.boxed_clone(),
        })
    }

    /// One computation, of these bit patterns.
    ///
    /// # Errors
    /// A model that does not come to an end.
    pub(super) fn point(&mut self, operands: &[u64]) -> Result<Expected> {
        self.inputs.fill(0);
        self.inputs[self.reset] = 1;
        self.inputs[self.start] = 1;
        for (&bits, &(data, strobe)) in operands.iter().zip(&self.operands) {
            self.inputs[data] = bits;
            self.inputs[strobe] = 1;
        }
        self.model.clock(&self.inputs);
        self.inputs.fill(0);
        self.inputs[self.reset] = 1;
        self.visits.fill(0);
        let mut expected =
            Expected { results: Vec::new(), registers: vec![None; self.registers.len()] };
        for _ in 0..MOST_CLOCKS {
            let values = self.model.values();
            if values[self.busy] == 0 {
                return Ok(expected);
            }
            let address = values[self.address] as usize;
            if let Some(due) = self.due.get(address) {
                for &(visit, at) in due {
                    if visit == self.visits[address] {
                        expected.registers[at] = Some(values[self.registers[at]]);
                    }
                }
                self.visits[address] += 1;
            }
            if values[self.valid] == 1 && expected.results.is_empty() {
                expected.results.extend(self.results.iter().map(|&at| values[at]));
            }
            self.model.clock(&self.inputs);
        }
        Err(anyhow!("the golden model does not end"))
    }
}

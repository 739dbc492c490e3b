//! Simulates a pipeline and its sequential core for one point (one set of operands), with numbers instead of symbolic terms.

use anyhow::{Context, Result, bail};

use super::MOST_CLOCKS;
use glint_rtl::netlist::{Design, Interpreter, NetId, Role};

/// A pipeline and its sequential core, with the operands and outputs that both have.
pub struct DesignPair<'a> {
    pub sequential: &'a Design,
    pub pipeline: &'a Design,
    pub operands: Vec<String>,
    /// The name of each output of the pipeline, with its net in the pipeline and in the core.
    pub outputs: Vec<(String, NetId, NetId)>,
    /// The number of clocks from the clock that takes a point to the clock that shows its results.
    pub latency: usize,
}

impl<'a> DesignPair<'a> {
    /// Pairs the two designs.
    ///
    /// # Errors
    ///
    /// Fails if `pipeline` is no pipeline, if the designs have different operands, or if the core lacks an output of the
    /// pipeline.
    pub fn new(sequential: &'a Design, pipeline: &'a Design) -> Result<Self> {
        let stages = pipeline.pipeline.as_ref().context("the design is not a pipeline")?;
        let mut operands = Vec::new();
        let mut outputs = Vec::new();
        for port in &pipeline.ports {
            let name = &pipeline.net(port.net).name;
            match port.role {
                Role::Point => operands.push(name.clone()),
                Role::Result | Role::Status => outputs.push((name.clone(), port.net)),
                _ => {}
            }
        }
        let mut sequential_operands = Vec::new();
        for port in &sequential.ports {
            if matches!(port.role, Role::Operand { .. }) {
                sequential_operands.push(sequential.net(port.net).name.clone());
            }
        }
        let mut sorted_operands = operands.clone();
        sorted_operands.sort();
        sequential_operands.sort();
        if sorted_operands != sequential_operands {
            bail!("the cores have different operands");
        }
        let mut paired_outputs = Vec::new();
        for (name, net) in outputs {
            let Some(same) = sequential.find(&name) else {
                bail!("the sequential core has no output `{name}`")
            };
            paired_outputs.push((name, net, same));
        }
        Ok(Self {
            sequential,
            pipeline,
            operands,
            outputs: paired_outputs,
            latency: stages.stages.len(),
        })
    }

    /// Simulates both designs for one point, with the bit patterns `operands`. Returns the bit patterns of the outputs: first
    /// from the sequential core, then from the pipeline.
    ///
    /// # Errors
    /// Fails if the sequential core shows no result within 8192 clocks, or if a design has a combinational loop.
    pub fn outputs(&self, operands: &[u64]) -> Result<[Vec<u64>; 2]> {
        Ok([self.of_sequential(operands)?, self.of_pipeline(operands)?])
    }

    fn of_sequential(&self, operands: &[u64]) -> Result<Vec<u64>> {
        let design = self.sequential;
        let valid = design.handshake()?.valid;
        let mut core = interpreter(design)?;
        for (rst_n, start) in [(0, 0), (1, 1)] {
            core.settle(&self.inputs(design, operands, rst_n, start));
            core.edge();
        }
        for _ in 0..MOST_CLOCKS {
            core.settle(&self.inputs(design, operands, 1, 0));
            if core.value(valid) == 1 {
                return Ok(self.outputs.iter().map(|&(_, _, net)| core.value(net)).collect());
            }
            core.edge();
        }
        bail!("the sequential core shows no result")
    }

    fn of_pipeline(&self, operands: &[u64]) -> Result<Vec<u64>> {
        let design = self.pipeline;
        let mut core = interpreter(design)?;
        core.settle(&self.inputs(design, operands, 0, 0));
        core.edge();
        for clock in 0..self.latency {
            core.settle(&self.inputs(design, operands, 1, u64::from(clock == 0)));
            core.edge();
        }
        core.settle(&self.inputs(design, operands, 1, 0));
        Ok(self.outputs.iter().map(|&(_, net, _)| core.value(net)).collect())
    }

    /// Returns the values of a design's inputs in one clock. `now` is the value of `start`, `in_valid` and the strobes: 1 in
    /// the clock that takes the point. `out_ready` is always 1, and an input without a known role is 0.
    fn inputs(&self, design: &Design, operands: &[u64], rst_n: u64, now: u64) -> Vec<u64> {
        let mut inputs = Vec::new();
        for port in design.inputs() {
            inputs.push(match port.role {
                Role::Reset => rst_n,
                Role::Start | Role::Strobe | Role::InValid => now,
                Role::OutReady => 1,
                _ => {
                    let name = &design.net(port.net).name;
                    match self.operands.iter().position(|operand| operand == name) {
                        Some(at) => operands[at],
                        None => 0,
                    }
                }
            });
        }
        inputs
    }
}

fn interpreter(design: &Design) -> Result<Interpreter<'_>> {
    let interpreter = Interpreter::new(design);
    interpreter.map_err(|_| anyhow::anyhow!("`{}` has a combinational loop", design.name))
}

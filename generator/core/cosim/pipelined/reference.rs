//! Runs the golden model of the sequential core for one point.
//!
//! The module returns the results, and the register values that a pipeline must show at its checkpoints.

use anyhow::{Result, bail};

use crate::cosim::driven::{Driven, signal};
use crate::cosim::ports::Ports;
use glint_golden::Model;
use glint_rtl::netlist::{Design, NetId, Pipeline};

/// A computation that takes more clocks counts as endless.
const MOST_CLOCKS: usize = 8192;

/// The golden model of the sequential core, which computes one point at a time.
#[derive(Clone)]
pub(super) struct Reference {
    model: Driven,
    address: usize,
    /// The indices of the results among the model's signals.
    results: Vec<usize>,
    /// For each checkpoint, the index of its register among the model's signals.
    registers: Vec<usize>,
    /// For each microinstruction, its checkpoints: the number of earlier executions of the microinstruction, and the index of
    /// the checkpoint.
    due: Vec<Vec<(usize, usize)>>,
    visits: Vec<usize>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Expected {
    /// The bit patterns of the first results that the computation shows.
    pub results: Vec<u64>,
    /// For each checkpoint, the value of its register; `None` if the computation does not reach the checkpoint's
    /// microinstruction.
    pub registers: Vec<Option<u64>>,
}

impl Reference {
    /// Finds the signals of the model that belong to the checkpoints and the results of a pipeline.
    ///
    /// # Errors
    /// Fails if the model lacks a result, a checkpoint's register, `word_address`, `busy`, `valid`, or an input of the operands
    /// or of the handshake.
    pub(super) fn new(
        design: &Design,
        pipeline: &Pipeline,
        model: Box<dyn Model>,
        ports: &Ports,
        results: &[NetId],
    ) -> Result<Self> {
        let signal = |name: &str| signal(model.as_ref(), name);
        let checkpoints = &pipeline.checkpoints;
        let length = checkpoints.iter().map(|it| it.address + 1).max().unwrap_or(0);
        let mut due = vec![Vec::new(); length];
        for (at, checkpoint) in checkpoints.iter().enumerate() {
            due[checkpoint.address].push((checkpoint.visit, at));
        }
        let of_results = results.iter().map(|&net| signal(&design.net(net).name));
        let of_registers = checkpoints.iter().map(|it| signal(&it.register));
        Ok(Self {
            address: signal("word_address")?,
            results: of_results.collect::<Result<_>>()?,
            registers: of_registers.collect::<Result<_>>()?,
            visits: vec![0; length],
            due,
            model: Driven::new(model, ports.operands.iter().map(|port| port.name.as_str()))?,
        })
    }

    /// Computes one point from the bit patterns of its operands, in the order of the ports.
    ///
    /// # Errors
    /// Fails if the golden model does not finish the computation within 8192 clocks.
    pub(super) fn point(&mut self, patterns: impl Iterator<Item = u64>) -> Result<Expected> {
        self.model.start(patterns);
        self.visits.fill(0);
        let mut expected =
            Expected { results: Vec::new(), registers: vec![None; self.registers.len()] };
        for _ in 0..MOST_CLOCKS {
            let values = self.model.values();
            if values[self.model.busy] == 0 {
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
            if values[self.model.valid] == 1 && expected.results.is_empty() {
                expected.results.extend(self.results.iter().map(|&at| values[at]));
            }
            self.model.clock();
        }
        bail!("the computation of the golden model does not end")
    }
}

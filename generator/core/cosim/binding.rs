//! Finds, for each signal of a golden model, the port or the register of the design with the same name.
//!
//! Co-simulation compares the predictions of the model with the simulated design by this binding, which fails if a signal has
//! no partner. A pipeline has checkpoints in place of registers. For example, the model's signal `busy` is bound to the port
//! `busy` of the design.

use std::sync::Arc;

use anyhow::Result;

use super::combinations::Space;
use super::measure::Measure;
use super::pipelined::Pipe;
use super::points::PointSource;
use super::ports::Ports;
use super::sequential::{SequentialModel, registers};
use glint_golden::{Contract, Model};
use glint_rtl::netlist::{Design, NetId};

/// The model that predicts the signals of a device: for a core with a microprogram, or for a pipeline.
#[derive(Clone)]
pub(super) enum Host {
    Core(SequentialModel),
    Pipe(Pipe),
}

/// A design and its golden model, whose signals are matched by name.
pub(super) struct Binding<'a> {
    pub(super) design: &'a Design,
    pub(super) measure: Measure<'a>,
    pub(super) ports: Arc<Ports>,
    /// The model at power-up. Every stream runs a copy of it.
    pub(super) host: Host,
    pub(super) outputs: Vec<NetId>,
    /// The nets whose values the model predicts, in the order of the predictions.
    pub(super) compared: Vec<NetId>,
    /// The number of nets in `compared` that are registers. For a pipeline, the number of its checkpoints.
    pub(super) registers: usize,
    /// The register with the address of the current microinstruction; `None` for a pipeline.
    pub(super) address: Option<NetId>,
    pub(super) space: Arc<Space>,
    pub(super) points: PointSource<'a>,
}

impl<'a> Binding<'a> {
    /// Fails if the model predicts a signal that the design does not have, or if the design has an architectural register or an
    /// output that the model does not predict. Fails also if design and contract do not have the same operands and outputs.
    pub(super) fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
    ) -> Result<Self> {
        let ports = Arc::new(Ports::new(design, contract)?);
        let (host, compared, measure, registers) = if let Some(pipeline) = &design.pipeline {
            let (pipe, compared, results) = Pipe::new(design, pipeline, model, &ports)?;
            let measure = Measure::new(design, contract, &results)?;
            (Host::Pipe(pipe), compared, measure, pipeline.checkpoints.len())
        } else {
            let (core, compared) = SequentialModel::new(design, model, &ports)?;
            let measure = Measure::new(design, contract, &compared)?;
            (Host::Core(core), compared, measure, registers(design).count())
        };
        let address = match design.pipeline {
            Some(_) => None,
            None => Some(design.register(design.control.address).q),
        };
        Ok(Self {
            outputs: design.outputs().map(|port| port.net).collect(),
            address,
            space: Arc::new(Space::new(&ports)),
            points: PointSource::new(contract),
            design,
            measure,
            ports,
            host,
            compared,
            registers,
        })
    }

    pub(super) fn is_pipeline(&self) -> bool {
        self.address.is_none()
    }

    /// Fixes operands at the given raw values. Combinations then cover only the other operands. Random inputs seldom have
    /// other values for a fixed operand.
    pub(super) fn holding(mut self, held: &[(String, i64)]) -> Self {
        for (name, raw) in held {
            self.points.hold(name, *raw);
        }
        Arc::make_mut(&mut self.space).hold(held);
        self
    }

    /// Limits the lines that are drawn at random to at most `results` results. A device without lines does not change.
    pub(super) fn shorten(&mut self, results: i64) {
        self.points.shorten(results - 1);
    }

    /// Returns the largest number of results of one computation whose operands are within their domains. Returns 1 for a device
    /// without lines.
    pub(super) fn longest(&self) -> u64 {
        let Some(length) = self.points.length() else { return 1 };
        let (_, longest) = self.measure.contract.operands()[length].domain;
        // A line with the length operand 0 has one result.
        longest.unsigned_abs() + 1
    }
}

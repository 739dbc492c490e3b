//! Finds, for each signal of a golden model, the port or the register of the design with the same name.
//!
//! By this binding, co-simulation compares the model's predictions with the simulated design. A pipeline has checkpoints in
//! place of registers.

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

/// The model that predicts the signals of a device: for a sequential core, or for a pipeline.
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
    /// Fails if model and design do not have the same signals, or if design and contract do not have the same operands and
    /// outputs.
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

    /// Fixes operands at the raw values in `held`. Combinations never have another value for a fixed operand, and random inputs
    /// seldom.
    pub(super) fn holding(mut self, held: &[(String, i64)]) -> Self {
        for (name, raw) in held {
            self.points.hold(name, *raw);
        }
        Arc::make_mut(&mut self.space).hold(held);
        self
    }

    /// Limits random lines to at most `results` results. Changes nothing for a device without lines.
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

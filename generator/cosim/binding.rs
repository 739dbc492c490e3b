//! The binding of a golden model to a design: which port or register each signal of the model is.

use std::sync::Arc;

use anyhow::{Context, Result, anyhow, ensure};

use super::combinations::{Combinations, Ports};
use super::measure::Measure;
use super::points::Points;
use super::stimulus::Stimulus;
use crate::golden::{Contract, Model};
use crate::hdl::netlist::{Design, NetId, RegisterKind};

/// A design and its golden model, bound by the names of ports and registers.
pub(super) struct Binding<'a> {
    pub(super) design: &'a Design,
    pub(super) measure: Measure<'a>,
    /// At power-up; every stream runs a copy of it.
    pub(super) model: Box<dyn Model>,
    pub(super) outputs: Vec<NetId>,
    /// For each input of the model its position among the design's; none if the orders are the same.
    pub(super) order: Option<Vec<usize>>,
    /// The nets that the model predicts, in its order.
    pub(super) compared: Vec<NetId>,
    /// The positions of the outputs `busy` and `valid` among these.
    pub(super) busy: usize,
    pub(super) valid: usize,
    /// That of `done`, where `start` is heard while it is high.
    overlaps: Option<usize>,
    /// The address of the microprogram.
    pub(super) address: NetId,
    pub(super) ports: Arc<Ports>,
    pub(super) points: Points<'a>,
    /// Inputs from power-up on; every stream runs a copy of them with a seed of its own.
    pub(super) stimulus: Stimulus,
}

impl<'a> Binding<'a> {
    /// Pairs them.
    ///
    /// # Errors
    /// A name of one side that the other does not have.
    pub(super) fn new(
        design: &'a Design,
        model: Box<dyn Model>,
        contract: &'a dyn Contract,
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
        let compared = model.signals().iter().map(|name| find(name)).collect::<Result<Vec<_>>>()?;
        for id in outputs.iter().chain(&registers(design)) {
            let name = &design.net(*id).name;
            ensure!(compared.contains(id), "the golden model does not predict `{name}`");
        }
        let order = (!order.iter().copied().eq(0..inputs.len())).then_some(order);
        let points = Points::new(contract);
        let stimulus = Stimulus::new(design, &points, 0)?;
        let position = |net: NetId| compared.iter().position(|&other| other == net);
        let handshake = design.handshake()?;
        let predicted = |net: NetId| {
            position(net).with_context(|| {
                format!("the golden model does not predict `{}`", design.net(net).name)
            })
        };
        let (busy, valid) = (predicted(handshake.busy)?, predicted(handshake.valid)?);
        let done = predicted(handshake.done)?;
        let measure = Measure::new(design, contract, |name| position(design.find(name)?))?;
        Ok(Self {
            design,
            model,
            outputs,
            order,
            compared,
            busy,
            valid,
            overlaps: design.control.overlaps.then_some(done),
            ports: Arc::new(Ports::new(design)?),
            address: design.register(design.control.address).q,
            points,
            stimulus,
            measure,
        })
    }

    /// Holds operands at raw values: combinations are of the others alone, and the stimulus seldom draws
    /// anything else.
    pub(super) fn holding(mut self, held: &[(String, i64)]) -> Self {
        for (name, raw) in held {
            self.points.hold(name, *raw);
        }
        Arc::make_mut(&mut self.ports).hold(held);
        self
    }

    /// Draws lines of at most `results` results.
    pub(super) fn shorten(&mut self, results: i64) {
        if let Some(length) = self.measure.contract.length() {
            self.points.limit(length, results - 1);
        }
    }

    /// Computations with these raw operands, in the order of the contract.
    pub(super) fn listed(&self, computations: &[Vec<i64>]) -> Combinations {
        let mut ports = Ports::clone(&self.ports);
        let names = self.measure.contract.operands().iter().map(|operand| operand.name.as_str());
        ports.list(names, computations);
        Combinations::new(Arc::new(ports), 0, computations.len() as u64)
    }

    /// The combinations of operands at `count` places, from the first on.
    pub(super) fn combinations(&self, first: u64, count: u64) -> Combinations {
        Combinations::new(self.ports.clone(), first, count)
    }

    /// A bound on the results of one computation.
    pub(super) fn longest(&self) -> u64 {
        let length = self.measure.contract.length();
        let operands = self.measure.contract.operands().iter();
        let operand = operands.filter(|operand| Some(operand.name.as_str()) == length);
        // A length of 0 is a result too.
        operand.map(|it| it.domain.1.unsigned_abs() + 1).max().unwrap_or(1)
    }

    /// Whether `start` is not heard in the clock that shows these values.
    pub(super) fn is_deaf(&self, values: &[u64]) -> bool {
        values[self.busy] == 1 && self.overlaps.is_none_or(|done| values[done] == 0)
    }

    /// How many registers a golden model must predict.
    pub(super) fn registers(&self) -> usize {
        registers(self.design).len()
    }
}

/// The registers that a golden model must predict.
fn registers(design: &Design) -> Vec<NetId> {
    design
        .registers
        .iter()
        .filter(|register| register.kind != RegisterKind::Internal)
        .map(|register| register.q)
        .collect()
}

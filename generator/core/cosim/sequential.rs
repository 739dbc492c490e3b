//! Predicts the signals of a sequential core at every clock, with the core's golden model.

use std::mem;

use anyhow::{Context, Result, anyhow, ensure};

use super::measure::Measure;
use super::outcome::StreamRecord;
use super::ports::Ports;
use glint_golden::Model;
use glint_rtl::netlist::{Design, NetId, RegisterKind};

/// The golden model of a sequential core, which gets the same inputs as the core.
#[derive(Clone)]
pub(super) struct SequentialModel {
    model: Box<dyn Model>,
    /// For each input of the model, its index among the design's inputs. `None` if the order is the same.
    order: Option<Vec<usize>>,
    /// The model's inputs in the model's order, if that is different from the design's.
    reordered: Vec<u64>,
    /// Indices among the model's signals. `overlaps` is the index of `done` if the core accepts `start` while `done` is high.
    busy: usize,
    valid: usize,
    overlaps: Option<usize>,
    /// Whether the core ignores `start` in the next clock.
    pub(super) deaf: bool,
    /// The number of results since the latest `start`.
    index: u64,
    /// The raw operands of the computation that shows results, and whether they are inside the domain.
    operands: Vec<i64>,
    inside: bool,
}

impl SequentialModel {
    /// Matches the model's inputs and signals with the design's nets by name. Also returns the predicted nets, in the order of
    /// the predictions.
    ///
    /// # Errors
    /// Fails if the model has an input or a signal that the design does not have, or if it does not predict an output or an
    /// architectural register of the design.
    pub(super) fn new(
        design: &Design,
        model: Box<dyn Model>,
        ports: &Ports,
    ) -> Result<(Self, Vec<NetId>)> {
        let find = |name: &String| {
            design.find(name).ok_or_else(|| {
                anyhow!("the golden model has a signal `{name}`, and the design does not")
            })
        };
        let inputs: Vec<NetId> = design.inputs().map(|port| port.net).collect();
        let mut order = Vec::new();
        for name in model.inputs() {
            let id = find(name)?;
            let at = inputs.iter().position(|&input| input == id);
            order.push(at.with_context(|| {
                format!("`{name}` is an input of the golden model, but not of the design")
            })?);
        }
        let mut compared = Vec::new();
        for name in model.signals() {
            compared.push(find(name)?);
        }
        for id in design.outputs().map(|port| port.net).chain(registers(design)) {
            let name = &design.net(id).name;
            ensure!(compared.contains(&id), "the golden model does not predict `{name}`");
        }
        // The outputs of the handshake are among `compared`.
        let position = |net: NetId| compared.iter().position(|&it| it == net);
        let core = Self {
            order: (!order.iter().copied().eq(0..inputs.len())).then_some(order),
            reordered: Vec::new(),
            busy: ports.busy.and_then(position).context("a core has an output `busy`")?,
            valid: position(ports.valid).context("a core has an output `valid`")?,
            overlaps: ports.done.filter(|_| ports.overlaps).and_then(position),
            deaf: false,
            index: 0,
            operands: Vec::new(),
            inside: false,
            model,
        };
        Ok((core, compared))
    }

    /// `inputs` has the bit patterns of the design's inputs, in the design's order.
    #[inline]
    pub(super) fn clock(&mut self, inputs: &[u64]) {
        match &self.order {
            None => self.model.clock(inputs),
            Some(order) => {
                self.reordered.clear();
                self.reordered.extend(order.iter().map(|&at| inputs[at]));
                self.model.clock(&self.reordered);
            }
        }
    }

    #[inline]
    pub(super) fn predicted(&self) -> &[u64] {
        self.model.values()
    }

    /// Counts a result in `seen`, if the model predicts a result in this clock, and measures the result's error. `accepted` has
    /// the raw operands of the computation that started last; without them no error is measured.
    #[inline]
    pub(super) fn note(
        &mut self,
        measure: &Measure,
        seen: &mut StreamRecord,
        accepted: Option<&[i64]>,
    ) {
        let values = self.model.values();
        let deaf = values[self.busy] == 1 && self.overlaps.is_none_or(|done| values[done] == 0);
        let was_deaf = mem::replace(&mut self.deaf, deaf);
        if deaf && !was_deaf {
            self.index = 0;
        }
        if values[self.valid] != 1 {
            return;
        }
        seen.points += 1;
        // Without operands, the result is only counted. An exhaustive check measures the errors elsewhere, and recorded inputs
        // do not tell to which operands a result belongs.
        let Some(accepted) = accepted else {
            return;
        };
        if self.index == 0 {
            self.operands.clear();
            self.operands.extend(accepted);
            self.inside = measure.inside(&self.operands);
        }
        if self.inside {
            measure.note(seen, &self.operands, self.index, values);
        } else {
            seen.histogram.add_outside();
        }
        self.index += 1;
    }
}

/// Returns the architectural registers of a design, which its golden model must predict.
pub(super) fn registers(design: &Design) -> impl Iterator<Item = NetId> {
    let predicted =
        design.registers.iter().filter(|register| register.kind != RegisterKind::Internal);
    predicted.map(|register| register.q)
}

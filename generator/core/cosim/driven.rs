//! Runs a golden model without hardware: starts a computation, advances the model clock by clock, and reads its signals by name.
//!
//! For example, `glint eval` runs a model in this way to print the registers of one computation.

use anyhow::{Context, Result};

use glint_golden::Model;

/// A golden model together with the values of its inputs, which the caller drives.
#[derive(Clone)]
pub struct Driven {
    model: Box<dyn Model>,
    inputs: Vec<u64>,
    reset: usize,
    start: usize,
    /// Data and strobe of each operand.
    operands: Vec<(usize, usize)>,
    pub(super) busy: usize,
    pub(super) valid: usize,
}

impl Driven {
    /// Takes a model at power-up, and finds its inputs by the names of the handshake and of the operands.
    ///
    /// # Errors
    /// Fails if the model does not have one of the names.
    pub fn new<'n>(model: Box<dyn Model>, operands: impl Iterator<Item = &'n str>) -> Result<Self> {
        let input = |name: &str| {
            let at = model.inputs().iter().position(|other| other == name);
            at.with_context(|| format!("the golden model has no input `{name}`"))
        };
        let mut places = Vec::new();
        for name in operands {
            places.push((input(name)?, input(&format!("{name}_write"))?));
        }
        Ok(Self {
            inputs: vec![0; model.inputs().len()],
            reset: input("rst_n")?,
            start: input("start")?,
            operands: places,
            busy: signal(model.as_ref(), "busy")?,
            valid: signal(model.as_ref(), "valid")?,
            model,
        })
    }

    /// Starts a computation: for one clock, drives `start` and the bit patterns of the operands.
    pub fn start(&mut self, patterns: impl Iterator<Item = u64>) {
        for (bits, &(data, strobe)) in patterns.zip(&self.operands) {
            self.inputs[data] = bits;
            self.inputs[strobe] = 1;
        }
        self.inputs[self.reset] = 1;
        self.inputs[self.start] = 1;
        self.clock();
        self.inputs.fill(0);
        self.inputs[self.reset] = 1;
    }

    /// Advances the model by one clock.
    pub fn clock(&mut self) {
        self.model.clock(&self.inputs);
    }

    /// Returns whether the model shows a result in this clock.
    pub fn is_valid(&self) -> bool {
        self.values()[self.valid] == 1
    }

    /// Returns the values of all signals of the model, in the order of [`Driven::names`].
    pub fn values(&self) -> &[u64] {
        self.model.values()
    }

    /// Returns the names of all signals of the model.
    pub fn names(&self) -> &[String] {
        self.model.signals()
    }
}

/// Returns the index of the signal `name` among the signals of a model.
pub(super) fn signal(model: &dyn Model, name: &str) -> Result<usize> {
    let at = model.signals().iter().position(|other| other == name);
    at.with_context(|| format!("the golden model does not predict `{name}`"))
}

//! Runs a golden model without hardware: starts a computation, advances the model clock by clock, and reads its signals by name.
//!
//! For example, `glint eval` runs a model in this way to print the registers of one computation.

use anyhow::{Context, Result};

use glint_golden::Model;

/// A golden model together with the bit patterns of its inputs, which the caller sets through [`Driven::start`].
#[derive(Clone)]
pub struct Driven {
    model: Box<dyn Model>,
    inputs: Vec<u64>,
    reset: usize,
    start: usize,
    /// For each operand, the indices of its data and of its strobe among the inputs.
    operands: Vec<(usize, usize)>,
    pub(super) busy: usize,
    pub(super) valid: usize,
}

impl Driven {
    /// Takes a model at power-up, and finds its inputs by the names of the handshake and of the `operands`.
    ///
    /// # Errors
    /// Fails if the model has no input `rst_n` or `start`, no input `<operand>` or `<operand>_write` for an operand, or does
    /// not predict `busy` or `valid`.
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

    /// For one clock, drives `start`, the strobes and the bit patterns of the operands, in the order of the operands in
    /// [`Driven::new`]. In later clocks, all inputs but `rst_n` are 0.
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

    pub fn clock(&mut self) {
        self.model.clock(&self.inputs);
    }

    pub fn is_valid(&self) -> bool {
        self.values()[self.valid] == 1
    }

    /// Returns bit patterns in the order of [`Driven::names`].
    pub fn values(&self) -> &[u64] {
        self.model.values()
    }

    pub fn names(&self) -> &[String] {
        self.model.signals()
    }
}

pub(super) fn signal(model: &dyn Model, name: &str) -> Result<usize> {
    let at = model.signals().iter().position(|other| other == name);
    at.with_context(|| format!("the golden model does not predict `{name}`"))
}

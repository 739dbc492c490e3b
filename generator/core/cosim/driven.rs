//! Drives a golden model on its own: starts a computation, clocks the model and reads its signals.

use anyhow::{Context, Result};

use glint_golden::Model;

/// A golden model whose handshake is driven.
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
    /// Takes a model, which must be at power-up, and finds its inputs of the handshake and of the operands that are named.
    ///
    /// # Errors
    /// Fails if the model does not have one of the names.
    pub fn new<'n>(model: Box<dyn Model>, operands: impl Iterator<Item = &'n str>) -> Result<Self> {
        let input = |name: &str| {
            let at = model.inputs().iter().position(|other| other == name);
            at.with_context(|| format!("the golden model has no input `{name}`"))
        };
        let operands = operands.map(|name| Ok((input(name)?, input(&format!("{name}_write"))?)));
        Ok(Self {
            inputs: vec![0; model.inputs().len()],
            reset: input("rst_n")?,
            start: input("start")?,
            operands: operands.collect::<Result<_>>()?,
            busy: signal(model.as_ref(), "busy")?,
            valid: signal(model.as_ref(), "valid")?,
            model,
        })
    }

    /// Starts a computation with these bit patterns, in one clock.
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

    /// Returns whether there is a result.
    pub fn is_valid(&self) -> bool {
        self.values()[self.valid] == 1
    }

    /// Returns all signals, with their names in [`Driven::names`].
    pub fn values(&self) -> &[u64] {
        self.model.values()
    }

    /// Returns the names of all signals.
    pub fn names(&self) -> &[String] {
        self.model.signals()
    }
}

/// Returns the position of a signal of a model.
pub(super) fn signal(model: &dyn Model, name: &str) -> Result<usize> {
    let at = model.signals().iter().position(|other| other == name);
    at.with_context(|| format!("the golden model does not predict `{name}`"))
}

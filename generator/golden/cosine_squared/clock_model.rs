//! `cosine-squared` clock by clock.

use std::sync::Arc;

use super::{Arithmetic, Params};
use crate::config::Config;
use crate::golden::Model;
use crate::golden::handshake::OperandRegister;
use crate::golden::line::Walker;

/// The names beside the walker's.
const SIGNALS: [&str; 2] = ["intensity_out", "amplitude_reg"];

/// The device, clock by clock.
#[derive(Clone, Debug)]
pub struct CosineSquaredModel {
    arithmetic: Arc<Arithmetic>,
    walker: Walker,
    amplitude: OperandRegister,
    /// What ROM 12 read at the latest edge.
    cosine: i64,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: Vec<u64>,
}

impl CosineSquaredModel {
    /// The device at power-up, of a configuration.
    ///
    /// # Panics
    /// If the configuration is one that [`Params::check`] refuses and the device's schema does not.
    pub fn new(config: &Config) -> Self {
        Self::from_params(&Params::from_config(config))
            .expect("a configuration that its schema accepts")
    }

    /// The device at power-up.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn from_params(params: &Params) -> Result<Self, String> {
        params.check()?;
        let operands = Walker::OPERANDS.into_iter().chain(["amplitude"]);
        let inputs = ["rst_n", "start"].into_iter().map(String::from);
        let signals = Walker::SIGNALS.into_iter().chain(SIGNALS);
        Ok(Self {
            arithmetic: Arc::new(Arithmetic::new(params)),
            walker: Walker::new(params.angle_format(), params.length_bits),
            amplitude: OperandRegister::new(params.colour_format()),
            cosine: 0,
            inputs: inputs
                .chain(operands.flat_map(|name| [name.to_string(), format!("{name}_write")]))
                .collect(),
            values: vec![0; signals.clone().count()],
            signals: signals.map(String::from).collect(),
        })
    }
}

impl Model for CosineSquaredModel {
    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn signals(&self) -> &[String] {
        &self.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let it = &self.arithmetic;
        self.cosine = it.cosine(self.walker.angle());
        self.amplitude.clock(self.walker.busy(), inputs[9], inputs[8]);
        self.walker.clock(inputs[0] & 1 == 1, inputs[1] & 1 == 1, &inputs[2..8]);
        let walker = self.walker.values();
        let (shared, own) = self.values.split_at_mut(walker.len());
        shared.copy_from_slice(&walker);
        own.copy_from_slice(&[
            it.colour(self.cosine, self.amplitude.value) as u64,
            self.amplitude.value as u64,
        ]);
    }

    fn values(&self) -> &[u64] {
        &self.values
    }
}

//! `threshold` clock by clock.

use super::{Arithmetic, Params};
use crate::config::Config;
use crate::golden::Model;
use crate::golden::handshake::{After, Handshake, OperandRegister, bits};

const INPUTS: [&str; 12] = [
    "rst_n",
    "start",
    "cos_gamma",
    "cos_gamma_write",
    "exponent",
    "exponent_write",
    "red",
    "red_write",
    "green",
    "green_write",
    "blue",
    "blue_write",
];

const SIGNALS: [&str; 15] = [
    "valid",
    "busy",
    "done",
    "red_out",
    "green_out",
    "blue_out",
    "run",
    "word_address",
    "cos_gamma_reg",
    "exponent_reg",
    "red_reg",
    "green_reg",
    "blue_reg",
    "scaled",
    "intensity",
];

/// The word in which the result stands, and in which the program ends.
const RESULT: u32 = 3;

/// The device, clock by clock.
#[derive(Clone, Debug)]
pub struct ThresholdModel {
    arithmetic: Arithmetic,
    /// Width of the signed register `scaled`.
    scaled_width: u32,
    handshake: Handshake,
    cosine: OperandRegister,
    exponent: OperandRegister,
    colours: [OperandRegister; 3],
    scaled: i64,
    intensity: i64,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: [u64; SIGNALS.len()],
}

impl ThresholdModel {
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
        let arithmetic = Arithmetic::new(params);
        Ok(Self {
            cosine: OperandRegister::clamped(params.cosine_format(), 0, arithmetic.one),
            exponent: OperandRegister::new(params.exponent_format()),
            colours: [OperandRegister::new(params.colour_format()); 3],
            scaled_width: params.intensity_fraction + 1,
            arithmetic,
            handshake: Handshake::default(),
            scaled: 0,
            intensity: 0,
            inputs: INPUTS.map(String::from).to_vec(),
            signals: SIGNALS.map(String::from).to_vec(),
            values: [0; SIGNALS.len()],
        })
    }

    /// What the word in force does to the datapath; what follows it.
    fn execute(&mut self) -> After {
        let (cosine, exponent) = (self.cosine.value, self.exponent.value);
        match self.handshake.word {
            1 => self.scaled = self.arithmetic.scaled(cosine, exponent),
            2 => self.intensity = self.arithmetic.gated(cosine, exponent, self.scaled),
            RESULT => return After::End,
            // Word 0 does nothing, running or idle.
            _ => {}
        }
        After::Next
    }

    fn refresh(&mut self) {
        let Handshake { run, word } = self.handshake;
        let result = word == RESULT;
        let [red, green, blue] = self.colours.map(|it| it.value);
        let out = |colour| self.arithmetic.colour(self.intensity, colour) as u64;
        self.values = [
            u64::from(result),
            u64::from(run),
            u64::from(run && result),
            out(red),
            out(green),
            out(blue),
            u64::from(run),
            u64::from(word),
            self.cosine.value as u64,
            self.exponent.value as u64,
            red as u64,
            green as u64,
            blue as u64,
            bits(self.scaled, self.scaled_width),
            self.intensity as u64,
        ];
    }
}

impl Model for ThresholdModel {
    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn signals(&self) -> &[String] {
        &self.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let run = self.handshake.run;
        let after = self.execute();
        self.cosine.clock(run, inputs[3], inputs[2]);
        self.exponent.clock(run, inputs[5], inputs[4]);
        for (register, pair) in self.colours.iter_mut().zip(inputs[6..].chunks_exact(2)) {
            register.clock(run, pair[1], pair[0]);
        }
        self.handshake.clock(inputs[0] & 1 == 1, inputs[1] & 1 == 1, after);
        self.refresh();
    }

    fn values(&self) -> &[u64] {
        &self.values
    }
}

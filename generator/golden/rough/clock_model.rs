//! `rough` clock by clock.

use std::array;
use std::sync::Arc;

use super::{Arithmetic, Params};
use crate::base::fixed::Format;
use crate::config::Config;
use crate::golden::Model;
use crate::golden::handshake::{After, Handshake, OperandRegister, bits};

const INPUTS: [&str; 16] = [
    "rst_n",
    "start",
    "cos_gamma",
    "cos_gamma_write",
    "cos_dgamma",
    "cos_dgamma_write",
    "exponent",
    "exponent_write",
    "dgamma_negative",
    "dgamma_negative_write",
    "red",
    "red_write",
    "green",
    "green_write",
    "blue",
    "blue_write",
];

const SIGNALS: [&str; 19] = [
    "valid",
    "busy",
    "done",
    "red_out",
    "green_out",
    "blue_out",
    "run",
    "word_address",
    "cos_gamma_reg",
    "cos_dgamma_reg",
    "exponent_reg",
    "dgamma_negative_reg",
    "red_reg",
    "green_reg",
    "blue_reg",
    "reg19_sin_gamma",
    "reg11_cos_cos",
    "reg12_sin_sin",
    "reg13_result",
];

/// The word that shows the result, and the last one.
const VALID: u32 = 8;
const END: u32 = 9;

/// The device, clock by clock.
#[derive(Clone, Debug)]
pub struct RoughModel {
    arithmetic: Arc<Arithmetic>,
    synchronous: bool,
    result_width: u32,
    handshake: Handshake,
    /// 1, 2, 3 and 4: cos γ, cos dγ, n, the sign of dγ; 5, 6 and 7: the colours.
    operands: [OperandRegister; 7],
    /// The operand whose sine a synchronous ROM 18 shows; none before the first clock.
    looked_up: Option<i64>,
    reg19_sin_gamma: i64,
    reg11_cos_cos: i64,
    reg12_sin_sin: i64,
    reg13_result: i64,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: [u64; SIGNALS.len()],
}

impl RoughModel {
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
        let largest = params.largest_cosine();
        let colour = OperandRegister::new(params.colour_format());
        Ok(Self {
            arithmetic: Arc::new(Arithmetic::new(params)?),
            synchronous: params.sine_synchronous,
            result_width: params.result_format().width(),
            handshake: Handshake::default(),
            operands: [
                OperandRegister::clamped(params.cos_gamma_format(), 0, largest),
                OperandRegister::clamped(params.cos_dgamma_format(), 0, largest),
                OperandRegister::new(params.exponent_format()),
                OperandRegister::new(Format::BIT),
                colour,
                colour,
                colour,
            ],
            looked_up: None,
            reg19_sin_gamma: 0,
            reg11_cos_cos: 0,
            reg12_sin_sin: 0,
            reg13_result: 0,
            inputs: INPUTS.map(String::from).to_vec(),
            signals: SIGNALS.map(String::from).to_vec(),
            values: [0; SIGNALS.len()],
        })
    }

    fn operand_values(&self) -> [i64; 7] {
        array::from_fn(|at| self.operands[at].value)
    }

    /// The output of ROM 18, addressed by `operand` now.
    fn sine(&self, operand: i64) -> i64 {
        if self.synchronous {
            // All zeros at power-up.
            self.looked_up.map_or(0, |earlier| self.arithmetic.sine.at(earlier))
        } else {
            self.arithmetic.sine.at(operand)
        }
    }

    /// What the word in force does to the datapath. Each odd word captures what the word before it
    /// let settle.
    fn execute(&mut self) {
        let [cos_gamma, cos_dgamma, exponent, dgamma_negative, ..] = self.operand_values();
        // Mux 17 addresses ROM 18 with register 2 from word 2 to the result, and else with register 1.
        let addressed =
            if (2..=VALID).contains(&self.handshake.word) { cos_dgamma } else { cos_gamma };
        match self.handshake.word {
            // Register 19 takes sin γ, register 11 cos γ·cos dγ.
            1 => {
                self.reg19_sin_gamma = self.sine(addressed);
                self.reg11_cos_cos = self.arithmetic.cos_cos(cos_gamma, cos_dgamma);
            }
            // Register 12 takes sin dγ·sin γ.
            3 => {
                self.reg12_sin_sin =
                    self.arithmetic.sin_sin(self.sine(addressed), self.reg19_sin_gamma)
            }
            // Register 13 takes n/2·(cos(γ ± dγ) − 1).
            5 => {
                let adder_15 = self.arithmetic.adder_15(
                    self.reg11_cos_cos,
                    self.reg12_sin_sin,
                    dgamma_negative,
                );
                self.reg13_result = self.arithmetic.scaled(adder_15, exponent, cos_gamma);
            }
            // Register 13 takes the square of itself plus 1.0.
            7 => self.reg13_result = self.arithmetic.squared(self.reg13_result, cos_gamma),
            _ => {}
        }
        self.looked_up = Some(addressed);
    }

    fn refresh(&mut self) {
        let Handshake { run, word } = self.handshake;
        let [cos_gamma, cos_dgamma, exponent, dgamma_negative, red, green, blue] =
            self.operand_values();
        let f = self.arithmetic.f(self.reg13_result);
        let out = |colour| self.arithmetic.colour(f, colour) as u64;
        self.values = [
            u64::from(word == VALID),
            u64::from(run),
            u64::from(run && word == END),
            out(red),
            out(green),
            out(blue),
            u64::from(run),
            u64::from(word),
            cos_gamma as u64,
            cos_dgamma as u64,
            exponent as u64,
            dgamma_negative as u64,
            red as u64,
            green as u64,
            blue as u64,
            self.reg19_sin_gamma as u64,
            self.reg11_cos_cos as u64,
            self.reg12_sin_sin as u64,
            bits(self.reg13_result, self.result_width),
        ];
    }
}

impl Model for RoughModel {
    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn signals(&self) -> &[String] {
        &self.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let run = self.handshake.run;
        self.execute();
        for (register, pair) in self.operands.iter_mut().zip(inputs[2..].chunks_exact(2)) {
            register.clock(run, pair[1], pair[0]);
        }
        let after = if self.handshake.word == END { After::End } else { After::Next };
        self.handshake.clock(inputs[0] & 1 == 1, inputs[1] & 1 == 1, after);
        self.refresh();
    }

    fn values(&self) -> &[u64] {
        &self.values
    }
}

//! `blinn` and `gauss` clock by clock.

use super::{Arithmetic, Params};
use crate::golden::Model;
use crate::golden::handshake::{After, Handshake, OperandRegister};

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

const SIGNALS: [&str; 17] = [
    "valid",
    "busy",
    "done",
    "red_out",
    "green_out",
    "blue_out",
    "f_out",
    "run",
    "word_address",
    "cos_gamma_reg",
    "exponent_reg",
    "red_reg",
    "green_reg",
    "blue_reg",
    "decay",
    "halvings",
    "reflectance",
];

/// The word in which the result stands, and in which the program ends.
const RESULT: u32 = 5;

/// The device, clock by clock.
#[derive(Clone, Debug)]
pub struct DecayModel {
    arithmetic: Arithmetic,
    handshake: Handshake,
    cosine: OperandRegister,
    exponent: OperandRegister,
    colours: [OperandRegister; 3],
    decay: i64,
    halvings: i64,
    reflectance: i64,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: [u64; SIGNALS.len()],
}

impl DecayModel {
    /// The device at power-up.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn from_params(params: &Params) -> Result<Self, String> {
        let arithmetic = Arithmetic::new(params)?;
        Ok(Self {
            cosine: OperandRegister::clamped(params.cosine_format(), 0, arithmetic.one),
            exponent: OperandRegister::new(params.exponent_format()),
            colours: [OperandRegister::new(params.colour_format()); 3],
            arithmetic,
            handshake: Handshake::default(),
            decay: 0,
            halvings: 0,
            reflectance: 0,
            inputs: INPUTS.map(String::from).to_vec(),
            signals: SIGNALS.map(String::from).to_vec(),
            values: [0; SIGNALS.len()],
        })
    }

    /// What the word in force does to the datapath; what follows it.
    ///
    /// Synchronous tables are addressed by registers that the word before did not change, so that they show
    /// the same as others would.
    fn execute(&mut self) -> After {
        let (cosine, exponent) = (self.cosine.value, self.exponent.value);
        match self.handshake.word {
            1 => self.decay = self.arithmetic.decay(cosine),
            2 => self.halvings = self.arithmetic.halvings(cosine, self.decay, exponent),
            4 => self.reflectance = self.arithmetic.reflectance(cosine, self.halvings),
            RESULT => return After::End,
            // Words 0 and 3 leave the tables a clock.
            _ => {}
        }
        After::Next
    }

    fn refresh(&mut self) {
        let Handshake { run, word } = self.handshake;
        let result = word == RESULT;
        let [red, green, blue] = self.colours.map(|it| it.value);
        let out = |colour| self.arithmetic.colour(self.reflectance, colour) as u64;
        self.values = [
            u64::from(result),
            u64::from(run),
            u64::from(run && result),
            out(red),
            out(green),
            out(blue),
            self.reflectance as u64,
            u64::from(run),
            u64::from(word),
            self.cosine.value as u64,
            self.exponent.value as u64,
            red as u64,
            green as u64,
            blue as u64,
            self.decay as u64,
            self.halvings as u64,
            self.reflectance as u64,
        ];
    }
}

impl Model for DecayModel {
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

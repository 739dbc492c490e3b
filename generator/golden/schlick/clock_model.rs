//! `schlick` clock by clock.

use super::{Arithmetic, Params};
use crate::base::fixed::mask;
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

const SIGNALS: [&str; 17] = [
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
    "quotient",
    "quotient_divisor",
    "quotient_remainder",
    "quotient_remaining",
];

/// The word in which the result stands, and in which the program ends.
const RESULT: u32 = 3;

/// The device, clock by clock.
///
/// The divider's registers are told from the division as a whole: after so many bits the quotient ends
/// in that many bits of the true one, and the remainder is what they leave.
#[derive(Clone, Debug)]
pub struct SchlickModel {
    arithmetic: Arithmetic,
    handshake: Handshake,
    cosine: OperandRegister,
    exponent: OperandRegister,
    colours: [OperandRegister; 3],
    division: Division,
    quotient: i64,
    remainder: i64,
    remaining: i64,
    remaining_bits: u32,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: [u64; SIGNALS.len()],
}

/// A division under way.
#[derive(Clone, Copy, Debug, Default)]
struct Division {
    dividend: i64,
    divisor: i64,
    /// Bits found.
    bits: u32,
    /// What the quotient's register held before.
    before: i64,
}

impl SchlickModel {
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
            remaining_bits: (arithmetic.quotient_bits - 1).ilog2() + 1,
            arithmetic,
            handshake: Handshake::default(),
            division: Division::default(),
            quotient: 0,
            remainder: 0,
            remaining: 0,
            inputs: INPUTS.map(String::from).to_vec(),
            signals: SIGNALS.map(String::from).to_vec(),
            values: [0; SIGNALS.len()],
        })
    }

    /// What the word in force does to the datapath; what follows it.
    fn execute(&mut self) -> After {
        match self.handshake.word {
            // The divider takes cos γ and n − n·cos γ + cos γ.
            1 => {
                let cosine = self.cosine.value;
                self.division = Division {
                    dividend: cosine,
                    divisor: self.arithmetic.divisor(cosine, self.exponent.value),
                    bits: 0,
                    before: self.quotient,
                };
                self.remainder = cosine;
                self.remaining = i64::from(self.arithmetic.quotient_bits) - 1;
                After::Next
            }
            // It finds a bit of the quotient, as often as the quotient has bits.
            2 => {
                let it = &mut self.division;
                it.bits += 1;
                let (quotient, remainder) = Arithmetic::divide(it.dividend, it.divisor, it.bits);
                let shifted = (it.before << it.bits | quotient) as u64;
                self.quotient = (shifted & mask(self.arithmetic.quotient_bits)) as i64;
                self.remainder = remainder;
                let again = self.remaining != 0;
                self.remaining = bits(self.remaining - 1, self.remaining_bits) as i64;
                if again { After::Again } else { After::Next }
            }
            RESULT => After::End,
            // Word 0 does nothing, running or idle.
            _ => After::Next,
        }
    }

    fn refresh(&mut self) {
        let Handshake { run, word } = self.handshake;
        let result = word == RESULT;
        let [red, green, blue] = self.colours.map(|it| it.value);
        let out = |colour| self.arithmetic.colour(self.quotient, colour) as u64;
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
            self.quotient as u64,
            self.division.divisor as u64,
            self.remainder as u64,
            self.remaining as u64,
        ];
    }
}

impl Model for SchlickModel {
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

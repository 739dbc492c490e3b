//! `lyon` clock by clock.

use super::{Arithmetic, Params, Scale};
use crate::config::Config;
use crate::golden::Model;
use crate::golden::handshake::{After, Handshake, OperandRegister, bits};

/// What a word does to the datapath.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    Idle,
    /// D² goes into its register; with a shift, the counter takes the operand.
    Distance,
    /// β·D²: the product, or one place of the shift register.
    Scale,
    /// The accumulator takes the square of the base.
    Base,
    /// It takes its own square.
    Square,
    Result,
}

/// The device, clock by clock.
#[derive(Clone, Debug)]
pub struct LyonModel {
    arithmetic: Arithmetic,
    words: Vec<Word>,
    handshake: Handshake,
    vector: [OperandRegister; 3],
    vector_width: u32,
    /// `shift` or `exponent`.
    scale: OperandRegister,
    colours: [OperandRegister; 3],
    /// D², where a multiplier scales it; otherwise the shift register.
    distance: i64,
    /// β·D² behind the multiplier.
    scaled: i64,
    accumulator: i64,
    remaining: i64,
    remaining_width: u32,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: Vec<u64>,
}

impl LyonModel {
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
        let squarings = arithmetic.squarings;
        let shift = params.scale == Scale::Shift;
        let operand = if shift { "shift" } else { "exponent" };
        let operands = ["dx", "dy", "dz", operand, "red", "green", "blue"];
        let mut inputs = vec!["rst_n".to_string(), "start".to_string()];
        for name in operands {
            inputs.extend([name.to_string(), format!("{name}_write")]);
        }
        let outputs = ["valid", "busy", "done", "red_out", "green_out", "blue_out"];
        let mut signals: Vec<String> = outputs.map(String::from).to_vec();
        signals.extend(["run", "word_address", "accumulator"].map(String::from));
        signals.extend(operands.map(|name| format!("{name}_reg")));
        signals.extend(if shift {
            vec!["shift_register".to_string()]
        } else {
            vec!["distance".to_string(), "scaled".to_string()]
        });
        // The counter counts squarings after the first, and shifts.
        if shift || squarings > 1 {
            signals.push("remaining".to_string());
        }
        let mut words = vec![Word::Idle, Word::Distance, Word::Scale, Word::Base];
        if squarings > 1 {
            words.push(Word::Square);
        }
        words.push(Word::Result);
        let scale_width = params.scale_format().width();
        Ok(Self {
            remaining_width: match (shift, squarings) {
                (false, _) => 2,
                (true, 3..) => scale_width.max(2),
                (true, _) => scale_width,
            },
            vector: [OperandRegister::new(params.vector_format()); 3],
            vector_width: params.vector_format().width(),
            scale: OperandRegister::new(params.scale_format()),
            colours: [OperandRegister::new(params.colour_format()); 3],
            arithmetic,
            words,
            handshake: Handshake::default(),
            distance: 0,
            scaled: 0,
            accumulator: 0,
            remaining: 0,
            inputs,
            values: vec![0; signals.len()],
            signals,
        })
    }

    fn word(&self) -> Word {
        self.words[self.handshake.word as usize]
    }

    fn count_down(&mut self) {
        self.remaining = bits(self.remaining - 1, self.remaining_width) as i64;
    }

    /// What the word in force does to the datapath; what follows it.
    fn execute(&mut self) -> After {
        let it = &self.arithmetic;
        let shift = it.scale == Scale::Shift;
        match self.word() {
            Word::Idle => After::Next,
            Word::Distance => {
                self.distance = it.distance(self.vector.map(|component| component.value));
                if shift {
                    self.remaining = self.scale.value;
                }
                After::Next
            }
            Word::Scale if shift => {
                let again = self.remaining > 0;
                self.distance = it.shifted(self.distance);
                self.count_down();
                if again { After::Again } else { After::Next }
            }
            Word::Scale => {
                self.scaled = it.scaled(self.distance * self.scale.value);
                After::Next
            }
            Word::Base => {
                let scaled = if shift { it.scaled(self.distance) } else { self.scaled };
                self.accumulator = it.square(it.base(scaled));
                if it.squarings > 1 {
                    self.remaining = i64::from(it.squarings) - 1;
                }
                After::Next
            }
            Word::Square => {
                let again = self.remaining > 1;
                self.accumulator = it.square(self.accumulator);
                self.count_down();
                if again { After::Again } else { After::Next }
            }
            Word::Result => After::End,
        }
    }

    fn refresh(&mut self) {
        let Handshake { run, word } = self.handshake;
        let result = self.word() == Word::Result;
        let colours = self.colours.map(|it| it.value);
        let outputs = colours.map(|colour| self.arithmetic.colour(self.accumulator, colour) as u64);
        self.values.clear();
        let values = &mut self.values;
        values.extend([u64::from(result), u64::from(run), u64::from(run && result)]);
        values.extend(outputs);
        values.extend([u64::from(run), u64::from(word), self.accumulator as u64]);
        values.extend(self.vector.map(|it| bits(it.value, self.vector_width)));
        values.push(self.scale.value as u64);
        values.extend(colours.map(|colour| colour as u64));
        values.push(self.distance as u64);
        if self.arithmetic.scale == Scale::Multiplier {
            values.push(self.scaled as u64);
        }
        values.push(self.remaining as u64);
        // Without a counter there is nothing to show of it.
        values.truncate(self.signals.len());
    }
}

impl Model for LyonModel {
    fn inputs(&self) -> &[String] {
        &self.inputs
    }

    fn signals(&self) -> &[String] {
        &self.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let run = self.handshake.run;
        let after = self.execute();
        let registers = self.vector.iter_mut().chain([&mut self.scale]).chain(&mut self.colours);
        for (register, pair) in registers.zip(inputs[2..].chunks_exact(2)) {
            register.clock(run, pair[1], pair[0]);
        }
        self.handshake.clock(inputs[0] & 1 == 1, inputs[1] & 1 == 1, after);
        self.refresh();
    }

    fn values(&self) -> &[u64] {
        &self.values
    }
}

//! `cosine-power`: the paper's W(n, γ) = (n/m·(cos γ − 1) + 1)^m (seed 002), by formula.

use super::contract;
use super::handshake::{After, Handshake, OperandRegister, bits};
use super::narrow::{Narrow, rounding_error};
use super::{Bound, Contract, Model, Operand};
use crate::fixed::{Format, Rounding, exp2};
use crate::reference;

/// What a configuration of the device says.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// `power`: m, a power of two, 2 … 16.
    pub power: u32,
    /// `cosine.fraction`: fraction bits of cos γ, C.
    pub cosine_fraction: u32,
    /// `cosine.signed`: cos γ may be negative, and is then taken as 0.
    pub cosine_signed: bool,
    /// `exponent.bits`: bits of n.
    pub exponent_bits: u32,
    /// `colour.bits`: bits of a colour operand and of a colour output, K.
    pub colour_bits: u32,
    /// `intensity.fraction`: fraction bits of the accumulator, F.
    pub intensity_fraction: u32,
    /// `intensity.rounding`: of everything that the accumulator takes.
    pub intensity_rounding: Rounding,
    /// `output.rounding`: of the colour outputs.
    pub output_rounding: Rounding,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    pub exponents: (i64, i64),
}

impl Default for Params {
    /// Proven below one unit with 16-bit squarings, which are one DSP block everywhere.
    fn default() -> Self {
        Self {
            power: 16,
            cosine_fraction: 20,
            cosine_signed: false,
            exponent_bits: 10,
            colour_bits: 8,
            intensity_fraction: 16,
            intensity_rounding: Rounding::Truncate,
            output_rounding: Rounding::Nearest,
            exponents: (1, 1000),
        }
    }
}

impl Params {
    /// Whether the model's 64-bit arithmetic holds every intermediate value.
    ///
    /// # Errors
    /// Names the configuration key that is out of its range.
    pub fn check(&self) -> Result<(), String> {
        let in_range = |key: &str, value: u32, most: u32| match value {
            v if (1..=most).contains(&v) => Ok(()),
            v => Err(format!("{key} is {v}; 1 to {most} are possible")),
        };
        if !matches!(self.power, 2 | 4 | 8 | 16) {
            return Err(format!(
                "power is {}; 2, 4, 8 or 16 are possible",
                self.power
            ));
        }
        in_range("cosine.fraction", self.cosine_fraction, 30)?;
        in_range("exponent.bits", self.exponent_bits, 16)?;
        in_range("colour.bits", self.colour_bits, 16)?;
        in_range("intensity.fraction", self.intensity_fraction, 30)
    }

    fn one(&self) -> i64 {
        1 << self.cosine_fraction
    }

    fn cosine_format(&self) -> Format {
        Format {
            signed: self.cosine_signed,
            int: 1,
            frac: self.cosine_fraction as i32,
        }
    }

    fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone, Debug)]
struct Arithmetic {
    one: i64,
    /// 1.0 − ulp of the accumulator.
    largest: i64,
    scaled: Narrow,
    square: Narrow,
    output: Narrow,
    squarings: u32,
}

impl Arithmetic {
    fn new(params: &Params) -> Self {
        let f = params.intensity_fraction;
        let accumulator = Format::unsigned(0, f as i32);
        let squarings = params.power.ilog2();
        let narrow = |frac| Narrow::new(frac, accumulator, params.intensity_rounding);
        Self {
            one: params.one(),
            largest: (1 << f) - 1,
            // n/m has log₂ m fraction bits: the same integer n, read elsewhere.
            scaled: narrow(params.cosine_fraction + squarings),
            square: narrow(2 * f),
            output: Narrow::new(f, params.colour_format(), params.output_rounding),
            squarings,
        }
    }

    /// Word 1: `n/m·(1 − cos γ)`, saturated.
    #[inline]
    fn scaled(&self, cosine: i64, exponent: i64) -> i64 {
        self.scaled.apply((self.one - cosine) * exponent)
    }

    /// The inverse of the accumulator, `1.0 − ulp − accumulator`; 0 for a surface that faces away.
    #[inline]
    fn base(&self, cosine: i64, accumulator: i64) -> i64 {
        if cosine == 0 {
            0
        } else {
            self.largest - accumulator
        }
    }

    #[inline]
    fn square(&self, x: i64) -> i64 {
        self.square.apply(x * x)
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.output.apply(f * colour)
    }
}

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
    "accumulator",
    "remaining",
];

/// The device, clock by clock.
#[derive(Clone, Debug)]
pub struct ClockModel {
    arithmetic: Arithmetic,
    handshake: Handshake,
    cosine: OperandRegister,
    exponent: OperandRegister,
    colours: [OperandRegister; 3],
    accumulator: i64,
    remaining: i64,
    inputs: Vec<String>,
    signals: Vec<String>,
    values: [u64; SIGNALS.len()],
}

impl ClockModel {
    /// The device at power-up.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn new(params: &Params) -> Result<Self, String> {
        params.check()?;
        let arithmetic = Arithmetic::new(params);
        // A single squaring needs no count of the squarings that remain.
        let signals = SIGNALS.len() - usize::from(arithmetic.squarings == 1);
        Ok(Self {
            cosine: OperandRegister::clamped(params.cosine_format(), 0, arithmetic.one),
            exponent: OperandRegister::new(params.exponent_format()),
            colours: [OperandRegister::new(params.colour_format()); 3],
            arithmetic,
            handshake: Handshake::default(),
            accumulator: 0,
            remaining: 0,
            inputs: INPUTS.map(String::from).to_vec(),
            signals: SIGNALS[..signals]
                .iter()
                .map(|&name| name.to_string())
                .collect(),
            values: [0; SIGNALS.len()],
        })
    }

    /// The word in which the result stands, and in which the program ends.
    fn result(&self) -> u32 {
        if self.arithmetic.squarings == 1 { 3 } else { 4 }
    }

    /// What the word in force does to the datapath; what follows it.
    fn execute(&mut self) -> After {
        let cosine = self.cosine.value;
        match self.handshake.word {
            word if word == self.result() => After::End,
            // The accumulator takes n/m·(1 − cos γ).
            1 => {
                self.accumulator = self.arithmetic.scaled(cosine, self.exponent.value);
                self.remaining = i64::from(self.arithmetic.squarings) - 1;
                After::Next
            }
            // It takes the square of its inverse …
            2 => {
                let base = self.arithmetic.base(cosine, self.accumulator);
                self.accumulator = self.arithmetic.square(base);
                After::Next
            }
            // … and then its own square, until log₂ m squarings are done.
            3 => {
                let again = self.remaining > 1;
                self.accumulator = self.arithmetic.square(self.accumulator);
                self.remaining = (self.remaining - 1) & 3;
                if again { After::Again } else { After::Next }
            }
            // Word 0 does nothing, running or idle.
            _ => After::Next,
        }
    }

    fn refresh(&mut self) {
        let Handshake { run, word } = self.handshake;
        let result = word == self.result();
        let [red, green, blue] = self.colours.map(|it| it.value);
        let out = |colour| self.arithmetic.colour(self.accumulator, colour) as u64;
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
            self.accumulator as u64,
            bits(self.remaining, 2),
        ];
    }
}

impl Model for ClockModel {
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
        self.handshake
            .clock(inputs[0] & 1 == 1, inputs[1] & 1 == 1, after);
        self.refresh();
    }

    fn values(&self) -> &[u64] {
        &self.values[..self.signals.len()]
    }
}

/// The accuracy contract. Control operands: `cos_gamma`, `exponent`.
#[derive(Clone, Debug)]
pub struct Accuracy {
    params: Params,
    arithmetic: Arithmetic,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl Accuracy {
    /// The contract of a configuration.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn new(params: &Params) -> Result<Self, String> {
        params.check()?;
        let one = params.one();
        let lowest = if params.cosine_signed { -one } else { 0 };
        let mut operands = vec![
            Operand {
                name: "cos_gamma".to_string(),
                format: params.cosine_format(),
                domain: (lowest, one),
                colour: false,
                doc: "cosine of the angle between the normal and the half vector".to_string(),
            },
            Operand {
                name: "exponent".to_string(),
                format: params.exponent_format(),
                domain: params.exponents,
                colour: false,
                doc: "specular exponent n".to_string(),
            },
        ];
        operands.extend(contract::colour_operands(params.colour_format()));
        Ok(Self {
            arithmetic: Arithmetic::new(params),
            params: params.clone(),
            operands,
            outputs: contract::colour_outputs(),
        })
    }
}

impl Contract for Accuracy {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[String] {
        &self.outputs
    }

    fn f_format(&self) -> Format {
        Format::unsigned(0, self.params.intensity_fraction as i32)
    }

    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let it = &self.arithmetic;
        let cosine = control[0].clamp(0, it.one);
        let base = it.base(cosine, it.scaled(cosine, control[1]));
        (0..it.squarings).fold(base, |power, _| it.square(power))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = control[0].clamp(0, self.arithmetic.one) as f64;
        let cosine = cosine * exp2(-(self.params.cosine_fraction as i32));
        reference::cosine_power(cosine, control[1] as f64, self.params.power)
    }

    /// Every quantity here lies in 0 … 1, hardware's and formula's alike, so by the mean value
    /// theorem an error ε before a power p grows to at most p·ε.
    ///
    /// - Base: the inverse stands for 1.0 − ulp − t where 1.0 − t is meant. With t rounded by an error
    ///   in (−ulp, 0] (truncated) the base is low by (0, ulp]; by ±ulp/2 (nearest), low by up to
    ///   3/2 ulp. Saturation of t at 1.0 − ulp makes the base 0 where the formula has at most as much.
    ///   The base is raised to m.
    /// - The result of squaring number i is rounded, and then raised to m/2^i: m − 1 in sum.
    /// - The output adds its own rounding; it cannot exceed the largest colour, for f < 1.
    fn bound(&self) -> Bound {
        let params = &self.params;
        let (f, power) = (params.intensity_fraction, f64::from(params.power));
        let ulp = exp2(-(f as i32));
        let scaled_fraction = params.cosine_fraction + params.power.ilog2();
        let scaled = rounding_error(scaled_fraction, f, params.intensity_rounding);
        let base = match params.intensity_rounding {
            // Truncation is upward in 1.0 − ulp − t, and so works against the missing ulp.
            Rounding::Truncate => ulp,
            Rounding::Nearest => ulp + scaled,
        };
        let squares = rounding_error(2 * f, f, params.intensity_rounding);
        let shares = [
            (
                "intensity.fraction",
                "the base, with the inverse for 1.0 − t",
                base * power,
            ),
            (
                "intensity.rounding",
                "rounding of the squares",
                squares * (power - 1.0),
            ),
        ];
        contract::bound(&shares, f, params.colour_bits, params.output_rounding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C = 4, F = 4, m = 4, small enough to follow by hand.
    fn small(power: u32) -> Params {
        Params {
            power,
            cosine_fraction: 4,
            exponent_bits: 4,
            colour_bits: 4,
            intensity_fraction: 4,
            exponents: (1, 15),
            ..Params::default()
        }
    }

    #[test]
    fn f_by_hand() {
        let f =
            |power, cosine, exponent| Accuracy::new(&small(power)).unwrap().f(&[cosine, exponent]);
        // c = 15/16, n = 6, m = 4: t = 1/16·6/4 = 1.5/16 → 1/16; base 15 − 1 = 14; 14² = 196/256 →
        // 12/16; 144/256 → 9/16.
        assert_eq!(f(4, 15, 6), 9);
        // One squaring with m = 2: t = 3/16, base 12, 144/256 → 9/16.
        assert_eq!(f(2, 15, 6), 9);
        // m = 16, n = 6: t = 6/256 → 0; 15 → 225/256 → 14 → 12 → 9 → 5.
        assert_eq!(f(16, 15, 6), 5);
        // Beyond the zero, at 1.0, at 0 and beyond the operand's range.
        assert_eq!(f(4, 8, 15), 0);
        assert_eq!(f(2, 16, 15), 14);
        assert_eq!(f(2, 31, 15), 14);
        assert_eq!(f(2, 0, 1), 0);
    }

    /// One point with m = 8 followed clock by clock: words 0, 1, 2, 3, 3, 4 and idle.
    #[test]
    fn a_point_clock_by_clock() {
        let mut model = ClockModel::new(&small(8)).unwrap();
        let value = |model: &ClockModel, name: &str| {
            model.values()[model.signals().iter().position(|it| it == name).unwrap()]
        };
        // c = 14/16, n = 12, red 15, written together with start: t = 2/16·12/8 = 3/16; base 12.
        model.clock(&[1, 1, 14, 1, 12, 1, 15, 1, 0, 0, 0, 0]);
        let mut seen = Vec::new();
        for _ in 0..6 {
            seen.push(
                [
                    "run",
                    "word_address",
                    "accumulator",
                    "remaining",
                    "valid",
                    "done",
                ]
                .map(|name| value(&model, name)),
            );
            // Writes while busy change nothing.
            model.clock(&[1, 0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
        }
        let expected = [
            [1, 0, 0, 0, 0, 0],
            [1, 1, 0, 0, 0, 0],
            [1, 2, 3, 2, 0, 0],
            // 144/256 → 9, 81/256 → 5, 25/256 → 1.
            [1, 3, 9, 2, 0, 0],
            [1, 3, 5, 1, 0, 0],
            [1, 4, 1, 0, 1, 1],
        ];
        assert_eq!(seen, expected);
        assert_eq!(
            ["run", "word_address", "valid", "done", "accumulator"].map(|name| value(&model, name)),
            [0, 0, 0, 0, 1]
        );
        // red: 15/16 → 1, to the nearest.
        assert_eq!(value(&model, "red_out"), 1);
        assert_eq!(value(&model, "cos_gamma_reg"), 14);
    }

    #[test]
    fn the_default_is_proven() {
        let bound = Accuracy::new(&Params::default()).unwrap().bound();
        // (16 + 15) ulps of 2⁻¹⁶ times 255, and half a unit.
        assert_eq!(bound.units, 31.0 * 255.0 / 65536.0 + 0.5);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let refused = |params: Params| Accuracy::new(&params).unwrap_err();
        assert!(
            refused(Params {
                power: 3,
                ..small(4)
            })
            .contains("power")
        );
        assert!(
            refused(Params {
                intensity_fraction: 0,
                ..small(4)
            })
            .contains("intensity.fraction")
        );
    }
}

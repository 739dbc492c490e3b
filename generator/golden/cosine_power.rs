//! The golden model and the accuracy contract of the device `cosine-power`, which computes f = (n/m·(c − 1) + 1)^m
//! ([symbols](crate#symbols)).
//!
//! The configuration chooses m = 2, 4, 8 or 16. f is 0 if the base is negative, or if c ≤ 0. Seed 002 calls the function W(n,
//! γ) and proposes it as an approximation of cⁿ.

use std::sync::Arc;

use super::contract::{self, ErrorShare};
use super::frame::{Frame, idle, step_by};
use super::highlight::{self, Highlight, Reflectance, Variation};
use super::narrow::{Narrow, rounding_error};
use super::{Contract, Model};
use crate::formulas;
use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::Config;
use glint_keys::cosine_power::Keys;

/// The integer arithmetic of the device, on raw values. The accumulator register contains f after the last squaring.
struct PowerArithmetic {
    keys: Keys,
    squarings: u32,
    /// 1.0 minus one ulp, the largest raw value of the accumulator.
    largest: i64,
    scaled: Narrow,
    square: Narrow,
}

impl PowerArithmetic {
    fn new(keys: Keys) -> Self {
        let (f, squarings) = (keys.f.fraction, keys.power.ilog2());
        let narrow = |frac| Narrow::new(frac, keys.f.format(), keys.f.rounding);
        Self {
            largest: (1 << f) - 1,
            // n/m is the integer n, read with log₂ m fraction bits.
            scaled: narrow(keys.operands.cosine.fraction + squarings),
            square: narrow(2 * f),
            keys,
            squarings,
        }
    }

    /// Returns `n/m·(1 − cos γ)`, rounded, and limited to the accumulator's format.
    #[inline]
    fn scaled(&self, cosine: i64, exponent: i64) -> i64 {
        self.scaled.apply((self.keys.operands.cosine.one() - cosine) * exponent)
    }

    /// Returns the base: the bitwise inverse of `accumulator`, which is `1.0 − ulp − accumulator`. The base is 0 if `cosine` is
    /// 0, because the surface then faces away.
    #[inline]
    fn base(&self, cosine: i64, accumulator: i64) -> i64 {
        if cosine == 0 { 0 } else { self.largest - accumulator }
    }

    #[inline]
    fn square(&self, x: i64) -> i64 {
        self.square.apply(x * x)
    }
}

pub fn model(config: &Config) -> Box<dyn Model> {
    let it = Arc::new(PowerArithmetic::new(Keys::of(config)));
    let mut frame = Frame::default();
    let [cosine, exponent] = highlight::slots(&it.keys.operands, &mut frame);
    let accumulator = frame.register("accumulator", it.keys.f.format());
    // A single squaring needs no count of the squarings that remain.
    let counted = it.squarings > 1;
    let count = Format::unsigned(2, 0);
    let remaining = if counted { frame.register("remaining", count) } else { frame.hidden() };
    // The accumulator takes n/m·(1 − cos γ).
    let scale = step_by(&it, move |it, s| {
        s[accumulator] = it.scaled(s[cosine], s[exponent]);
        s[remaining] = i64::from(it.squarings) - 1;
    });
    // The accumulator takes the square of its inverse …
    let base = step_by(&it, move |it, s| {
        s[accumulator] = it.square(it.base(s[cosine], s[accumulator]));
    });
    // … and then its own square, until log₂ m squarings are done.
    let square = step_by(&it, move |it, s| {
        s[accumulator] = it.square(s[accumulator]);
        s[remaining] -= 1;
    })
    .repeat_while(move |s| s[remaining] > 1);
    let mut program = vec![idle(), scale, base];
    program.extend(counted.then_some(square));
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Box::new(products.behind(frame, accumulator, program))
}

/// Returns the accuracy contract, with the control operands `cos_gamma` and `exponent`.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let it = PowerArithmetic::new(Keys::of(config));
    let operands = highlight::operands(&it.keys.operands, &it.keys.domain);
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Box::new(Highlight::new(it, operands, products))
}

impl Reflectance for PowerArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let cosine = self.keys.operands.cosine.clamped(control[0]);
        let base = self.base(cosine, self.scaled(cosine, control[1]));
        (0..self.squarings).fold(base, |power, _| self.square(power))
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = self.keys.operands.cosine.value(control[0]);
        formulas::cosine_power(cosine, control[1] as f64, self.keys.power)
    }

    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        Some(formulas::cosine_power(cosine, exponent as f64, self.keys.power))
    }

    fn expressions(&self) -> Vec<String> {
        let power = self.keys.power;
        let base = format!("exponent / {power} * (cos_gamma - 1) + 1");
        let base = contract::clamped_at_0(&base);
        vec![contract::where_it_faces(&format!("{base} ** {power}"))]
    }

    /// Returns how fast and by which jumps W changes. The largest n is an upper limit of the slope n·base^(m − 1), because the
    /// base is at most 1. If n is below m, W is (1 − n/m)^m at a right angle, and jumps to 0 there. The smallest n has the
    /// largest jump.
    fn variation(&self) -> Option<Variation> {
        let (least, most) = self.keys.domain.exponents();
        let power = f64::from(self.keys.power);
        let base = (1.0 - least as f64 / power).max(0.0);
        Some(Variation { slope: most as f64, jump: libm::pow(base, power) })
    }

    /// Derives the contributions to the error of f. Every quantity here lies in 0 … 1, in the hardware and in the formula. By the
    /// mean value theorem, an error ε before a power p therefore grows to at most p·ε.
    ///
    /// - Base: the hardware uses the inverse, 1.0 − ulp − t, instead of 1.0 − t. If t is truncated, its error is in (−ulp, 0],
    ///   and the base is low by (0, ulp]. If t is rounded to the nearest, its error is ±ulp/2, and the base is low by up to 3/2
    ///   ulp. If t saturates at 1.0 − ulp, the hardware's base is 0, and the formula's base is at most as large as this error.
    ///   The base is raised to m.
    /// - The result of squaring number i is rounded, and then raised to m/2^i. The factors of these errors add up to m − 1.
    /// - The output adds its own rounding. It cannot exceed the largest colour, because f < 1.
    fn shares(&self) -> Vec<ErrorShare> {
        let (f, power) = (self.keys.f.fraction, f64::from(self.keys.power));
        let ulp = exp2(-(f as i32));
        let scaled_fraction = self.keys.operands.cosine.fraction + self.squarings;
        let scaled = rounding_error(scaled_fraction, f, self.keys.f.rounding);
        let base = match self.keys.f.rounding {
            // Truncation is upward in 1.0 − ulp − t, and so works against the missing ulp.
            Rounding::Truncate => ulp,
            Rounding::Nearest => ulp + scaled,
        };
        let squares = rounding_error(2 * f, f, self.keys.f.rounding);
        vec![
            ("intensity.fraction", "the base, with the inverse for 1.0 − t", base * power),
            ("intensity.rounding", "rounding of the squares", squares * (power - 1.0)),
        ]
    }

    /// Returns a warning if, for some n below m, a smaller m approximates cosⁿγ better than the configured m.
    fn remarks(&self) -> Vec<String> {
        let power = self.keys.power;
        let (first, last) = self.keys.domain.exponents();
        let worse: Vec<(i64, f64, u32, f64)> = (first.max(1)..=last.min(i64::from(power) - 1))
            .filter_map(|n| {
                let own = formula_error(n, power);
                let (error, other) = [2, 4, 8, 16]
                    .into_iter()
                    .filter(|&other| other < power)
                    .map(|other| (formula_error(n, other), other))
                    .min_by(|a, b| a.0.total_cmp(&b.0))?;
                (error < own).then_some((n, own, other, error))
            })
            .collect();
        let Some(&(n, own, other, error)) =
            worse.iter().max_by(|a, b| (a.1 - a.3).total_cmp(&(b.1 - b.3)))
        else {
            return Vec::new();
        };
        let exponents: Vec<String> = worse.iter().map(|entry| entry.0.to_string()).collect();
        vec![format!(
            "power = {power} is above some n of the domain: for n = {} a smaller power is closer to cos^n. \
             For example, at n = {n} the error of the formula is {own:.4} with power = {power}, and \
             {error:.4} with power = {other}. Raise domain.exponent_min, or set the smaller power",
            exponents.join(", ")
        )]
    }
}

/// Returns the largest difference between W and cosⁿγ over 512 cosines, spaced evenly from 1/512 to 1.
fn formula_error(n: i64, power: u32) -> f64 {
    const GRID: u32 = 512;
    (1..=GRID)
        .map(|step| {
            let cosine = f64::from(step) / f64::from(GRID);
            let n = n as f64;
            (formulas::cosine_power(cosine, n, power) - formulas::blinn(cosine, n)).abs()
        })
        .fold(0.0, f64::max)
}

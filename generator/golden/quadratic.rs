//! The golden model and the accuracy contract of the device `quadratic`. It computes f = max(0, c + a(n)·(c² − c)), or 0 if c ≤
//! 0 ([symbols](crate#symbols)). The device reads the coefficient a(n) from a table, ROM(n). The source is the patent UA 20998,
//! which seed 001 cites.

pub mod coefficient;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::contract::{self, ErrorShare};
use super::frame::{Frame, idle, step_by};
use super::highlight::{self, Highlight, Reflectance, Variation};
use super::narrow::{Narrow, rounding_error};
use super::{Contract, Model};
use crate::formulas;
use glint_base::fixed::{Format, exp2};
use glint_config::Config;
use glint_keys::quadratic::{Keys, Scheme};

struct QuadraticArithmetic {
    keys: Keys,
    difference: Narrow,
    /// The coefficients a(n) in ROM(n), as exact values and as raw words.
    exact: Vec<f64>,
    words: Vec<i64>,
    /// The numbers of zero bits that are appended to c and to the product, so both have the same number of fraction bits.
    pads: (u32, u32),
    sum: Narrow,
}

impl QuadraticArithmetic {
    fn new(keys: Keys) -> Self {
        let (cosine, fraction) = (keys.operands.cosine.fraction, keys.coefficient_fraction());
        let scale = f64::from(1u32 << fraction);
        let exact = coefficient::table(keys.scheme, 1 << keys.operands.exponent_bits);
        let product = keys.difference_fraction + fraction;
        let point = product.max(cosine);
        let difference = difference_format(keys.difference_fraction);
        Self {
            difference: Narrow::new(2 * cosine, difference, keys.difference_rounding),
            words: exact.iter().map(|a| (a * scale + 0.5).floor() as i64).collect(),
            exact,
            pads: (point - cosine, point - product),
            sum: Narrow::new(point, keys.f.format(), keys.f.rounding),
            keys,
        }
    }

    /// Returns `c² − c`, rounded to the register `difference`.
    #[inline]
    fn difference(&self, cosine: i64) -> i64 {
        self.difference.apply(cosine * cosine - (cosine << self.keys.operands.cosine.fraction))
    }

    /// Returns f: `c + a(n)·(c² − c)`, rounded and limited to 0 … 1.0 − ulp.
    #[inline]
    fn intensity(&self, cosine: i64, exponent: i64, difference: i64) -> i64 {
        let product = difference * self.words[exponent as usize];
        self.sum.apply((cosine << self.pads.0) + (product << self.pads.1))
    }
}

fn difference_format(fraction: u32) -> Format {
    Format::signed(-2, fraction as i32)
}

pub fn model(config: &Config) -> Box<dyn Model> {
    let it = Arc::new(QuadraticArithmetic::new(Keys::of(config)));
    let mut frame = Frame::default();
    let [cosine, exponent] = highlight::slots(&it.keys.operands, &mut frame);
    let difference = frame.register("difference", difference_format(it.keys.difference_fraction));
    let intensity = frame.register("intensity", it.keys.f.format());
    let program = vec![
        idle(),
        step_by(&it, move |it, s| s[difference] = it.difference(s[cosine])),
        step_by(&it, move |it, s| {
            s[intensity] = it.intensity(s[cosine], s[exponent], s[difference]);
        }),
    ];
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Box::new(products.behind(frame, intensity, program))
}

/// Returns the accuracy contract, with the control operands `cos_gamma` and `exponent`.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let it = QuadraticArithmetic::new(Keys::of(config));
    let operands = highlight::operands(&it.keys.operands, &it.keys.domain);
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Box::new(Highlight::new(it, operands, products))
}

impl Reflectance for QuadraticArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let cosine = self.keys.operands.cosine.clamped(control[0]);
        self.intensity(cosine, control[1], self.difference(cosine))
    }

    /// Returns the exact f, with a(n) as it was before ROM(n) rounded it.
    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = self.keys.operands.cosine.value(control[0]);
        formulas::quadratic(cosine, self.exact[control[1] as usize])
    }

    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        Some(formulas::quadratic(cosine, self.exact[exponent as usize]))
    }

    /// Returns the largest slope and no jump. The slope is at most 1 + |a| for the largest |a| of the domain, because it is
    /// 1 − a + 2·a·c where the formula is not clamped. At a right angle the formula is 0.
    fn variation(&self) -> Option<Variation> {
        let (least, most) = self.keys.domain.exponents();
        let exact = self.exact[least as usize..=most as usize].iter();
        Some(Variation { slope: 1.0 + exact.fold(0.0, |a: f64, it| a.max(it.abs())), jump: 0.0 })
    }

    /// Returns the formula in Python. With the scheme `minimax` it reads a(n) from the list `coefficient`, because the minimax
    /// coefficient has no closed form.
    fn expressions(&self) -> Vec<String> {
        let coefficient = match self.keys.scheme {
            Scheme::Taylor => "(max(exponent, 1) - 1)",
            Scheme::Minimax => "coefficient[int(exponent)]",
        };
        let f = format!("cos_gamma * (1 - {coefficient} * (1 - cos_gamma))");
        vec![contract::where_it_faces(&contract::clamped_at_0(&f))]
    }

    /// Derives the contributions to the error of f = `c − a·g`, with g = c − c² in 0 … 1/4. If formula and hardware are both
    /// clamped, the error is 0. Otherwise `a·g ≤ c`, which means `1 − c ≤ 1/a`, holds for the exact a or for its word, and g is
    /// at most 1/a.
    ///
    /// - An error of the word a(n) is multiplied by g.
    /// - The rounding of g is multiplied by the word a(n).
    /// - f is rounded, and 1.0 becomes the largest word, which is an ulp less.
    fn shares(&self) -> Vec<ErrorShare> {
        let f = self.keys.f.fraction;
        let scale = exp2(-(self.keys.coefficient_fraction() as i32));
        let (first, last) = self.keys.domain.exponents();
        let (mut rounded, mut largest) = (0.0f64, 0.0f64);
        for n in first as usize..=last as usize {
            let (exact, word) = (self.exact[n], self.words[n] as f64 * scale);
            let reach = (1.0 / exact.min(word).max(4.0)).min(0.25);
            rounded = rounded.max((exact - word).abs() * reach);
            largest = largest.max(word);
        }
        let square_fraction = 2 * self.keys.operands.cosine.fraction;
        let (fraction, rounding) = (self.keys.difference_fraction, self.keys.difference_rounding);
        let difference = rounding_error(square_fraction, fraction, rounding);
        vec![
            ("coefficient.fraction", "rounding of a(n)", rounded),
            ("difference.fraction", "rounding of c² − c, times a(n)", difference * largest),
            ("intensity.fraction", "rounding of f, and 1.0 as the largest word", exp2(-(f as i32))),
        ]
    }

    /// Returns a warning if `minimax` would approximate cⁿ better than `taylor` at the largest n of the domain.
    fn remarks(&self) -> Vec<String> {
        if self.keys.scheme != Scheme::Taylor {
            return Vec::new();
        }
        let n = self.keys.domain.most;
        let best = coefficient::table(Scheme::Minimax, n as u32 + 1);
        let errors = [(n - 1) as f64, best[n as usize]].map(|a| formula_error(n, a));
        if errors[1] >= errors[0] {
            return Vec::new();
        }
        vec![format!(
            "with coefficient.scheme = \"taylor\", the formula differs from cos^n by up to {:.4}, at n = \
             {n}; with \"minimax\", by up to {:.4}",
            errors[0], errors[1]
        )]
    }
}

/// Returns the largest difference between the parabola with the coefficient `a` and cⁿ. It is computed at the zero of the
/// parabola and on a grid of cosines that covers the highlight: 1 − c goes from 0 to 8/n, but at most to 1.
fn formula_error(n: i64, a: f64) -> f64 {
    const GRID: u32 = 2048;
    let n = n as f64;
    let reach = (8.0 / n).min(1.0);
    (0..=GRID)
        .map(|step| 1.0 - reach * f64::from(step) / f64::from(GRID))
        // The parabola's zero, where the error has its corner.
        .chain([1.0 - 1.0 / a.max(1.0)])
        .map(|cosine| (formulas::quadratic(cosine, a) - formulas::blinn(cosine, n)).abs())
        .fold(0.0, f64::max)
}

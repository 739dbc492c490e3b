//! The golden model and the accuracy contract of the device `threshold`. It computes f = (n/2·(c − 1) + 1)², or 0 if the square
//! is below a level ([symbols](crate#symbols)).
//!
//! The level of n is a word of the table ROM(n): a darker highlight is invisible. f is also 0 if the square's base is negative,
//! or if c ≤ 0. The source is the patent UA 30041, which seed 001 cites.

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
use glint_keys::threshold::Keys;

struct ThresholdArithmetic {
    keys: Keys,
    /// The number 1 with the fraction bits of the base.
    base_one: i64,
    scaled: Narrow,
    square: Narrow,
    /// The words of ROM(n), one for each octave of n.
    thresholds: Vec<i64>,
    /// The largest error of the square. If the exact square differs from the level by at most this error, either outcome of the
    /// comparison is right.
    margin: f64,
}

impl ThresholdArithmetic {
    fn new(keys: Keys) -> Self {
        let (f, rounding) = (keys.f.fraction, keys.f.rounding);
        // n/2 has one fraction bit.
        let product_fraction = keys.operands.cosine.fraction + 1;
        let mut it = Self {
            base_one: 1 << f,
            scaled: Narrow::new(product_fraction, Format::signed(0, f as i32), rounding),
            square: Narrow::new(2 * f, keys.f.format(), rounding),
            thresholds: Self::thresholds(&keys),
            margin: 0.0,
            keys,
        };
        it.margin = it.shares().iter().map(|share| share.2).sum::<f64>().min(1.0);
        it
    }

    /// Returns the words of ROM(n), one for each octave of n. A word is the smallest f at which the largest colour reaches `level
    /// / 100` units, and at most 1.0 − ulp. For example, the level 100 gives 258 for colours of 8 bits and an f of 16 fraction
    /// bits.
    fn thresholds(keys: &Keys) -> Vec<i64> {
        // The smallest word with 100 · largest · word ≥ level · 2^F. The right side is less than 2^30 · 2^24, so an `i64` holds
        // it.
        let unit = 100 * ((1 << keys.operands.colours.bits) - 1);
        let largest = (1 << keys.f.fraction) - 1;
        let mut words = Vec::with_capacity(keys.levels.len());
        for &level in &keys.levels {
            let wanted = i64::from(level) << keys.f.fraction;
            let word = wanted / unit + i64::from(wanted % unit != 0);
            words.push(word.min(largest));
        }
        words
    }

    /// Returns `n/2·(cos γ − 1)`, rounded, or −1.0 if the product is less.
    #[inline]
    fn scaled(&self, cosine: i64, exponent: i64) -> i64 {
        self.scaled.apply((cosine - self.keys.operands.cosine.one()) * exponent)
    }

    /// Returns the word of ROM(n) for the octave of `exponent`: the exponents from 2^k to below 2^(k + 1). The exponent 0 counts
    /// as 1. The last word serves all larger octaves.
    #[inline]
    fn threshold(&self, exponent: i64) -> i64 {
        let octave = exponent.max(1).ilog2() as usize;
        self.thresholds[octave.min(self.thresholds.len() - 1)]
    }

    /// Returns f: the square of the base, or 0 if the square is below the word of ROM(n), or if cos γ is 0.
    #[inline]
    fn gated(&self, cosine: i64, exponent: i64, scaled: i64) -> i64 {
        let base = scaled + self.base_one;
        let square = self.square.apply(base * base);
        if cosine == 0 || square < self.threshold(exponent) { 0 } else { square }
    }

    /// Returns the exact square of the base, before the comparison, and the level in ROM(n), as values.
    #[inline]
    fn square_and_level(&self, control: &[i64]) -> (f64, f64) {
        let ulp = exp2(-(self.keys.f.fraction as i32));
        let level = self.threshold(control[1]) as f64 * ulp;
        (formulas::parabola(self.keys.operands.cosine.value(control[0]), control[1] as f64), level)
    }
}

pub fn model(config: &Config) -> Box<dyn Model> {
    let it = Arc::new(ThresholdArithmetic::new(Keys::of(config)));
    let mut frame = Frame::default();
    let [cosine, exponent] = highlight::slots(&it.keys.operands, &mut frame);
    let fraction = it.keys.f.fraction as i32;
    let scaled = frame.register("scaled", Format::signed(0, fraction));
    let intensity = frame.register("intensity", it.keys.f.format());
    let program = vec![
        idle(),
        step_by(&it, move |it, s| s[scaled] = it.scaled(s[cosine], s[exponent])),
        step_by(&it, move |it, s| s[intensity] = it.gated(s[cosine], s[exponent], s[scaled])),
    ];
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Box::new(products.behind(frame, intensity, program))
}

/// Returns the accuracy contract, with the control operands `cos_gamma` and `exponent`.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    Box::new(highlight(ThresholdArithmetic::new(Keys::of(config))))
}

fn highlight(it: ThresholdArithmetic) -> Highlight {
    let operands = highlight::operands(&it.keys.operands, &it.keys.domain);
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Highlight::new(it, operands, products)
}

impl Reflectance for ThresholdArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let cosine = self.keys.operands.cosine.clamped(control[0]);
        self.gated(cosine, control[1], self.scaled(cosine, control[1]))
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let (square, level) = self.square_and_level(control);
        formulas::threshold(square, level)
    }

    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        let level = self.threshold(exponent) as f64 * exp2(-(self.keys.f.fraction as i32));
        Some(formulas::threshold(formulas::parabola(cosine, exponent as f64), level))
    }

    /// Returns how fast and by which jumps f changes. The largest n is an upper limit of the slope n·base, because the base is at
    /// most 1. The base falls with the cosine, so the formula jumps to 0 only once. It jumps from the level in ROM(n), plus or
    /// minus `margin`. If (1 − n/2)² is above this level, it jumps from (1 − n/2)² at a right angle instead.
    fn variation(&self) -> Option<Variation> {
        let (least, most) = self.keys.domain.exponents();
        let mut jump: f64 = 0.0;
        for n in least..=most {
            let level = self.threshold(n) as f64 * exp2(-(self.keys.f.fraction as i32));
            let base = (1.0 - n as f64 / 2.0).max(0.0);
            jump = jump.max((level + self.margin).max(base * base));
        }
        Some(Variation { slope: most as f64, jump })
    }

    /// Returns the exact square and 0, which are both right, if the square differs from the level in ROM(n) by at most `margin`.
    #[inline]
    fn references(&self, control: &[i64]) -> [f64; 2] {
        let (square, level) = self.square_and_level(control);
        if (square - level).abs() <= self.margin {
            [square, 0.0]
        } else {
            [formulas::threshold(square, level); 2]
        }
    }

    /// Returns an expression for each side of the jump. The first compares the square with the level less the margin, the
    /// second with the level plus the margin.
    fn expressions(&self) -> Vec<String> {
        let square =
            format!("{} ** 2", contract::clamped_at_0("exponent / 2 * (cos_gamma - 1) + 1"));
        let margin = self.margin;
        ["-", "+"]
            .map(|side| {
                let level = format!("levels[int(exponent)] {side} {margin:e}");
                contract::where_it_faces(&format!("({square} if {square} >= {level} else 0)"))
            })
            .to_vec()
    }

    /// Derives the contributions to the error of f. Base, square and formula lie in 0 … 1, so an error ε of the base is at most
    /// 2·ε in the square.
    ///
    /// The product is rounded into the base, and limited to −1.0 where the formula is clamped. The square is rounded; the
    /// square of 1.0 is an ulp low. The comparison with ROM(n) adds no error: if the square differs from ROM(n) by at most the
    /// sum of these errors, both outcomes are right.
    fn shares(&self) -> Vec<ErrorShare> {
        let f = self.keys.f.fraction;
        let base = rounding_error(self.keys.operands.cosine.fraction + 1, f, self.keys.f.rounding);
        vec![
            ("intensity.rounding", "rounding of the base", 2.0 * base),
            (
                "intensity.fraction",
                "rounding of the square, and 1.0 as the largest word",
                exp2(-(f as i32)),
            ),
        ]
    }

    /// Returns a warning if a level hides outputs above 0, for one n of each octave. Such a level is visible as an edge around
    /// the highlight.
    fn remarks(&self) -> Vec<String> {
        let (f, colour_bits) = (&self.keys.f, self.keys.operands.colours.bits);
        let largest = (1 << colour_bits) - 1;
        let (first, last) = self.keys.domain.exponents();
        let colour = Format::unsigned(colour_bits as i32, 0);
        let output = Narrow::new(f.fraction, colour, f.output_rounding);
        // One n of each octave represents the octave.
        let octaves = (0..=12).map(|octave| (1i64 << octave).clamp(first, last));
        let largest_hidden = |n: i64| self.threshold(n) - 1;
        let Some(n) = octaves.max_by_key(|&n| (largest_hidden(n), -n)) else {
            return Vec::new();
        };
        let word = largest_hidden(n);
        let shown = output.apply(word.max(0) * largest);
        if shown == 0 {
            return Vec::new();
        }
        vec![format!(
            "visibility.levels hide visible outputs: at n = {n}, outputs of up to {shown} become 0, although \
             the formula without ROM(n) shows them; levels of at most 50 hide only outputs that round to 0"
        )]
    }
}

//! The golden model and the accuracy contract that the devices `blinn` and `gauss` share: f = 2^(−n·decay(c)), or 0 if c ≤ 0
//! ([symbols](crate#symbols)).
//!
//! The decay is −log₂ c in `blinn`, which makes f = cⁿ, and γ²/(2 ln 2) in `gauss`, which makes f = exp(−n·γ²/2). For example,
//! c = 0.5 and n = 2 give the decay 1 in `blinn`, and f = 0.25.

#[cfg(test)]
mod tests;

use std::f64::consts::{LN_2, PI};
use std::sync::Arc;

use super::contract::{self, ErrorShare};
use super::frame::{Frame, State, idle, step, step_by};
use super::highlight::{self, Highlight, Reflectance, Variation};
use super::narrow::Narrow;
use super::polynomial::Polynomial;
use super::{Contract, Model};
use crate::formulas;
use glint_approximate::Piecewise;
use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::Config;
use glint_keys::decay::{Decay, Keys};

/// Each octave of the distance is divided into this number of parts. Each part's error is bounded separately.
const PARTS: i64 = 32;

struct DecayArithmetic {
    of: Decay,
    keys: Keys,
    /// `ratio` is the table of the decay divided by the distance 1 − c; `power` is the table of 2^−x.
    ratio: Arc<Piecewise>,
    power: Arc<Piecewise>,
    to_decay: Narrow,
    from_fine: Narrow,
    from_coarse: Narrow,
    to_kept: Narrow,
    to_result: Narrow,
}

impl DecayArithmetic {
    /// Makes a configuration's tables. Panics if the schema's check has not accepted it.
    fn new(of: Decay, keys: Keys) -> Self {
        let ratio = keys.ratio(of).expect("a configuration that is checked");
        let power = keys.power().expect("a configuration that is checked");
        let halvings = keys.halvings(of);
        let kept = keys.f.fraction + u32::from(keys.f.rounding == Rounding::Nearest);
        let truncate =
            |fraction: u32, format: Format| Narrow::new(fraction, format, Rounding::Truncate);
        let product_fraction = keys.operands.cosine.fraction + keys.ratio_fraction;
        Self {
            to_decay: truncate(product_fraction, keys.decay_format()),
            from_fine: truncate(keys.decay_fraction, halvings),
            from_coarse: truncate(keys.coarse_fraction, halvings),
            to_kept: truncate(keys.fraction, Format::unsigned(1, kept as i32)),
            to_result: Narrow::new(kept, keys.f.format(), keys.f.rounding),
            of,
            keys,
            ratio,
            power,
        }
    }

    /// Returns the octave and the raw distance of the cosine c. In `blinn`, the octave is the number of times that c must be
    /// doubled to be at least one half. The distance is 1 minus the doubled c, less an ulp. In `gauss`, the octave is always 0,
    /// and c is not doubled. For example, with 4 fraction bits, c = 5/16 has octave 1 and distance 5 in `blinn`.
    ///
    /// If the fraction bits of c are all 0 (c = 0 or 1.0), all bits of the octave in `blinn` are 1, as in the hardware.
    #[inline]
    fn operand(&self, cosine: i64) -> (i64, i64) {
        let one = self.keys.operands.cosine.one();
        let fraction = cosine & (one - 1);
        match self.of {
            Decay::Angle => (0, one - 1 - fraction),
            Decay::Logarithm if fraction == 0 => {
                let ones = (self.keys.operands.cosine.fraction - 1).ilog2() + 1;
                ((1 << ones) - 1, one / 2 - 1)
            }
            Decay::Logarithm => {
                let octave = self.keys.operands.cosine.fraction - 1 - fraction.ilog2();
                (i64::from(octave), one - 1 - (fraction << octave))
            }
        }
    }

    /// Returns the raw decay that is multiplied by n, and whether it is small. The decay is `octave` plus `distance` times
    /// `ratio`. A small decay is below ¼ and has `decay.fraction` fraction bits; a larger decay is truncated to
    /// `decay.coarse_fraction` fraction bits.
    #[inline]
    fn factor(&self, octave: i64, distance: i64, ratio: i64) -> (i64, bool) {
        let (fraction, coarse) = (self.keys.decay_fraction, self.keys.coarse_fraction);
        let decay = self.to_decay.apply(distance * ratio);
        if octave == 0 && decay >> (fraction - 2) == 0 {
            (decay, true)
        } else {
            ((octave << coarse) + (decay >> (fraction - coarse)), false)
        }
    }

    /// Returns n·decay with `exponential.argument` fraction bits. f is 2 to the power of minus this product.
    #[inline]
    fn halvings(&self, (factor, small): (i64, bool), exponent: i64) -> i64 {
        let narrow = if small { self.from_fine } else { self.from_coarse };
        narrow.apply(factor * exponent)
    }

    /// Returns the operand of the table of 2^−x: the fraction bits of `halvings`.
    #[inline]
    fn argument(&self, halvings: i64) -> i64 {
        halvings & ((1 << self.keys.argument) - 1)
    }

    /// Returns f: `power`, the table's value of 2^−x, shifted right by the integer part of n·decay and rounded. f is 0 if c is
    /// 0, and 1.0 less an ulp if c is 1.0.
    #[inline]
    fn reflectance(&self, cosine: i64, halvings: i64, power: i64) -> i64 {
        if cosine == 0 {
            0
        } else if cosine == self.keys.operands.cosine.one() {
            (1 << self.keys.f.fraction) - 1
        } else {
            let places = (halvings >> self.keys.argument).min(63);
            self.to_result.apply(self.to_kept.apply(power) >> places)
        }
    }

    /// Returns the exact decay for a distance 1 − c, from 0 to 1.0.
    fn exact_decay(&self, distance: f64) -> f64 {
        match self.of {
            Decay::Logarithm => -libm::log2(1.0 - distance),
            Decay::Angle => {
                let gamma = libm::acos(1.0 - distance);
                gamma * gamma / (2.0 * LN_2)
            }
        }
    }

    /// Returns upper limits of three errors of f, as values, for all raw distances from `from` to `to` in an octave. The first
    /// comes from the error of the ratio, the second from the rounding of the decay, the third from the bits that a coarse decay
    /// loses.
    fn of_distances(&self, (from, to): (i64, i64), octave: f64) -> [f64; 3] {
        let keys = &self.keys;
        let [from, to] = [from, to].map(|raw| raw as f64 * keys.operands.cosine.ulp());
        // Half of the range of the low bits that the table does not read, times the steepest slope of the ratio.
        let unseen = match keys.unseen() {
            0 => 0.0,
            bits => exp2(bits as i32 - 1) * keys.operands.cosine.ulp() * self.of.steepest(),
        };
        let ratio = self.ratio.bound * exp2(-(keys.ratio_fraction as i32)) + unseen;
        let fine = [ratio * to, exp2(-(keys.decay_fraction as i32))];
        // A small decay keeps all its bits, so it has no coarse error.
        let is_coarse = octave > 0.0 || self.exact_decay(to) + fine[0] >= 0.25;
        let coarse = if is_coarse { exp2(-(keys.coarse_fraction as i32)) } else { 0.0 };
        let parts = [fine[0], fine[1], coarse];
        let least = octave + self.exact_decay(from) - parts.iter().sum::<f64>();
        let (first, last) = (keys.domain.least as f64, keys.domain.most as f64);
        let n = if least > 0.0 { (1.0 / (least * LN_2)).clamp(first, last) } else { last };
        let weight = LN_2 * n * libm::exp2(-n * least.max(0.0));
        parts.map(|part| part * weight)
    }

    #[inline]
    fn formula(&self, cosine: f64, exponent: f64) -> f64 {
        match self.of {
            Decay::Logarithm => formulas::blinn(cosine, exponent),
            Decay::Angle => formulas::gauss(cosine, exponent),
        }
    }
}

/// Returns the golden model. Panics if `config` has not passed the check against the schema.
pub fn model(config: &Config, of: Decay) -> Box<dyn Model> {
    let it = Arc::new(DecayArithmetic::new(of, Keys::of(config)));
    let keys = &it.keys;
    let mut frame = Frame::default();
    let [cosine, exponent] = highlight::slots(&keys.operands, &mut frame);
    let ratio = Polynomial::new(&mut frame, &["ratio", "ratio_sum1", "ratio_sum2"], &it.ratio);
    let factor = frame.register("factor", Format::unsigned(keys.factor_bits(it.of) as i32, 0));
    let small = frame.register("decay_small", Format::BIT);
    let halvings = frame.register("halvings", keys.halvings(it.of));
    let power = Polynomial::new(&mut frame, &["power", "power_sum1", "power_sum2"], &it.power);
    let reflectance = frame.register("reflectance", keys.f.format());
    frame.shows("f_out", reflectance);

    let mut program = vec![idle()];
    let arithmetic = it.clone();
    let operand = move |s: &State| arithmetic.operand(s[cosine]).1 >> arithmetic.keys.unseen();
    program.extend(ratio.steps(operand).map(step));
    let (ratio, powers) = (ratio.q(), power.q());
    program.push(step_by(&it, move |it, s| {
        let (octave, distance) = it.operand(s[cosine]);
        let (decay, is_small) = it.factor(octave, distance + 1, s[ratio]);
        (s[factor], s[small]) = (decay, is_small.into());
    }));
    program.push(step_by(&it, move |it, s| {
        s[halvings] = it.halvings((s[factor], s[small] != 0), s[exponent]);
    }));
    let mask = it.argument(i64::MAX);
    program.extend(power.steps(move |s| s[halvings] & mask).map(step));
    program.push(step_by(&it, move |it, s| {
        s[reflectance] = it.reflectance(s[cosine], s[halvings], s[powers]);
    }));
    let products = highlight::products(&keys.operands.colours, &keys.f);
    Box::new(products.behind(frame, reflectance, program))
}

/// Returns the accuracy contract, with the control operands `cos_gamma` and `exponent`. Panics if `config` has not passed the
/// check against the schema.
pub fn contract(config: &Config, of: Decay) -> Box<dyn Contract> {
    let it = DecayArithmetic::new(of, Keys::of(config));
    let operands = highlight::operands(&it.keys.operands, &it.keys.domain);
    let products = highlight::products(&it.keys.operands.colours, &it.keys.f);
    Box::new(Highlight::new(it, operands, products))
}

impl Reflectance for DecayArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let cosine = self.keys.operands.cosine.clamped(control[0]);
        let (octave, distance) = self.operand(cosine);
        let ratio = self.ratio.result(distance >> self.keys.unseen());
        let halvings = self.halvings(self.factor(octave, distance + 1, ratio), control[1]);
        self.reflectance(cosine, halvings, self.power.result(self.argument(halvings)))
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        self.formula(self.keys.operands.cosine.value(control[0]), control[1] as f64)
    }

    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        Some(self.formula(cosine, exponent as f64))
    }

    /// Returns how fast and by which jumps f changes. The largest n is an upper limit of the slope; the smallest n jumps most at
    /// a right angle.
    /// - cosⁿγ has the slope n·c^(n − 1), at most n. With n = 0 it jumps from 1 to 0 at a right angle.
    /// - exp(−n·γ²/2) has the slope n·(γ/sin γ)·exp(−n·γ²/2). It is at most n, since γ/sin γ ≤ exp(γ²/2) up to a right angle:
    ///   the logarithm of γ/sin γ is γ²/6 + γ⁴/180 + …, of positive terms that are together below γ²/2 there. At a right angle
    ///   exp(−n·γ²/2) jumps from exp(−n·π²/8) to 0.
    fn variation(&self) -> Option<Variation> {
        let (least, most) = self.keys.domain.exponents();
        let jump = match self.of {
            Decay::Logarithm if least > 0 => 0.0,
            Decay::Logarithm => 1.0,
            Decay::Angle => libm::exp(-(least as f64) * PI * PI / 8.0).next_up(),
        };
        Some(Variation { slope: most as f64, jump })
    }

    fn expressions(&self) -> Vec<String> {
        vec![contract::where_it_faces(match self.of {
            Decay::Logarithm => "cos_gamma ** exponent",
            Decay::Angle => "exp(-exponent * acos(cos_gamma) ** 2 / 2)",
        })]
    }

    /// Derives the contributions to the error of f. Let y = n·decay be exact and z the hardware's product before it is cut to
    /// the fraction bits of the table of 2^−x.
    ///
    /// - The ratio of decay to distance has the error of its table, which is proved over every operand. In addition, several
    ///   distances share one operand of the table. Their difference from the middle distance is multiplied by the steepest
    ///   slope of the ratio. The sum of both errors is multiplied by the distance.
    /// - |z − y| ≤ n·e, where e is the decay's error, including the bits that a coarse decay loses. So |2^−z − 2^−y| ≤ ln
    ///   2·n·e·2^−min(y, z), and min(y, z) ≥ n·(decay − e) with the smallest decay of a set of distances. As a function of n this
    ///   is largest at n = 1/(ln 2·(decay − e)). Octaves beyond the first have the same distances and larger decays, so the first
    ///   of them is the worst.
    /// - z is truncated to the operand of the table of 2^−x. The table holds the value at the middle of the arguments that are
    ///   truncated to one operand. The argument is therefore off by at most half an ulp of the operand. The slope of 2^−x is at
    ///   most ln 2, and the table adds its own error. The shift to the right makes both errors smaller.
    /// - f is rounded, or saturated just below 1.0; this changes f by at most an ulp. If the integer part of n·decay is F + 2 or
    ///   more, nothing of f is left, and f was below that ulp.
    /// - The output adds its own rounding. It cannot exceed the largest colour, because f < 1.
    fn shares(&self) -> Vec<ErrorShare> {
        let octaves: &[f64] = match self.of {
            Decay::Logarithm => &[0.0, 1.0],
            Decay::Angle => &[0.0],
        };
        let last = 1i64 << self.keys.distance(self.of);
        let mut worst = None;
        let mut largest = f64::NEG_INFINITY;
        for &octave in octaves {
            let mut from = 1;
            while from <= last {
                let to = (from + from / PARTS).min(last);
                let errors = self.of_distances((from, to), octave);
                let sum: f64 = errors.iter().sum();
                if sum.total_cmp(&largest).is_ge() {
                    (worst, largest) = (Some(errors), sum);
                }
                from += (from / PARTS).max(1);
            }
        }
        let [ratio, rounding, coarse] = worst.unwrap_or_default();
        let ulp = |fraction: u32| exp2(-(fraction as i32));
        vec![
            ("ratio.fraction", "the polynomials of decay over distance, times n", ratio),
            ("decay.fraction", "rounding of the decay, times n", rounding),
            (
                "decay.coarse_fraction",
                "bits of the decay that the product by n does not see",
                coarse,
            ),
            (
                "exponential.argument",
                "bits of n*decay that the table of 2^-x does not see",
                LN_2 / 2.0 * ulp(self.keys.argument),
            ),
            (
                "exponential.fraction",
                "the polynomials of 2^-x",
                self.power.bound * ulp(self.keys.fraction),
            ),
            ("intensity.fraction", "rounding of f", ulp(self.keys.f.fraction)),
        ]
    }
}

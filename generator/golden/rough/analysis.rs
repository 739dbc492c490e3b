//! Bounds the error of f of the device `rough` for every pair of bins of the angles γ and dγ, for exact arithmetic.
//!
//! The quarter circle is divided into 512 bins, intervals of angles of equal size. [`super::bound`] takes the largest of these
//! bounds, and explains the symbols.

use std::f64::consts::FRAC_PI_2;

use super::Keys;
use crate::narrow::rounding_error;
use crate::sine::{ErrorRange, Sine};
use glint_base::fixed::{Rounding, exp2};

/// The number of bins of a quarter circle. A bin is small compared with the narrowest highlight, which is 3.6° wide at n = 1000.
const BINS: usize = 512;
/// A bin's width, in radians.
pub const BIN: f64 = FRAC_PI_2 / BINS as f64;

/// A margin, in radians, that covers the rounding of angles in f64.
pub const SLACK: f64 = 1e-9;

/// The errors of the table of sines (ROM 18), for each bin of the angle.
pub struct Errors {
    /// The largest error of the table, and the part of it that words of unlimited width would leave ([`ErrorRange`]).
    errors: Vec<(f64, f64)>,
    /// The largest sine in each bin.
    sines: Vec<f64>,
}

impl Errors {
    fn new(sine: &Sine) -> Self {
        let mut errors = vec![(0.0, 0.0); BINS];
        sine.for_each_piece(|piece: ErrorRange| {
            let (low, high) = piece.cosines;
            let first = bin(libm::acos(high) - SLACK);
            let last = bin(libm::acos(low) + SLACK);
            for slot in &mut errors[first..=last] {
                if piece.error > slot.0 {
                    *slot = (piece.error, piece.shape);
                }
            }
        });
        let sines = (1..=BINS).map(|edge| libm::sin(edge as f64 * BIN)).collect();
        Self { errors, sines }
    }

    /// Returns the largest error that the table causes in register 12, the product of both sines, for γ in bin `i` and dγ in bin
    /// `j`.
    fn product(&self, i: usize, j: usize) -> f64 {
        self.part(i, j, |error, _| error)
    }

    /// Returns the share of [`Self::product`] that comes from one cause. `part` returns this cause's share of a table entry's
    /// error, from the entry's error and shape.
    pub fn part(&self, i: usize, j: usize, part: impl Fn(f64, f64) -> f64) -> f64 {
        let (gamma, dgamma) = (self.errors[i], self.errors[j]);
        self.sines[i] * part(dgamma.0, dgamma.1)
            + (self.sines[j] + dgamma.0) * part(gamma.0, gamma.1)
    }
}

/// The factor n·b by which an error of cos(γ ± dγ) changes f, for a bin of γ and a bin of dγ with a certain distance.
pub struct Weight {
    /// The largest weight n·b for any n of the domain and any angles in these bins. With the base b = n/2·(cos(γ ± dγ) − 1) + 1,
    /// an error of cos(γ ± dγ) changes f = b² by at most this factor.
    pub linear: f64,
    /// The largest n of the domain for which the square is not constant, or 0.
    exponent: f64,
}

impl Weight {
    /// Returns the weight for pairs of bins that are `distance` bins apart: 0 if the square is constant for every n of the
    /// domain. `anywhere` is the largest error of the base at any angles.
    fn new(keys: &Keys, distance: usize, anywhere: f64) -> Self {
        let (least, most) = exponents(keys);
        let sine = libm::sin((distance.saturating_sub(1)) as f64 * BIN / 2.0);
        let q = 2.0 * sine * sine;
        // E is the largest error of the base. With the clamp, the square is constant if n·q/2 is above 1 + E; without the
        // clamp, if it is above 2 + E.
        let reach = if keys.clamp { 1.0 } else { 2.0 };
        let limit = most.min(2.0 * (reach + anywhere) / q);
        if limit < least {
            return Self { linear: 0.0, exponent: 0.0 };
        }
        let linear = if keys.clamp {
            let best = (1.0 / q).clamp(least, most);
            best * (1.0 - best * q / 2.0).max(0.0)
        } else {
            limit
        };
        Self { linear, exponent: limit }
    }
}

fn exponents(keys: &Keys) -> (f64, f64) {
    (keys.domain.least as f64, keys.domain.most as f64)
}

fn bin(angle: f64) -> usize {
    ((angle.max(0.0) / BIN) as usize).min(BINS - 1)
}

pub struct Analysis {
    pub errors: Errors,
    /// The weights, for γ − dγ by the distance of the two bins, and for γ + dγ by the sum of their numbers.
    pub weights: Vec<Weight>,
    /// The last bin that dγ can reach.
    deviation: usize,
    /// The largest rounding error of registers 11 and 12 together: the products of the cosines and of the sines.
    pub products: f64,
    /// The largest rounding error of the base in register 13.
    pub base: f64,
    /// The largest error of the square in register 13.
    pub ulp: f64,
    /// The largest error of the base before it is rounded, where the square is not constant.
    pub square: f64,
}

impl Analysis {
    /// Analyses the configuration `keys` with its table `sine`.
    pub fn new(keys: &Keys, sine: &Sine) -> Self {
        let errors = Errors::new(sine);
        let deviation = bin(keys.deviation.to_radians() + SLACK);
        let (p, f) = (keys.product_fraction, keys.f.fraction);
        let rounding = keys.product_rounding;
        let cos_cos = rounding_error(2 * keys.operands.cosine.fraction, p, rounding);
        let mut sin_sin = rounding_error(2 * keys.sine_fraction, p, rounding);
        let largest_product = errors.sines[deviation] + errors.errors[deviation].0;
        if rounding == Rounding::Nearest && largest_product >= 1.0 - exp2(-(p as i32)) {
            // A product that would round to 1.0 saturates to 1.0 − ulp.
            sin_sin = sin_sin.max(exp2(-(p as i32)));
        }
        let base = rounding_error(p + 1, f, keys.f.rounding);
        let mut it = Self {
            errors,
            weights: Vec::new(),
            deviation,
            products: cos_cos + sin_sin,
            base,
            ulp: exp2(-(f as i32)),
            square: 0.0,
        };
        let largest = it.pairs().map(|(i, j)| it.errors.product(i, j)).fold(0.0, f64::max);
        let (_, most) = exponents(keys);
        let anywhere = most / 2.0 * (largest + it.products) + base;
        it.weights = (0..2 * BINS).map(|distance| Weight::new(keys, distance, anywhere)).collect();
        for (i, j) in it.pairs() {
            let weight = it.weights[i.abs_diff(j)].exponent / 2.0;
            let error = weight * (it.errors.product(i, j) + it.products);
            it.square = it.square.max(error);
        }
        it
    }

    /// Returns all pairs of a bin of γ and a bin of dγ, up to the largest deviation of the domain.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let deviation = self.deviation;
        (0..BINS).flat_map(move |i| (0..=deviation).map(move |j| (i, j)))
    }

    pub fn sine(&self, bin: usize) -> f64 {
        self.errors.sines[bin]
    }

    /// Returns the bound on the error of f for γ in bin `i` and dγ in bin `j`; `negative` selects γ − dγ.
    pub fn bound(&self, i: usize, j: usize, negative: bool) -> f64 {
        self.bound_of(i, j, negative, self.errors.product(i, j))
    }

    /// Returns the bound like [`Self::bound`], but `error` replaces the amount by which the bins' table errors change register
    /// 12.
    pub fn bound_of(&self, i: usize, j: usize, negative: bool, error: f64) -> f64 {
        let apart = if negative { i.abs_diff(j) } else { i + j };
        self.rounded(self.weights[apart].linear * (error + self.products))
    }

    /// Adds all roundings to `linear`, the weight n·b times the error of cos(γ ± dγ).
    pub fn rounded(&self, linear: f64) -> f64 {
        let base = self.square + self.base;
        linear + 2.0 * self.base + self.ulp + base * base
    }
}

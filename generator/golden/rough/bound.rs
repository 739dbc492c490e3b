//! The proof of the error bound of `rough`.
//!
//! **Notation.** b = n/2·(cos(γ ± dγ) − 1) + 1 is the formula's base, b′ the hardware's (adder 16 in
//! word 6), and E ≥ |b′ − b|. Operands are exact, for the formula is taken at the quantised ones.
//!
//! **The base.** Registers 11 and 12 hold cos γ·cos dγ and sin γ·sin dγ with rounding errors e₁₁, e₁₂ and
//! the sine's errors δ: with s = sin γ, t = sin dγ, register 12 is off by s·δ(dγ) + (t + δ(dγ))·δ(γ) at
//! most. Adder 15 is exact, the product by n/2 is exact, and register 13 rounds by e₁₃. Hence
//! E = n/2·(e₁₁ + e₁₂ + s·δ(dγ) + (t + δ(dγ))·δ(γ)) + e₁₃. Saturation of register 13 moves b′ towards
//! 0 … 1 only (clamped) or −1 … 1 (not clamped), within which alone it matters.
//!
//! **The square.** Both bases clamped to 0 … 1, |b′² − b²| ≤ 2·b·E + E², which vanishes where b < −E. So a
//! cosine's error e counts n·b·e. As b ≤ 1 − n·q/2 with q = 1 − cos(γ − dγ), which is the smaller for the
//! nearer of the two signs, the weight n·b is the largest at n = 1/q, and small where γ and dγ
//! are far apart: there the table may be coarse. Without the clamp |b| ≤ 1 and n·q/2 ≤ 2 + E count
//! instead. Register 13 rounds the square by less than an ulp, or saturates 1.0 to 1.0 − ulp.
//!
//! **The maximum.** The quarter circle is cut into equal bins, in each of which the largest error of the
//! table's entries is known; the smallest γ − dγ of two bins depends on their distance alone, the smallest γ + dγ on the
//! sum of their numbers. All pairs of bins are tried. With the clamp, [`super::pairs`] looks into those whose bound is
//! largest: there what a table's error and roundings allow for does not come together at any operands. The terms are those of
//! the pair of bins, in proportion.

use std::f64::consts::FRAC_PI_2;

use super::{Arithmetic, Kind, Params, pairs};
use crate::base::fixed::{Rounding, exp2};
use crate::golden::contract::ErrorShare;
use crate::golden::narrow::rounding_error;
use crate::golden::sine::{Piece, Sine, TableScheme};

/// Bins of the quarter circle: fine against the narrowest highlight, 3.6° at n = 1000.
const BINS: usize = 512;
pub const BIN: f64 = FRAC_PI_2 / BINS as f64;

/// A slack that covers the rounding of angles in f64.
pub const SLACK: f64 = 1e-9;

/// What the error of f is made of.
pub fn shares(it: &Arithmetic) -> Vec<ErrorShare> {
    match it.params.arithmetic {
        Kind::Patent => {
            vec![("arithmetic", "words modulo 1.0 wrap where the base is negative", 1.0)]
        }
        Kind::Exact => exact(it),
    }
}

/// The table's error by angle.
struct Errors {
    /// The largest error of an operand in each bin, with its shape (as in [`Piece`]).
    errors: Vec<(f64, f64)>,
    /// The largest sine in each bin.
    sines: Vec<f64>,
}

impl Errors {
    fn new(sine: &Sine) -> Self {
        let mut errors = vec![(0.0, 0.0); BINS];
        sine.for_each_piece(|piece: Piece| {
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

    /// The largest error of register 12 from the table, for γ in bin `i` and dγ in bin `j`.
    fn product(&self, i: usize, j: usize) -> f64 {
        self.part(i, j, |error, _| error)
    }

    /// The part of [`Self::product`] that comes from a part of each entry's error, which `part` takes
    /// from the error and its shape.
    fn part(&self, i: usize, j: usize, part: impl Fn(f64, f64) -> f64) -> f64 {
        let (gamma, dgamma) = (self.errors[i], self.errors[j]);
        self.sines[i] * part(dgamma.0, dgamma.1)
            + (self.sines[j] + dgamma.0) * part(gamma.0, gamma.1)
    }
}

/// What an error counts when γ and dγ are a number of bins apart.
struct Weight {
    /// The largest n·b.
    linear: f64,
    /// The largest n for which the square is not constant.
    exponent: f64,
}

impl Weight {
    /// `anywhere` is the largest error of the base for whatever angles.
    fn new(params: &Params, distance: usize, anywhere: f64) -> Self {
        let (least, most) = exponents(params);
        let sine = libm::sin((distance.saturating_sub(1)) as f64 * BIN / 2.0);
        let q = 2.0 * sine * sine;
        // The square is constant beyond n·q/2 = 1 + E, or, where |b| counts, 2 + E.
        let reach = if params.clamp { 1.0 } else { 2.0 };
        let limit = most.min(2.0 * (reach + anywhere) / q);
        if limit < least {
            return Self { linear: 0.0, exponent: 0.0 };
        }
        let linear = if params.clamp {
            let best = (1.0 / q).clamp(least, most);
            best * (1.0 - best * q / 2.0).max(0.0)
        } else {
            limit
        };
        Self { linear, exponent: limit }
    }
}

fn exponents(params: &Params) -> (f64, f64) {
    (params.keys.exponents.0 as f64, params.keys.exponents.1 as f64)
}

fn bin(angle: f64) -> usize {
    ((angle.max(0.0) / BIN) as usize).min(BINS - 1)
}

/// The bounds of pairs of bins.
pub struct Analysis {
    errors: Errors,
    /// By distance of the bins, or by the sum of their numbers.
    weights: Vec<Weight>,
    /// The last bin of dγ.
    deviation: usize,
    /// The rounding of registers 11 and 12 together, and of register 13: of the base, and an ulp of the square.
    products: f64,
    base: f64,
    ulp: f64,
    /// The largest error of the base before its rounding, where the square is not constant.
    square: f64,
}

impl Analysis {
    fn new(params: &Params, sine: &Sine) -> Self {
        let errors = Errors::new(sine);
        let deviation = bin(params.deviation.to_radians() + SLACK);
        let (p, f) = (params.product_fraction, params.keys.intensity_fraction);
        let rounding = params.product_rounding;
        let cos_cos = rounding_error(2 * params.keys.cosine_fraction, p, rounding);
        let mut sin_sin = rounding_error(2 * params.sine_fraction, p, rounding);
        let largest_product = errors.sines[deviation] + errors.errors[deviation].0;
        if rounding == Rounding::Nearest && largest_product >= 1.0 - exp2(-(p as i32)) {
            // What would round to 1.0 saturates to 1.0 − ulp.
            sin_sin = sin_sin.max(exp2(-(p as i32)));
        }
        let base = rounding_error(p + 1, f, params.intensity_rounding);
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
        let (_, most) = exponents(params);
        let anywhere = most / 2.0 * (largest + it.products) + base;
        it.weights =
            (0..2 * BINS).map(|distance| Weight::new(params, distance, anywhere)).collect();
        let square = |(i, j): (usize, usize)| {
            it.weights[i.abs_diff(j)].exponent / 2.0 * (it.errors.product(i, j) + it.products)
        };
        it.square = it.pairs().map(square).fold(0.0, f64::max);
        it
    }

    /// Every bin of γ with every bin of dγ.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let deviation = self.deviation;
        (0..BINS).flat_map(move |i| (0..=deviation).map(move |j| (i, j)))
    }

    /// The largest sine in a bin.
    pub fn sine(&self, bin: usize) -> f64 {
        self.errors.sines[bin]
    }

    /// The largest error of f in two bins.
    pub fn bound(&self, i: usize, j: usize, negative: bool) -> f64 {
        self.bound_of(i, j, negative, self.errors.product(i, j))
    }

    /// The same where register 12 is off by `error` from the table.
    pub fn bound_of(&self, i: usize, j: usize, negative: bool, error: f64) -> f64 {
        let apart = if negative { i.abs_diff(j) } else { i + j };
        self.rounded(self.weights[apart].linear * (error + self.products))
    }

    /// The largest error of f where what adder 15 is off by makes n·b times as much.
    pub fn rounded(&self, linear: f64) -> f64 {
        let base = self.square + self.base;
        linear + 2.0 * self.base + self.ulp + base * base
    }
}

fn exact(it: &Arithmetic) -> Vec<ErrorShare> {
    let params = &it.params;
    let analysis = Analysis::new(params, &it.sine);
    let of = |&(i, j): &(usize, usize)| analysis.bound(i, j, true);
    let pairs = analysis.pairs();
    let at = pairs.reduce(|one, other| if of(&other) > of(&one) { other } else { one });
    let at = at.unwrap_or_default();
    let linear = analysis.weights[at.0.abs_diff(at.1)].linear;
    let base = analysis.square + analysis.base;
    let mut shares: Vec<ErrorShare> = sine_terms(params)
        .iter()
        .enumerate()
        .map(|(k, &(key, what))| {
            let part = |error, shape| split(params, error, shape)[k];
            (key, what, linear * analysis.errors.part(at.0, at.1, part))
        })
        .collect();
    let twice = 2.0 * analysis.base + analysis.ulp;
    shares.extend([
        (
            "product.fraction",
            "rounding of registers 11 and 12, times n",
            linear * analysis.products,
        ),
        ("intensity.fraction", "rounding of register 13, twice", twice),
        ("domain.exponent_max", "square of the base's error", base * base),
    ]);
    if params.clamp {
        let sum: f64 = shares.iter().map(|share| share.2).sum();
        let part = pairs::largest_error(it, &analysis) / sum;
        shares.iter_mut().for_each(|share| share.2 *= part);
    }
    shares
}

/// The keys that govern the parts which [`split`] tells apart.
fn sine_terms(params: &Params) -> &'static [(&'static str, &'static str)] {
    match params.sine_scheme {
        TableScheme::Direct { .. } => &[
            ("sine.fraction", "rounding of the sine, times n"),
            ("sine.address", "one sine for a whole bucket, times n"),
        ],
        TableScheme::Segmented { .. } => &[
            ("sine.fraction", "rounding of the sine, times n"),
            ("sine.segments", "straight segments for the sine, times n"),
            ("sine.slope_fraction", "rounding of the slopes, times n"),
        ],
    }
}

/// An entry's error, which is known as a whole, in parts that add up to it: in proportion to what
/// rounding (with the floor after interpolation), the shape and the slope's rounding could cost at most.
fn split(params: &Params, error: f64, shape: f64) -> [f64; 3] {
    let ulp = exp2(-(params.sine_fraction as i32));
    let most = match params.sine_scheme {
        TableScheme::Direct { .. } => [ulp / 2.0, shape, 0.0],
        // A slope is off by half an ulp over the segment, and the base halves that again.
        TableScheme::Segmented { slope_fraction, .. } => {
            [1.5 * ulp, shape, exp2(-(slope_fraction as i32)) / 4.0]
        }
    };
    most.map(|part| part * error / most.iter().sum::<f64>())
}

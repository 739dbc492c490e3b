//! Computes the terms of the error bound of the device `rough`, each with the configuration key that governs it. For the patent's
//! arithmetic, which wraps modulo 1.0, the only term is 1.0.
//!
//! The rest of this head proves the bound for exact arithmetic. Block numbers, such as register 11, are the numbers in the figure
//! of the patent UA 60139.
//!
//! **Notation.** b = n/2·(cos(γ ± dγ) − 1) + 1 is the base of the square in the formula, before any clamp. b′ is the base that the
//! hardware computes (adder 16, in word 6 of the microprogram). E is a bound of |b′ − b|. Operands are exact, because the formula
//! is taken at the quantised operands.
//!
//! **The base.** Registers 11 and 12 hold cos γ·cos dγ and sin γ·sin dγ, with the rounding errors e₁₁ and e₁₂. The sines from the
//! table have the errors δ(γ) and δ(dγ). Let s = sin γ and t = sin dγ. The sines put register 12 off by at most s·δ(dγ) + (t +
//! δ(dγ))·δ(γ). Adder 15 is exact, the product by n/2 is exact, and register 13 adds the rounding error e₁₃. Hence E = n/2·(e₁₁ +
//! e₁₂ + s·δ(dγ) + (t + δ(dγ))·δ(γ)) + e₁₃. Saturation of register 13 moves b′ only towards the interval 0 … 1 (clamped) or −1 … 1
//! (not clamped). The value of b′ matters only within this interval.
//!
//! **The square with the clamp.** Let c(b) be b clamped to 0 … 1. For b ≥ −E, |c(b′)² − c(b)²| ≤ 2·max(b, 0)·E + E². For b < −E the
//! difference is 0, because both bases are clamped to 0. An error e of the cosine therefore changes f by n·b·e, so n·b is its
//! weight. Let q = 1 − cos(γ − dγ), the smaller of the two values 1 − cos(γ ± dγ). As b ≤ 1 − n·q/2, the weight n·b is largest at
//! n = 1/q. The weight is small if γ and dγ are far apart, so the table may be coarse there.
//!
//! **The square without the clamp.** Here |b| ≤ 1, and n·q/2 ≤ 2 + E wherever the square is not constant. The weight is therefore
//! at most the largest such n. With and without the clamp, register 13 rounds the square by less than an ulp, or saturates 1.0 to
//! 1.0 − ulp.
//!
//! **The maximum.** The quarter circle is cut into equal bins, and the largest error of the table's entries is known in each bin.
//! The smallest γ − dγ of two bins depends only on their distance, and the smallest γ + dγ only on the sum of their numbers. The
//! code tries all pairs of bins, and the terms are the worst pair's terms. With the clamp, [`super::pairs`] finds a smaller
//! bound, because the largest errors of table and roundings do not occur at the same operands. All terms are then multiplied by
//! one factor, so their sum is this smaller bound.

use super::analysis::Analysis;
use super::{Keys, Kind, RomLayout, RoughArithmetic, pairs};
use crate::contract::ErrorShare;
use glint_base::fixed::exp2;

pub fn shares(it: &RoughArithmetic) -> Vec<ErrorShare> {
    match it.keys.arithmetic {
        Kind::Patent => {
            vec![("arithmetic", "words modulo 1.0 wrap where the base is negative", 1.0)]
        }
        Kind::Exact => exact(it),
    }
}

fn exact(it: &RoughArithmetic) -> Vec<ErrorShare> {
    let keys = &it.keys;
    let analysis = Analysis::new(keys, &it.sine);
    // The bins of γ and dγ with the largest bound.
    let (mut gamma, mut dgamma) = (0, 0);
    for (i, j) in analysis.pairs() {
        if analysis.bound(i, j, true) > analysis.bound(gamma, dgamma, true) {
            (gamma, dgamma) = (i, j);
        }
    }
    let linear = analysis.weights[gamma.abs_diff(dgamma)].linear;
    let base = analysis.square + analysis.base;
    let mut shares: Vec<ErrorShare> = Vec::new();
    for (k, &(key, what)) in sine_terms(keys).iter().enumerate() {
        let error =
            analysis.errors.part(gamma, dgamma, |error, shape| split(keys, error, shape)[k]);
        shares.push((key, what, linear * error));
    }
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
    if keys.clamp {
        let sum: f64 = shares.iter().map(|share| share.2).sum();
        let part = pairs::largest_error(it, &analysis) / sum;
        for (_, _, error) in &mut shares {
            *error *= part;
        }
    }
    shares
}

/// Returns the key and the description of each part of [`split`].
fn sine_terms(keys: &Keys) -> &'static [(&'static str, &'static str)] {
    match keys.scheme {
        RomLayout::Direct => &[
            ("sine.fraction", "rounding of the sine, times n"),
            ("sine.address", "one sine for a whole bucket, times n"),
        ],
        RomLayout::Segmented => &[
            ("sine.fraction", "rounding of the sine, times n"),
            ("sine.segments", "straight segments for the sine, times n"),
            ("sine.slope_fraction", "rounding of the slopes, times n"),
        ],
    }
}

/// Splits the error of a table entry in proportion to the largest possible errors of three causes. They are the rounding (with
/// the floor after interpolation), the shape, and the slope's rounding.
fn split(keys: &Keys, error: f64, shape: f64) -> [f64; 3] {
    let ulp = exp2(-(keys.sine_fraction as i32));
    let most = match keys.scheme {
        RomLayout::Direct => [ulp / 2.0, shape, 0.0],
        // A slope is off by half an ulp over the segment, and the base halves that again.
        RomLayout::Segmented => [1.5 * ulp, shape, exp2(-(keys.slope_fraction as i32)) / 4.0],
    };
    most.map(|part| part * error / most.iter().sum::<f64>())
}

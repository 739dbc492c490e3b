//! Defines the golden model of the device and its accuracy contract.
//!
//! The golden model computes the device's values in integers, from the formula and not from the description. `cosim` compares
//! the two on every clock, so a mistake in one of them shows as a difference if a random point reaches it.

use std::sync::Arc;

use super::Keys;
use glint::config::Config;
use glint::fixed::{Format, exp2};
use glint::golden::contract::{ErrorShare, control};
use glint::golden::frame::{Frame, idle, step_by};
use glint::golden::highlight::{Highlight, Products, Reflectance};
use glint::golden::narrow::{Narrow, rounding_error};
use glint::golden::{Contract, Model};

/// The arithmetic, one operation a method.
struct Fresnel {
    keys: Keys,
    /// From the fraction bits of a product to those of the powers.
    rounded: Narrow,
}

impl Fresnel {
    fn new(config: &Config) -> Self {
        let keys = Keys::of(config);
        let powers = Format::unsigned(0, keys.power as i32);
        Self { rounded: Narrow::new(2 * keys.power, powers, keys.rounding), keys }
    }

    /// 1 − x, from so many fraction bits to those of the powers.
    fn complement(&self, x: i64, fraction: u32) -> i64 {
        ((1 << fraction) - x) << (self.keys.power - fraction)
    }

    fn square(&self, c: i64) -> i64 {
        let t = self.complement(c, self.keys.cosine);
        self.rounded.apply(t * t)
    }

    fn fourth(&self, square: i64) -> i64 {
        self.rounded.apply(square * square)
    }

    fn fifth(&self, fourth: i64, c: i64) -> i64 {
        self.rounded.apply(fourth * self.complement(c, self.keys.cosine))
    }

    fn blend(&self, fifth: i64, f0: i64) -> i64 {
        let exact = f0 << (2 * self.keys.power - self.keys.reflectance);
        self.rounded.apply(exact + fifth * self.complement(f0, self.keys.reflectance))
    }

    /// Returns the formats of c, f0 and f.
    fn formats(&self) -> [Format; 3] {
        [(1, self.keys.cosine), (0, self.keys.reflectance), (0, self.keys.power)]
            .map(|(int, fraction)| Format::unsigned(int, fraction as i32))
    }
}

/// Returns the colours, which f multiplies.
fn products(it: &Fresnel) -> Products {
    Products::colours(it.formats()[2], it.keys.colour_bits, it.keys.output_rounding)
}

/// Returns the golden model: operands and registers, and what each microinstruction does to them.
pub fn model(config: &Config) -> Box<dyn Model> {
    let it = Arc::new(Fresnel::new(config));
    let [cosine, reflectance, powers] = it.formats();
    let mut frame = Frame::default();
    let c = frame.clamped("cos_half", cosine, 0, 1 << it.keys.cosine);
    let f0 = frame.operand("f0", reflectance);
    let (power, f) = (frame.register("power", powers), frame.register("f", powers));
    let program = vec![
        idle(),
        step_by(&it, move |it, s| s[power] = it.square(s[c])),
        step_by(&it, move |it, s| s[power] = it.fourth(s[power])),
        step_by(&it, move |it, s| s[power] = it.fifth(s[power], s[c])),
        step_by(&it, move |it, s| s[f] = it.blend(s[power], s[f0])),
    ];
    Box::new(products(&it).behind(frame, f, program))
}

/// Returns the function that the device computes, and its error bound.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let it = Fresnel::new(config);
    let [cosine, reflectance, _] = it.formats();
    let most = reflectance.max_raw() as i64;
    let operands = vec![
        control("cos_half", cosine, (0, 1 << it.keys.cosine), "cosine to the half vector"),
        control("f0", reflectance, (0, most), "reflectance head-on"),
    ];
    let products = products(&it);
    Box::new(Highlight::new(it, operands, products))
}

impl Reflectance for Fresnel {
    fn f(&self, control: &[i64]) -> i64 {
        let fifth = self.fifth(self.fourth(self.square(control[0])), control[0]);
        self.blend(fifth, control[1])
    }

    fn reference(&self, control: &[i64]) -> f64 {
        let [c, f0] = [(control[0], self.keys.cosine), (control[1], self.keys.reflectance)]
            .map(|(raw, fraction)| raw as f64 * exp2(-(fraction as i32)));
        let t = 1.0 - c;
        f0 + (1.0 - f0) * (t * t * t * t * t)
    }

    fn expressions(&self) -> Vec<String> {
        vec!["f0 + (1 - f0) * (1 - cos_half) ** 5".to_owned()]
    }

    /// Let u be the last place of u0.F, r what a rounding is off by at most (u/2 or u), and t = 1 − c,
    /// which is exact, as is 1 − f0.
    ///
    /// - The square s is off by at most u: t = 1 saturates to 1 − u. Any other t is at most 1 − u, so that
    ///   t² ≤ 1 − 2u + u² is rounded, by r ≤ u, to no more than 1 − u.
    /// - The fourth power q is off by at most 2u + r: |s² − t⁴| = |s − t²|·(s + t²) ≤ u·2; s ≤ 1 − u does
    ///   not saturate, as t above.
    /// - The fifth is off by at most 2u + 2r: |q·t − t⁵| ≤ |q − t⁴|; q·t ≤ 1 − u does not saturate.
    /// - f is off by at most 2u + 2r + u: 1 − f0 ≤ 1 adds nothing to the error of the fifth power, and
    ///   the sum is at most 1, so that rounding and saturation together move it by u at most.
    fn shares(&self) -> Vec<ErrorShare> {
        let u = exp2(-(self.keys.power as i32));
        let r = rounding_error(2 * self.keys.power, self.keys.power, self.keys.rounding);
        vec![
            ("power.fraction", "(1 - c)^2 below 1", 2.0 * u),
            ("power.rounding", "rounding of the higher powers", 2.0 * r),
            ("power.fraction", "f rounded and below 1", u),
        ]
    }
}

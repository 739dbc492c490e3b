//! The golden model and the accuracy contract of the device `dot-product`, which computes cos γ = max(0, N·H / |N|).
//!
//! N is a vector of any length, such as an interpolated normal (operands `nx`, `ny`, `nz`). H is a unit vector, such as the half
//! vector (`hx`, `hy`, `hz`). γ is the angle between N and H. With the key `two_sided` the result is |N·H| / |N|. The result is
//! at most 1, and 0 if N = 0. The device multiplies N·H by 1/√(N·N), which it interpolates in a table.

use std::sync::Arc;

use super::device::{self, Formula};
use super::frame::{Frame, idle, step, step_by};
use super::inverse_root::{Root, centred, unit_vector};
use super::narrow::{Narrow, rounding_error};
use super::{Contract, Model, Sweep, Term};
use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::Config;
use glint_keys::dot_product::Keys;

fn device(config: &Config) -> device::Device {
    let it = Arc::new(CosineFormula::new(config));
    let Keys { fraction, other, kept, .. } = it.keys;
    let mut frame = Frame::default();
    let of_normal = Format::signed(1, fraction as i32);
    let normal = ["nx", "ny", "nz"].map(|name| frame.operand(name, of_normal));
    let of_half = Format::signed(1, other as i32);
    let half = ["hx", "hy", "hz"].map(|name| frame.operand(name, of_half));
    let sum = frame.register("sum", Format::signed(4, it.keys.products() as i32));
    let squares = frame.register("squares", Format::unsigned(4, 2 * fraction as i32));
    let mantissa = frame.register("mantissa", Format::unsigned(it.root.width as i32, 0));
    let shift = frame.register("shift", Format::unsigned(it.root.pair_bits() as i32, 0));
    let distance = frame.register("distance", it.keys.distance());
    let inverse = frame.register("inverse", it.keys.shortened());
    let cosine = frame.register("cosine", Format::unsigned(1, kept as i32));
    frame.shows("cosine_out", cosine);
    let add = |axis: usize| {
        let (n, h, first) = (normal[axis], half[axis], axis == 0);
        step(move |s| {
            s[sum] = s[n] * s[h] + if first { 0 } else { s[sum] };
            s[squares] = s[n] * s[n] + if first { 0 } else { s[squares] };
        })
    };
    let device = frame.device([
        idle(),
        add(0),
        add(1),
        add(2),
        step_by(&it, move |it, s| {
            s[shift] = it.root.pairs(s[squares]);
            s[mantissa] = it.root.mantissa(s[squares], s[shift]);
        }),
        step_by(&it, move |it, s| s[distance] = it.distance(s[sum], s[shift])),
        step_by(&it, move |it, s| {
            s[inverse] = it.shortened.apply(it.root.inverse(s[mantissa]));
        }),
        step_by(&it, move |it, s| {
            s[cosine] = it.rounded.apply(s[distance] * s[inverse]).min(it.one);
        }),
        idle().valid().end(),
    ]);
    let one = 1 << other;
    ["hx", "hy", "hz"].into_iter().fold(device, |device, name| device.domain(name, -one, one))
}

pub fn model(config: &Config) -> Box<dyn Model> {
    device(config).model()
}

pub fn contract(config: &Config) -> Box<dyn Contract> {
    device(config).contract(CosineFormula::new(config))
}

/// Rounds each component to `fraction` fraction bits and returns it raw. For example, 0.5 with 4 fraction bits gives 8.
fn raw_vector(vector: [f64; 3], fraction: u32) -> [i64; 3] {
    vector.map(|component| (component * exp2(fraction as i32)).round() as i64)
}

/// The formula N·H/|N|, limited to 0 … 1, with the constants of the hardware's arithmetic.
struct CosineFormula {
    keys: Keys,
    root: Root,
    /// Rounds the shifted product N·H to the register `distance`, which holds half of the product.
    distance: Narrow,
    shortened: Narrow,
    rounded: Narrow,
    one: i64,
}

impl CosineFormula {
    fn new(config: &Config) -> Self {
        let keys = Keys::of(config);
        let wide = Format::unsigned(2, keys.kept as i32);
        Self {
            root: Root::new(keys.fraction, keys.address, keys.inverse),
            distance: Narrow::new(keys.products() + 1, keys.distance(), Rounding::Nearest),
            shortened: Narrow::new(keys.inverse, keys.shortened(), Rounding::Nearest),
            rounded: Narrow::new(2 * keys.factor - 1, wide, keys.rounding),
            one: 1 << keys.kept,
            keys,
        }
    }

    /// Returns the raw value of the register `distance`: half of N·H, shifted and rounded. The shift makes the length of N lie
    /// from 1 to 2. A negative N·H gives 0, or half of |N·H| with `two_sided`.
    fn distance(&self, sum: i64, shift: i64) -> i64 {
        self.distance.apply(if self.keys.two_sided { sum.abs() } else { sum } << shift)
    }

    /// Returns upper limits of three errors of the cosine, as values: from the inverse root, from the rounding of both factors,
    /// and from the cosine's rounding.
    ///
    /// Let m be N·N, shifted to 1 ≤ m < 4. Let f = 1/√m, and let t be N·H, shifted by half as many places. The cosine is t·f.
    ///
    /// - The hardware's f is multiplied by t, which is at most √m. `Root::error` bounds the error of √m·f. The rounding of f to
    ///   the factor adds half a unit of the factor's last place, times √m < 2.
    /// - The hardware's t is off by half a unit of its last place. A t of 2.0 is off by a whole unit, but f is a half there. f
    ///   is at most 1.
    /// - Beyond t = √m the cosine stays 1, and the computed value does not fall.
    fn errors(&self) -> [f64; 3] {
        let Keys { factor, kept, rounding, .. } = self.keys;
        let (root, place) = (self.root.error(), exp2(-(factor as i32)));
        let root = root[0] + root[1];
        [root, place * (2.0 + root + place), rounding_error(2 * factor - 1, kept, rounding)]
    }
}

impl Formula for CosineFormula {
    fn exact(&self, v: &[f64]) -> Vec<f64> {
        let unit = unit_vector([v[0], v[1], v[2]]);
        let sum: f64 = (0..3).map(|axis| unit[axis] * v[3 + axis]).sum();
        vec![if self.keys.two_sided { sum.abs() } else { sum }.clamp(0.0, 1.0)]
    }

    fn terms(&self, _output: usize) -> Vec<Term> {
        let [root, factors, rounding] = self.errors();
        let units = exp2(self.keys.kept as i32);
        let terms = [
            ("table.address", "the inverse root", root),
            ("factor.bits", "rounding of the factors", factors),
            ("output.rounding", "rounding of the cosine", rounding),
        ];
        terms.map(|(key, what, error)| Term { key, what, units: error * units }).into()
    }

    /// Returns random operands at which faults are likely to show: a normal of random length, and a unit vector. The unit vector
    /// is near the normal's direction, where highlights are, or nearly perpendicular to it, where the result begins to be
    /// clamped.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let normal = unit_vector(centred(unit));
        let off = centred(unit);
        let along: f64 = (0..3).map(|axis| normal[axis] * off[axis]).sum();
        let across = unit_vector([0, 1, 2].map(|axis| off[axis] - along * normal[axis]));
        // `small` is about the angle between `half` and its target, drawn evenly over octaves. The target is `normal` if `near`,
        // otherwise `across`.
        let (near, small) = (unit() < 0.5, exp2(-(unit() * f64::from(self.keys.fraction)) as i32));
        let half = [0, 1, 2].map(|axis| {
            if near {
                normal[axis] + small * across[axis]
            } else {
                across[axis] + small * off[axis]
            }
        });
        let Keys { fraction, other, .. } = self.keys;
        let length = exp2(1) * libm::exp2(-unit() * f64::from(fraction));
        let normal = raw_vector(normal.map(|it| length * it), fraction);
        let half = raw_vector(unit_vector(half), other);
        Some([normal, half].concat())
    }

    /// Visits every sum of squares N·N from 1 on, because N·N alone determines the inverse root.
    fn sweep(&self) -> Option<Sweep> {
        Some(self.root.sweep())
    }

    /// Returns an upper limit of the error, in units, for the sum of squares `place`. It is the actual error of the inverse root
    /// there, plus the largest possible errors of the factors and of the rounding.
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let [_, factors, rounding] = self.errors();
        let error = self.root.relative_error(place[0]) + factors + rounding;
        Some(error * exp2(self.keys.kept as i32))
    }
}

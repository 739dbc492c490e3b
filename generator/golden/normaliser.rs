//! The golden model and the accuracy contract of the device `normaliser`, which computes the unit vector v/|v| of a vector v.
//!
//! v has any length and the components `x`, `y`, `z`. The table of 1/√s covers two octaves of s, so the device first shifts v to
//! the left until s = v·v lies in these octaves. It interpolates 1/√s, and multiplies each shifted component by 1/√s. For
//! example, v = (0, 0, 0.5) gives (0, 0, 1). The zero vector gives the zero vector.

use std::sync::Arc;

use super::device::{self, Formula};
use super::frame::{Frame, Slot, idle, step, step_by};
use super::inverse_root::{Root, unit_vector};
use super::narrow::{Narrow, rounding_error};
use super::{Contract, Model, Sweep, Term};
use glint_base::fixed::{Format, exp2};
use glint_config::Config;
use glint_keys::normaliser::Keys;

struct Normaliser {
    keys: Keys,
    root: Root,
    /// Rounds a shifted component times the inverse root to a component of the unit vector.
    rounded: Narrow,
}

impl Normaliser {
    fn new(config: &Config) -> Self {
        let keys = Keys::of(config);
        let Keys { fraction, address, inverse, kept, rounding } = keys;
        Self {
            root: Root::new(fraction, address, inverse),
            rounded: Narrow::new(fraction + 1 + inverse, Format::signed(1, kept as i32), rounding),
            keys,
        }
    }

    fn vector(&self) -> Format {
        Format::signed(1, self.keys.fraction as i32)
    }

    fn result(&self) -> Format {
        Format::signed(1, self.keys.kept as i32)
    }

    /// Returns a raw component of the unit vector: `component`, shifted left by `pairs` places, times `inverse`, rounded.
    /// `inverse` is the inverse root of the shifted v·v.
    fn scaled(&self, component: i64, pairs: i64, inverse: i64) -> i64 {
        let shifted = if component == 0 { 0 } else { component << pairs };
        self.rounded.apply(shifted * inverse)
    }

    /// Returns an upper limit of the error, as a value, that the rounding of a result causes.
    fn rounding_error(&self) -> f64 {
        let Keys { fraction, inverse, kept, rounding, .. } = self.keys;
        rounding_error(fraction + 1 + inverse, kept, rounding)
    }
}

fn device(config: &Config) -> device::Device {
    let it = Arc::new(Normaliser::new(config));
    let mut frame = Frame::default();
    let components = ["x", "y", "z"].map(|name| frame.operand(name, it.vector()));
    let sum = frame.register("sum", Format::unsigned(4, 2 * it.keys.fraction as i32));
    let mantissa = frame.register("mantissa", Format::unsigned(it.root.width as i32, 0));
    let shift = frame.register("shift", Format::unsigned(it.root.pair_bits() as i32, 0));
    let inverse = frame.register("inverse", Format::unsigned(1, it.keys.inverse as i32));
    let units = ["unit_x", "unit_y", "unit_z"].map(|name| {
        let unit = frame.register(name, it.result());
        frame.shows(&format!("{name}_out"), unit);
        unit
    });
    let square =
        |first: bool, x: Slot| step(move |s| s[sum] = s[x] * s[x] + if first { 0 } else { s[sum] });
    let scale = |x: Slot, unit: Slot| {
        step_by(&it, move |it, s| s[unit] = it.scaled(s[x], s[shift], s[inverse]))
    };
    let [x, y, z] = components;
    frame.device([
        idle(),
        square(true, x),
        square(false, y),
        square(false, z),
        step_by(&it, move |it, s| {
            s[shift] = it.root.pairs(s[sum]);
            s[mantissa] = it.root.mantissa(s[sum], s[shift]);
        }),
        // The hardware reads the table in this microinstruction; no predicted register changes.
        idle(),
        step_by(&it, move |it, s| s[inverse] = it.root.inverse(s[mantissa])),
        scale(x, units[0]),
        scale(y, units[1]),
        scale(z, units[2]),
        idle().valid().end(),
    ])
}

pub fn model(config: &Config) -> Box<dyn Model> {
    device(config).model()
}

pub fn contract(config: &Config) -> Box<dyn Contract> {
    device(config).contract(Normaliser::new(config))
}

impl Formula for Normaliser {
    fn exact(&self, vector: &[f64]) -> Vec<f64> {
        unit_vector([vector[0], vector[1], vector[2]]).into()
    }

    /// Derives the terms of the error bound of a component, in units. Let m be the mantissa of v·v, r the table's value of
    /// 1/√m, and x the shifted component. Since x² ≤ m, an error of r changes the product x·r by at most √m times that error;
    /// [`Root::error`] bounds it. The product is rounded once. It does not saturate, because |x|/√m ≤ 1 and the other errors
    /// are far below 1.
    fn terms(&self, _output: usize) -> Vec<Term> {
        let [chord, root] = self.root.error();
        let units = exp2(self.keys.kept as i32);
        let terms = [
            ("table.address", "straight segments for the inverse root", chord),
            ("inverse.fraction", "rounding of the inverse root", root),
            ("output.rounding", "rounding of the results", self.rounding_error()),
        ];
        terms.map(|(key, what, error)| Term { key, what, units: error * units }).into()
    }

    /// Returns a vector in a random direction. Its length is drawn evenly over octaves, because the shift depends on the
    /// octave.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let most = exp2(1 + self.keys.fraction as i32)
            * libm::exp2(-unit() * f64::from(self.keys.fraction));
        Some((0..3).map(|_| ((2.0 * unit() - 1.0) * most).round() as i64).collect())
    }

    /// Visits every sum of squares from 1 on. The sum determines the inverse root, and so the largest error of a component.
    fn sweep(&self) -> Option<Sweep> {
        Some(self.root.sweep())
    }

    /// Returns an upper limit of the error, in units, for the sum of squares `place`. It is the inverse root's error, plus the
    /// rounding's error, for a component as long as the vector.
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let error = self.root.relative_error(place[0]) + self.rounding_error();
        Some(error * exp2(self.keys.kept as i32))
    }
}

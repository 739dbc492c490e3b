//! The golden model and the contract, from the formula.

use std::sync::Arc;

use super::device::{self, Formula};
use super::dot_product::unit_vector;
use super::frame::{Frame, Slot, idle, step, step_by};
use super::narrow::{Narrow, rounding_error};
use super::{Contract, Model, Sweep, Term};
use glint_base::fixed::{Format, exp2, mask};
use glint_config::Config;
use glint_keys::normaliser::Keys;

/// The most that the sum of squares can be: each component is at least −2.0.
const FARTHEST: i64 = 12;

/// The inverse root of a sum of three squares, by a table.
pub(super) struct Root {
    /// Bits of the sum.
    pub width: u32,
    address: u32,
    fraction: u32,
    /// 1/√m at the ends of the segments, from m = 1.0 on, raw.
    ends: Vec<i64>,
}

impl Root {
    /// Of components with so many fraction bits: the leading bits of the sum that choose a segment, and fraction bits of
    /// an inverse root.
    pub fn new(components: u32, address: u32, fraction: u32) -> Self {
        let segments = 1i64 << address;
        let scale = exp2(fraction as i32);
        // m goes from 1.0 to 4.0 in steps of 4.0/segments.
        let end =
            |at: i64| (scale / (at as f64 * (4.0 / segments as f64)).sqrt() + 0.5).floor() as i64;
        let ends = (segments / 4..=segments).map(end).collect();
        Self { width: 2 * components + 4, address, fraction, ends }
    }

    /// Pairs of leading zeros, as many as the shifter counts.
    pub fn pairs(&self, sum: i64) -> i64 {
        match sum {
            0 => (1 << self.pair_bits()) - 1,
            _ => i64::from((self.width - 1 - sum.ilog2()) / 2),
        }
    }

    /// Bits of that count.
    pub fn pair_bits(&self) -> u32 {
        (self.width - 1).ilog2()
    }

    /// The sum shifted by so many pairs.
    pub fn mantissa(&self, sum: i64, pairs: i64) -> i64 {
        if sum == 0 { 0 } else { sum << (2 * pairs) }
    }

    /// 1/√m by the chord of the segment.
    pub fn inverse(&self, mantissa: i64) -> i64 {
        if mantissa == 0 {
            return 0;
        }
        let below = self.width - self.address;
        let at = ((mantissa >> below) - (1 << (self.address - 2))) as usize;
        let along = below.min(self.fraction - self.address + 2);
        let rest = (mantissa >> (below - along)) & mask(along) as i64;
        self.ends[at] - (((self.ends[at] - self.ends[at + 1]) * rest) >> along)
    }

    /// The errors of √m·f by the chords and by roundings, as values. Let m be the mantissa, 1 ≤ m < 4, f = 1/√m and r what
    /// stands for it, u the last place of r.
    ///
    /// - f is convex, so that a chord lies above it, by at most h²/8·max f″ = h²/8·¾·a^(−5/2) in the segment from
    ///   a on, of length h.
    /// - The ends of the chord are rounded: ½u. What is cut of the way along the segment is at most a part
    ///   2^−(R − A + 2) of a fall of at most h/2 = 2^(1 − A): ½u. The fall is truncated: u. In all 2u.
    /// - That counts √m times, which is below 2: 4u for the rounding, and the chord's times the root of the end of the segment.
    pub fn error(&self) -> [f64; 2] {
        let h = 4.0 / exp2(self.address as i32);
        let chord = (1 << (self.address - 2)..1u32 << self.address)
            .map(|at| {
                let a = f64::from(at) * h;
                h * h / 8.0 * 0.75 * libm::pow(a, -2.5) * (a + h).sqrt()
            })
            .fold(0.0, f64::max);
        [chord, 4.0 * exp2(-(self.fraction as i32))]
    }

    /// Every sum of squares, which determines the inverse root.
    pub fn sweep(&self) -> Sweep {
        Sweep::ranges([("sum of squares", (1, FARTHEST << (self.width - 4)))])
    }

    /// √m·r − 1 of a sum of squares.
    pub fn relative_error(&self, sum: i64) -> f64 {
        let mantissa = self.mantissa(sum, self.pairs(sum));
        let root = (mantissa as f64 * exp2(2 - self.width as i32)).sqrt();
        (self.inverse(mantissa) as f64 * exp2(-(self.fraction as i32)) * root - 1.0).abs()
    }
}

struct Normaliser {
    keys: Keys,
    root: Root,
    /// To a result, from a shifted component times an inverse root.
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

    /// A component of the unit vector.
    fn scaled(&self, component: i64, pairs: i64, inverse: i64) -> i64 {
        let shifted = if component == 0 { 0 } else { component << pairs };
        self.rounded.apply(shifted * inverse)
    }

    /// What the rounding of a result leaves, as a value.
    fn rounding_error(&self) -> f64 {
        let Keys { fraction, inverse, kept, rounding, .. } = self.keys;
        rounding_error(fraction + 1 + inverse, kept, rounding)
    }
}

/// The operations of each microinstruction.
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
        // The table reads.
        idle(),
        step_by(&it, move |it, s| s[inverse] = it.root.inverse(s[mantissa])),
        scale(x, units[0]),
        scale(y, units[1]),
        scale(z, units[2]),
        idle().valid().end(),
    ])
}

/// The golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    device(config).model()
}

/// The function that the device computes, and its error bound.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    device(config).contract(Normaliser::new(config))
}

impl Formula for Normaliser {
    fn exact(&self, vector: &[f64]) -> Vec<f64> {
        unit_vector([vector[0], vector[1], vector[2]]).into()
    }

    /// The shifted component x has x² ≤ m, so that the error of the product is at most √m times that of r: [`Root::error`]. The
    /// product is rounded once. It does not saturate: |x·f| ≤ 1, and the rest is far below 1.
    ///
    /// The zero vector has zeros, as the formula has it here.
    fn terms(&self) -> Vec<Term> {
        let [chord, root] = self.root.error();
        let units = exp2(self.keys.kept as i32);
        let term = |key, what, error| Term { key, what, units: error * units };
        vec![
            term("table.address", "straight segments for the inverse root", chord),
            term("inverse.fraction", "rounding of the inverse root", root),
            term("output.rounding", "rounding of the results", self.rounding_error()),
        ]
    }

    /// Vectors of any length, each octave as often as any other: the shift goes by the length.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let most = exp2(1 + self.keys.fraction as i32)
            * libm::exp2(-unit() * f64::from(self.keys.fraction));
        Some((0..3).map(|_| ((2.0 * unit() - 1.0) * most).round() as i64).collect())
    }

    /// The sum of squares determines the inverse root, and the largest error of any component with it.
    fn sweep(&self) -> Option<Sweep> {
        Some(self.root.sweep())
    }

    /// Returns the error of a component as long as the vector: that before it is rounded, and the rounding.
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let error = self.root.relative_error(place[0]) + self.rounding_error();
        Some(error * exp2(self.keys.kept as i32))
    }
}

//! The golden model and the contract, from the formula.

use super::device::{self, Formula};
use super::frame::{Frame, idle, step};
use super::narrow::{Narrow, rounding_error};
use super::{Contract, Model, Sweep, Term};
use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::Config;
use glint_keys::dot_product::Keys;

/// A sum of products to a cosine of 0 ... 1.
#[derive(Clone, Copy)]
struct Limited {
    rounded: Narrow,
    one: i64,
}

impl Limited {
    fn apply(self, sum: i64) -> i64 {
        self.rounded.apply(sum).min(self.one)
    }
}

/// The operations of each microinstruction.
fn device(config: &Config) -> device::Device {
    let Cosine { keys, limited } = Cosine::new(config);
    let [fraction, other, kept] = [keys.fraction, keys.other, keys.kept].map(|bits| bits as i32);
    let mut frame = Frame::default();
    let mut component = |name, fraction: i32| {
        frame.clamped(name, Format::signed(1, fraction), -(1 << fraction), 1 << fraction)
    };
    let [nx, ny, nz] = ["nx", "ny", "nz"].map(|name| component(name, fraction));
    let [hx, hy, hz] = ["hx", "hy", "hz"].map(|name| component(name, other));
    let sum = frame.register("sum", Format::signed(2, fraction + other));
    let cosine = frame.register("cosine", Format::unsigned(1, kept));
    frame.shows("cosine_out", cosine);
    frame.device([
        idle(),
        step(move |s| s[sum] = s[nx] * s[hx]),
        step(move |s| s[sum] += s[ny] * s[hy]),
        step(move |s| s[sum] += s[nz] * s[hz]),
        step(move |s| s[cosine] = limited.apply(s[sum])),
        idle().valid().end(),
    ])
}

/// The golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    device(config).model()
}

/// The function that the device computes, and its error bound.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    device(config).contract(Cosine::new(config))
}

/// The formula: max(0, N.H), and at most 1.
struct Cosine {
    keys: Keys,
    limited: Limited,
}

impl Cosine {
    fn new(config: &Config) -> Self {
        let keys = Keys::of(config);
        let wide = Format::unsigned(2, keys.kept as i32);
        let rounded = Narrow::new(keys.products(), wide, keys.rounding);
        Self { limited: Limited { rounded, one: 1 << keys.kept }, keys }
    }
}

/// The unit vector of a direction; the zero vector stays.
pub(super) fn unit_vector(vector: [f64; 3]) -> [f64; 3] {
    let now = vector.map(|it| it * it).iter().sum::<f64>().sqrt();
    vector.map(|it| if now == 0.0 { 0.0 } else { it / now })
}

impl Formula for Cosine {
    fn exact(&self, v: &[f64]) -> Vec<f64> {
        // A component beyond 1 or -1 is taken for that.
        let at = |place: usize| v[place].clamp(-1.0, 1.0);
        let sum: f64 = (0..3).map(|axis| at(axis) * at(3 + axis)).sum();
        vec![sum.clamp(0.0, 1.0)]
    }

    /// Components within their domain; `certify` holds the hardware against this.
    fn expressions(&self) -> Vec<String> {
        vec!["max(0, min(1, nx * hx + ny * hy + nz * hz))".to_owned()]
    }

    /// The products and their sum are exact, and rounded once. To clamp to 0 … 1 brings two values no further
    /// apart, and both ends are values of the output, so that the rest of the way changes nothing.
    fn terms(&self) -> Vec<Term> {
        let error = rounding_error(self.keys.products(), self.keys.kept, self.keys.rounding);
        let units = match self.keys.rounding {
            // What is cut has at least the last place of a product, which it keeps below a whole unit.
            Rounding::Truncate => {
                error * exp2(self.keys.kept as i32)
                    - exp2(self.keys.kept as i32 - self.keys.products() as i32)
            }
            Rounding::Nearest => error * exp2(self.keys.kept as i32),
        };
        let what = "rounding of the cosine";
        vec![Term { key: "output.rounding", what, units: units.max(0.0) }]
    }

    /// A unit vector, and another close to it, or close to a right angle with it: highlights are near a product of 1,
    /// and at 0 the result begins to be clamped.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let mut centred = || [(); 3].map(|()| 2.0 * unit() - 1.0);
        let normal = unit_vector(centred());
        let off = centred();
        let along: f64 = (0..3).map(|axis| normal[axis] * off[axis]).sum();
        let across = unit_vector([0, 1, 2].map(|axis| off[axis] - along * normal[axis]));
        // The smaller of the two angles between them and what they are close to, by octaves.
        let (near, small) = (unit() < 0.5, exp2(-(unit() * f64::from(self.keys.fraction)) as i32));
        let half = [0, 1, 2].map(|axis| {
            if near {
                normal[axis] + small * across[axis]
            } else {
                across[axis] + small * off[axis]
            }
        });
        let raw = |vector: [f64; 3], fraction: u32| {
            vector.map(|component| (component * exp2(fraction as i32)).round() as i64)
        };
        let Keys { fraction, other, .. } = self.keys;
        Some([raw(normal, fraction), raw(unit_vector(half), other)].concat())
    }

    /// The sum determines the result.
    fn sweep(&self) -> Option<Sweep> {
        let most = 3 << self.keys.products();
        Some(Sweep::ranges([("sum of the products", (-most, most))]))
    }

    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let exact = place[0] as f64 * exp2(self.keys.kept as i32 - self.keys.products() as i32);
        let one = exp2(self.keys.kept as i32);
        Some((self.limited.apply(place[0]) as f64 - exact.clamp(0.0, one)).abs())
    }
}

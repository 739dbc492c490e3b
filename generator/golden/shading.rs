//! `shading`: ambient, diffuse and specular light of a normal of any length, from the models of its parts.

use super::device::{self, Formula};
use super::frame::{Frame, Slot, State};
use super::inverse_root::unit_vector;
use super::narrow::Narrow;
use super::{
    Axis, Contract, Model, Sweep, Term, Values, blinn, cosine_power, dot_product, formulas, schlick,
};
use glint_base::fixed::{Rounding, exp2};
use glint_config::Config;
use glint_keys::shading::{Highlight, Keys, Parts};

/// The parts, one after the other, and the sum behind them.
fn device(keys: &Keys, parts: &Parts) -> device::Device {
    let mut frame = Frame::default();
    let normal = ["nx", "ny", "nz"].map(|name| frame.operand(name, keys.normal_format()));
    let mut vector = |names: [&str; 3]| names.map(|it| frame.operand(it, keys.light_format()));
    let [light, half] = [["lx", "ly", "lz"], ["hx", "hy", "hz"]].map(&mut vector);
    let exponent = frame.operand("exponent", keys.exponent_format());
    let [ambient, diffuse, specular] = ["ambient", "diffuse", "specular"].map(|kind| {
        ["red", "green", "blue"]
            .map(|it| frame.operand(&format!("{kind}_{it}"), keys.colour_format()))
    });

    /// An operand of a part: a value so many places to the left.
    fn left(
        (name, slot, places): (&'static str, Slot, u32),
    ) -> (&'static str, impl Fn(&State) -> i64 + Send + Sync) {
        (name, move |s: &State| s[slot] << places)
    }
    let [nx, ny, nz] = normal;
    let mut cosine = |name: &str, config: &Config, [x, y, z]: [Slot; 3]| {
        let given = [("nx", nx), ("ny", ny), ("nz", nz), ("hx", x), ("hy", y), ("hz", z)];
        let given = given.map(|(name, slot)| left((name, slot, 0)));
        frame.part(name, &*dot_product::model(config), given).out("cosine_out")
    };
    let facing = cosine("diffuse_cosine", &parts.facing, light);
    let cos_gamma = cosine("specular_cosine", &parts.cosine, half);
    let [red, green, blue] = specular.map(|slot| (slot, keys.guard()));
    let given = [
        ("cos_gamma", cos_gamma, 0),
        ("exponent", exponent, 0),
        ("red", red.0, red.1),
        ("green", green.0, green.1),
        ("blue", blue.0, blue.1),
    ];
    let highlight =
        frame.part("highlight", &*(part(keys).model)(&parts.highlight), given.map(left));

    let places = keys.facing();
    let sum = Narrow::new(places, keys.colour_format(), Rounding::Nearest);
    let guarded = places - keys.guard();
    for (at, name) in ["red_out", "green_out", "blue_out"].into_iter().enumerate() {
        let (ambient, diffuse, shine) = (ambient[at], diffuse[at], highlight.out(name));
        frame.output(name, keys.colour_format(), move |s| {
            sum.apply((s[ambient] << places) + s[diffuse] * s[facing] + (s[shine] << guarded))
        });
    }
    let device = frame.dataflow().domain("exponent", keys.least(), keys.most);
    let one = 1 << keys.light;
    let vectors = ["lx", "ly", "lz", "hx", "hy", "hz"].into_iter();
    vectors.fold(device, |device, name| device.domain(name, -one, one))
}

/// The golden side of a highlight: model, contract, and its formula of cosine and n.
struct Part {
    model: fn(&Config) -> Box<dyn Model>,
    contract: fn(&Config) -> Box<dyn Contract>,
    formula: fn(f64, f64) -> f64,
}

fn part(keys: &Keys) -> Part {
    match keys.highlight {
        Highlight::CosinePower => Part {
            model: cosine_power::model,
            contract: cosine_power::contract,
            formula: |c, n| formulas::cosine_power(c, n, 16),
        },
        Highlight::Blinn => {
            Part { model: blinn::model, contract: blinn::contract, formula: formulas::blinn }
        }
        Highlight::Schlick => {
            Part { model: schlick::model, contract: schlick::contract, formula: formulas::schlick }
        }
    }
}

fn parts(keys: &Keys) -> Parts {
    keys.parts().unwrap_or_else(|(part, _)| panic!("`{part}` is checked"))
}

/// The golden model.
///
/// # Panics
/// If the check of the schema has not accepted the configuration.
pub fn model(config: &Config) -> Box<dyn Model> {
    let keys = Keys::of(config);
    device(&keys, &parts(&keys)).model()
}

/// The accuracy contract.
///
/// # Panics
/// As [`model`].
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let keys = Keys::of(config);
    let parts = parts(&keys);
    let device = device(&keys, &parts);
    let highlight = (part(&keys).contract)(&parts.highlight);
    let errors = Errors {
        facing: error(&*dot_product::contract(&parts.facing)),
        cosine: error(&*dot_product::contract(&parts.cosine)),
        highlight: error(&*highlight) * exp2(-(keys.guard() as i32)),
        slope: highlight.highlight().and_then(|it| it.slope()),
    };
    device.contract(Shading { formula: part(&keys).formula, errors, keys })
}

/// The proved bound of a part, as a value.
fn error(contract: &dyn Contract) -> f64 {
    contract.bound().units * exp2(-contract.outputs()[0].format.frac)
}

/// The proved errors of the parts.
struct Errors {
    /// The error of the cosine between normal and light.
    facing: f64,
    /// The error of the cosine between normal and half vector.
    cosine: f64,
    /// The error of a colour's highlight, in units of a result.
    highlight: f64,
    /// The largest slope of the highlight's formula over the cosine.
    slope: Option<f64>,
}

/// The formula.
struct Shading {
    keys: Keys,
    formula: fn(f64, f64) -> f64,
    errors: Errors,
}

impl Formula for Shading {
    fn exact(&self, v: &[f64]) -> Vec<f64> {
        let unit = unit_vector([v[0], v[1], v[2]]);
        let cosine = |at: usize| {
            let products = (0..3).map(|axis| unit[axis] * v[at + axis]);
            products.sum::<f64>().clamp(0.0, 1.0)
        };
        let (facing, f) = (cosine(3), (self.formula)(cosine(6), v[9]));
        let most = exp2(self.keys.colour_bits as i32) - 1.0;
        let colour = |at: usize| (v[10 + at] + v[13 + at] * facing + v[16 + at] * f).min(most);
        (0..3).map(colour).collect()
    }

    /// An error of an operand of a part grows by the part's slope in it, and the part adds its own.
    ///
    /// - A colour is diffuse·cosine + specular·f(cosine), saturated: its slopes are at most the largest colour, and that times
    ///   the slope of f.
    fn terms(&self) -> Vec<Term> {
        let Errors { facing, cosine, highlight, slope } = self.errors;
        let Some(slope) = slope else { return Vec::new() };
        let colour = exp2(self.keys.colour_bits as i32) - 1.0;
        let term = |key, what, units| Term { key, what, units };
        vec![
            term("colour.bits", "the cosine of the light, through the colour", facing * colour),
            term(
                "cosine.fraction",
                "the cosine of the highlight, through the colour",
                cosine * slope * colour,
            ),
            term("highlight", "the highlight", highlight),
            term("colour.bits", "rounding of the results", 0.5),
        ]
    }

    /// A light anywhere, a half vector as near to the normal as the exponent asks for, and dull colours, whose sum does not saturate.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let Keys { normal, light, colour_bits, most, .. } = self.keys;
        let mut centred = || [(); 3].map(|()| 2.0 * unit() - 1.0);
        let direction = unit_vector(centred());
        let [to_light, off] = [unit_vector(centred()), centred()];
        let n = self.keys.least() as f64 + unit() * (most - self.keys.least()) as f64;
        let (length, away) = (0.25 + 1.5 * unit(), unit() * 2.0 / n.sqrt());
        let half = unit_vector([0, 1, 2].map(|axis| direction[axis] + away * off[axis]));
        let raw = |value: f64, fraction: u32| (value * exp2(fraction as i32)).round() as i64;
        let mut operands: Vec<i64> = direction.map(|it| raw(it * length, normal)).into();
        operands.extend([to_light, half].concat().into_iter().map(|it| raw(it, light)));
        operands.push(n.round() as i64);
        let third = exp2(colour_bits as i32) / 3.0;
        operands.extend((0..9).map(|_| (unit() * third) as i64));
        Some(operands)
    }

    /// Normals of one plane under one light, which the viewer is at, with four exponents.
    fn sweep(&self) -> Option<Sweep> {
        let Keys { normal, light, colour_bits, most, .. } = self.keys;
        let (one, to_light, white) = (1 << normal, 1 << light, (1 << colour_bits) - 1);
        let vectors = [("ny", 0), ("nz", one / 2)].into_iter();
        let lights =
            [("lx", 0), ("ly", 0), ("lz", to_light), ("hx", 0), ("hy", 0), ("hz", to_light)];
        let fixed = |(name, value): (&str, i64)| Axis {
            name: name.to_owned(),
            values: Values::List(vec![value]),
        };
        let material = [("ambient", white / 8), ("diffuse", white / 2), ("specular", white / 3)];
        let material = material.into_iter().flat_map(|(kind, value)| {
            ["red", "green", "blue"].map(|colour| fixed((&format!("{kind}_{colour}"), value)))
        });
        let exponents = Values::List([8, 4, 2, 1].map(|part| (most / part).max(16)).into());
        let mut axes = vec![Axis { name: "nx".to_owned(), values: Values::Range(-one, one) }];
        axes.extend(vectors.chain(lights).map(fixed));
        axes.push(Axis { name: "exponent".to_owned(), values: exponents });
        axes.extend(material);
        Some(Sweep {
            axes,
            omits: "normals out of one plane, other lights and materials".to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bound;
    use glint_config::Value;
    use glint_keys::shading::schema;

    /// The largest error with a cosine of 12 fraction bits is beyond the bound that a part with a false claim would give, and within
    /// the one that it gives.
    #[test]
    fn the_bound_of_the_whole_falls_with_that_of_a_part() {
        let keys = [("cosine.fraction", 12), ("domain.exponent_max", 1000)];
        let keys = keys.map(|(key, value)| (key.to_owned(), Value::Integer(value)));
        let config = Config::from_values(&schema(), "coarse", keys.into()).expect("sound keys");
        let (keys, whole) = (Keys::of(&config), contract(&config));
        let errors = Errors { facing: 2e-7, cosine: 2e-7, highlight: 0.1, slope: Some(1000.0) };
        let claimed = Shading { formula: part(&keys).formula, errors, keys };
        let claimed = Bound::of(claimed.terms()).units;
        // A linear congruential generator.
        let mut at = 1u64;
        let mut unit = || {
            at = at.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (at >> 11) as f64 * exp2(-53)
        };
        let points =
            (0..4000).map(|_| whole.largest_error(&whole.hint(&mut unit).expect("a point")));
        let worst = points.fold(0.0, f64::max);
        assert!(worst > claimed && worst < whole.bound().units, "{claimed} {worst}");
    }
}

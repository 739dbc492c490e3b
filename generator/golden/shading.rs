//! The golden model and the accuracy contract of the device `shading`, which computes a colour as
//! ambient + Σ (diffuse·cos α + specular·f(cos γ)).
//!
//! The sum runs over the lights. α is the angle between the surface normal and the direction of a light, γ the angle between the
//! normal and the half vector of the light; f is the highlight's formula, for example cⁿ with c = cos γ. `shading` consists of
//! other devices, called its parts: for each light two `dot-product` devices compute the cosines from a normal of any length, and
//! a highlight device such as `blinn` or `function` computes f. The golden model runs the golden models of the parts and adds
//! their light. The contract combines the proved error bounds of the parts.

use std::sync::Arc;

use super::contract::{self, COSINE};
use super::device::{self, Formula};
use super::frame::{Frame, Slot, State};
use super::highlight::Variation;
use super::inverse_root::unit_vector;
use super::narrow::Narrow;
use super::{
    Axis, Contract, Model, Sweep, Term, Values, blinn, cosine_power, dot_product, function, gauss,
    quadratic, schlick, threshold,
};
use glint_base::fixed::{Rounding, exp2};
use glint_config::Config;
use glint_formula::{Kind, parse};
use glint_keys::shading::{HighlightDevice, Keys, PartConfigs};

/// Returns the device: the parts of each light, one after the other, followed by the sum of ambient, diffuse and specular light.
fn device(keys: &Keys, parts: &PartConfigs) -> device::Device {
    let mut frame = Frame::default();
    let mut vector = |name: &str, suffix: &str, format| {
        ["x", "y", "z"].map(|axis| frame.operand(&format!("{name}{axis}{suffix}"), format))
    };
    let normal = vector("n", "", keys.normal_format());
    let of_light = |suffix| ["l", "h"].map(|name| vector(name, suffix, keys.light_format()));
    let lights: Vec<[[Slot; 3]; 2]> = keys.suffixes().map(of_light).collect();
    let exponent = keys.has_exponent().then(|| frame.operand("exponent", keys.exponent_format()));
    let [ambient, diffuse, specular] = ["ambient", "diffuse", "specular"].map(|kind| {
        ["red", "green", "blue"]
            .map(|it| frame.operand(&format!("{kind}_{it}"), keys.colour_format()))
    });

    /// Returns an operand of a part: a value so many places to the left.
    fn left(
        (name, slot, places): (&'static str, Slot, u32),
    ) -> (&'static str, impl Fn(&State) -> i64 + Send + Sync) {
        (name, move |s: &State| s[slot] << places)
    }
    let [nx, ny, nz] = normal;
    let cosine = |frame: &mut Frame, name: &str, config: &Config, [x, y, z]: [Slot; 3]| {
        let given = [("nx", nx), ("ny", ny), ("nz", nz), ("hx", x), ("hy", y), ("hz", z)];
        let given = given.map(|(name, slot)| left((name, slot, 0)));
        frame.part(name, &*dot_product::model(config), given).out("cosine_out")
    };
    let (mut facing, mut shine) = (Vec::new(), Vec::new());
    for (suffix, [light, half]) in keys.suffixes().zip(lights) {
        facing.push(cosine(&mut frame, &format!("diffuse_cosine{suffix}"), &parts.facing, light));
        let name = format!("specular_cosine{suffix}");
        let cos_gamma = cosine(&mut frame, &name, &parts.cosine, half);
        let (model, name) = ((part(keys).model)(&parts.highlight), format!("highlight{suffix}"));
        let Some(exponent) = exponent else {
            let part = frame.part(&name, &*model, [left(("x", cos_gamma, 0))]);
            shine.push([part.out("result_out"); 3]);
            continue;
        };
        let colours = ["red", "green", "blue"].into_iter().zip(specular);
        let colours = colours.map(|(name, slot)| (name, slot, keys.guard()));
        let given = [("cos_gamma", cos_gamma, 0), ("exponent", exponent, 0)];
        let part = frame.part(&name, &*model, given.into_iter().chain(colours).map(left));
        shine.push(["red_out", "green_out", "blue_out"].map(|it| part.out(it)));
    }

    let function = (!keys.has_exponent()).then(|| function::contract(&parts.highlight));
    let of_f = function.map_or(0, |it| it.outputs()[0].format.frac as u32);
    let places = keys.facing().max(of_f);
    let sum = Narrow::new(places, keys.colour_format(), Rounding::Nearest);
    let (to_light, is_formula) = (places - keys.facing(), !keys.has_exponent());
    let to_shine = places - if is_formula { of_f } else { keys.guard() };
    let facing = Arc::new(facing);
    for (at, name) in ["red_out", "green_out", "blue_out"].into_iter().enumerate() {
        let (ambient, diffuse, specular) = (ambient[at], diffuse[at], specular[at]);
        let (facing, shine) = (facing.clone(), shine.iter().map(|it| it[at]).collect::<Vec<_>>());
        frame.output(name, keys.colour_format(), move |s| {
            let facing: i64 = facing.iter().map(|it| s[*it]).sum();
            let shine: i64 = shine.iter().map(|it| s[*it]).sum();
            let shine = if is_formula { shine * s[specular] } else { shine };
            let matt = s[diffuse] * facing;
            sum.apply((s[ambient] << places) + (matt << to_light) + (shine << to_shine))
        });
    }
    let mut device = frame.dataflow();
    if keys.has_exponent() {
        device = device.domain("exponent", keys.least(), keys.most);
    }
    let one = 1 << keys.light;
    for suffix in keys.suffixes() {
        for name in ["lx", "ly", "lz", "hx", "hy", "hz"] {
            device = device.domain(&format!("{name}{suffix}"), -one, one);
        }
    }
    device
}

/// The golden side of a highlight.
struct HighlightModels {
    model: fn(&Config) -> Box<dyn Model>,
    contract: fn(&Config) -> Box<dyn Contract>,
}

fn part(keys: &Keys) -> HighlightModels {
    macro_rules! part {
        ($of:ident) => {
            HighlightModels { model: $of::model, contract: $of::contract }
        };
    }
    match keys.highlight {
        HighlightDevice::CosinePower => part!(cosine_power),
        HighlightDevice::Blinn => part!(blinn),
        HighlightDevice::Schlick => part!(schlick),
        HighlightDevice::Gauss => part!(gauss),
        HighlightDevice::Quadratic => part!(quadratic),
        HighlightDevice::Threshold => part!(threshold),
        HighlightDevice::Function => part!(function),
    }
}

fn parts(keys: &Keys) -> PartConfigs {
    keys.parts().unwrap_or_else(|(part, _)| panic!("`{part}` is checked"))
}

/// Returns the golden model of the device `shading` for a configuration.
///
/// # Panics
/// Panics if the check of the schema has not accepted the configuration. The caller must check it first.
pub fn model(config: &Config) -> Box<dyn Model> {
    let keys = Keys::of(config);
    device(&keys, &parts(&keys)).model()
}

/// Returns the accuracy contract of the device `shading` for a configuration.
///
/// # Panics
/// Panics as [`model`] does.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let keys = Keys::of(config);
    let parts = parts(&keys);
    let device = device(&keys, &parts);
    let highlight = (part(&keys).contract)(&parts.highlight);
    let colour = exp2(keys.colour_bits as i32) - 1.0;
    let errors = PartErrors {
        facing: error(&*dot_product::contract(&parts.facing)),
        cosine: error(&*dot_product::contract(&parts.cosine)),
        highlight: match keys.has_exponent() {
            true => error(&*highlight) * exp2(-(keys.guard() as i32)),
            false => error(&*highlight) * colour,
        },
        variation: match highlight.highlight() {
            Some(highlight) => highlight.variation(),
            None => function::slope(&parts.highlight).map(|slope| Variation { slope, jump: 0.0 }),
        },
    };
    device.contract(Shading { highlight, errors, keys })
}

/// Returns the proved bound of a part, as a value.
fn error(contract: &dyn Contract) -> f64 {
    contract.bound().units * exp2(-contract.outputs()[0].format.frac)
}

/// The proved errors of the parts.
struct PartErrors {
    /// The error bound of the cosine between normal and light.
    facing: f64,
    /// The error bound of the cosine between normal and half vector.
    cosine: f64,
    /// The error bound of the highlight of a colour, in units of a result.
    highlight: f64,
    /// How much the formula of the highlight changes with the cosine, if that is known.
    variation: Option<Variation>,
}

/// The formula.
struct Shading {
    keys: Keys,
    /// The accuracy contract of the highlight device, which is a part of `shading`.
    highlight: Box<dyn Contract>,
    errors: PartErrors,
}

impl Shading {
    /// Returns the highlight's formula of a cosine that is not quantised.
    fn f(&self, cosine: f64, exponent: i64) -> f64 {
        match self.highlight.highlight() {
            Some(highlight) => highlight.at_cosine(cosine, exponent).unwrap_or(f64::NAN),
            None => function::at(&self.keys.formula, cosine),
        }
    }
}

impl Formula for Shading {
    fn exact(&self, v: &[f64]) -> Vec<f64> {
        let unit = unit_vector([v[0], v[1], v[2]]);
        let cosine = |vector: &[f64]| {
            let sum: f64 = unit.iter().zip(vector).map(|(a, b)| a * b).sum();
            if self.keys.two_sided { sum.abs() } else { sum }.clamp(0.0, 1.0)
        };
        let (vectors, rest) = v[3..].split_at(6 * self.keys.lights as usize);
        let (exponent, material) = rest.split_at(usize::from(self.keys.has_exponent()));
        let n = exponent.first().map_or(0, |&n| n as i64);
        let of_lights = |of: &dyn Fn(&[f64]) -> f64| vectors.chunks(6).map(of).sum::<f64>();
        let facing = of_lights(&|light| cosine(&light[..3]));
        let f = of_lights(&|light| self.f(cosine(&light[3..]), n));
        let most = exp2(self.keys.colour_bits as i32) - 1.0;
        let colour = |at: usize| material[at] + material[3 + at] * facing + material[6 + at] * f;
        (0..3).map(|at| colour(at).clamp(0.0, most)).collect()
    }

    /// Derives the terms of a colour's error. An error of an operand of a part grows by the part's slope in it, and the part adds
    /// its own; each light adds its own.
    ///
    /// - A colour is diffuse·cosine + specular·f(cosine), saturated: its slopes are at most the largest colour, and that times
    ///   the slope of f. Where f jumps, cosine and exact cosine may lie on both sides.
    fn terms(&self) -> Vec<Term> {
        let PartErrors { facing, cosine, highlight, variation } = self.errors;
        let Some(Variation { slope, jump }) = variation else { return Vec::new() };
        let colour = exp2(self.keys.colour_bits as i32) - 1.0;
        let lights = f64::from(self.keys.lights);
        let term = |key, what, units| Term { key, what, units };
        let mut terms = vec![
            term(
                "colour.bits",
                "the cosine of the light, through the colour",
                facing * colour * lights,
            ),
            term(
                "cosine.fraction",
                "the cosine of the highlight, through the colour",
                cosine * slope * colour * lights,
            ),
            term("domain.exponent_max", "the highlight", highlight * lights),
            term("colour.bits", "rounding of the results", 0.5),
        ];
        if jump > 0.0 {
            terms.push(term(
                "domain.exponent_max",
                "where the highlight's formula jumps",
                jump * colour * lights,
            ));
        }
        terms
    }

    /// Returns the formulas of the colours; none where the highlight's formula reads a table, or nobody wrote it.
    fn expressions(&self) -> Vec<String> {
        let squares = "(nx ** 2 + ny ** 2 + nz ** 2)";
        let cosine = |vector: &str, suffix: &str| {
            let axes = ["x", "y", "z"].map(|axis| format!("n{axis} * {vector}{axis}{suffix}"));
            let along = format!("({}) / sqrt({squares})", axes.join(" + "));
            let above = match self.keys.two_sided {
                true => format!("abs({along})"),
                false => contract::clamped_at_0(&along),
            };
            format!("(min({above}, 1) if {squares} > 0 else 0)")
        };
        let (operand, f) = match self.highlight.highlight() {
            Some(highlight) => (COSINE, highlight.expressions()),
            None => ("x", self.highlight.expressions()),
        };
        let Some(f) = f.first().and_then(|text| parse(text).ok()) else { return Vec::new() };
        if f.has(&|part| matches!(part, Kind::Word(..))) {
            return Vec::new();
        }
        let (mut facing, mut shine) = (Vec::new(), Vec::new());
        for suffix in self.keys.suffixes() {
            facing.push(cosine("l", suffix));
            let of = parse(&cosine("h", suffix)).expect("a formula");
            let f = f.substitute(&glint_formula::Expression::operand(operand), &of, &(0..0));
            shine.push(format!("({})", f.python()));
        }
        let [facing, shine] = [facing, shine].map(|parts| parts.join(" + "));
        let most = exp2(self.keys.colour_bits as i32) - 1.0;
        let colours = ["red", "green", "blue"].into_iter();
        colours
            .map(|colour| {
                let sum = format!(
                    "ambient_{colour} + diffuse_{colour} * ({facing}) + specular_{colour} * ({shine})"
                );
                format!("min({}, {most:?})", contract::clamped_at_0(&sum))
            })
            .collect()
    }

    /// Returns a unit of each light, and half a one that the result is rounded by.
    fn limit(&self) -> f64 {
        f64::from(self.keys.lights) + 0.5
    }

    /// Returns a light anywhere, a half vector as near to the normal as the exponent asks for, and dull colours, whose
    /// sum does not saturate.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let Keys { normal, light, colour_bits, most, lights, .. } = self.keys;
        let mut centred = || [(); 3].map(|()| 2.0 * unit() - 1.0);
        let direction = unit_vector(centred());
        let pairs = (0..lights).map(|_| [unit_vector(centred()), centred()]);
        let pairs: Vec<[[f64; 3]; 2]> = pairs.collect();
        let n = self.keys.least() as f64 + unit() * (most - self.keys.least()) as f64;
        let (length, away) = (0.25 + 1.5 * unit(), unit() * 2.0 / n.sqrt());
        let raw = |value: f64, fraction: u32| (value * exp2(fraction as i32)).round() as i64;
        let mut operands: Vec<i64> = direction.map(|it| raw(it * length, normal)).into();
        for [to_light, off] in pairs {
            let half = unit_vector([0, 1, 2].map(|axis| direction[axis] + away * off[axis]));
            operands.extend([to_light, half].concat().into_iter().map(|it| raw(it, light)));
        }
        operands.extend(self.keys.has_exponent().then(|| n.round() as i64));
        let share = exp2(colour_bits as i32) / (1.0 + 2.0 * f64::from(lights));
        operands.extend((0..9).map(|_| (unit() * share) as i64));
        Some(operands)
    }

    /// Returns normals of one plane under one light, which the viewer is at, with four exponents.
    fn sweep(&self) -> Option<Sweep> {
        let Keys { normal, light, colour_bits, most, .. } = self.keys;
        let (one, to_light, white) = (1 << normal, 1 << light, (1 << colour_bits) - 1);
        let fixed = |(name, value): (&str, i64)| Axis {
            name: name.to_owned(),
            values: Values::List(vec![value]),
        };
        let of_light =
            [("lx", 0), ("ly", 0), ("lz", to_light), ("hx", 0), ("hy", 0), ("hz", to_light)];
        let lights = self.keys.suffixes().flat_map(|suffix| {
            of_light.map(|(name, value)| fixed((&format!("{name}{suffix}"), value)))
        });
        let material = [("ambient", white / 8), ("diffuse", white / 2), ("specular", white / 3)];
        let material = material.into_iter().flat_map(|(kind, value)| {
            ["red", "green", "blue"].map(|colour| fixed((&format!("{kind}_{colour}"), value)))
        });
        let least = self.keys.least();
        let exponents = Values::List([8, 4, 2, 1].map(|part| (most / part).max(least)).into());
        let mut axes = vec![Axis { name: "nx".to_owned(), values: Values::Range(-one, one) }];
        axes.extend([("ny", 0), ("nz", one / 2)].map(fixed).into_iter().chain(lights));
        if self.keys.has_exponent() {
            axes.push(Axis { name: "exponent".to_owned(), values: exponents });
        }
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

    /// The largest error with a cosine of 12 fraction bits is beyond the bound that a part with a false claim would give, and
    /// within the one that it gives.
    #[test]
    fn the_bound_of_the_whole_falls_with_that_of_a_part() {
        let keys = [("cosine.fraction", 12), ("domain.exponent_max", 1000)];
        let keys = keys.map(|(key, value)| (key.to_owned(), Value::Integer(value)));
        let config = Config::from_values(&schema(), "coarse", keys.into()).expect("sound keys");
        let (keys, whole) = (Keys::of(&config), contract(&config));
        let variation = Some(Variation { slope: 1000.0, jump: 0.0 });
        let errors = PartErrors { facing: 2e-7, cosine: 2e-7, highlight: 0.1, variation };
        let highlight = (part(&keys).contract)(&parts(&keys).highlight);
        let claimed = Shading { highlight, errors, keys };
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

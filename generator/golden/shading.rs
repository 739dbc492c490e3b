//! The golden model and the accuracy contract of the device `shading`, which computes a colour as ambient + Σ (diffuse·cos α +
//! specular·f(cos γ)).
//!
//! The sum runs over the lights. α is the angle between the surface normal and a light's direction, and f the highlight's
//! formula, for example cⁿ ([symbols](crate#symbols)). A negative cosine counts as 0, or as positive with the key `two_sided`,
//! and a colour saturates. `shading` consists of other devices, called its parts. For each light, two `dot-product` devices
//! compute the cosines from a normal of any length. A highlight device such as `blinn` or `function` computes f. The contract
//! combines the proved error bounds of the parts.

use std::sync::Arc;

use super::contract::{self, COSINE};
use super::device::{self, Formula};
use super::frame::{Frame, Slot, State};
use super::highlight::Variation;
use super::inverse_root::{centred, unit_vector};
use super::narrow::Narrow;
use super::{
    Axis, Contract, Model, Sweep, Term, Values, blinn, cosine_power, dot_product, function, gauss,
    quadratic, schlick, threshold,
};
use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::Config;
use glint_formula::{Expression, Kind, TextSpan, parse};
use glint_keys::shading::{HighlightDevice, HighlightPart, Keys, LightParts};

fn device(keys: &Keys, parts: &LightParts) -> device::Device {
    let mut frame = Frame::default();
    let normal = vector(&mut frame, "n", "", keys.normal_format());
    let mut lights: Vec<[[Slot; 3]; 2]> = Vec::new();
    for suffix in keys.suffixes() {
        lights.push(["l", "h"].map(|name| vector(&mut frame, name, suffix, keys.light_format())));
    }
    let exponent = keys.has_exponent().then(|| frame.operand("exponent", keys.exponent_format()));
    let [ambient, diffuse, specular] = ["ambient", "diffuse", "specular"].map(|kind| {
        ["red", "green", "blue"]
            .map(|it| frame.operand(&format!("{kind}_{it}"), keys.colour_format()))
    });

    let (mut facing, mut shine) = (Vec::new(), Vec::new());
    for (suffix, [light, half]) in keys.suffixes().zip(lights) {
        let name = format!("diffuse_cosine{suffix}");
        facing.push(cosine(&mut frame, &name, &parts.facing, normal, light));
        let name = format!("specular_cosine{suffix}");
        let cos_gamma = cosine(&mut frame, &name, &parts.cosine, normal, half);
        let (model, name) = (highlight_model(keys, &parts.highlight), format!("highlight{suffix}"));
        let Some(exponent) = exponent else {
            let part = frame.part(&name, &*model, [left("x", cos_gamma, 0)]);
            shine.push([part.out("result_out"); 3]);
            continue;
        };
        let mut given = vec![left("cos_gamma", cos_gamma, 0), left("exponent", exponent, 0)];
        for (name, slot) in ["red", "green", "blue"].into_iter().zip(specular) {
            given.push(left(name, slot, keys.guard()));
        }
        let part = frame.part(&name, &*model, given);
        shine.push(["red_out", "green_out", "blue_out"].map(|it| part.out(it)));
    }

    let of_f = match &parts.highlight {
        HighlightPart::OfFormula(_, planned) => planned.function.fraction,
        HighlightPart::OfExponent(_) => 0,
    };
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

fn vector(frame: &mut Frame, name: &str, suffix: &str, format: Format) -> [Slot; 3] {
    ["x", "y", "z"].map(|axis| frame.operand(&format!("{name}{axis}{suffix}"), format))
}

/// Returns the operand `name` of a part, and a function for its value: the raw value of `slot`, shifted left by `places` bits.
fn left(
    name: &'static str,
    slot: Slot,
    places: u32,
) -> (&'static str, impl Fn(&State) -> i64 + Send + Sync) {
    (name, move |s: &State| s[slot] << places)
}

/// Adds a part that computes the cosine between the normal and another vector. Returns the cosine's slot.
fn cosine(
    frame: &mut Frame,
    name: &str,
    config: &Config,
    [nx, ny, nz]: [Slot; 3],
    [x, y, z]: [Slot; 3],
) -> Slot {
    let slots = [("nx", nx), ("ny", ny), ("nz", nz), ("hx", x), ("hy", y), ("hz", z)];
    let operands = slots.map(|(name, slot)| left(name, slot, 0));
    frame.part(name, &*dot_product::model(config), operands).out("cosine_out")
}

fn highlight_model(keys: &Keys, part: &HighlightPart) -> Box<dyn Model> {
    let config = match part {
        HighlightPart::OfExponent(config) => config,
        HighlightPart::OfFormula(config, planned) => return function::model(config, planned),
    };
    match keys.highlight {
        HighlightDevice::CosinePower => cosine_power::model(config),
        HighlightDevice::Blinn => blinn::model(config),
        HighlightDevice::Schlick => schlick::model(config),
        HighlightDevice::Gauss => gauss::model(config),
        HighlightDevice::Quadratic => quadratic::model(config),
        HighlightDevice::Threshold => threshold::model(config),
        HighlightDevice::Function => unreachable!("a formula has a plan"),
    }
}

fn highlight_contract(keys: &Keys, part: &HighlightPart) -> Box<dyn Contract> {
    let config = match part {
        HighlightPart::OfExponent(config) => config,
        HighlightPart::OfFormula(config, planned) => return function::contract(config, planned),
    };
    match keys.highlight {
        HighlightDevice::CosinePower => cosine_power::contract(config),
        HighlightDevice::Blinn => blinn::contract(config),
        HighlightDevice::Schlick => schlick::contract(config),
        HighlightDevice::Gauss => gauss::contract(config),
        HighlightDevice::Quadratic => quadratic::contract(config),
        HighlightDevice::Threshold => threshold::contract(config),
        HighlightDevice::Function => unreachable!("a formula has a plan"),
    }
}

pub fn model(config: &Config, parts: &LightParts) -> Box<dyn Model> {
    device(&Keys::of(config), parts).model()
}

pub fn contract(config: &Config, parts: &LightParts) -> Box<dyn Contract> {
    let keys = Keys::of(config);
    let device = device(&keys, parts);
    let highlight = highlight_contract(&keys, &parts.highlight);
    let colour = exp2(keys.colour_bits as i32) - 1.0;
    let errors = PartErrors {
        facing: error(&*dot_product::contract(&parts.facing)),
        cosine: error(&*dot_product::contract(&parts.cosine)),
        highlight: match keys.has_exponent() {
            true => error(&*highlight) * exp2(-(keys.guard() as i32)),
            false => error(&*highlight) * colour,
        },
        variation: match &parts.highlight {
            HighlightPart::OfFormula(_, planned) => {
                function::slope(planned).map(|slope| Variation { slope, jump: 0.0 })
            }
            HighlightPart::OfExponent(_) => highlight.highlight().and_then(|it| it.variation()),
        },
    };
    device.contract(Shading { highlight, errors, keys })
}

/// Returns the proved error bound of a part as a value (not in units).
fn error(contract: &dyn Contract) -> f64 {
    contract.bounds().governing().units * exp2(-contract.outputs()[0].format.frac)
}

struct PartErrors {
    /// The error of the cosine between normal and light.
    facing: f64,
    /// The error of the cosine between normal and half vector.
    cosine: f64,
    /// The error of the highlight for one colour, in units of a result.
    highlight: f64,
    /// How much the formula of the highlight changes with the cosine; `None` if nobody has stated it.
    variation: Option<Variation>,
}

struct Shading {
    keys: Keys,
    /// The accuracy contract of the highlight device.
    highlight: Box<dyn Contract>,
    errors: PartErrors,
}

impl Shading {
    /// Returns the exact f at an unrounded cosine, or NaN if the highlight cannot compute it.
    fn f(&self, cosine: f64, exponent: i64) -> f64 {
        match self.highlight.highlight() {
            Some(highlight) => highlight.at_cosine(cosine, exponent).unwrap_or(f64::NAN),
            None => function::at(&self.keys.formula, cosine),
        }
    }

    /// Returns the cosine between a unit normal and another unit vector, limited to 0 … 1. With the key `two_sided`, a negative
    /// cosine counts as positive.
    fn cosine(&self, unit_normal: &[f64], vector: &[f64]) -> f64 {
        let sum: f64 = unit_normal.iter().zip(vector).map(|(a, b)| a * b).sum();
        if self.keys.two_sided { sum.abs() } else { sum }.clamp(0.0, 1.0)
    }

    /// Returns a Python expression for the cosine between the normal and a light's vector. `vector` is `l` or `h`, and `suffix`
    /// selects the light.
    fn cosine_expression(&self, vector: &str, suffix: &str) -> String {
        let squares = "(nx ** 2 + ny ** 2 + nz ** 2)";
        let axes = ["x", "y", "z"].map(|axis| format!("n{axis} * {vector}{axis}{suffix}"));
        let along = format!("({}) / sqrt({squares})", axes.join(" + "));
        let above = match self.keys.two_sided {
            true => format!("abs({along})"),
            false => contract::clamped_at_0(&along),
        };
        format!("(min({above}, 1) if {squares} > 0 else 0)")
    }
}

impl Formula for Shading {
    fn exact(&self, v: &[f64]) -> Vec<f64> {
        let normal = unit_vector([v[0], v[1], v[2]]);
        let (vectors, rest) = v[3..].split_at(6 * self.keys.lights as usize);
        let (exponent, material) = rest.split_at(usize::from(self.keys.has_exponent()));
        let n = exponent.first().map_or(0, |&n| n as i64);
        let (mut facing, mut f) = (0.0, 0.0);
        for light in vectors.chunks(6) {
            let (to_light, half) = light.split_at(3);
            facing += self.cosine(&normal, to_light);
            f += self.f(self.cosine(&normal, half), n);
        }
        let most = exp2(self.keys.colour_bits as i32) - 1.0;
        let mut colours = Vec::with_capacity(3);
        for at in 0..3 {
            let (ambient, diffuse, specular) = (material[at], material[3 + at], material[6 + at]);
            let colour = ambient + diffuse * facing + specular * f;
            colours.push(colour.clamp(0.0, most));
        }
        colours
    }

    /// Derives the terms of the error bound of a colour, in units. An error of an operand of a part is multiplied by the slope
    /// of the part, and the part adds its own error. The errors of all lights add up. If nobody has stated how f changes with
    /// the cosine, the bound is not stated.
    ///
    /// - A colour is diffuse·cosine + specular·f(cosine), saturated. Its slope by the light's cosine is at most the largest
    ///   colour. Its slope by the highlight's cosine is at most the largest colour times the slope of f.
    /// - If f jumps, the computed and the exact cosine may be on different sides of the jump.
    fn terms(&self, _output: usize) -> Vec<Term> {
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

    /// Returns the colours in Python. The list is empty if the highlight's formula reads a table, or if nobody has written it as
    /// an expression.
    fn expressions(&self) -> Vec<String> {
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
            facing.push(self.cosine_expression("l", suffix));
            let cosine = parse(&self.cosine_expression("h", suffix)).expect("a formula");
            let of_light =
                f.substitute(&Expression::operand(operand), &cosine, &TextSpan::default());
            shine.push(format!("({})", of_light.python()));
        }
        let [facing, shine] = [facing, shine].map(|parts| parts.join(" + "));
        let most = exp2(self.keys.colour_bits as i32) - 1.0;
        let colours = ["red", "green", "blue"].map(|colour| {
            let sum = format!(
                "ambient_{colour} + diffuse_{colour} * ({facing}) + specular_{colour} * ({shine})"
            );
            format!("min({}, {most:?})", contract::clamped_at_0(&sum))
        });
        colours.into()
    }

    /// Returns one unit for each light, plus half a unit for the result's rounding.
    fn limit(&self, _output: usize) -> f64 {
        f64::from(self.keys.lights) + 0.5
    }

    /// Returns random operands. The lights are in any direction, and the half vectors are near the normal; a larger exponent
    /// makes them nearer. The colours are so dark that their sum does not saturate.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let Keys { normal, light, colour_bits, most, lights, .. } = self.keys;
        let direction = unit_vector(centred(unit));
        let mut pairs: Vec<[[f64; 3]; 2]> = Vec::new();
        for _ in 0..lights {
            pairs.push([unit_vector(centred(unit)), centred(unit)]);
        }
        let n = self.keys.least() as f64 + unit() * (most - self.keys.least()) as f64;
        let (length, away) = (0.25 + 1.5 * unit(), unit() * 2.0 / n.sqrt());
        let mut operands = Vec::new();
        for component in direction {
            operands.push(raw(component * length, normal));
        }
        for [to_light, off] in pairs {
            let half = unit_vector([0, 1, 2].map(|axis| direction[axis] + away * off[axis]));
            operands.extend(to_light.map(|component| raw(component, light)));
            operands.extend(half.map(|component| raw(component, light)));
        }
        if self.keys.has_exponent() {
            operands.push(n.round() as i64);
        }
        let share = exp2(colour_bits as i32) / (1.0 + 2.0 * f64::from(lights));
        for _ in 0..9 {
            operands.push((unit() * share) as i64);
        }
        Some(operands)
    }

    /// Visits normals in one plane, under lights and half vectors along the z axis, with fixed colours and four exponents.
    fn sweep(&self) -> Option<Sweep> {
        let Keys { normal, light, colour_bits, most, .. } = self.keys;
        let (one, to_light, white) = (1 << normal, 1 << light, (1 << colour_bits) - 1);
        let mut axes = vec![Axis { name: "nx".to_owned(), values: Values::Range(-one, one) }];
        axes.push(fixed_axis("ny".to_owned(), 0));
        axes.push(fixed_axis("nz".to_owned(), one / 2));
        let of_light =
            [("lx", 0), ("ly", 0), ("lz", to_light), ("hx", 0), ("hy", 0), ("hz", to_light)];
        for suffix in self.keys.suffixes() {
            for (name, value) in of_light {
                axes.push(fixed_axis(format!("{name}{suffix}"), value));
            }
        }
        if self.keys.has_exponent() {
            let least = self.keys.least();
            let exponents = [8, 4, 2, 1].map(|part| (most / part).max(least));
            let values = Values::List(exponents.into());
            axes.push(Axis { name: "exponent".to_owned(), values });
        }
        for (kind, value) in
            [("ambient", white / 8), ("diffuse", white / 2), ("specular", white / 3)]
        {
            for colour in ["red", "green", "blue"] {
                axes.push(fixed_axis(format!("{kind}_{colour}"), value));
            }
        }
        Some(Sweep {
            axes,
            omits: "normals out of one plane, other lights and materials".to_owned(),
        })
    }
}

/// Rounds `value` to `fraction` fraction bits and returns it raw. For example, 0.3 with 4 fraction bits gives 5.
fn raw(value: f64, fraction: u32) -> i64 {
    (value * exp2(fraction as i32)).round() as i64
}

fn fixed_axis(name: String, value: i64) -> Axis {
    Axis { name, values: Values::List(vec![value]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bound;
    use glint_config::Value;
    use glint_keys::shading::schema;

    /// With a cosine of 12 fraction bits, the largest error is below the true bound. It is above the bound that falsely small
    /// bounds of the parts would give.
    #[test]
    fn the_bound_of_the_whole_falls_with_that_of_a_part() {
        let keys = [("cosine.fraction", 12), ("domain.exponent_max", 1000)];
        let keys = keys.map(|(key, value)| (key.to_owned(), Value::Integer(value)));
        let config = Config::from_values(&schema(), "coarse", keys.into()).expect("sound keys");
        let parts = glint_keys::shading::parts(&config).expect("sound parts");
        let (keys, whole) = (Keys::of(&config), contract(&config, &parts));
        let variation = Some(Variation { slope: 1000.0, jump: 0.0 });
        let errors = PartErrors { facing: 2e-7, cosine: 2e-7, highlight: 0.1, variation };
        let highlight = highlight_contract(&keys, &parts.highlight);
        let claimed = Shading { highlight, errors, keys };
        let claimed = Bound::of(claimed.terms(0)).units;
        // A linear congruential generator.
        let mut at = 1u64;
        let mut unit = || {
            at = at.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (at >> 11) as f64 * exp2(-53)
        };
        let points =
            (0..4000).map(|_| whole.largest_error(&whole.hint(&mut unit).expect("a point")));
        let worst = points.fold(0.0, f64::max);
        assert!(worst > claimed && worst < whole.bounds().governing().units, "{claimed} {worst}");
    }
}

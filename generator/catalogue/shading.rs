//! The hardware description of the device `shading`, which computes a colour as ambient + Σ (diffuse·cos α + specular·f(cos γ)).
//!
//! The sum runs over the lights. α is the angle between the surface normal and the direction of a light, and f the highlight's
//! formula, for example cⁿ ([symbols](crate#symbols)). `shading` consists of other devices, called its parts: for each light two
//! `dot-product` devices and a highlight device, such as `blinn` or `function`. A sum above the largest colour becomes the
//! largest colour.

use super::{blinn, cosine_power, dot_product, function, gauss, quadratic, schlick, threshold};
use glint_base::fixed::{Overflow, Rounding};
use glint_config::Config;
use glint_keys::shading::{HighlightDevice, HighlightPart, Keys, LightParts};
use glint_rtl::dsl::{About, Designer, Signal};

/// Builds the hardware. `parts` has the configurations of the parts.
pub fn describe<'d>(d: &'d Designer, config: &Config, parts: &LightParts) {
    let keys = Keys::of(config);
    d.about(about(&keys));
    let vector = |name: &str, suffix: &str, doc: &str, format| {
        ["x", "y", "z"].map(|axis| {
            let operand = d.operand(&format!("{name}{axis}{suffix}"), format);
            operand.doc(&format!("{axis} of {doc}")).q()
        })
    };
    let normal = vector("n", "", "the normal, of any length", keys.normal_format());
    let lights: Vec<[[Signal<'d>; 3]; 2]> = keys
        .suffixes()
        .map(|suffix| {
            let of = if suffix.is_empty() { String::new() } else { format!(" {suffix}") };
            let of_light = |name, doc: String| vector(name, suffix, &doc, keys.light_format());
            [
                of_light("l", format!("the unit vector to the light{of}")),
                of_light("h", format!("the unit half vector{of}")),
            ]
        })
        .collect();
    let exponent = keys
        .has_exponent()
        .then(|| d.operand("exponent", keys.exponent_format()).doc("specular exponent n").q());
    let material = |kind: &str| {
        ["red", "green", "blue"].map(|colour| {
            let name = format!("{kind}_{colour}");
            d.operand(&name, keys.colour_format())
                .doc(&format!("{kind} {colour} of the material"))
                .q()
        })
    };
    let [ambient, diffuse, specular] = ["ambient", "diffuse", "specular"].map(material);

    let cosine = |name: &str, config: &Config, other: [Signal<'d>; 3]| {
        let ([nx, ny, nz], [hx, hy, hz]) = (normal, other);
        let given = [("nx", nx), ("ny", ny), ("nz", nz), ("hx", hx), ("hy", hy), ("hz", hz)];
        d.instance(name, |d| dot_product::describe(d, config), &given).out("cosine_out")
    };
    let guard = keys.guard() as i32;
    let guarded = specular.map(|it| it.with_fraction(guard).shift_left(guard));
    let mut facing = Vec::new();
    let mut shine: [Vec<Signal<'d>>; 3] = Default::default();
    for (suffix, [light, half]) in keys.suffixes().zip(lights) {
        facing.push(cosine(&format!("diffuse_cosine{suffix}"), &parts.facing, light));
        let cos_gamma = cosine(&format!("specular_cosine{suffix}"), &parts.cosine, half);
        let mut given = vec![("cos_gamma", cos_gamma)];
        given.extend(exponent.map(|it| ("exponent", it)));
        given.extend(["red", "green", "blue"].into_iter().zip(guarded));
        let part = |given: &[(&str, Signal<'d>)]| {
            let name = format!("highlight{suffix}");
            d.instance(&name, |d| describe_highlight(d, &keys, &parts.highlight), given)
        };
        if keys.has_exponent() {
            let highlight = part(&given);
            let colours = ["red_out", "green_out", "blue_out"].map(|it| highlight.out(it));
            shine.iter_mut().zip(colours).for_each(|(all, it)| all.push(it.shift_right(guard)));
        } else {
            shine[0].push(part(&[("x", cos_gamma)]).out("result_out"));
        }
    }
    let total = |name: &str, parts: &[Signal<'d>]| {
        let (first, rest) = parts.split_first().expect("a light");
        let numbered = (2..).zip(rest);
        numbered.fold(*first, |sum, (light, it)| d.add(&format!("{name}_of_{light}"), sum, *it))
    };
    let facing = total("facing", &facing);
    let of_formula = (!keys.has_exponent()).then(|| total("shine", &shine[0]));
    for (at, colour) in ["red", "green", "blue"].into_iter().enumerate() {
        let shine = match of_formula {
            Some(f) => d.mul(&format!("{colour}_specular"), specular[at], f),
            None => total(&format!("{colour}_shine"), &shine[at]),
        };
        let matt = d.mul(&format!("{colour}_diffuse"), diffuse[at], facing);
        let lit = d.add(&format!("{colour}_lit"), matt, shine);
        let sum = d.add(&format!("{colour}_sum"), lit, ambient[at]);
        let (rounding, overflow) = (Rounding::Nearest, Overflow::Saturate);
        let name = format!("{colour}_saturated");
        let output = format!("{colour}_out");
        d.output(&output, d.narrow(&name, sum, keys.colour_format(), rounding, overflow));
    }
    d.dataflow();
}

fn describe_highlight(d: &Designer, keys: &Keys, part: &HighlightPart) {
    let config = match part {
        HighlightPart::OfExponent(config) => config,
        HighlightPart::OfFormula(config, planned) => return function::describe(d, config, planned),
    };
    match keys.highlight {
        HighlightDevice::CosinePower => cosine_power::describe(d, config),
        HighlightDevice::Blinn => blinn::describe(d, config),
        HighlightDevice::Schlick => schlick::describe(d, config),
        HighlightDevice::Gauss => gauss::describe(d, config),
        HighlightDevice::Quadratic => quadratic::describe(d, config),
        HighlightDevice::Threshold => threshold::describe(d, config),
        HighlightDevice::Function => unreachable!("a formula has a plan"),
    }
}

/// Returns f as text, such as `c^n`.
fn highlight_formula(keys: &Keys) -> String {
    let power = keys.power;
    let formula = match keys.highlight {
        HighlightDevice::CosinePower => {
            return format!("max(0, n/{power}*(c - 1) + 1)^{power} where c > 0, else 0");
        }
        HighlightDevice::Function => return format!("{} with x = c", keys.formula),
        HighlightDevice::Blinn => "c^n",
        HighlightDevice::Schlick => "c/(n - n*c + c)",
        HighlightDevice::Gauss => "exp(-n*acos(c)^2/2) where c > 0, else 0",
        HighlightDevice::Quadratic => "max(0, c - a(n)*(c - c^2))",
        HighlightDevice::Threshold => {
            "max(0, n/2*(c - 1) + 1)^2 where that reaches ROM(n) and c > 0, else 0"
        }
    };
    formula.to_owned()
}

fn about(keys: &Keys) -> About {
    let f = highlight_formula(keys);
    let cosine = |other: &str| match keys.two_sided {
        true => format!("min(1, abs(N.{other}))"),
        false => format!("min(1, max(0, N.{other}))"),
    };
    let sum = if keys.lights > 1 { "the sum over the lights of " } else { "" };
    let (facing, c) = (cosine("L"), cosine("H"));
    About {
        device: "shading".to_owned(),
        title: "The colour of a point: a normal, a light, a half vector, a material".to_owned(),
        formula: format!("out = ambient + {sum}diffuse*{facing} + specular*f(c), c = {c}, f(c) = {f}"),
        source: "J. F. Blinn, Models of Light Reflection for Computer Synthesized Pictures, SIGGRAPH 1977".to_owned(),
        notes: vec![
            "N is the unit vector of the normal. The normal may have any length, for example after \
             interpolation. If it is the zero vector, every cosine is 0.".into(),
            "Light and half vector must be unit vectors. For components below -1 or above 1 no error bound is \
             stated.".into(),
            "A sum above the largest result becomes the largest result.".into(),
        ],
    }
}

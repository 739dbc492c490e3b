//! `shading`: normals in, colours out. Its parts are other devices of Glint.

use super::{blinn, cosine_power, dot_product, schlick};
use glint_base::fixed::{Overflow, Rounding};
use glint_config::Config;
use glint_keys::shading::{Highlight, Keys};
use glint_rtl::dsl::{About, Designer, Signal};

/// The device.
///
/// # Panics
/// If the check of the schema has not accepted the configuration.
pub fn describe<'d>(d: &'d Designer, config: &Config) {
    let keys = Keys::of(config);
    let parts = keys.parts().unwrap_or_else(|(part, _)| panic!("`{part}` is checked"));
    d.about(about(&keys));
    let vector = |names: [&str; 3], doc: &str, format| {
        names.map(|name| d.operand(name, format).doc(&format!("{} of {doc}", &name[1..])).q())
    };
    let normal = vector(["nx", "ny", "nz"], "the normal, of any length", keys.normal_format());
    let light = vector(["lx", "ly", "lz"], "the unit vector to the light", keys.light_format());
    let half = vector(["hx", "hy", "hz"], "the unit half vector", keys.light_format());
    let exponent = d.operand("exponent", keys.exponent_format()).doc("specular exponent n").q();
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
    let facing = cosine("diffuse_cosine", &parts.facing, light);
    let cos_gamma = cosine("specular_cosine", &parts.cosine, half);
    let guard = keys.guard() as i32;
    let [red, green, blue] = specular.map(|it| it.with_fraction(guard).shift_left(guard));
    let given = [
        ("cos_gamma", cos_gamma),
        ("exponent", exponent),
        ("red", red),
        ("green", green),
        ("blue", blue),
    ];
    let describe = match keys.highlight {
        Highlight::CosinePower => cosine_power::describe,
        Highlight::Blinn => blinn::describe,
        Highlight::Schlick => schlick::describe,
    };
    let highlight = d.instance("highlight", |d| describe(d, &parts.highlight), &given);

    for (at, colour) in ["red", "green", "blue"].into_iter().enumerate() {
        let output = format!("{colour}_out");
        let shine = highlight.out(&output).shift_right(guard);
        let matt = d.mul(&format!("{colour}_diffuse"), diffuse[at], facing);
        let lit = d.add(&format!("{colour}_lit"), matt, shine);
        let sum = d.add(&format!("{colour}_sum"), lit, ambient[at]);
        let (rounding, overflow) = (Rounding::Nearest, Overflow::Saturate);
        let name = format!("{colour}_saturated");
        d.output(&output, d.narrow(&name, sum, keys.colour_format(), rounding, overflow));
    }
    d.dataflow();
}

fn about(keys: &Keys) -> About {
    let highlight = match keys.highlight {
        Highlight::CosinePower => "(n/16 * (N.H - 1) + 1)^16",
        Highlight::Blinn => "(N.H)^n",
        Highlight::Schlick => "N.H / (n - n * N.H + N.H)",
    };
    About {
        device: "shading".to_owned(),
        title: "The colour of a point: a normal, a light, a half vector, a material".to_owned(),
        formula: format!("out = ambient + diffuse * max(0, N.L) + specular * {highlight}"),
        source: "J. F. Blinn, Models of Light Reflection for Computer Synthesized Pictures, SIGGRAPH 1977".to_owned(),
        notes: vec![
            "The normal need not be a unit vector: an interpolated one will do. Of the zero vector every cosine is 0.".into(),
            "Light and half vector are unit vectors: nothing is stated of components beyond -1 and 1.".into(),
            "A sum above the largest result becomes the largest.".into(),
        ],
    }
}

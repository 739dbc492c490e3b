//! The keys of `shading`, and the configurations of its parts.

use super::common;
use super::{blinn, cosine_power, dot_product, schlick};
use glint_base::fixed::Format;
use glint_config::{Config, Key, Problems, Schema, Value};

glint_config::choices! {
    /// The device that makes the highlight of a cosine.
    pub enum Highlight {
        /// W(n, γ).
        CosinePower = "cosine-power",
        /// cosⁿγ.
        Blinn = "blinn",
        /// c/(n − nc + c).
        Schlick = "schlick",
    }
}

glint_config::keys! {
    /// The keys of a configuration.
    pub struct Keys {
        highlight: Highlight = Key::choice("highlight", "cosine-power", Highlight::WORDS,
            "The device that makes the highlight of the cosine."),
        normal: u32 = Key::integer("normal.fraction", 14, 6..=14,
            "Fraction bits of a component of the normal, s1.F, which need not be a unit vector."),
        light: u32 = Key::integer("light.fraction", 14, 6..=14,
            "Fraction bits of a component of the light and the half vector, unit vectors, s1.F."),
        cosine: u32 = Key::integer("cosine.fraction", 18, 12..=20,
            "Fraction bits of the cosine between normal and half vector."),
        exponent_bits: u32 = common::exponent_bits(),
        colour_bits: u32 = Key::integer("colour.bits", 8, 2..=10,
            "Bits of a coefficient of the material, and of a result."),
        most: i64 = Key::integer("domain.exponent_max", 128, 16..=4095,
            "The largest n for which the accuracy contract is stated."),
    }
}

/// The keys of the device.
pub fn schema() -> Schema {
    Schema { device: "shading", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    let most = (1 << keys.exponent_bits) - 1;
    if keys.most > most {
        problems.push(
            "domain.exponent_max",
            format!("{} does not fit the {} bits of the exponent", keys.most, keys.exponent_bits),
            format!("at most {most}, or a larger exponent.bits"),
        );
    } else if let Err((part, why)) = keys.parts() {
        let why = why.iter().map(|it| format!("{}: {}", it.key, it.message)).next();
        let message = format!("its part `{part}` cannot be made: {}", why.unwrap_or_default());
        problems.push("highlight", message, "other widths");
    }
}

/// The configurations of the parts.
pub struct Parts {
    /// That of the cosine between normal and light.
    pub facing: Config,
    /// That of the cosine between normal and half vector.
    pub cosine: Config,
    /// That of the highlight.
    pub highlight: Config,
}

impl Keys {
    /// The format of a component of the normal.
    pub fn normal_format(&self) -> Format {
        Format::signed(1, self.normal as i32)
    }

    /// The format of a component of the light and the half vector.
    pub fn light_format(&self) -> Format {
        Format::signed(1, self.light as i32)
    }

    /// The format of a coefficient of the material, and of a result.
    pub fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }

    /// The format of n.
    pub fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    /// Fraction bits of a highlight in units of a result, as far as its colours have bits.
    pub fn guard(&self) -> u32 {
        (12 - self.colour_bits).min(4)
    }

    /// Fraction bits of the cosine between normal and light, whose slope in a colour is the smaller.
    pub fn facing(&self) -> u32 {
        self.cosine.min(self.colour_bits + 6)
    }

    /// The smallest n for which the accuracy contract is stated: below the power of W it jumps at a right angle.
    pub fn least(&self) -> i64 {
        if self.highlight == Highlight::CosinePower { 16 } else { 1 }
    }

    /// The parts.
    ///
    /// # Errors
    /// The part that refuses its configuration, and why.
    pub fn parts(&self) -> Result<Parts, (&'static str, Box<Problems>)> {
        let make = |schema: Schema, keys: &[(&str, i64)]| {
            let value = |&(key, value): &(&str, i64)| (key.to_owned(), Value::Integer(value));
            Config::from_values(&schema, "part", keys.iter().map(value).collect())
                .map_err(|why| (schema.device, Box::new(why)))
        };
        let [normal, light, cosine, exponent, colour] = [
            self.normal,
            self.light,
            self.cosine,
            self.exponent_bits,
            self.colour_bits + self.guard(),
        ]
        .map(i64::from);
        let between = |kept: i64| {
            let keys = [
                ("vector.fraction", normal),
                ("half.fraction", light),
                ("table.address", 10),
                ("inverse.fraction", 21),
                ("output.fraction", kept),
            ];
            make(dot_product::schema(), &keys)
        };
        let (schema, fraction) = match self.highlight {
            Highlight::CosinePower => (cosine_power::schema(), 18),
            Highlight::Blinn => (blinn::schema(), 18),
            Highlight::Schlick => (schlick::schema(), 14),
        };
        let highlight = [
            ("cosine.fraction", cosine),
            ("exponent.bits", exponent),
            ("colour.bits", colour),
            ("intensity.fraction", fraction),
            ("domain.exponent_min", self.least()),
            ("domain.exponent_max", self.most),
        ];
        Ok(Parts {
            facing: between(self.facing().into())?,
            cosine: between(cosine)?,
            highlight: make(schema, &highlight)?,
        })
    }
}

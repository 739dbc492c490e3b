//! Declares the configuration keys of the device `shading`, and derives the configurations of its parts from them: `dot-product`
//! for the cosines, and a highlight device such as `blinn`.

use super::common;
use super::function::FunctionPlan;
use super::{blinn, cosine_power, dot_product, function, gauss, quadratic, schlick, threshold};
use glint_base::config_error::ConfigError;
use glint_base::fixed::Format;
use glint_config::{Config, Key, Problems, Schema, TextPattern, Value};

glint_config::choices! {
    /// Computes the highlight from the cosine c = cos γ and the specular exponent n.
    pub enum HighlightDevice {
        /// (n/m·(c − 1) + 1)^m with the key `power` as m; 0 if the base is negative.
        CosinePower = "cosine-power",
        /// cⁿ.
        Blinn = "blinn",
        /// c/(n − nc + c).
        Schlick = "schlick",
        /// exp(−n·γ²/2).
        Gauss = "gauss",
        /// max(0, c − a(n)·(c − c²)), with a(n) from a table.
        Quadratic = "quadratic",
        /// (n/2·(c − 1) + 1)², or 0 if this square is below the level of n in a table, or if its base is negative.
        Threshold = "threshold",
        /// A formula of the cosine alone.
        Function = "function",
    }
}

glint_config::keys! {
    pub struct Keys {
        highlight: HighlightDevice = Key::choice("highlight", "cosine-power", HighlightDevice::WORDS,
            "The device that computes the highlight from the cosine."),
        power: u32 = common::power().only_when("highlight", "cosine-power"),
        formula: String = Key::text(FORMULA, "x^32", TextPattern::Formula,
            "The highlight as a formula of the cosine x, without an exponent.")
            .only_when("highlight", "function"),
        lights: u32 = Key::integer("lights", 1, 1..=4,
            "Number of lights. Each light has its own light vector and half vector. Their diffuse and specular \
             parts are added."),
        two_sided: bool = dot_product::two_sided(),
        normal: u32 = Key::integer("normal.fraction", 14, 6..=14,
            "Number of fraction bits F of the components of the normal, whose format is s1.F. The normal may \
             have any length."),
        light: u32 = Key::integer("light.fraction", 14, 6..=14,
            "Number of fraction bits F of the components of the light vector and the half vector, which are \
             unit vectors with the format s1.F."),
        cosine: u32 = Key::integer("cosine.fraction", 18, 12..=20,
            "Number of fraction bits of the cosine between normal and half vector."),
        exponent_bits: u32 = common::exponent_bits().unless("highlight", "function"),
        colour_bits: u32 = Key::integer("colour.bits", 8, 2..=10,
            "Width of the coefficients of the material and of the results."),
        most: i64 = Key::integer("domain.exponent_max", 128, 16..=4095,
            "The largest n of the accuracy contract.")
            .unless("highlight", "function"),
    }
}

pub fn schema() -> Schema {
    Schema { device: "shading", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    let most = (1 << keys.exponent_bits) - 1;
    if keys.most > most {
        let message = format!(
            "the largest n, {}, does not fit the {} bits of the exponent",
            keys.most, keys.exponent_bits
        );
        let remedy =
            format!("set domain.exponent_max to at most {most}, or set a larger exponent.bits");
        problems.push("domain.exponent_max", message, remedy);
    }
}

const FORMULA: &str = "function.formula";

/// The suffixes of the operands of each light.
const SUFFIXES: [&str; 4] = ["", "2", "3", "4"];

pub struct LightParts {
    /// The `dot-product` between the normal and the direction of the light.
    pub facing: Config,
    /// The `dot-product` between the normal and the half vector.
    pub cosine: Config,
    pub highlight: HighlightPart,
}

/// Computes the reflectance f at the cosine c.
pub enum HighlightPart {
    /// A highlight device that has the exponent n as an operand, such as `blinn`.
    OfExponent(Config),
    /// The device `function` for the formula of the highlight, with its plan.
    OfFormula(Config, Box<FunctionPlan>),
}

/// Makes the parts of a configuration of `shading`, and plans the formula of the highlight. Fails, with a key of `shading`, if a
/// part refuses its configuration, or if the formula has no plan.
pub fn parts(config: &Config) -> Result<LightParts, ConfigError> {
    Keys::of(config).parts()
}

/// Makes the configuration of a part, with the module name `part`. The first problem of the part becomes an error of the key
/// `highlight`.
fn part(schema: &Schema, keys: Vec<(&str, Value)>) -> Result<Config, ConfigError> {
    let keys = keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    Config::from_values(schema, "part", keys).map_err(|problems| {
        let why = problems.iter().next().map_or_else(String::new, |it| it.error.to_string());
        let message = format!("the part `{}` of the device cannot be made: {why}", schema.device);
        ConfigError::new("highlight", message, "set other widths")
    })
}

fn integer(key: &'static str, value: i64) -> (&'static str, Value) {
    (key, Value::Integer(value))
}

struct PartSettings {
    schema: Schema,
    /// The number of fraction bits of the reflectance f.
    fraction: i64,
    /// The smallest exponent n for which the accuracy contract of `shading` is stated. For a smaller n, f can jump from a
    /// positive value to 0 where γ reaches a right angle.
    least: i64,
}

impl Keys {
    fn highlight_part(&self) -> PartSettings {
        let (schema, fraction, least) = match self.highlight {
            HighlightDevice::CosinePower => (cosine_power::schema(), 18, self.power.into()),
            HighlightDevice::Blinn => (blinn::schema(), 18, 1),
            HighlightDevice::Gauss => (gauss::schema(), 18, 16),
            HighlightDevice::Quadratic => (quadratic::schema(), 16, 1),
            HighlightDevice::Threshold => (threshold::schema(), 16, 2),
            HighlightDevice::Schlick => (schlick::schema(), 14, 1),
            HighlightDevice::Function => (function::schema(), 16, 1),
        };
        PartSettings { schema, fraction, least }
    }

    /// Returns the format of a component of the normal.
    pub fn normal_format(&self) -> Format {
        Format::signed(1, self.normal as i32)
    }

    /// Returns the format of a component of the light vector and of the half vector.
    pub fn light_format(&self) -> Format {
        Format::signed(1, self.light as i32)
    }

    /// Returns the format of a material coefficient and of a result, such as `u8.0`.
    pub fn colour_format(&self) -> Format {
        Format::unsigned(self.colour_bits as i32, 0)
    }

    pub fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    /// Returns by how many bits the colours of the highlight device are wider than a result, to make the rounding error of the
    /// highlight small: 4 for `colour.bits = 8`. They have at most 12 bits, so `colour.bits = 10` gives 2.
    pub fn guard(&self) -> u32 {
        (12 - self.colour_bits).min(4)
    }

    /// Returns the number of fraction bits of the cosine between normal and light. A colour changes less with this cosine than
    /// with the cosine of the highlight, so fewer bits suffice.
    pub fn facing(&self) -> u32 {
        self.cosine.min(self.colour_bits + 6)
    }

    /// Returns the smallest exponent n for which the accuracy contract is stated: 1 for `blinn` and `function`, 16 for `gauss`,
    /// and the key `power` for `cosine-power`.
    pub fn least(&self) -> i64 {
        self.highlight_part().least
    }

    /// Returns whether the highlight device has the operand `exponent`, which `function` lacks.
    pub fn has_exponent(&self) -> bool {
        self.highlight != HighlightDevice::Function
    }

    /// Returns the suffixes that the names of operands and parts have, one for each light: none for the first, then `2`, `3` and
    /// `4`.
    pub fn suffixes(&self) -> impl Iterator<Item = &'static str> + use<> {
        SUFFIXES.into_iter().take(self.lights as usize)
    }

    fn parts(&self) -> Result<LightParts, ConfigError> {
        let facing = self.cosine_part(self.facing())?;
        let cosine = self.cosine_part(self.cosine)?;
        let highlight = match self.has_exponent() {
            true => HighlightPart::OfExponent(self.exponent_part()?),
            false => self.formula_part()?,
        };
        Ok(LightParts { facing, cosine, highlight })
    }

    /// Returns the configuration of a `dot-product` that computes a cosine with `fraction` fraction bits. `shading` has two for
    /// each light: one for the diffuse cosine, and one for the highlight's cosine. Fails if the device `dot-product` refuses
    /// the configuration.
    fn cosine_part(&self, fraction: u32) -> Result<Config, ConfigError> {
        // The highlight's slope is n: beyond 128 each bit of n is one more of the cosine.
        let more = i64::from((self.most.max(2) - 1).ilog2()).saturating_sub(6).clamp(0, 3);
        let keys = vec![
            integer("vector.fraction", self.normal.into()),
            integer("half.fraction", self.light.into()),
            ("two_sided", Value::Flag(self.two_sided)),
            integer("table.address", 10 + (more + 1) / 2),
            integer("inverse.fraction", 21 + more),
            integer("factor.bits", 18 + more),
            integer("output.fraction", fraction.into()),
        ];
        part(&dot_product::schema(), keys)
    }

    /// Makes the configuration of the highlight device that the key `highlight` names.
    fn exponent_part(&self) -> Result<Config, ConfigError> {
        let PartSettings { schema, fraction, .. } = self.highlight_part();
        let mut keys = vec![
            integer("cosine.fraction", self.cosine.into()),
            integer("exponent.bits", self.exponent_bits.into()),
            integer("colour.bits", (self.colour_bits + self.guard()).into()),
            integer("intensity.fraction", fraction),
            integer("domain.exponent_min", self.least()),
            integer("domain.exponent_max", self.most),
        ];
        if self.highlight == HighlightDevice::CosinePower {
            keys.push(("power", Value::Text(self.power.to_string())));
        }
        part(&schema, keys)
    }

    /// Makes the device `function` for the formula of the highlight. Fails if the formula cannot be read, has no value at a
    /// cosine from 0 to 1, or has no plan.
    fn formula_part(&self) -> Result<HighlightPart, ConfigError> {
        let text = |key: &'static str, value: &str| (key.to_owned(), Value::Text(value.to_owned()));
        let integer = |key: &'static str, value: i64| (key.to_owned(), Value::Integer(value));
        let PartSettings { schema, fraction, .. } = self.highlight_part();
        let keys = vec![
            text(FORMULA, &self.formula),
            text("function.from", "0"),
            text("function.to", "1"),
            ("function.to_included".to_owned(), Value::Flag(true)),
            integer("operand.fraction", self.cosine.into()),
            integer("result.fraction", fraction),
        ];
        // The part shares only the formula with the user's file.
        const OTHER: &str = "give another formula, or set a smaller cosine.fraction";
        let of_formula = |error: ConfigError, remedy: &str| match error.key == FORMULA {
            true => ConfigError { remedy: remedy.to_owned(), ..error },
            false => ConfigError::new(FORMULA, error.message, OTHER),
        };
        let config = Config::from_values(&schema, "part", keys).map_err(|problems| {
            let first = problems.iter().next().map(|problem| problem.error.clone());
            let error = first.unwrap_or_else(|| ConfigError::new(FORMULA, "", OTHER));
            let remedy = error.remedy.clone();
            of_formula(error, &remedy)
        })?;
        let planned = function::plan(&config).map_err(|error| {
            of_formula(error, "change the formula, because the cosine x is from 0 to 1")
        })?;
        Ok(HighlightPart::OfFormula(config, Box::new(planned)))
    }
}

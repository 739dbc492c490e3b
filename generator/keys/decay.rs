//! Declares the configuration keys of the devices `blinn` and `gauss`, and computes their tables of polynomials.
//!
//! Both devices compute f = 2^(−n·decay(c)), with c = cos γ, the specular exponent n, and the decay −log₂ c in `blinn` and γ²/(2
//! ln 2) in `gauss`. One table gives the ratio of the decay to the distance 1 − c. In `blinn`, the mantissa m of the cosine, from
//! 1/2 to 1, takes the place of c. The other table gives 2^−x.

use std::sync::Arc;

use super::common::{self, Domain, Intensity, Operands};
use glint_approximate::{Curve, Outside, Piecewise, TargetFunction, Wish, find};
use glint_base::config_error::ConfigError;
use glint_base::fixed::Format;
use glint_config::{Config, Key, Problems, Schema, Value};
use glint_formula::parse;

glint_config::keys! {
    pub struct Keys {
        operands: Operands = Operands::keys(),
        ratio_fraction: u32 = Key::integer("ratio.fraction", 16, 5..=20,
            "Number of fraction bits of the decay divided by 1 - cos, which a table of polynomials gives.").drawn(5, 12),
        ratio_degree: String = degree("ratio.degree"),
        decay_fraction: u32 = Key::integer("decay.fraction", 26, 12..=30,
            "Number of fraction bits of the decay, where f = 2^(-n*decay)."),
        coarse_fraction: u32 = Key::integer("decay.coarse_fraction", 18, 8..=30,
            "Number of fraction bits of a large decay in its product with n. A decay below 1/4 keeps all \
             fraction bits."),
        argument: u32 = Key::integer("exponential.argument", 18, 4..=20,
            "Number of fraction bits of n*decay. A table of polynomials computes 2^-x from them.").drawn(4, 12),
        fraction: u32 = Key::integer("exponential.fraction", 18, 5..=24, "Number of fraction bits of 2^-x.").drawn(5, 12),
        degree: String = degree("exponential.degree"),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

/// The keys for the fraction bits and the degree of the table of the ratio.
const RATIO: [&str; 2] = ["ratio.fraction", "ratio.degree"];

/// The keys for the fraction bits and the degree of the table of 2^−x.
const EXPONENTIAL: [&str; 2] = ["exponential.fraction", "exponential.degree"];

/// Makes the key for the degree of a table's polynomials. Its default `auto` chooses the cheapest degree.
fn degree(name: &'static str) -> Key {
    Key::choice(
        name,
        "auto",
        &["auto", "1", "2", "3"],
        "The degree of the polynomials. The default has the least cost.",
    )
}

/// The decay as a function of c = cos γ, with which the device computes f = 2^(−n·decay).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decay {
    /// −log₂ c, in `blinn`. The table covers c from 1/2 to 1. A smaller c is doubled until it lies in this range; each doubling
    /// adds 1 to the decay.
    Logarithm,
    /// γ²/(2 ln 2), in `gauss`.
    Angle,
}

impl Decay {
    /// Returns the formula of the decay divided by the distance `v`: for `x`, `-log2(1 - x) / x` in `blinn`.
    fn over_distance(self, v: &str) -> String {
        match self {
            Self::Logarithm => format!("-log2(1 - {v}) / {v}"),
            Self::Angle => format!("acos(1 - {v})^2 / (2 * ln(2) * {v})"),
        }
    }

    /// Returns the largest slope of the ratio decay/(1 − c) as a function of the distance v = 1 − c, rounded up to three
    /// decimals. The ratio is convex, so the slope is largest at the largest distance: 1/(ln 2·(1 − v)·v) + log₂(1 − v)/v² at v =
    /// ½ in `blinn`, and (π − π²/4)/(2 ln 2) at v = 1 in `gauss`.
    pub fn steepest(self) -> f64 {
        match self {
            Self::Logarithm => 1.771,
            Self::Angle => 0.487,
        }
    }

    /// Returns the number of leading bits of the distance that are always 0: the distance of `blinn` is at most 1/2.
    fn known(self) -> u32 {
        u32::from(self == Self::Logarithm)
    }
}

impl Keys {
    /// Returns the number of bits of u, whose leading bits are the operand of the ratio's table. In `gauss`, u is the distance 1
    /// − c minus one unit in the last place of the cosine c. In `blinn`, the mantissa replaces c. For a cosine with 20 fraction
    /// bits u has 19 bits in `blinn` and 20 bits in `gauss`.
    pub fn distance(&self, decay: Decay) -> u32 {
        self.operands.cosine.fraction - decay.known()
    }

    /// Returns the format of the decay, whose values are below 2.0: `u1.26` for `decay.fraction = 26`. In `blinn`, this is the
    /// decay of the mantissa, without the powers of two.
    pub fn decay_format(&self) -> Format {
        Format::unsigned(1, self.decay_fraction as i32)
    }

    /// Returns the number of integer bits of the complete decay. In `blinn` the integer also counts the doublings of the cosine:
    /// 6 bits for 20 fraction bits of the cosine. In `gauss` it has 1 bit.
    fn whole_bits(&self, decay: Decay) -> u32 {
        let octave = (self.operands.cosine.fraction - 1).ilog2() + 1;
        1 + octave * decay.known()
    }

    /// Returns the width with which the decay enters the multiplier for n·decay. A decay below ¼ is multiplied with all its
    /// fraction bits, and a larger one with its integer bits and `decay.coarse_fraction` fraction bits.
    pub fn factor_bits(&self, decay: Decay) -> u32 {
        (self.decay_fraction - 2).max(self.whole_bits(decay) + self.coarse_fraction)
    }

    /// Returns the format of the product n·decay, such as `u11.18` for the defaults of `gauss`. Its integer part says how often
    /// the result is halved.
    pub fn halvings(&self, decay: Decay) -> Format {
        let whole = self.operands.exponent_bits + self.whole_bits(decay);
        Format::unsigned(whole as i32, self.argument as i32)
    }

    /// Returns the number of low bits of u that do not address the table of the ratio. The table reads one fraction bit of 1 − c
    /// more than the ratio has. 20 cosine bits and 16 ratio bits leave 3.
    pub fn unseen(&self) -> u32 {
        self.operands.cosine.fraction.saturating_sub(self.ratio_fraction + 1)
    }

    /// Returns the table of the ratio. Its operand is u without the low bits that it does not read. Its value is the ratio at the
    /// middle of all distances with the same operand. Fails with the key `ratio.fraction` if no approximation can be found.
    pub fn ratio(&self, decay: Decay) -> Result<Arc<Piecewise>, ConfigError> {
        let unseen = self.unseen();
        let fraction = self.operands.cosine.fraction - unseen;
        let middle = format!("(x + 1/2^{} + 1/2^{})", fraction + 1, fraction + unseen + 1);
        let bits = self.distance(decay) - unseen;
        let last = (1 << bits) - 1;
        let formula = decay.over_distance(&middle);
        let of = (bits as i32 - fraction as i32, fraction as i32);
        table(&formula, (last, of), self.ratio_fraction, &self.ratio_degree, RATIO)
    }

    /// Returns the table of 2^−x, where x is the fraction of n·decay. Its value is the power at the middle of the fractions that
    /// are truncated to the same x. Fails with the key `exponential.fraction` if no approximation can be found.
    pub fn power(&self) -> Result<Arc<Piecewise>, ConfigError> {
        let formula = format!("exp2(-x - 1/2^{})", self.argument + 1);
        let (last, of) = ((1 << self.argument) - 1, (0, self.argument as i32));
        table(&formula, (last, of), self.fraction, &self.degree, EXPONENTIAL)
    }
}

/// Returns the approximation of `formula` for the raw operands from 0 to `last`, with an error below one unit of the result's
/// last bit. The operand has `int` integer bits and `frac` fraction bits, and the result has `fraction` fraction bits. `degree`
/// is the value of `degree_key`. Fails if no approximation can be found, with `key`, the key for the fraction bits; the remedy
/// names both keys.
fn table(
    formula: &str,
    (last, (int, frac)): (i64, (i32, i32)),
    fraction: u32,
    degree: &str,
    [key, degree_key]: [&'static str; 2],
) -> Result<Arc<Piecewise>, ConfigError> {
    let function = TargetFunction {
        curve: Curve::Formula(parse(formula).expect("a formula of ours")),
        domain: (0, last),
        operand: Format::unsigned(int, frac),
        outside: Outside::Anything,
        fraction,
        error: 1.0,
    };
    let wish = Wish { degree: degree.parse().ok(), ..Wish::default() };
    find(&function, wish).map_err(|refusal| {
        let remedy = format!("set a smaller {key}, or set {degree_key} to \"auto\"");
        ConfigError::new(key, refusal.message, remedy)
    })
}

/// Returns the schema of `device`, with the default `nearest` for `intensity.rounding`.
pub(super) fn schema(device: &'static str, check: fn(&Config, &mut Problems)) -> Schema {
    let mut keys = Keys::keys();
    for key in &mut keys {
        if key.name == "intensity.rounding" {
            key.default = Value::Text("nearest".to_owned());
        }
    }
    Schema { device, keys, check }
}

/// Checks the keys, and whether both tables can be found. Only if the file has no other mistake, searches the tables, which can
/// take long.
pub(super) fn check(config: &Config, decay: Decay, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
    let (coarse, fine) = (keys.coarse_fraction, keys.decay_fraction);
    if coarse > fine {
        let message = format!(
            "the product with n uses {coarse} fraction bits of the decay, and the decay has only {fine}"
        );
        let remedy =
            format!("set decay.coarse_fraction to at most {fine}, or set a larger decay.fraction");
        problems.push("decay.coarse_fraction", message, remedy);
    }
    if problems.is_refused() {
        return;
    }
    for error in [keys.ratio(decay).err(), keys.power().err()].into_iter().flatten() {
        problems.push_error(error);
    }
}

//! Declares the configuration keys of the device `rough`, which computes f = (n/2·(cos(γ ± dγ) − 1) + 1)². dγ is a perturbation
//! of the normal's angle. By default, f is 0 if the base of the square is negative or if cos γ ≤ 0.

use super::common::{self, Domain, Intensity, Operands};
use glint_base::fixed::Rounding;
use glint_config::{Config, Key, Problems, Schema};

glint_config::choices! {
    /// The number system of sums and products.
    pub enum ArithmeticMode {
        /// Numbers with integer bits and signs.
        Exact = "exact",
        /// The arithmetic of the patent UA 60139. Every number is a fraction modulo 1.0, so a missing carry replaces the
        /// subtraction of 1.
        Patent = "patent",
    }
}

glint_config::choices! {
    /// The layout of ROM 18, the table of sines.
    pub enum RomLayout {
        /// The table has ranges of 1 − cos that become shorter toward cos = 1. A range consists of segments with linear
        /// interpolation. Below the last range, the table has an exact entry for each cosine.
        Segmented = "segmented",
        /// The table has one entry for each of 2^`sine.address` equally long intervals of the cosine.
        Direct = "direct",
    }
}

glint_config::keys! {
    /// In the patent's arithmetic, cosines, sines, their products and f all have `cosine.fraction` bits; `cosine.signed`,
    /// `clamp`, `product.*`, `intensity.*` and `sine.fraction` do not apply.
    pub struct Keys {
        arithmetic: ArithmeticMode = Key::choice("arithmetic", "exact", ArithmeticMode::WORDS,
            "exact: numbers have an integer bit. patent: numbers are modulo 1.0, as in UA 60139."),
        clamp: bool = exact(Key::flag("clamp", true,
            "Clamps a negative n/2*(cos - 1) + 1 to 0. Without the clamp, a ring appears around the highlight.")),
        operands: Operands = exact_of(Operands::keys(), &["cosine.signed"]),
        product_fraction: u32 = exact(Key::integer("product.fraction", 22, 8..=28,
            "Number of fraction bits of registers 11 and 12, which hold the products of cosines and of sines.")),
        product_rounding: Rounding = exact(Key::rounding("product.rounding", "truncate",
            "Rounding mode of registers 11 and 12.")),
        f: Intensity = exact_of(Intensity::keys(), &["intensity.fraction", "intensity.rounding"]),
        scheme: RomLayout = Key::choice("sine.scheme", "segmented", RomLayout::WORDS,
            "The sine table in ROM 18. segmented: linear interpolation in segments that become shorter toward \
             cos = 1. direct: one word for each address, as in the patent."),
        sine_fraction: u32 = exact(Key::integer("sine.fraction", 22, 8..=28,
            "Number of fraction bits of the sine.")),
        synchronous: bool = Key::flag("sine.synchronous", true,
            "Whether ROM 18 is read at the clock edge (block memory). If false, it is combinational (logic)."),
        address: u32 = Key::integer("sine.address", 12, 4..=16,
            "Number of address bits of the direct table.")
            .only_when("sine.scheme", "direct"),
        segments: Vec<u32> = Key::integers("sine.segments", &[6, 8, 7, 6, 5, 4, 3, 3, 2], 2..=10, 1..=11,
            "Log2 of the number of segments for each range of 1 - cos, from the top. Each range is a factor of \
             four, for example 1/4 to 1.")
            .only_when("sine.scheme", "segmented"),
        slope_fraction: u32 = Key::integer("sine.slope_fraction", 18, 8..=28,
            "Number of fraction bits of the rise over a segment.")
            .only_when("sine.scheme", "segmented"),
        domain: Domain = Domain::keys(),
        deviation: f64 = Key::number("domain.deviation", 30.0, 0.0..=90.0,
            "The largest angle between the normal and the perturbed normal, in degrees."),
    }
}

fn exact(key: Key) -> Key {
    key.only_when("arithmetic", "exact")
}

fn exact_of(keys: Vec<Key>, names: &[&str]) -> Vec<Key> {
    let keys = keys.into_iter();
    keys.map(|key| if names.contains(&key.name) { exact(key) } else { key }).collect()
}

impl Keys {
    pub fn patent(&self) -> bool {
        self.arithmetic == ArithmeticMode::Patent
    }
}

pub fn schema() -> Schema {
    Schema { device: "rough", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
    let cosine = keys.operands.cosine.fraction;
    // No combination of key values makes a net wider than 64 bits. The widest net is the product of n/2 and the output of adder
    // 15, with the fraction bits of the square: 13 + 48 bits.
    if keys.patent() && keys.operands.exponent_bits < 2 {
        let message = "n has one bit, which the patent's wiring of n/2 drops".to_owned();
        let remedy = "set exponent.bits to at least 2, or set arithmetic = \"exact\"".to_owned();
        problems.push("exponent.bits", message, remedy);
    }
    let (fraction, product) =
        if keys.patent() { (cosine, cosine) } else { (keys.sine_fraction, keys.product_fraction) };
    if product > 2 * fraction.min(cosine) {
        let message = format!(
            "the registers have {product} fraction bits, more than the products that they hold"
        );
        problems.push(
            "product.fraction",
            message,
            format!("set product.fraction to at most {}", 2 * fraction.min(cosine)),
        );
    }
    if keys.scheme == RomLayout::Direct {
        if keys.address > cosine {
            let message =
                "the sine table has more address bits than the cosine has fraction bits".to_owned();
            let remedy =
                format!("set sine.address to at most {cosine}, or set a larger cosine.fraction");
            problems.push("sine.address", message, remedy);
        }
        let remedy = "set a smaller sine.address, or set sine.scheme = \"segmented\"";
        let size = (keys.address, fraction);
        common::check_rom_size("sine.address", "ROM 18", size, remedy, problems);
        return;
    }
    let most = common::check_segments(&keys.segments, "sine.segments", cosine, problems);
    let rest = i64::from(cosine) - 2 * keys.segments.len() as i64;
    if !(0..=12).contains(&rest) {
        problems.push(
            "sine.segments",
            format!("2^{rest} exact entries would remain below the last range"),
            "set so many ranges that cosine.fraction minus two bits for each range is from 0 to 12"
                .to_owned(),
        );
    }
    let slope = keys.slope_fraction;
    if slope > fraction || most + slope < fraction {
        let message = format!(
            "the slope has {slope} fraction bits, which do not fit the {fraction} fraction bits of the sine"
        );
        let remedy = format!(
            "set sine.slope_fraction to a value from {} to {fraction}",
            fraction.saturating_sub(most).max(8)
        );
        problems.push("sine.slope_fraction", message, remedy);
    }
}

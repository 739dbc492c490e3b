//! The keys of `blinn` and `gauss`.

use super::common::{self, Domain, Intensity, Operands};
use glint_config::{Config, Key, Problems, Schema, Value};

glint_config::keys! {
    /// The keys of a configuration.
    pub struct Keys {
        operands: Operands = Operands::keys(),
        decay_fraction: u32 = Key::integer("decay.fraction", 26, 12..=28,
            "Fraction bits of the decay: f = 2^(-n*decay)."),
        segments: Vec<u32> = Key::integers("decay.segments", &[6, 5, 4, 3, 2], 2..=10, 1..=11,
            "log2 of the straight segments for each factor of four of 1 - cos, from the top."),
        tail: u32 = Key::integer("decay.tail", 1, 0..=6,
            "log2 of the segments into which what lies below the last of these is cut."),
        slope_fraction: u32 = Key::integer("decay.slope_fraction", 24, 8..=28,
            "Fraction bits of the rise over a segment."),
        coarse_fraction: u32 = Key::integer("decay.coarse_fraction", 19, 8..=28,
            "Fraction bits with which a decay that is not small is multiplied by n; a small one keeps all."),
        address: u32 = Key::integer("exponential.address", 7, 3..=10,
            "Leading bits of the fraction of n*decay that address the table of 2^-x."),
        offset_bits: Vec<u32> = Key::integers("exponential.offset_bits", &[2, 3, 4], 2..=5, 1..=3,
            "Bits of the fields below them, each with a table of offsets."),
        offset_address: Vec<u32> = Key::integers("exponential.offset_address", &[6, 5, 3], 0..=10, 1..=3,
            "Leading bits that choose the slope of each of these tables."),
        fraction: u32 = Key::integer("exponential.fraction", 19, 8..=24,
            "Fraction bits of the tables of 2^-x."),
        synchronous: bool = Key::flag("tables.synchronous", true,
            "The tables read on the clock edge (block RAM) instead of at once (logic)."),
        f: Intensity = Intensity::keys(),
        domain: Domain = Domain::keys(),
    }
}

impl Keys {
    /// The fields of the fraction of n·decay below the address, from the top: bits, and leading bits that choose a slope.
    pub fn offsets(&self) -> impl Iterator<Item = (u32, u32)> {
        self.offset_bits.iter().copied().zip(self.offset_address.iter().copied())
    }
}

/// The keys of one of the devices, which has so many coarse fraction bits by default.
pub(super) fn schema(
    device: &'static str,
    coarse_fraction: i64,
    check: fn(&Config, &mut Problems),
) -> Schema {
    let mut keys = Keys::keys();
    for key in &mut keys {
        match key.name {
            "decay.coarse_fraction" => key.default = Value::Integer(coarse_fraction),
            "intensity.rounding" => key.default = Value::Text("nearest".to_owned()),
            _ => {}
        }
    }
    Schema { device, keys, check }
}

/// The most bits of a fraction of n·decay.
const MOST_EXPONENT_BITS: u32 = 20;

/// The conditions between keys; the table's operand has so many bits fewer than the cosine.
pub(super) fn check(config: &Config, known: u32, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.operands.exponent_bits, problems);
    check_decay(&keys, keys.operands.cosine.fraction - known, problems);
    let (address, bits, addresses) = (keys.address, &keys.offset_bits, &keys.offset_address);
    if addresses.len() != bits.len() {
        problems.push(
            "exponential.offset_address",
            format!(
                "{} entries for the {} fields of exponential.offset_bits",
                addresses.len(),
                bits.len()
            ),
            "one entry for each field".to_owned(),
        );
    }
    if let Some(most) = addresses.iter().find(|&&most| most > address) {
        problems.push(
            "exponential.offset_address",
            format!(
                "a slope cannot be chosen by {most} of the {address} bits of exponential.address"
            ),
            format!("at most {address}, or a larger exponential.address"),
        );
    }
    let total = address + bits.iter().sum::<u32>();
    if total > MOST_EXPONENT_BITS {
        problems.push(
            "exponential.offset_bits",
            format!("with exponential.address the fraction of n*decay would have {total} bits"),
            format!("fewer or smaller fields, for at most {MOST_EXPONENT_BITS} bits in all"),
        );
    }
}

fn check_decay(keys: &Keys, operand_bits: u32, problems: &mut Problems) {
    // A factor of four takes two bits; below the last bit there are none.
    let rest = operand_bits.saturating_sub(2 * keys.segments.len() as u32);
    if rest < keys.tail {
        problems.push(
            "decay.segments",
            format!(
                "{rest} of the {operand_bits} bits of 1 - cos would remain for the tail below the last range"
            ),
            "fewer ranges, a smaller decay.tail, or a larger cosine.fraction".to_owned(),
        );
    }
    common::check_segments(&keys.segments, "decay.segments", operand_bits, problems);
    let fraction = keys.decay_fraction;
    for (key, bits, what) in [
        ("decay.slope_fraction", keys.slope_fraction, "the rise over a segment"),
        ("decay.coarse_fraction", keys.coarse_fraction, "the decay for the product by n"),
    ] {
        if bits > fraction {
            problems.push(
                key,
                format!("{bits} fraction bits of {what} do not go with {fraction} of the decay"),
                format!("at most {fraction}, or a larger decay.fraction"),
            );
        }
    }
}

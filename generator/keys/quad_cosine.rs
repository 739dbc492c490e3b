//! Declares the configuration keys of the device `quad-cosine`, which computes f = cosᵏ(√(n/k)·δ) for the points of a scan
//! line. δ is an angle, and n the specular exponent.

use super::common::{self, Domain};
use glint_base::fixed::{Format, Rounding};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        angle_fraction: u32 = common::angle_fraction(26),
        angle_multiplied: u32 = Key::integer("angle.multiplied", 17, 4..=24,
            "Number of leading fraction bits of the angle that multiplier 11 uses."),
        root_fraction: u32 = Key::integer("root.fraction", 14, 8..=20,
            "Number of fraction bits of sqrt(n/k) in ROM 9."),
        table_address: u32 = common::table_address(11),
        length_bits: u32 = common::length_bits(),
        stages: u32 = common::line_stages(&["2", "7"]),
        exponent_bits: u32 = common::exponent_bits(),
        colour_bits: u32 = common::colour_bits(),
        fraction: u32 = common::intensity_fraction(10),
        output_rounding: Rounding = common::output_rounding(),
        domain: Domain = Domain::keys(),
    }
}

impl Keys {
    /// Returns the format of an angle, in right angles: `s1.26` by default.
    pub fn angle_format(&self) -> Format {
        Format::signed(1, self.angle_fraction as i32)
    }

    /// Returns the format of f: `u0.10` by default.
    pub fn f_format(&self) -> Format {
        Format::unsigned(0, self.fraction as i32)
    }
}

pub fn schema() -> Schema {
    Schema { device: "quad-cosine", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.exponent_bits, problems);
    if keys.exponent_bits < 3 {
        let message = "decoder 10 compares n with 7, and this takes three bits".to_owned();
        problems.push("exponent.bits", message, "set exponent.bits to at least 3".to_owned());
    }
    let fraction = keys.angle_fraction;
    if keys.angle_multiplied > fraction {
        let message = format!(
            "multiplier 11 uses more bits of the angle than the angle has fraction bits, {fraction}"
        );
        let remedy =
            format!("set angle.multiplied to at most {fraction}, or set a larger angle.fraction");
        problems.push("angle.multiplied", message, remedy);
    }
    let product = keys.angle_multiplied + keys.root_fraction;
    if keys.table_address > product {
        let message = format!(
            "each table has more address bits than the angle times the root has fraction bits, {product}"
        );
        let remedy = format!(
            "set table.address to at most {product}, or set a larger angle.multiplied or root.fraction"
        );
        problems.push("table.address", message, remedy);
    }
    let size = (keys.table_address + 2, keys.fraction);
    let remedy = "set a smaller table.address or a smaller intensity.fraction";
    common::check_rom_size("table.address", "ROM 12", size, remedy, problems);
}

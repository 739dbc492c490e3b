//! Declares the configuration keys of the device `quad-cosine`, and checks that their values are valid together.
//!
//! `quad-cosine` computes f = cosᵏ(√(n/k)·δ) for the points of a scan line, where δ is an angle and n is the specular exponent.
//! For example, the key `exponent.bits` sets the width of n.

use super::common::{self, Domain};
use glint_base::fixed::{Format, Rounding};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    /// The values of a configuration of the device `quad-cosine`, one field for each of its keys.
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
    /// Returns the format of an angle along the scan line, in right angles. For example, the defaults give `s1.26`.
    pub fn angle_format(&self) -> Format {
        Format::signed(1, self.angle_fraction as i32)
    }

    /// Returns the format of the reflectance f. For example, the default gives `u0.10`.
    pub fn f_format(&self) -> Format {
        Format::unsigned(0, self.fraction as i32)
    }
}

/// Returns the schema of the device `quad-cosine`: its configuration keys, and the check of their combinations.
pub fn schema() -> Schema {
    Schema { device: "quad-cosine", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    common::check_exponents(&keys.domain, keys.exponent_bits, problems);
    if keys.exponent_bits < 3 {
        let message = "decoder 10 tells n = 7 from smaller ones, which takes three bits".to_owned();
        problems.push("exponent.bits", message, "at least 3".to_owned());
    }
    let fraction = keys.angle_fraction;
    if keys.angle_multiplied > fraction {
        let message = format!("the angle has {fraction} fraction bits");
        let remedy = format!("at most {fraction}, or a larger angle.fraction");
        problems.push("angle.multiplied", message, remedy);
    }
    let product = keys.angle_multiplied + keys.root_fraction;
    if keys.table_address > product {
        let message = format!("the angle times the root has {product} fraction bits");
        let remedy = format!("at most {product}, or a larger angle.multiplied or root.fraction");
        problems.push("table.address", message, remedy);
    }
    let size = (keys.table_address + 2, keys.fraction);
    let remedy = "fewer address bits or narrower entries";
    common::check_rom_size("table.address", "ROM 12", size, remedy, problems);
}

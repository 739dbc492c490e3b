//! Declares the configuration keys of the device `cosine-squared`, which computes f = cos²(a·δ) for the points of a scan line.
//! δ is an angle that changes from point to point, and a is a factor that stretches it.

use super::common;
use glint_base::fixed::{Format, Rounding};
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        angle_integer: u32 = Key::integer("angle.integer", 7, 1..=8,
            "Number of integer bits of the stretched angles, which are signed and in right angles."),
        angle_fraction: u32 = common::angle_fraction(22),
        table_address: u32 = common::table_address(10),
        length_bits: u32 = common::length_bits(),
        stages: u32 = common::line_stages(&["2", "5"]),
        colour_bits: u32 = common::colour_bits(),
        fraction: u32 = common::intensity_fraction(10),
        output_rounding: Rounding = common::output_rounding(),
    }
}

impl Keys {
    /// Returns the format of a stretched angle, in right angles: `s7.22` by default.
    pub fn angle_format(&self) -> Format {
        Format::signed(self.angle_integer as i32, self.angle_fraction as i32)
    }

    /// Returns the format of f: `u0.10` by default.
    pub fn f_format(&self) -> Format {
        Format::unsigned(0, self.fraction as i32)
    }
}

pub fn schema() -> Schema {
    Schema { device: "cosine-squared", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    let fraction = keys.angle_fraction;
    if keys.table_address > fraction {
        let message =
            format!("the table has more address bits than the angle has fraction bits, {fraction}");
        let remedy =
            format!("set table.address to at most {fraction}, or set a larger angle.fraction");
        problems.push("table.address", message, remedy);
    }
    let size = (keys.table_address, keys.fraction);
    let remedy = "set a smaller table.address or a smaller intensity.fraction";
    common::check_rom_size("table.address", "ROM 12", size, remedy, problems);
}

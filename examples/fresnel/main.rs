//! Defines a device that is not in Glint's catalogue: Schlick's approximation of the Fresnel factor.
//!
//! The program has Glint's whole command line, with this device as the only one:
//!
//! ```sh
//! cargo run --release --example fresnel -- new fresnel > f.toml
//! cargo run --release --example fresnel -- generate f.toml --out /tmp/x
//! cargo run --release --example fresnel -- cosim f.toml --simulator verilator
//! cargo run --release --example fresnel -- eval f.toml cos_half=0.1 f0=0.04
//! ```
//!
//! At a grazing angle, every surface reflects like a mirror. C. Schlick ("An Inexpensive BRDF Model for Physically-based
//! Rendering", Computer Graphics Forum 13(3), 1994) approximates this by
//!
//! ```text
//! f = f0 + (1 − f0)·(1 − c)⁵
//! ```
//!
//! where c is the cosine of the angle between the direction of the light and the half vector, and f0 is the reflectance at
//! normal incidence: 0.04 for glass, 0.95 for silver. The device multiplies the three colours by f. The device has one
//! multiplier for f, which a microprogram of six microinstructions uses four times.
//!
//! A device has five parts: configuration keys, a description, a golden model, an accuracy contract, and a constant that ties
//! them together. Keys and constant are in this file. The description is in `description.rs`; golden model and contract are in
//! `golden.rs`. Description and golden model share nothing but the keys.

mod description;
pub mod golden;

use std::process::ExitCode;
use std::sync::Arc;

use glint::config::{Config, Key, Problems, Schema};
use glint::fixed::Rounding;
use glint::registry::{Device, KeyParts, Registry};

// The configuration keys, which the user of the device may set. The command `new` writes the keys into a commented file, with
// these sentences; a file with a wrong value is refused with its line and a remedy.

glint::keys! {
    struct Keys {
        cosine: u32 = Key::integer("cosine.fraction", 10, 4..=16,
            "Fraction bits of cos_half, u1.F."),
        reflectance: u32 = Key::integer("reflectance.fraction", 8, 4..=16,
            "Fraction bits of f0, u0.F."),
        power: u32 = Key::integer("power.fraction", 12, 4..=24,
            "Fraction bits of the powers of 1 - c and of f, u0.F: the width of the multiplier."),
        rounding: Rounding = Key::rounding("power.rounding", "nearest",
            "How the powers and f are rounded."),
        colour_bits: u32 = Key::integer("colour.bits", 8, 4..=16,
            "Bits of colour operands and outputs."),
        output_rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "How the outputs are rounded."),
    }
}

fn schema() -> Schema {
    Schema { device: "fresnel", keys: Keys::keys(), check }
}

/// The multiplier takes 1 − c and 1 − f0 whole, so they have no more fraction bits than the powers.
fn check(config: &Config, problems: &mut Problems) {
    let Keys { power, cosine, reflectance, .. } = Keys::of(config);
    for (key, bits) in [("cosine.fraction", cosine), ("reflectance.fraction", reflectance)] {
        if bits > power {
            problems.push(
                key,
                format!("more fraction bits than the {power} of power.fraction"),
                format!("at most {power}, or a larger power.fraction"),
            );
        }
    }
}

// The line that ties all together, and the command line.

/// The device.
pub const FRESNEL: Device = Device {
    name: "fresnel",
    summary: "Schlick's Fresnel factor, f0 + (1 - f0)*(1 - c)^5",
    schema,
    parts: |_| {
        Ok(Arc::new(KeyParts {
            describe: description::describe,
            model: golden::model,
            contract: golden::contract,
        }))
    },
    proved: false,
};

fn main() -> ExitCode {
    glint::cli::run(&Registry::empty().with(FRESNEL))
}

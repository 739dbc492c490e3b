//! A device with several signed outputs: a vector of any length to the unit vector of its direction.
//!
//! ```text
//! (x, y, z) / sqrt(x² + y² + z²)
//! ```
//!
//! The sum of squares is shifted until it is from 1 to 4 (leading zeros by pairs, which halve under the root), a table
//! with straight segments gives the inverse of its root, and three products with the components, shifted as far,
//! are the result. Of the zero vector, which has no direction, it makes zeros.
//!
//! ```sh
//! cargo run --release --example normaliser -- new normaliser > n.toml
//! cargo run --release --example normaliser -- cosim n.toml --simulator verilator
//! cargo run --release --example normaliser -- eval n.toml x=0.3 y=-0.4 z=0
//! ```

mod description;
mod golden;

use std::process::ExitCode;

use glint::config::{Config, Key, Problems, Schema};
use glint::fixed::Rounding;
use glint::registry::{Device, Registry};

glint::keys! {
    struct Keys {
        fraction: u32 = Key::integer("vector.fraction", 14, 2..=14,
            "Fraction bits of a component, s1.F."),
        address: u32 = Key::integer("table.address", 9, 3..=12,
            "Leading bits of the sum that choose a segment."),
        inverse: u32 = Key::integer("inverse.fraction", 20, 6..=24,
            "Fraction bits of the inverse root, u1.R."),
        kept: u32 = Key::integer("output.fraction", 14, 2..=20, "Fraction bits of a result, s1.C."),
        rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "How the components of the unit vector are rounded."),
    }
}

fn schema() -> Schema {
    Schema { device: "normaliser", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let Keys { fraction, address, inverse, kept, .. } = Keys::of(config);
    let sum = 2 * fraction + 4;
    if address >= sum {
        problems.push(
            "table.address",
            format!("the sum of squares has {sum} bits, of which one at least is left for the way along a segment"),
            format!("at most {}, or a larger vector.fraction", sum - 1),
        );
    }
    if inverse < address {
        problems.push(
            "inverse.fraction",
            format!("coarser than the {address} bits of table.address"),
            format!("at least {address}"),
        );
    }
    if kept > inverse {
        problems.push(
            "output.fraction",
            format!("more fraction bits than the {inverse} of the inverse root"),
            format!("at most {inverse}, or a larger inverse.fraction"),
        );
    }
}

/// The device.
pub const NORMALISER: Device = Device {
    name: "normaliser",
    summary: "(x, y, z)/sqrt(x^2 + y^2 + z^2), by a table of inverse roots",
    schema,
    describe: description::describe,
    model: golden::model,
    contract: golden::contract,
};

fn main() -> ExitCode {
    glint::cli::run(&Registry::empty().with(NORMALISER))
}

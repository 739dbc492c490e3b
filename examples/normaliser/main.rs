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
use glint::registry::{Device, Registry};

fn schema() -> Schema {
    let rounding = "How the components of the unit vector are rounded.";
    Schema {
        device: "normaliser",
        keys: vec![
            Key::integer("vector.fraction", 14, 2..=14, "Fraction bits of a component, s1.F."),
            Key::integer(
                "table.address",
                9,
                3..=12,
                "Leading bits of the sum that choose a segment.",
            ),
            Key::integer(
                "inverse.fraction",
                20,
                6..=24,
                "Fraction bits of the inverse root, u1.R.",
            ),
            Key::integer("output.fraction", 14, 2..=20, "Fraction bits of a result, s1.C."),
            Key::choice("output.rounding", "nearest", &["truncate", "nearest"], rounding),
        ],
        check,
    }
}

fn check(config: &Config, problems: &mut Problems) {
    let address = config.integer("table.address");
    let sum = 2 * config.integer("vector.fraction") + 4;
    if address >= sum {
        problems.push(
            "table.address",
            format!("the sum of squares has {sum} bits, of which one at least is left for the way along a segment"),
            format!("at most {}, or a larger vector.fraction", sum - 1),
        );
    }
    let inverse = config.integer("inverse.fraction");
    if inverse < address {
        problems.push(
            "inverse.fraction",
            format!("coarser than the {address} bits of table.address"),
            format!("at least {address}"),
        );
    }
    if config.integer("output.fraction") > inverse {
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

//! A device that is no highlight: the cosine from which all highlights start, max(0, N·H).
//!
//! N is the unit normal and H the unit half vector; `examples/normaliser` makes unit vectors of any. The device has
//! three components of each, one multiplier that a microprogram uses three times, and one output. Nothing in it
//! multiplies a colour, or knows γ and n.
//!
//! ```sh
//! cargo run --release --example dot_product -- cosim d.toml
//! cargo run --release --example dot_product -- eval d.toml nx=0.6 nz=0.8 hx=0 hz=1
//! ```

mod description;
mod golden;

use std::process::ExitCode;

use glint::config::{Config, Key, Problems, Schema};
use glint::fixed::Rounding;
use glint::registry::{Device, Registry};

glint::keys! {
    struct Keys {
        fraction: u32 = Key::integer("vector.fraction", 14, 2..=20,
            "Fraction bits of a component, s1.F."),
        kept: u32 = Key::integer("output.fraction", 14, 2..=20,
            "Fraction bits of the cosine, u1.C."),
        rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "How the cosine is rounded."),
    }
}

fn schema() -> Schema {
    Schema { device: "dot-product", keys: Keys::keys(), check }
}

/// The sum of products has twice the fraction bits of a component, and the cosine is rounded from it.
fn check(config: &Config, problems: &mut Problems) {
    let keys = Keys::of(config);
    let most = 2 * keys.fraction;
    if keys.kept > most {
        problems.push(
            "output.fraction",
            format!("more fraction bits than the {most} of a product of components"),
            format!("at most {most}, or a larger vector.fraction"),
        );
    }
}

/// The device.
pub const DOT_PRODUCT: Device = Device {
    name: "dot-product",
    summary: "max(0, N.H) of two unit vectors, the cosine that highlights start from",
    schema,
    describe: description::describe,
    model: golden::model,
    contract: golden::contract,
};

fn main() -> ExitCode {
    glint::cli::run(&Registry::empty().with(DOT_PRODUCT))
}

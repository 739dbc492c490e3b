//! Declares the configuration keys of the device `normaliser`, which computes the unit vector in the direction of a vector of
//! any length.

use glint_base::fixed::Rounding;
use glint_config::{Config, Key, Problems, Schema};

glint_config::keys! {
    pub struct Keys {
        fraction: u32 = Key::integer("vector.fraction", 14, 2..=14,
            "Number of fraction bits F of the components of the vector, whose format is s1.F."),
        address: u32 = address(),
        inverse: u32 = inverse(),
        kept: u32 = Key::integer("output.fraction", 14, 2..=20, "Number of fraction bits C of the results, whose format is s1.C."),
        rounding: Rounding = Key::rounding("output.rounding", "nearest",
            "Rounding mode of the components of the unit vector."),
    }
}

/// Makes the key `table.address`, the number of leading bits of the sum of squares that select a segment in the table of
/// inverse roots.
pub(super) fn address() -> Key {
    let doc = "Number of leading bits of the sum of squares that select a segment.";
    Key::integer("table.address", 9, 3..=12, doc)
}

/// Makes the key `inverse.fraction`, the number of fraction bits of the inverse root that the table gives.
pub(super) fn inverse() -> Key {
    Key::integer(
        "inverse.fraction",
        20,
        6..=24,
        "Number of fraction bits R of the inverse root, whose format is u1.R.",
    )
}

pub fn schema() -> Schema {
    Schema { device: "normaliser", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let Keys { fraction, address, inverse, kept, .. } = Keys::of(config);
    check_root(fraction, address, inverse, problems);
    if kept > inverse {
        let message = format!(
            "the results have more fraction bits than the inverse root, which has {inverse}"
        );
        let remedy =
            format!("set output.fraction to at most {inverse}, or set a larger inverse.fraction");
        problems.push("output.fraction", message, remedy);
    }
}

/// Checks the table of inverse roots for components with `fraction` fraction bits. The sum of squares must have more bits than
/// `address`, and `inverse` must not be below `address`.
pub(super) fn check_root(fraction: u32, address: u32, inverse: u32, problems: &mut Problems) {
    let sum = 2 * fraction + 4;
    if address >= sum {
        let message = format!(
            "the sum of squares has {sum} bits, and at least one of these bits must select the position \
             within a segment"
        );
        let remedy =
            format!("set table.address to at most {}, or set a larger vector.fraction", sum - 1);
        problems.push("table.address", message, remedy);
    }
    if inverse < address {
        let message =
            format!("the inverse root has fewer fraction bits than table.address has, {address}");
        problems.push(
            "inverse.fraction",
            message,
            format!("set inverse.fraction to at least {address}"),
        );
    }
}

//! The device `parabola`, which computes x².
//!
//! A device has five parts: configuration keys, a description of the hardware, a golden model, an accuracy contract, and a
//! constant that ties them together. Keys and constant are in this file. The description is in `description.rs`; golden model and
//! accuracy contract are in `golden.rs`. Description and golden model share nothing but the keys: Glint compares the two clock by
//! clock.

mod description;
mod golden;

use std::sync::Arc;

use glint::config::{Key, Schema};
use glint::registry::{Device, KeyParts};

glint::keys! {
    /// The configuration keys, which the user of the device may set. The command `new` writes the keys and their descriptions
    /// into a configuration file.
    struct Keys {
        operand: u32 = Key::integer("x.fraction", 12, 4..=16, "Fraction bits of x, u0.F."),
        result: u32 = Key::integer("result.fraction", 12, 4..=16, "Fraction bits of the result, u1.F."),
    }
}

fn schema() -> Schema {
    // `check` reports combinations of keys that the device cannot have. This device can have every combination.
    Schema { device: "parabola", keys: Keys::keys(), check: |_, _| {} }
}

/// The device.
pub const DEVICE: Device = Device {
    name: "parabola",
    summary: "x^2 of a fraction",
    schema,
    parts: |_| {
        Ok(Arc::new(KeyParts {
            describe: description::describe,
            model: golden::model,
            contract: golden::contract,
        }))
    },
    // `true` would say that a record proves the bound of the contract.
    proved: false,
};

//! The command line of Glint, with only this device: `cargo run -- --help`.

use std::process::ExitCode;

use glint::registry::Registry;

fn main() -> ExitCode {
    glint::cli::run(&Registry::empty().with(parabola_device::DEVICE))
}

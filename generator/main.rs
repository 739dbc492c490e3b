//! The command line of all devices.

use std::process::ExitCode;

fn main() -> ExitCode {
    glint::cli::run(&glint::registry::Registry::all())
}

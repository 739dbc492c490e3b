//! The program `glint`: the command line with the devices that Glint ships. A program with devices of its own calls
//! [`glint::cli::run`] with another registry.

use std::process::ExitCode;

fn main() -> ExitCode {
    glint::cli::run_as("glint", &glint::registry::Registry::shipped())
}

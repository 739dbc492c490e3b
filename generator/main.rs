//! The program `glint`: the command line with the devices of Glint's own registry.

use std::process::ExitCode;

fn main() -> ExitCode {
    glint::cli::run_as("glint", &glint::registry::Registry::shipped())
}

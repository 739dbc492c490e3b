//! The command line of the catalogue.

use std::process::ExitCode;

fn main() -> ExitCode {
    glint::cli::run_as("glint", &glint::registry::Registry::shipped())
}

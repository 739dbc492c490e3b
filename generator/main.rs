//! The command line of the catalogue.

use std::process::ExitCode;

fn main() -> ExitCode {
    glint::cli::run(&glint::registry::Registry::shipped())
}

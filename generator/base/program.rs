//! Holds the name of the running program, for messages that tell a user which command to type.

use std::fmt;
use std::sync::OnceLock;

static NAME: OnceLock<String> = OnceLock::new();

/// Prints the name of the running program. The name is `glint`, unless a program with its own devices has set a different one
/// with [`run_as`].
#[derive(Clone, Copy, Debug)]
pub struct Program;

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(NAME.get().map_or("glint", String::as_str))
    }
}

/// Sets the name of the running program for `Program`. Only the first call has an effect.
pub fn run_as(name: &str) {
    NAME.get_or_init(|| name.to_owned());
}

//! Stores the name of the running program, for messages that tell a user which command to type. The name is `glint`, unless a
//! program with its own devices sets another name with [`run_as`].

use std::fmt;
use std::sync::OnceLock;

static NAME: OnceLock<String> = OnceLock::new();

/// The name of the running program, for use in messages: `glint`, unless [`run_as`] has set another name. For example, a report
/// of mistakes ends with "`glint explain G0203` says more".
#[derive(Clone, Copy, Debug)]
pub struct Program;

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(NAME.get().map_or("glint", String::as_str))
    }
}

/// Sets the name of the running program. Only the first call has an effect.
pub fn run_as(name: &str) {
    NAME.get_or_init(|| name.to_owned());
}

//! Code that the tests in `tests/quick` and `tests/tools` share.

// Each test crate uses a part of this.
#![allow(dead_code)]

pub mod bench;
pub mod cores;
pub mod files;
pub mod host;
pub mod json;
pub mod netlist;
pub mod random_netlist;
pub mod said;
pub mod sample;
pub mod tools;
pub mod waveform;

use std::fmt::Display;

/// A result without which a test cannot go on.
pub trait Sure<T> {
    /// Returns the value.
    ///
    /// # Panics
    /// There is an error, which is told with its causes.
    fn sure(self) -> T;

    /// Returns the value of what is named in the message otherwise.
    ///
    /// # Panics
    /// There is an error, which is told with its causes.
    fn sure_of(self, what: impl Display) -> T;
}

impl<T, E: Display> Sure<T> for Result<T, E> {
    #[track_caller]
    fn sure(self) -> T {
        self.unwrap_or_else(|error| panic!("{error:#}"))
    }

    #[track_caller]
    fn sure_of(self, what: impl Display) -> T {
        self.unwrap_or_else(|error| panic!("{what}: {error:#}"))
    }
}

/// Returns the number of cases of a fuzz test: `all` with `GLINT_TESTS=all`, a third of them otherwise, or what `GLINT_FUZZ_CASES`
/// says.
///
/// # Panics
/// Panics if `GLINT_FUZZ_CASES` is no number.
pub fn cases(all: u32) -> u32 {
    match std::env::var("GLINT_FUZZ_CASES") {
        Ok(text) => text.parse().expect("GLINT_FUZZ_CASES is a number"),
        Err(_) if std::env::var("GLINT_TESTS").is_ok() => all,
        Err(_) => all.div_ceil(3),
    }
}

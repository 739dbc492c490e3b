//! The shared parts of the tests.

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

/// Cases of a fuzz test: so many by default, or what `GLINT_FUZZ_CASES` says.
///
/// # Panics
/// It does not say a number.
pub fn cases(default: u32) -> u32 {
    match std::env::var("GLINT_FUZZ_CASES") {
        Ok(text) => text.parse().expect("GLINT_FUZZ_CASES is a number"),
        Err(_) => default,
    }
}

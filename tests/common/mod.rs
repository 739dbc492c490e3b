//! The shared parts of the tests.

pub mod bench;
pub mod cores;
pub mod host;
pub mod netlist;
pub mod said;
pub mod sample;
pub mod tools;

/// Cases of a fuzz test: so many by default, or what `GLINT_FUZZ_CASES` says.
///
/// # Panics
/// It does not say a number.
#[allow(dead_code)]
pub fn cases(default: u32) -> u32 {
    match std::env::var("GLINT_FUZZ_CASES") {
        Ok(text) => text.parse().expect("GLINT_FUZZ_CASES is a number"),
        Err(_) => default,
    }
}

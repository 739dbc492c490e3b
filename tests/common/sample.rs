//! Draws the sample of a long test that a default run executes. The sample is the same in every run and for every commit, so that a
//! test fails only because of a change in the tree.
//!
//! `GLINT_SAMPLE=TEXT` draws another sample, and `GLINT_TESTS=all` runs all cases. `bash tools/test --draw` and `--all` set these
//! variables.

use std::env;

use proptest::test_runner::RngSeed;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// `count` of the items, in their order; all of them with `GLINT_TESTS=all`.
///
/// The text in `GLINT_SAMPLE` decides what is drawn. What was drawn is in the output of a test that fails.
///
/// # Panics
/// `GLINT_TESTS` says something else.
pub fn sampled<T>(what: &str, items: impl IntoIterator<Item = T>, count: usize) -> Vec<T> {
    let mut items: Vec<(usize, T)> = items.into_iter().enumerate().collect();
    match env::var("GLINT_TESTS").as_deref() {
        Err(_) => {}
        Ok("all") => return items.into_iter().map(|(_, item)| item).collect(),
        Ok(other) => panic!("GLINT_TESTS is `{other}`; it can be `all`"),
    }
    let (of, drawn_by) = (items.len(), drawn_by());
    let mut random = ChaCha8Rng::from_seed(seed(&format!("{drawn_by} {what}")));
    // The first `count` places of a shuffle.
    for at in 0..count.min(of) {
        let other = at + (random.next_u64() % (of - at) as u64) as usize;
        items.swap(at, other);
    }
    items.truncate(count);
    items.sort_by_key(|(place, _)| *place);
    println!(
        "{what}: {} of {of}, drawn by GLINT_SAMPLE={drawn_by}; GLINT_TESTS=all for all",
        items.len()
    );
    items.into_iter().map(|(_, item)| item).collect()
}

/// The text that draws the sample of a default run.
const FIXED: &str = "fixed";

/// Returns the text in `GLINT_SAMPLE`, or [`FIXED`].
fn drawn_by() -> String {
    env::var("GLINT_SAMPLE").unwrap_or_else(|_| FIXED.to_owned())
}

/// Returns the seed of the random inputs of proptest: the same in every run, unless `GLINT_SAMPLE` has another text.
pub fn fuzz_seed() -> RngSeed {
    let bytes = seed(&format!("{} proptest", drawn_by()));
    RngSeed::Fixed(u64::from_le_bytes(std::array::from_fn(|at| bytes[at])))
}

/// SHA-256 of a text.
fn seed(text: &str) -> [u8; 32] {
    use sha2::{Digest, Sha256};
    Sha256::digest(text.as_bytes()).into()
}

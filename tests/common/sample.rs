//! Draws the sample of a long test that a default run executes. The commit decides the sample, so that over time all cases run.
//!
//! `GLINT_TESTS=all` runs all cases, and `GLINT_SAMPLE` replaces the commit.

use std::env;
use std::process::Command;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// `count` of the items, in their order; all of them with `GLINT_TESTS=all`.
///
/// The commit draws, or the text in `GLINT_SAMPLE`. What was drawn is in the output of a test that fails.
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

/// Returns the seed: `GLINT_SAMPLE`, or the commit, or in a tree without a history the version.
fn drawn_by() -> String {
    env::var("GLINT_SAMPLE")
        .ok()
        .or_else(commit)
        .unwrap_or_else(|| env!("CARGO_PKG_VERSION").into())
}

fn commit() -> Option<String> {
    let mut git = Command::new("git");
    let output = git.args(["rev-parse", "--short=12", "HEAD"]).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// SHA-256 of a text.
fn seed(text: &str) -> [u8; 32] {
    use sha2::{Digest, Sha256};
    Sha256::digest(text.as_bytes()).into()
}

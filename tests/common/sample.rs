//! Takes the cases of a long test that a run executes: a few fixed cases in a default run, the same for every commit, so that a test
//! fails only because of a change in the tree.
//!
//! `tests/kinds.toml` has the kinds of these checks, with the cases of each. `GLINT_SAMPLE=TEXT` draws cases at random instead, and
//! `GLINT_TESTS=all` runs all cases. `bash tools/test --draw` and `--all` set these variables.

use std::collections::BTreeMap;
use std::env;

use proptest::test_runner::RngSeed;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use serde::Deserialize;

/// A kind of check of which a run takes some cases, as in `tests/kinds.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckKind {
    /// The name of the test binary and of the test.
    pub test: String,
    /// What the test checks of each case.
    pub checks: String,
    pub fixed: FixedCases,
    /// How many cases `bash tools/test --draw` draws.
    pub drawn: usize,
}

/// The cases of a default run.
#[derive(Deserialize)]
#[serde(untagged)]
pub enum FixedCases {
    /// How many cases.
    Count(usize),
    /// The names of the cases.
    Names(Vec<String>),
}

/// The cases that a run takes.
enum Taken {
    All,
    Fixed,
    /// Cases drawn by this text.
    Drawn(String),
}

impl Taken {
    /// Returns the cases that the environment asks for.
    ///
    /// # Panics
    /// `GLINT_TESTS` has a value other than `all`.
    fn by_environment() -> Self {
        match env::var("GLINT_TESTS").as_deref() {
            Err(_) => env::var("GLINT_SAMPLE").map_or(Self::Fixed, Self::Drawn),
            Ok("all") => Self::All,
            Ok(other) => panic!("GLINT_TESTS is `{other}`; it can be `all`"),
        }
    }
}

/// Returns the kinds in `tests/kinds.toml`, by name.
///
/// # Panics
/// The file is wrong.
pub fn kinds() -> BTreeMap<String, CheckKind> {
    toml::from_str(include_str!("../kinds.toml")).expect("tests/kinds.toml")
}

fn kind_of(name: &str) -> CheckKind {
    let kind = kinds().remove(name);
    kind.unwrap_or_else(|| panic!("tests/kinds.toml has no kind `{name}`"))
}

/// Returns the cases of a kind that this run takes, in the order of `items`.
///
/// # Panics
/// There is no such kind, its fixed cases have names, or `GLINT_TESTS` is wrong.
pub fn sampled<T>(kind: &str, items: impl IntoIterator<Item = T>) -> Vec<T> {
    sampled_for("", kind, items)
}

/// Returns the cases of a kind that this run takes for a subject, for example of faults of one device, in the order of `items`.
///
/// # Panics
/// There is no such kind, its fixed cases have names, or `GLINT_TESTS` is wrong.
pub fn sampled_for<T>(subject: &str, kind: &str, items: impl IntoIterator<Item = T>) -> Vec<T> {
    let CheckKind { fixed, drawn, .. } = kind_of(kind);
    let draw = format!("{kind} {subject}");
    match (Taken::by_environment(), fixed) {
        (Taken::All, _) => items.into_iter().collect(),
        (Taken::Drawn(by), _) => drawn_by(&by, &draw, items, drawn),
        (Taken::Fixed, FixedCases::Count(count)) => drawn_by("fixed", &draw, items, count),
        (Taken::Fixed, FixedCases::Names(_)) => panic!("the cases of `{kind}` have names"),
    }
}

/// Returns the cases of a kind that this run takes, in the order of `items`. `name_of` returns the name of a case.
///
/// # Panics
/// There is no such kind, a fixed case is not among the items, or `GLINT_TESTS` is wrong.
pub fn sampled_by_name<T>(
    kind: &str,
    items: impl IntoIterator<Item = T>,
    name_of: impl Fn(&T) -> String,
) -> Vec<T> {
    let CheckKind { fixed, drawn, .. } = kind_of(kind);
    let names = match (Taken::by_environment(), fixed) {
        (Taken::All, _) => return items.into_iter().collect(),
        (Taken::Drawn(by), _) => return drawn_by(&by, kind, items, drawn),
        (Taken::Fixed, FixedCases::Count(_)) => panic!("the cases of `{kind}` have no names"),
        (Taken::Fixed, FixedCases::Names(names)) => names,
    };
    let taken: Vec<T> = items.into_iter().filter(|item| names.contains(&name_of(item))).collect();
    let found: Vec<String> = taken.iter().map(name_of).collect();
    assert_eq!(found.len(), names.len(), "{kind}: {found:?} of {names:?}");
    taken
}

/// Returns `count` of the items, in their order. The texts `by` and `draw` decide which.
fn drawn_by<T>(by: &str, draw: &str, items: impl IntoIterator<Item = T>, count: usize) -> Vec<T> {
    let mut items: Vec<(usize, T)> = items.into_iter().enumerate().collect();
    let all = items.len();
    let mut random = ChaCha8Rng::from_seed(seed(&format!("{by} {draw}")));
    // The first `count` places of a shuffle.
    for at in 0..count.min(all) {
        let other = at + (random.next_u64() % (all - at) as u64) as usize;
        items.swap(at, other);
    }
    items.truncate(count);
    items.sort_by_key(|(place, _)| *place);
    // What was drawn is in the output of a test that fails.
    println!("{draw}: {} of {all}, drawn by `{by}`; GLINT_TESTS=all for all", items.len());
    items.into_iter().map(|(_, item)| item).collect()
}

/// Returns the seed of the random inputs of proptest: the same in every run, unless `GLINT_SAMPLE` is set.
pub fn fuzz_seed() -> RngSeed {
    let by = env::var("GLINT_SAMPLE").unwrap_or_else(|_| "fixed".to_owned());
    let bytes = seed(&format!("{by} proptest"));
    RngSeed::Fixed(u64::from_le_bytes(std::array::from_fn(|at| bytes[at])))
}

/// SHA-256 of a text.
fn seed(text: &str) -> [u8; 32] {
    use sha2::{Digest, Sha256};
    Sha256::digest(text.as_bytes()).into()
}

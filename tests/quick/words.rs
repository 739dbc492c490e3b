//! Counts patterns that make comments hard to follow, and names of types with several meanings. Neither count may grow.
//!
//! CONTRIBUTING.md has the rules. For example, "the range of the sum" is clear, while "that of the sum" makes the reader search
//! for a noun. Whoever lowers a count should lower its limit in this file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use regex::Regex;

use crate::common::files::{below, read};

/// Patterns of comments, and how often each may occur at most.
const PATTERNS: [(&str, usize); 6] = [
    (r"\b([Tt]hat of|[Tt]hose of|[Tt]hose that)\b", 10),
    (
        r"\b[Ww]hat (is|are|was|it|they|the|a|an|has|does|do|can|stands|comes|takes|makes|no|of)\b",
        22,
    ),
    (r"\b[Ss]tands?\b", 5),
    (r"\bof which\b", 5),
    // A line that begins with "of the" continues a sentence, unless the line before ends it.
    (r"[.;:][ \n][Oo]f (a|an|the|each|every|what|two|all)\b", 4),
    (r"\bThere is none\b", 0),
];

/// So many names of types are defined in more than one file.
const REPEATED_TYPE_NAMES: usize = 7;

/// Returns the Rust files of the program, by path, with their texts.
fn sources() -> Vec<(String, String)> {
    let paths = ["generator", "bindings"].into_iter().flat_map(|folder| below(Path::new(folder)));
    let rust = paths.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    rust.map(|path| (path.display().to_string(), read(path))).collect()
}

#[test]
fn comments_are_no_harder_to_follow() {
    let sources = sources();
    let lines = sources.iter().flat_map(|(_, text)| text.lines());
    let comments = lines.filter_map(|line| line.trim().strip_prefix("//"));
    let text: Vec<&str> = comments.map(|line| line.trim_start_matches(['/', '!', ' '])).collect();
    let text = text.join("\n");
    for (pattern, limit) in PATTERNS {
        let count = Regex::new(pattern).expect("a pattern").find_iter(&text).count();
        assert!(
            count <= limit,
            "comments have `{pattern}` {count} times, {limit} before: CONTRIBUTING.md says what to write instead"
        );
    }
}

#[test]
fn names_of_types_get_no_more_meanings() {
    let definition =
        Regex::new(r"(?m)^\s*(?:pub(?:\([a-z ]+\))? )?(?:struct|enum|trait|union) ([A-Z]\w*)");
    let definition = definition.expect("a pattern");
    let mut files: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, text) in sources() {
        for found in definition.captures_iter(&text) {
            files.entry(found[1].to_owned()).or_default().insert(path.clone());
        }
    }
    let repeated = files.iter().filter(|(_, files)| files.len() > 1);
    let names: Vec<&str> = repeated.map(|(name, _)| name.as_str()).collect();
    let count = names.len();
    assert!(
        count <= REPEATED_TYPE_NAMES,
        "{count} names of types have several meanings, {REPEATED_TYPE_NAMES} before: {}",
        names.join(", ")
    );
}

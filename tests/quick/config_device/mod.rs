//! Defines the schemas of two devices for tests of configurations: `lamp` has most types of keys and conditions between keys,
//! `mirror` has one key.
//!
//! No hardware belongs to these schemas.

use glint::config::{Config, Key, Problems, Schema};

pub fn schemas() -> Vec<Schema> {
    let mirror = Schema {
        device: "mirror",
        keys: vec![Key::integer("width", 8, 1..=32, "Bits of a pixel.")],
        check: |_, _| {},
    };
    vec![lamp(), mirror]
}

pub fn lamp() -> Schema {
    Schema {
        device: "lamp",
        keys: vec![
            Key::choice("arithmetic", "exact", &["exact", "patent"], "How numbers are kept."),
            Key::choice("power", "16", &["2", "4", "8", "16"], "The power of the cosine."),
            Key::integer("cosine.fraction", 20, 4..=30, "Fraction bits of the cosines."),
            Key::flag("cosine.signed", false, "whether cosines may be negative"),
            Key::choice("sine.scheme", "direct", &["direct", "segmented"], "How the sine is had."),
            Key::integer("sine.address", 12, 1..=16, "Address bits of the table.")
                .only_when("sine.scheme", "direct"),
            Key::integers("sine.segments", &[6, 5], 2..=14, 1..=8, "Log2 of the segments.")
                .only_when("sine.scheme", "segmented"),
            Key::number("domain.deviation", 30.0, 0.5..=90.0, "Largest deviation in degrees."),
        ],
        check,
    }
}

fn check(config: &Config, problems: &mut Problems) {
    let fraction = config.integer("cosine.fraction");
    if config.choice("sine.scheme") == "direct" && config.integer("sine.address") > fraction {
        problems.push(
            "sine.address",
            "the table has more address bits than the cosine",
            "lower sine.address or raise cosine.fraction",
        );
    }
    let segments = config.integers("sine.segments").len() as i64;
    if config.choice("sine.scheme") == "segmented" && 2 * segments > fraction {
        problems.push("sine.segments", "more segments than the cosine has", "give fewer");
    }
}

/// Returns the text of a configuration in which every key that is a comment has its value.
pub fn uncommented(text: &str) -> String {
    let is_of_key = |c: char| c.is_ascii_alphanumeric() || "_.".contains(c);
    // The last line of an explanation may begin as an assignment, and ends with a full stop.
    let is_assignment = |line: &str| {
        let name = line.split_once(" = ").map(|(name, _)| name);
        name.is_some_and(|name| name.chars().all(is_of_key)) && !line.ends_with('.')
    };
    let lines = text.lines().map(|line| match line.strip_prefix("# ") {
        Some(bare) if is_assignment(bare) => bare,
        _ => line,
    });
    lines.collect::<Vec<_>>().join("\n")
}

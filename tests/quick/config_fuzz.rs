//! Tests the reader of configurations with random texts: it returns a configuration, or problems that each have a message and a
//! remedy.
//!
//! If a problem has a line and a column, the printed report states the same position.

use crate::common::cases;
use crate::common::cores::device;
use crate::config_device::{lamp, schemas, uncommented};
use glint::config::{Config, Schema, commented, parse, read, sample};
use glint::core::Core;
use glint::keys::presets::FUNCTION;
use glint::registry::Registry;
use proptest::collection::vec;
use proptest::prelude::*;

/// Reads a text, and holds the answer to what it promises. What is accepted.
fn answer(text: &str, schemas: &[Schema]) -> Result<Option<Config>, TestCaseError> {
    let problems = match parse("fuzz.toml", text, schemas) {
        Ok(config) => {
            let schema = schemas.iter().find(|schema| schema.device == config.device);
            let schema = schema.expect("an accepted configuration is of a known device");
            let again = parse("fuzz.toml", &config.to_toml(schema), schemas);
            prop_assert!(again.is_ok_and(|again| again == config), "{text}");
            return Ok(Some(config));
        }
        Err(problems) => problems,
    };
    prop_assert!(!problems.is_empty());
    let report = problems.to_string();
    for problem in problems.iter() {
        prop_assert!(!problem.error.message.is_empty() && !problem.error.remedy.is_empty());
        prop_assert!(problem.error.message.chars().count() < 200, "{}", problem.error.message);
        // The place that scripts are told is the one that people read.
        if let Some((line, column)) = problems.position(problem) {
            prop_assert!(
                report.contains(&format!("--> fuzz.toml:{line}:{column}\n")),
                "{line}:{column} is not in\n{report}"
            );
        }
    }
    Ok(None)
}

/// Returns a value as it stands in a file: right, too large, of another type, or nested.
fn value() -> impl Strategy<Value = String> {
    let leaves = r#"0 1 -1 8 16 22 25 1000 4096 9223372036854775807 -9223372036854775808
        99999999999999999999999 0xffff_ffff 1.5 -0.0 nan -inf 1e400 5e-324 true false
        "" "truncate" "nearest" "direct" "patent" 'é🔆\' "\u0000" 1979-05-27 [2] [] {}"#;
    let leaves = leaves.split_whitespace().chain(["\"\"\"\n\"\"\"", "[6, 5, 4, 3]"]);
    let leaf = prop::sample::select(leaves.map(str::to_owned).collect::<Vec<_>>());
    leaf.prop_recursive(4, 24, 6, |inner| {
        prop_oneof![
            vec(inner.clone(), 0..6).prop_map(|items| format!("[{}]", items.join(", "))),
            vec(inner, 1..3).prop_map(|items| format!("{{ a = {} }}", items.join(", b = "))),
        ]
    })
}

/// Returns a file for a device of the catalogue in which keys have any values; seldom for a function, whose widths the reader
/// searches for.
fn settings() -> impl Strategy<Value = String> {
    let is_function = |schema: &Schema| schema.device == FUNCTION;
    let (functions, highlights): (Vec<_>, Vec<_>) =
        Registry::catalogue().schemas().into_iter().partition(is_function);
    let devices: Vec<Schema> = highlights.into_iter().cycle().take(250).chain(functions).collect();
    let setting = (any::<prop::sample::Index>(), value(), 0..40u8);
    (prop::sample::select(devices), vec(setting, 0..8)).prop_map(|(schema, settings)| {
        let mut text = format!("device = \"{}\"\n", schema.device);
        for (at, value, odd) in settings {
            let key = at.get(&schema.keys).name;
            let line = match odd {
                0 => format!("{key}.deeper = {value}\n"),
                1 => format!("[{key}]\n"),
                2 => format!("\"{key}\" = {value}\n"),
                3 => format!("é.{key} = {value}\n"),
                4 => format!("name = {value}\n"),
                5 => format!("strict = {value}\n"),
                _ => format!("{key} = {value}\n"),
            };
            text.push_str(&line);
        }
        text
    })
}

/// Pieces that a configuration is made of, and some that it is not.
fn piece() -> impl Strategy<Value = String> {
    let spaces =
        ["\n", "\r\n", "\r", " ", "\t", " = ", "[6, 5]", "device = \"lamp\"\n", "[sine]\n"];
    let controls = ["\u{feff}", "\0", "\u{1b}"];
    let words = r#"= . , # [ ] [[ ]] { } " ' """ ''' \ é 🔆 device name strict "lamp" "module"
        power cosine fraction cosine.fraction sine segments scheme "segmented"
        true nan inf -0 1_000 0x1f 1e400 99999999999999999999 1979-05-27T07:32:00Z"#;
    let pieces = spaces.into_iter().chain(controls).chain(words.split_whitespace());
    prop::sample::select(pieces.map(str::to_owned).collect::<Vec<_>>())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(2000),
        failure_persistence: None,
        rng_seed: crate::common::sample::fuzz_seed(),
        ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text(text in any::<String>()) {
        answer(&text, &schemas())?;
    }

    #[test]
    fn nested_without_end(depth in 1usize..20_000, opening in "[\\[{(a.=]{1,3}") {
        let text = format!("device = \"lamp\"\npower = {}", opening.repeat(depth));
        answer(&text, &schemas())?;
        answer(&opening.repeat(depth), &schemas())?;
    }

    #[test]
    fn arbitrary_settings(text in settings()) {
        answer(&text, &Registry::catalogue().schemas())?;
    }

    #[test]
    fn arbitrary_pieces(pieces in vec(piece(), 0..40), known in any::<bool>()) {
        let start = if known { "device = \"lamp\"\n" } else { "" };
        answer(&format!("{start}{}", pieces.concat()), &schemas())?;
    }

    #[test]
    fn mutated_files(
        seed in any::<u64>(),
        comments in any::<bool>(),
        changes in vec((any::<prop::sample::Index>(), 0usize..6, piece()), 1..6),
    ) {
        let text = if comments {
            let defaults = Config::defaults(&lamp(), "lamp");
            uncommented(&commented(&lamp(), &defaults, &[]))
        } else {
            sample(&lamp(), seed, &|_| None).to_toml(&lamp())
        };
        let mut text: Vec<char> = text.chars().collect();
        for (place, removed, piece) in changes {
            let start = place.index(text.len() + 1);
            let end = (start + removed).min(text.len());
            text.splice(start..end, piece.chars());
        }
        answer(&text.into_iter().collect::<String>(), &schemas())?;
    }

    #[test]
    fn arbitrary_bytes(bytes in vec(any::<u8>(), 0..200)) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), &bytes).expect("written");
        if let Err(problems) = read(file.path(), &schemas()) {
            prop_assert!(!problems.to_string().is_empty());
            prop_assert_eq!(problems.to_json().as_array().map(Vec::len), Some(problems.len()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: cases(2000) / 10,
        failure_persistence: None,
        rng_seed: crate::common::sample::fuzz_seed(),
        ..ProptestConfig::default()
    })]

    /// A configuration that the reader accepts is accepted by the description and the golden model too.
    #[test]
    fn an_accepted_configuration_is_a_device(text in settings()) {
        if let Some(config) = answer(&text, &Registry::catalogue().schemas())? {
            let core = Core::new(device(&config.device), config);
            prop_assert!(core.is_ok(), "{:?}", core.err());
            prop_assert!(core.expect("a core").lockstep(1).is_ok());
        }
    }
}

//! Whatever the text, the reader answers with a configuration or with problems that have a place.

mod config_device;

use config_device::{lamp, schemas};
use glint::config::{commented, parse, read, sample};
use proptest::collection::vec;
use proptest::prelude::*;

/// Reads a text, and holds the answer to what it promises.
fn answer(text: &str) -> Result<(), TestCaseError> {
    let problems = match parse("fuzz.toml", text, &schemas()) {
        Ok(config) => {
            let schemas = schemas();
            let schema = schemas.iter().find(|schema| schema.device == config.device);
            let schema = schema.expect("an accepted configuration is of a known device");
            let again = parse("fuzz.toml", &config.to_toml(schema), &schemas);
            prop_assert_eq!(again.ok(), Some(config));
            return Ok(());
        }
        Err(problems) => problems,
    };
    prop_assert!(!problems.is_empty());
    let report = problems.to_string();
    for problem in problems.iter() {
        prop_assert!(!problem.message.is_empty() && !problem.remedy.is_empty());
        prop_assert!(problem.message.chars().count() < 200, "{}", problem.message);
        // The place that scripts are told is the one that people read.
        if let Some((line, column)) = problems.position(problem) {
            prop_assert!(
                report.contains(&format!("--> fuzz.toml:{line}:{column}\n")),
                "{line}:{column} is not in\n{report}"
            );
        }
    }
    Ok(())
}

/// Pieces that a configuration is made of, and some that it is not.
fn piece() -> impl Strategy<Value = String> {
    let pieces = [
        "\n",
        "\r\n",
        "\r",
        " ",
        "\t",
        "=",
        " = ",
        ".",
        ",",
        "#",
        "[",
        "]",
        "[[",
        "]]",
        "{",
        "}",
        "\"",
        "'",
        "\"\"\"",
        "'''",
        "\\",
        "\u{feff}",
        "\0",
        "\u{1b}",
        "é",
        "🔆",
        "device",
        "name",
        "strict",
        "\"lamp\"",
        "\"module\"",
        "power",
        "cosine",
        "fraction",
        "cosine.fraction",
        "sine",
        "segments",
        "[6, 5]",
        "scheme",
        "\"segmented\"",
        "true",
        "nan",
        "inf",
        "-0",
        "1_000",
        "0x1f",
        "1e400",
        "99999999999999999999",
        "1979-05-27T07:32:00Z",
        "device = \"lamp\"\n",
        "[sine]\n",
    ];
    prop::sample::select(pieces.map(str::to_owned).to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000,
        failure_persistence: None,
        ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text(text in any::<String>()) {
        answer(&text)?;
    }

    #[test]
    fn arbitrary_pieces(pieces in vec(piece(), 0..40), known in any::<bool>()) {
        let start = if known { "device = \"lamp\"\n" } else { "" };
        answer(&format!("{start}{}", pieces.concat()))?;
    }

    #[test]
    fn mutated_files(
        seed in any::<u64>(),
        comments in any::<bool>(),
        changes in vec((any::<prop::sample::Index>(), 0usize..6, piece()), 1..6),
    ) {
        let text = match comments {
            true => commented(&lamp(), "lamp"),
            false => sample(&lamp(), seed).to_toml(&lamp()),
        };
        let mut text: Vec<char> = text.chars().collect();
        for (place, removed, piece) in changes {
            let start = place.index(text.len() + 1);
            let end = (start + removed).min(text.len());
            text.splice(start..end, piece.chars());
        }
        answer(&text.into_iter().collect::<String>())?;
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

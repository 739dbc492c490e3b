//! Tests that configurations are written as text and read back unchanged, and that random configurations cover the values of
//! their keys.

use std::collections::BTreeSet;

use crate::config_device::{lamp, schemas, uncommented};
use glint::config::{Config, Key, Schema, Value, brief, commented, parse, sample};

#[test]
fn the_commented_file() {
    let expected = include_str!("config_device/commented.toml");
    let defaults = Config::defaults(&lamp(), "my_lamp");
    let text = commented(&lamp(), &defaults, &[]);
    assert_eq!(text, expected);
    for text in [uncommented(&text), text] {
        let read = parse("x.toml", &text, &schemas()).expect("valid");
        assert_eq!(read, defaults, "{text}");
    }
}

#[test]
fn the_short_file() {
    let given = "device = \"lamp\"\nname = \"my_lamp\"\npower = 4\npackage.software = true\n";
    let config = parse("x.toml", given, &schemas()).expect("valid");
    let keys = ["power", "package.software"].map(str::to_owned);
    let text = brief(&lamp(), &config, &keys);
    assert_eq!(text, include_str!("config_device/brief.toml"));
    for text in [uncommented(&text), text] {
        assert_eq!(parse("x.toml", &text, &schemas()).expect("valid"), config, "{text}");
    }
}

#[test]
fn tables_and_dotted_keys_are_the_same() {
    let tables = "device = \"lamp\"\npower = 4\n[cosine]\nfraction = 0x10\n[sine]\n\
                  scheme = \"segmented\"\nsegments = [7, +6]\n[domain]\ndeviation = 45\n";
    let dotted = "power = 4\ncosine.fraction = 16\nsine = { scheme = \"segmented\", segments = [7, 6] }\n\
                  domain.deviation = 4.5e1\ndevice = \"lamp\"\n";
    let config = parse("a-b.toml", tables, &schemas()).expect("valid");
    assert_eq!(config, parse("a-b.toml", dotted, &schemas()).expect("valid"));
    assert_eq!((config.name.as_str(), config.strict), ("a_b", false));
    assert_eq!((config.choice("power"), config.integer("power")), ("4", 4));
    assert_eq!(config.integer("cosine.fraction"), 16);
    assert!(!config.flag("cosine.signed"));
    assert_eq!(config.integers("sine.segments"), [7, 6]);
    assert_eq!(config.number("domain.deviation"), 45.0);
}

#[test]
fn keys_that_every_device_shares() {
    let text = "device = \"lamp\"\n[package]\nsoftware = true\n";
    let config = parse("x.toml", text, &schemas()).expect("valid");
    assert!(config.flag("package.software"));
    assert_eq!(config.choice("architecture"), "sequential");
    let again = parse("x.toml", &config.to_toml(&lamp()), &schemas());
    assert_eq!(again.expect("it reads back"), config);
    // At their defaults they are not written: records of configurations are older than they are.
    let defaults = Config::defaults(&lamp(), "x").to_toml(&lamp());
    assert!(!defaults.contains("package"), "{defaults}");
}

#[test]
fn samples_are_valid_and_read_back() {
    for seed in 0..500 {
        let config = sample(&lamp(), seed, &|_| None);
        let text = config.to_toml(&lamp());
        let read = parse("x.toml", &text, &schemas());
        assert_eq!(read.expect("a sample is valid"), config, "{text}");
    }
}

#[test]
fn samples_cover_ends_and_both_sides_of_every_choice() {
    let configs: Vec<Config> = (0..500).map(|seed| sample(&lamp(), seed, &|_| None)).collect();
    let seen = |key: &str| -> BTreeSet<String> {
        configs.iter().map(|config| config.value(key).bare()).collect()
    };
    assert_eq!(seen("power").len(), 4);
    assert_eq!(seen("arithmetic").len(), 2);
    assert_eq!(seen("cosine.fraction").len(), 27);
    assert_eq!(seen("sine.address").len(), 16);
    let often = |key: &str, value: Value| {
        configs.iter().filter(|config| *config.value(key) == value).count()
    };
    // A uniform draw would give each about 18 times.
    assert!(often("cosine.fraction", Value::Integer(4)) > 30);
    assert!(often("cosine.fraction", Value::Integer(30)) > 40);
    assert!(often("domain.deviation", Value::Number(0.5)) > 30);
    let lengths: BTreeSet<usize> = configs
        .iter()
        .filter(|config| config.choice("sine.scheme") == "segmented")
        .map(|config| config.integers("sine.segments").len())
        .collect();
    assert_eq!(lengths, (1..=8).collect());
    // The same seed, the same configuration; and seeds differ.
    assert_eq!(sample(&lamp(), 7, &|_| None), configs[7]);
    assert_ne!(configs[7].to_toml(&lamp()), configs[8].to_toml(&lamp()));
}

#[test]
fn mistakes_in_a_schema_are_found() {
    assert_eq!(lamp().mistakes(), Vec::<String>::new());
    let doc = "Something.";
    let faulty = Schema {
        device: "faulty",
        keys: vec![
            Key::integer("a", 0, 1..=2, doc),
            Key::flag("a.b", false, doc),
            Key::flag("Name", false, doc),
            Key::flag("strict", false, doc),
            Key::flag("package.software", false, doc),
            Key::flag("package", false, doc),
            Key::flag("twice", false, doc),
            Key::flag("twice", false, doc).only_when("later", "true"),
            Key::choice("later", "x", &["x", "y"], doc).only_when("twice", "maybe"),
        ],
        check: |_, _| {},
    };
    assert_eq!(
        faulty.mistakes(),
        [
            "`a` is both a key and a table",
            "default of `a`: `a` = 0 is out of range",
            "`Name` is not made of plain lower-case words",
            "`strict` is a key of every device",
            "`package.software` is a key of every device",
            "`package` is both a key and a table",
            "`twice` is declared twice",
            "`twice` depends on `later`, which is not declared before it",
            "`later` depends on `twice` = maybe, a value that the key cannot have",
        ]
    );
    let refused =
        Schema { check: |_, problems| problems.push("power", "too much", "less"), ..lamp() };
    assert_eq!(refused.mistakes(), ["defaults: too much"]);
}

//! Tests that the control ROM of `rough` is table 1 of the patent UA 60139, bit for bit, for the configurations with the
//! patent's microprogram.
//!
//! Keys such as `colour.multipliers = 1` add microinstructions; then the ten microinstructions of the patent still set its
//! control lines as the table does.

use glint::config::{parse, sample};
use glint::hdl::netlist::{Design, Field};
use glint::package::{EmitInputs, emit};

use crate::common::Sure;
use crate::common::cores::device;

/// The patent's table 1 (figure 4), typed from it. Columns V1 … V9, rows by address.
const TABLE: [[u64; 9]; 10] = [
    [0, 0, 0, 0, 0, 0, 0, 0, 1],
    [0, 0, 0, 1, 1, 0, 0, 0, 1],
    [0, 1, 1, 0, 0, 0, 0, 0, 1],
    [0, 1, 1, 0, 0, 1, 0, 0, 1],
    [1, 0, 1, 0, 0, 0, 0, 0, 1],
    [1, 0, 1, 0, 0, 0, 1, 0, 1],
    [1, 1, 1, 0, 0, 0, 0, 0, 1],
    [1, 1, 1, 0, 0, 0, 1, 0, 1],
    [1, 0, 1, 0, 0, 0, 0, 1, 1],
    [0, 0, 0, 0, 0, 0, 0, 0, 0],
];

/// The lines of the block of control that V1 … V9 are, in the table's header.
const LINES: [u16; 9] = [45, 46, 47, 48, 49, 50, 51, 43, 44];

/// Returns the design of the device with these keys.
fn design(toml: &str) -> Design {
    let schema = (device("rough").schema)();
    let config = parse("rough.toml", toml, &[schema]).sure_of(toml);
    device("rough").open(config).sure_of(toml).design().sure_of(toml)
}

fn assert_is_the_table(design: &Design, what: &str) {
    let rom = design.rom(design.control.rom);
    assert_eq!(design.width(rom.data), 9, "{what}");
    let value = |row: &[u64; 9]| row.iter().fold(0, |word, bit| word << 1 | bit);
    let table: Vec<u64> = TABLE.iter().map(value).collect();
    assert_eq!(rom.words, table, "{what}");

    let lines: Vec<u16> =
        design.control.fields.iter().flat_map(|field| field.lines.clone()).collect();
    assert_eq!(lines, LINES, "{what}");

    let files = emit(design, &EmitInputs::default()).sure_of(what);
    let name = format!("rtl_out/{0}/{0}_control.mem", design.name);
    let memory = files.iter().find(|file| file.path == name).expect("the control ROM");
    let words: Vec<String> = memory
        .contents
        .lines()
        .map(|line| line.split("//").next().unwrap_or("").trim().replace('_', ""))
        .filter(|word| !word.is_empty())
        .collect();
    let table = TABLE.map(|row| row.map(|bit| bit.to_string()).concat());
    assert_eq!(words, table, "{what}");
}

/// The patent's lines have the patent's values in its microinstructions; in any other no register of the patent is loaded.
fn assert_has_the_lines(design: &Design, what: &str) {
    let control = &design.control;
    let rows: Vec<Vec<u64>> = (control.microprogram.iter())
        .map(|microinstruction| {
            let fields = control.fields.iter().zip(&microinstruction.values);
            let of_patent = fields.filter(|(field, _)| !field.lines.is_empty());
            let bits = |(field, value): (&Field, &u64)| {
                let lines = field.lines.len();
                (0..lines).rev().map(|bit| value >> bit & 1).collect::<Vec<_>>()
            };
            of_patent.flat_map(bits).collect()
        })
        .collect();
    let (first, last) = (&rows[..8], &rows[rows.len() - 2..]);
    let patent = |row: &[u64; 9]| row.to_vec();
    assert_eq!(first, TABLE[..8].iter().map(patent).collect::<Vec<_>>(), "{what}");
    assert_eq!(last, TABLE[8..].iter().map(patent).collect::<Vec<_>>(), "{what}");
    for added in &rows[8..rows.len() - 2] {
        // V4 to V7 load registers 19, 11, 12 and 13; V9 goes on.
        assert_eq!((&added[3..7], added[8]), (&[0; 4][..], 1), "{what}");
    }
}

#[test]
fn every_option_has_the_words_of_the_patent() {
    let either = |key: &str, values: [&str; 2]| values.map(|value| format!("{key} = {value}\n"));
    // Options that any arithmetic has, and those of exact arithmetic alone.
    let common = [
        either("sine.scheme", ["\"segmented\"", "\"direct\""]),
        either("sine.synchronous", ["true", "false"]),
        either("output.rounding", ["\"truncate\"", "\"nearest\""]),
    ];
    let exact = [
        either("clamp", ["true", "false"]),
        either("cosine.signed", ["true", "false"]),
        either("product.rounding", ["\"truncate\"", "\"nearest\""]),
        either("intensity.rounding", ["\"truncate\"", "\"nearest\""]),
    ];
    let product = |options: &[[String; 2]], texts: Vec<String>| {
        options.iter().fold(texts, |texts, option| {
            let with = |text: &String| option.each_ref().map(|line| format!("{text}{line}"));
            texts.iter().flat_map(with).collect()
        })
    };
    let start =
        |arithmetic: &str| vec![format!("device = \"rough\"\narithmetic = \"{arithmetic}\"\n")];
    let mut texts = product(&common, start("patent"));
    texts.extend(product(&exact, product(&common, start("exact"))));
    assert_eq!(texts.len(), 8 + 128);
    for toml in texts {
        assert_is_the_table(&design(&toml), &toml);
    }
}

#[test]
fn random_configurations_have_the_words_of_the_patent() {
    let schema = (device("rough").schema)();
    for seed in 0..200 {
        let config = sample(&schema, seed, &|_| None);
        let toml = config.to_toml(&schema);
        let opened = device("rough").open(config.clone()).sure_of(&toml);
        let design = opened.design().sure_of(&toml);
        if config.choice("colour.multipliers") == "3" {
            assert_is_the_table(&design, &toml);
        }
        assert_has_the_lines(&design, &toml);
    }
}

/// Microinstructions beyond the patent's stand between its microinstructions 7 and 8, where they move none of the
/// patent's lines, and in fields of their own.
#[test]
fn keys_that_add_microinstructions_leave_the_lines_of_the_patent() {
    for (more, added) in [("[colour]\nmultipliers = 1\n", 3), ("[output]\nregistered = true\n", 1)]
    {
        let toml = format!("device = \"rough\"\n{more}");
        let design = design(&toml);
        assert_eq!(design.control.microprogram.len(), TABLE.len() + added, "{toml}");
        assert_has_the_lines(&design, &toml);
    }
}

//! Tests the C program that recomputes every operand of a function with MPFR: it finds the bound that Glint proved, and notices
//! a wrong word or a damaged file.

use std::path::Path;

use glint::core::Core;
use glint::tools::transient::Directory;
use glint::verify::CheckVerdict;
use rayon::prelude::*;

use crate::common::cores::{configuration, parsed};
use crate::common::files::{put, read};
use crate::common::tools::{EFFORT, LIMIT, finding, ran, tool};

/// Formula, ends of the domain, fraction bits of operand and result: every function and operation that a formula can have.
const FUNCTIONS: [(&str, &str, &str, u32, u32); 15] = [
    ("1 / sqrt(x)", "1", "4", 10, 10),
    ("tan(x)", "-1", "1", 10, 12),
    ("x % 0.375", "0", "4", 8, 10),
    ("if(x <= 0, 0.5, (1 - cos(x)) / x^2)", "-1", "1", 8, 12),
    ("abs(x - 0.3) ^ 1.5", "0", "1", 10, 12),
    ("cbrt(x)", "-1", "1", 8, 10),
    ("asin(x) - sin(x)", "-1", "1", 8, 12),
    ("floor(3 * x) / 3", "0", "2", 10, 10),
    ("max(x^3, -x^2)", "-1", "1", 10, 10),
    ("x^-2 + min(1, pi * x)", "1", "2", 10, 10),
    ("erf(x) * e + tanh(x)", "0", "2", 10, 10),
    ("log2(x) - ln(x) + 2^x + exp(-x)", "1", "2", 10, 10),
    // Steps at operands, at values that f64 has not.
    ("floor(x * 0.1)", "0", "64", 2, 8),
    ("floor(1.164 * (x - 16) + 0.5) / 16", "16", "64", 2, 8),
    ("if(log2(x) >= 1.0e0, x % 0.2, x % 1e-1)", "1", "4", 8, 10),
];

fn core((formula, from, to, operand, result): (&str, &str, &str, u32, u32), more: &str) -> Core {
    let text = format!(
        "device = \"function\"\nname = \"f\"\n{more}\n[function]\nformula = \"{formula}\"\nfrom = \"{from}\"\nto = \"{to}\"\n\
         [operand]\nfraction = {operand}\n[result]\nfraction = {result}\n"
    );
    parsed("f.toml", &text)
}

/// Writes the program with the files that it reads, and compiles it without a warning.
pub fn compiled(core: &Core) -> Directory {
    let dir = Directory::new().expect("a directory");
    for file in core.recomputation().expect("a program") {
        put(dir.path().join(&file.path), &file.contents);
    }
    compile(dir.path());
    dir
}

/// Compiles the program of the core `f` without a warning.
pub fn compile(dir: &Path) {
    let source = "software/f/f_recompute.c";
    let flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-o", "recompute"];
    ran("cc", flags.into_iter().chain([source, "-lmpfr", "-lgmp", "-lm"]), dir);
}

/// Runs the program: whether it accepts, and its last line.
fn said(dir: &Path) -> (bool, String) {
    let shell = tool("sh").run(["-c", "./recompute rtl_out/f"], dir, LIMIT).expect("a program");
    (shell.status.success(), shell.output.lines().last().unwrap_or_default().to_owned())
}

#[test]
fn every_operand_is_recomputed_with_the_error_that_was_proved() {
    FUNCTIONS.into_par_iter().for_each(|function| {
        for architecture in ["", "architecture = \"pipelined\""] {
            let core = core(function, architecture);
            let (accepts, said) = said(compiled(&core).path());
            assert!(accepts, "{function:?}: {said}");
            // Both round upwards, Glint after f64 and its limits of it.
            let printed =
                said.split("the largest error is ").nth(1).and_then(|it| it.split(' ').next());
            let printed: f64 = printed.and_then(|it| it.parse().ok()).expect("a number");
            let bound = core.contract.bounds().governing().units;
            assert!((printed - bound).abs() < 2e-6, "{function:?}: {said} {bound}");
        }
    });
}

#[test]
fn a_wrong_word_is_noticed() {
    let dir = compiled(&core(FUNCTIONS[10], ""));
    let memory = dir.path().join("rtl_out/f/f_coefficients.mem");
    let text = read(&memory);
    // The first digit has the highest bits of the constant coefficient.
    let at = text.match_indices('\n').nth(2).expect("words").0 + 1;
    let digit = text[at..].chars().next().and_then(|it| it.to_digit(16)).expect("a digit");
    let wrong = format!("{}{:x}{}", &text[..at], digit ^ 1, &text[at + 1..]);
    put(&memory, &wrong);
    let (accepts, words) = said(dir.path());
    assert!(!accepts && words.ends_with("word 1 differs from the model"), "{words}");

    // The model has the wrong word, too.
    let model = dir.path().join("software/f/f_model.c");
    let word = |text: &str| {
        text.lines().nth(3).expect("a word").split(' ').next().map(str::to_owned).expect("digits")
    };
    let code = read(&model);
    let [right, planted] =
        [word(&text), word(&wrong)].map(|it| it.trim_start_matches('0').to_owned());
    assert_eq!(code.matches(&format!("0x{right}u")).count(), 1, "{code}");
    put(&model, code.replace(&format!("0x{right}u"), &format!("0x{planted}u")));
    compile(dir.path());
    let (accepts, words) = said(dir.path());
    assert!(!accepts && words.ends_with("DOES NOT HOLD"), "{words}");
}

#[test]
fn the_check_proves_functions_and_asks_nothing_of_highlights() {
    let found = finding(&core(FUNCTIONS[0], ""), "recomputation", EFFORT);
    assert_eq!(found.verdict, CheckVerdict::Proved, "{found:?}");
    assert!(found.words.ends_with(" holds."), "{found:?}");
    let found = finding(&configuration("configs/cosine_power.toml"), "recomputation", EFFORT);
    assert_eq!(found.verdict, CheckVerdict::NotApplicable, "{found:?}");
}

#[test]
fn a_damaged_word_is_no_number() {
    let dir = compiled(&core(FUNCTIONS[10], ""));
    let memory = dir.path().join("rtl_out/f/f_coefficients.mem");
    let text = read(&memory);
    let word = text.lines().nth(3).and_then(|it| it.split(' ').next()).expect("a word").to_owned();
    for damaged in
        [format!("{word}x"), format!("{word}_0"), format!("+{word}"), format!("0x{word}")]
    {
        put(&memory, text.replacen(&word, &damaged, 1));
        let (accepts, words) = said(dir.path());
        assert!(
            !accepts && words.ends_with(&format!("is not a hexadecimal number: {damaged}")),
            "{words}"
        );
    }
}

#[test]
fn a_core_without_memory_files_says_that_none_is_checked() {
    for memories in ["inline", "case"] {
        let more =
            format!("[package]\nmemories = \"{memories}\"\nsoftware = true\nrecomputation = true");
        let core = core(FUNCTIONS[10], &more);
        let dir = Directory::new().expect("a directory");
        for file in core.files("f.toml", None).expect("files") {
            put(dir.path().join(&file.path), &file.contents);
        }
        compile(dir.path());
        let run = |arguments: &str| {
            tool("sh")
                .run(["-c", &format!("./recompute {arguments}")], dir.path(), LIMIT)
                .expect("a program")
        };
        let alone = run("");
        assert!(alone.status.success(), "{}", alone.output);
        assert!(
            alone
                .output
                .starts_with("no memory is checked: the words of the tables are in the Verilog")
        );
        let with_directory = run("/nonexistent");
        assert_eq!(with_directory.status.code(), Some(2), "{}", with_directory.output);
    }
}

#[test]
fn operands_that_no_precision_decides_are_counted() {
    let core = core(("floor(sin(pi * x) * 2)", "0", "1", 4, 4), "");
    let dir = compiled(&core);
    let run =
        tool("sh").run(["-c", "./recompute rtl_out/f"], dir.path(), LIMIT).expect("a program");
    assert_eq!(run.status.code(), Some(3), "{}", run.output);
    assert!(
        run.output.ends_with("not decided: 1 operands, the first is the raw operand 8\n"),
        "{}",
        run.output
    );
}

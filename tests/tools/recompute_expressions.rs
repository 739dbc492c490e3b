//! Tests the program in C that computes every combination of an expression's operands: it finds the bounds that Glint proved, and
//! notices wrong tables, wrong bounds and wrong arithmetic.

use std::path::Path;

use glint::core::Core;
use glint::verify::{CheckVerdict, Effort};
use rayon::prelude::*;

use super::recompute::{compile, compiled};
use crate::common::cores::{device, parsed, with_keys};
use crate::common::files::{put, read};
use crate::common::tools::{EFFORT, LIMIT, finding, tool};

const BYTE: &str = "{ bits = 8, fraction = 7 }";
const SIGNED_BYTE: &str = "{ bits = 8, fraction = 7, signed = true }";

/// An expression for a test: operands with their formats, and results with their formulas.
struct ExpressionCase {
    operands: &'static [(&'static str, &'static str)],
    results: &'static [(&'static str, &'static str)],
}

const DIVIDE: ExpressionCase = ExpressionCase {
    operands: &[("x", BYTE), ("y", BYTE)],
    results: &[("q", r#"formula = "x / y", fraction = 6, where = "y >= 0.25""#)],
};

const HYPOT: ExpressionCase = ExpressionCase {
    operands: &[("x", SIGNED_BYTE), ("y", SIGNED_BYTE)],
    results: &[("h", r#"formula = "hypot(x, y)", fraction = 7"#)],
};

const POLAR: ExpressionCase = ExpressionCase {
    operands: &[("x", SIGNED_BYTE), ("y", SIGNED_BYTE)],
    results: &[
        ("r", r#"formula = "sqrt(x^2 + y^2)", fraction = 7"#),
        ("angle", r#"formula = "atan2(y, x) / pi", fraction = 7, where = "x^2 + y^2 > 0""#),
    ],
};

/// A product and a mean, which doubles have exactly.
const EXACT: ExpressionCase = ExpressionCase {
    operands: &[("x", SIGNED_BYTE), ("y", SIGNED_BYTE)],
    results: &[
        ("product", r#"formula = "x * y", fraction = 14"#),
        ("mean", r#"formula = "(x + y) / 2", fraction = 7"#),
    ],
};

/// Every function and operation that a formula of several operands can have. Names of operands are also names in the program.
const CASES: [ExpressionCase; 12] = [
    DIVIDE,
    HYPOT,
    POLAR,
    EXACT,
    ExpressionCase {
        operands: &[("y", SIGNED_BYTE), ("x", SIGNED_BYTE)],
        results: &[("angle", r#"formula = "atan2(y, x)", fraction = 6, where = "abs(x) > 0""#)],
    },
    ExpressionCase {
        operands: &[("near", SIGNED_BYTE), ("double", SIGNED_BYTE)],
        results: &[(
            "out",
            r#"formula = "if(near < double, min(near, 0.3), max(double * near, -0.1)) + abs(double)", fraction = 8"#,
        )],
    },
    ExpressionCase {
        operands: &[("x", "{ from = 1, to = 4, fraction = 6 }"), ("y", SIGNED_BYTE)],
        results: &[
            ("grown", r#"formula = "x * exp(-y)", fraction = 6"#),
            ("l", r#"formula = "ln(x) + y * log2(x)", fraction = 8"#),
        ],
    },
    ExpressionCase {
        operands: &[("x", "{ from = 0.5, to = 2, fraction = 6 }"), ("y", SIGNED_BYTE)],
        results: &[("p", r#"formula = "x ^ y", fraction = 7"#)],
    },
    ExpressionCase {
        operands: &[("x", SIGNED_BYTE), ("y", SIGNED_BYTE), ("turn", "{ bits = 4, fraction = 4 }")],
        results: &[
            ("u", r#"formula = "x * cos(2 * pi * turn) - y * sin(2 * pi * turn)", fraction = 6"#),
            ("v", r#"formula = "tanh(x) + erf(y) * tan(turn)", fraction = 6"#),
        ],
    },
    ExpressionCase {
        operands: &[("x", BYTE), ("y", BYTE)],
        results: &[("steps", r#"formula = "floor(3 * x) / 4 + y % 0.4", fraction = 8"#)],
    },
    // The cosine is 0 at an operand, and MPFR has limits on both sides of 0.
    ExpressionCase {
        operands: &[("x", "{ bits = 5, fraction = 3 }"), ("y", "{ bits = 3, fraction = 3 }")],
        results: &[(
            "r",
            r#"formula = "1 / (1 + sqrt(abs(cos(2 * pi * x)))^2) + y", fraction = 6"#,
        )],
    },
    ExpressionCase {
        operands: &[("x", BYTE)],
        results: &[("root", r#"formula = "sqrt(x)", fraction = 7, where = "x > 0.1""#)],
    },
];

impl ExpressionCase {
    /// Returns the core, with more lines before the tables.
    fn core(&self, more: &str) -> Core {
        let mut text = format!("device = \"expression\"\nname = \"f\"\n{more}\n[operands]\n");
        for (name, format) in self.operands {
            text += &format!("{name} = {format}\n");
        }
        text += "[results]\n";
        for (name, fields) in self.results {
            text += &format!("{name} = {{ {fields}, error = 1.0 }}\n");
        }
        parsed("f.toml", &text)
    }
}

/// Runs the program, and returns its exit code and what it prints.
fn run(dir: &Path, arguments: &str) -> (Option<i32>, String) {
    let command = format!("./recompute {arguments}");
    let run = tool("sh").run(["-c", &command], dir, LIMIT).expect("a program");
    (run.status.code(), run.output)
}

/// Returns the names of the memory files that the program checks.
fn memory_files(dir: &Path) -> Vec<String> {
    let program = read(dir.join("software/f/f_recompute.c"));
    let calls = program.split("check_memory(directory, \"").skip(1);
    calls.filter_map(|call| call.split('"').next()).map(str::to_owned).collect()
}

/// Returns the argument with the directory of the memory files, or nothing for a core that has none.
fn memory_argument(dir: &Path) -> &'static str {
    if memory_files(dir).is_empty() { "" } else { "rtl_out/f" }
}

/// Returns the largest errors that the program prints, in the order of the results.
fn printed_errors(output: &str) -> Vec<f64> {
    let mut errors = Vec::new();
    for line in output.lines() {
        if let Some((_, rest)) = line.split_once("the largest error is ") {
            let number = rest.split(' ').next().expect("a number");
            errors.push(number.parse().expect("a number"));
        }
    }
    errors
}

#[test]
fn every_combination_is_recomputed_with_the_error_that_was_proved() {
    CASES.par_iter().for_each(|case| {
        for architecture in ["", "architecture = \"pipelined\""] {
            let core = case.core(architecture);
            let dir = compiled(&core);
            let (code, output) = run(dir.path(), memory_argument(dir.path()));
            assert_eq!(code, Some(0), "{output}");
            assert!(output.ends_with(": every combination computed\n"), "{output}");
            let errors = printed_errors(&output);
            assert_eq!(errors.len(), case.results.len(), "{output}");
            for (number, error) in errors.iter().enumerate() {
                let bound = core.contract.bounds().outputs[number].units;
                assert!((error - bound).abs() < 3e-6, "{output} {bound}");
            }
        }
    });
}

#[test]
fn exact_formulas_need_no_mpfr() {
    let core = EXACT.core("");
    let dir = compiled(&core);
    let (code, output) = run(dir.path(), memory_argument(dir.path()));
    assert_eq!(code, Some(0), "{output}");
    assert_eq!(output.matches(", 0 of them computed by MPFR").count(), 2, "{output}");
}

/// Replaces a text that a file has once.
fn replace(path: &Path, old: &str, new: &str) {
    let text = read(path);
    assert_eq!(text.matches(old).count(), 1, "`{old}` in {text}");
    put(path, text.replace(old, new));
}

#[test]
fn a_wrong_word_is_noticed() {
    let dir = compiled(&HYPOT.core(""));
    let files = memory_files(dir.path());
    let memory = dir.path().join("rtl_out/f").join(files.first().expect("a memory file"));
    // The last word has the polynomial of the operands next to 1. Its first digit has the highest bits of the constant coefficient.
    let text = read(&memory);
    let word = text.split_ascii_whitespace().last().expect("a word");
    let digit = word.chars().next().and_then(|digit| digit.to_digit(16)).expect("a digit");
    let wrong = format!("{:x}{}", digit ^ 1, &word[1..]);
    let at = text.rfind(word).expect("the word");
    put(&memory, format!("{}{wrong}{}", &text[..at], &text[at + word.len()..]));
    let (code, output) = run(dir.path(), "rtl_out/f");
    assert_eq!(code, Some(1), "{output}");
    assert!(output.ends_with("differs from the model\n"), "{output}");

    // The model has the wrong word, too.
    let literal = |word: &str| format!("0x{}u", word.trim_start_matches('0'));
    replace(&dir.path().join("software/f/f_model.c"), &literal(word), &literal(&wrong));
    compile(dir.path());
    let (code, output) = run(dir.path(), "rtl_out/f");
    assert_eq!(code, Some(1), "{output}");
    assert!(output.contains("DOES NOT HOLD") && output.ends_with("a bound does not hold\n"));
}

#[test]
fn a_smaller_bound_is_noticed() {
    let core = POLAR.core("");
    let dir = compiled(&core);
    let source = dir.path().join("software/f/f_recompute.c");
    let bound = core.contract.bounds().outputs[1].units;
    let entry = |bound: f64| format!("{{\"angle_out\", -7, {bound:?}}}");
    replace(&source, &entry(bound), &entry(bound - 1e-9));
    compile(dir.path());
    let (code, output) = run(dir.path(), "rtl_out/f");
    assert_eq!(code, Some(1), "{output}");
    let lines: Vec<&str> = output.lines().collect();
    assert!(lines[0].contains(" holds for ") && lines[1].contains("DOES NOT HOLD"), "{output}");
}

#[test]
fn a_wrong_function_in_double_is_noticed() {
    let dir = compiled(&HYPOT.core(""));
    let source = dir.path().join("software/f/f_recompute.c");
    replace(&source, "near_rising(sqrt, ", "near_rising(cbrt, ");
    compile(dir.path());
    let (code, output) = run(dir.path(), "rtl_out/f");
    assert_eq!(code, Some(2), "{output}");
    assert!(output.contains("the C library is less exact than this program assumes"), "{output}");
}

#[test]
fn parts_are_all_combinations() {
    let dir = compiled(&DIVIDE.core(""));
    let (_, whole) = run(dir.path(), "rtl_out/f");
    let mut largest: f64 = 0.0;
    let mut count = 0;
    for part in 1..=3 {
        let (code, output) = run(dir.path(), &format!("--part {part}/3 rtl_out/f"));
        assert_eq!(code, Some(0), "{output}");
        let last = output.lines().last().expect("a line");
        let (computed, of) = last.split_once(' ').expect("words");
        assert!(of.starts_with("of 65536 combinations computed, from number "), "{output}");
        count += computed.parse::<u64>().expect("a number");
        largest = largest.max(printed_errors(&output)[0]);
    }
    assert_eq!((count, largest), (65536, printed_errors(&whole)[0]));
    for wrong in ["0/3", "4/3", "1", "1/2/3", "-1/3"] {
        let (code, output) = run(dir.path(), &format!("--part {wrong} rtl_out/f"));
        assert_eq!(code, Some(2), "{wrong}: {output}");
    }
}

/// Returns the keys of a sum of two operands. It needs no table, so that its core is made at once.
fn sum(bits: u32, more: &str) -> String {
    let operand = format!("{{ bits = {bits}, fraction = 0 }}");
    format!(
        "name = \"f\"\n{more}\n[operands]\nx = {operand}\ny = {operand}\n\
         [results]\nsum = {{ formula = \"x + y\", fraction = 0, error = 1.0 }}\n"
    )
}

#[test]
fn the_check_computes_as_many_combinations_as_the_effort_allows() {
    let found = finding(&DIVIDE.core(""), "recomputation", EFFORT);
    assert_eq!(found.verdict, CheckVerdict::Proved, "{found:?}");
    assert!(found.words.ends_with("every combination computed."), "{found:?}");
    assert_eq!(found.domain, "every combination of operands: x = 0 to 255, y = 0 to 255");

    let wide = with_keys(device("expression"), &sum(13, "")).expect("a core");
    let found = finding(&wide, "recomputation", EFFORT);
    assert_eq!(found.verdict, CheckVerdict::LeftOut, "{found:?}");
    assert!(found.words.contains("67 108 864") && found.words.contains("--full"), "{found:?}");
    assert_eq!(found.complete_with.as_deref(), Some("glint verify core.toml --full"));
    let found = finding(&wide, "recomputation", Effort { full: true, ..EFFORT });
    assert_eq!(found.verdict, CheckVerdict::Proved, "{found:?}");

    let too_wide = with_keys(device("expression"), &sum(17, "")).expect("a core");
    let found = finding(&too_wide, "recomputation", EFFORT);
    assert_eq!(found.verdict, CheckVerdict::NotApplicable, "{found:?}");
    assert!(
        found.words.contains("17179869184 combinations, more than the limit of 2^32"),
        "{found:?}"
    );
}

#[test]
fn the_key_is_refused_where_there_are_too_many_combinations() {
    let asked = "package.software = true\npackage.recomputation = true";
    assert!(with_keys(device("expression"), &sum(16, asked)).is_ok());
    let refused = with_keys(device("expression"), &sum(17, asked));
    let message = refused.err().expect("an error").to_string();
    assert!(message.contains("17179869184 combinations, more than the limit of 2^32"), "{message}");
}

//! Lists the configurations from which a user can start, by name. A function, such as `exp2` or `sigmoid`, is for the device
//! `function`, and a computation, such as `divide` or `rotate`, for `expression`. A preset states some keys; the others have
//! their defaults.

use glint_config::{TableEntries, TableEntry, Value};

pub const FUNCTION: &str = "function";

#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// The device `function` or `expression`.
    pub device: &'static str,
    /// The keys that the preset states.
    pub values: Vec<(String, Value)>,
}

/// A preset of the device `function`: the name, the formula, the ends of the domain, the value of `function.outside`, the
/// numbers of fraction bits of operand and result, and the value of `approximation.reduction`.
type FunctionPreset =
    (&'static str, &'static str, [&'static str; 2], &'static str, [i64; 2], &'static str);

/// A domain is a whole operand format, without 0 if the function has no value there. −8 to 8 with 12 fraction bits is the
/// format `s3.12`.
const FUNCTIONS: [FunctionPreset; 16] = [
    ("exp2", "2^x", ["-8", "8"], "clamp", [12, 8], "exponent"),
    ("exp", "exp(x)", ["-8", "8"], "clamp", [12, 4], "exponent"),
    ("log2", "log2(x)", ["1 / 256", "256"], "clamp", [8, 12], "octaves"),
    ("ln", "ln(x)", ["1 / 256", "256"], "clamp", [8, 12], "octaves"),
    ("reciprocal", "1 / x", ["1 / 256", "256"], "clamp", [8, 8], "octaves"),
    ("rsqrt", "1 / sqrt(x)", ["1 / 256", "256"], "clamp", [8, 12], "octaves"),
    ("sqrt", "sqrt(x)", ["0", "256"], "clamp", [8, 12], "octaves"),
    ("sin", "sin(2 * pi * x)", ["0", "1"], "wrap", [16, 15], "quadrants"),
    ("cos", "cos(2 * pi * x)", ["0", "1"], "wrap", [16, 15], "quadrants"),
    ("atan", "atan(x)", ["-8", "8"], "clamp", [12, 14], "odd"),
    ("sigmoid", "sigmoid(x)", ["-8", "8"], "clamp", [12, 16], "odd"),
    ("tanh", "tanh(x)", ["-4", "4"], "clamp", [13, 15], "odd"),
    ("gelu", "gelu(x)", ["-8", "8"], "clamp", [12, 12], "none"),
    ("silu", "silu(x)", ["-8", "8"], "clamp", [12, 12], "none"),
    ("softplus", "softplus(x)", ["-8", "8"], "clamp", [12, 12], "none"),
    ("gamma", "x^(1 / 2.2)", ["0", "1"], "clamp", [12, 12], "none"),
];

/// A preset of the device `expression`: operands with their formats, named parts with their formulas, and results.
struct ExpressionPreset {
    name: &'static str,
    operands: &'static [(&'static str, OperandFormat)],
    parts: &'static [(&'static str, &'static str)],
    /// The results, each with its name, its formula, its number of fraction bits, and the condition under which the error bound
    /// is promised. An empty condition promises it for all operands.
    results: &'static [(&'static str, &'static str, i64, &'static str)],
}

/// Whether the operand has a sign, its width in bits, and its number of fraction bits.
type OperandFormat = (bool, i64, i64);

/// The format of numbers from −1 to below 1.
const COORDINATE: OperandFormat = (true, 16, 15);

/// The format of numbers from 0 to below 1.
const PART_OF_ONE: OperandFormat = (false, 16, 16);

const EXPRESSIONS: [ExpressionPreset; 10] = [
    ExpressionPreset {
        name: "divide",
        operands: &[("x", PART_OF_ONE), ("y", PART_OF_ONE)],
        parts: &[],
        results: &[("q", "x / y", 15, "x < y")],
    },
    ExpressionPreset {
        name: "hypot",
        operands: &[("x", COORDINATE), ("y", COORDINATE)],
        parts: &[],
        results: &[("r", "hypot(x, y)", 15, "")],
    },
    ExpressionPreset {
        name: "atan2",
        operands: &[("x", COORDINATE), ("y", COORDINATE)],
        parts: &[],
        results: &[("angle", "atan2(y, x) / pi", 15, "x^2 + y^2 > 0")],
    },
    ExpressionPreset {
        name: "polar",
        operands: &[("x", COORDINATE), ("y", COORDINATE)],
        parts: &[("s", "x^2 + y^2")],
        results: &[("r", "sqrt(s)", 15, ""), ("angle", "atan2(y, x) / pi", 15, "s > 0")],
    },
    ExpressionPreset {
        name: "sincos",
        operands: &[("turn", PART_OF_ONE)],
        parts: &[],
        results: &[
            ("sine", "sin(2 * pi * turn)", 15, ""),
            ("cosine", "cos(2 * pi * turn)", 15, ""),
        ],
    },
    ExpressionPreset {
        name: "rotate",
        operands: &[("x", COORDINATE), ("y", COORDINATE), ("turn", PART_OF_ONE)],
        parts: &[("s", "sin(2 * pi * turn)"), ("c", "cos(2 * pi * turn)")],
        results: &[("u", "x * c - y * s", 15, ""), ("v", "x * s + y * c", 15, "")],
    },
    ExpressionPreset {
        name: "pow",
        operands: &[("x", PART_OF_ONE), ("y", PART_OF_ONE)],
        parts: &[],
        results: &[("r", "x ^ y", 15, "x > 0")],
    },
    ExpressionPreset {
        name: "multiply-add",
        operands: &[("a", COORDINATE), ("b", COORDINATE), ("c", COORDINATE), ("d", COORDINATE)],
        parts: &[],
        results: &[("r", "a * b + c * d", 15, "")],
    },
    ExpressionPreset {
        name: "lerp",
        operands: &[("a", COORDINATE), ("b", COORDINATE), ("t", PART_OF_ONE)],
        parts: &[],
        results: &[("r", "a + t * (b - a)", 15, "")],
    },
    ExpressionPreset {
        name: "attenuation",
        operands: &[("d", (false, 16, 12)), ("k", PART_OF_ONE)],
        parts: &[],
        results: &[("a", "1 / (1 + d + k * d^2)", 16, "")],
    },
];

/// Returns the names of all presets, first of `function`, then of `expression`.
pub fn names() -> impl Iterator<Item = &'static str> {
    names_of_functions().chain(names_of_expressions())
}

pub fn names_of_expressions() -> impl Iterator<Item = &'static str> {
    EXPRESSIONS.iter().map(|preset| preset.name)
}

pub fn names_of_functions() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|preset| preset.0)
}

/// Returns the preset with this name. `sqrt` is a preset of the device `function` with `function.formula = "sqrt(x)"`,
/// `function.to = "256"` and five more keys.
pub fn find(name: &str) -> Option<Preset> {
    if let Some(preset) = FUNCTIONS.iter().find(|preset| preset.0 == name) {
        return Some(Preset { device: FUNCTION, values: of_function(preset) });
    }
    let preset = EXPRESSIONS.iter().find(|preset| preset.name == name)?;
    Some(Preset { device: "expression", values: of_expression(preset) })
}

fn of_function(preset: &FunctionPreset) -> Vec<(String, Value)> {
    let (_, formula, [from, to], outside, [operand, result], reduction) = *preset;
    let text = |key: &str, value: &str| (key.to_owned(), Value::Text(value.to_owned()));
    let number = |key: &str, value: i64| (key.to_owned(), Value::Integer(value));
    vec![
        text("function.formula", formula),
        text("function.from", from),
        text("function.to", to),
        text("function.outside", outside),
        number("operand.fraction", operand),
        number("result.fraction", result),
        text("approximation.reduction", reduction),
    ]
}

fn of_expression(preset: &ExpressionPreset) -> Vec<(String, Value)> {
    let text = |text: &str| Value::Text(text.to_owned());
    let mut operands = Vec::new();
    for (name, (signed, bits, fraction)) in preset.operands {
        let mut fields =
            vec![("bits", Value::Integer(*bits)), ("fraction", Value::Integer(*fraction))];
        if *signed {
            fields.push(("signed", Value::Flag(true)));
        }
        operands.push(TableEntry::new(name, &fields));
    }
    let mut parts = Vec::new();
    for (name, formula) in preset.parts {
        parts.push(TableEntry::new(name, &[("formula", text(formula))]));
    }
    let mut results = Vec::new();
    for (name, formula, fraction, promise) in preset.results {
        let mut fields = vec![
            ("formula", text(formula)),
            ("fraction", Value::Integer(*fraction)),
            ("error", Value::Number(1.0)),
        ];
        if !promise.is_empty() {
            fields.push(("where", text(promise)));
        }
        results.push(TableEntry::new(name, &fields));
    }
    let mut values = vec![("operands".to_owned(), Value::Table(TableEntries(operands)))];
    if !parts.is_empty() {
        values.push(("let".to_owned(), Value::Table(TableEntries(parts))));
    }
    values.push(("results".to_owned(), Value::Table(TableEntries(results))));
    values
}

//! Functions by their names: configurations to start from.

use crate::config::Value;

/// The device that they are configurations of.
pub const DEVICE: &str = "function";

/// A name; the formula; the domain's ends; what is outside; fraction bits of operand and result.
type Preset = (&'static str, &'static str, [&'static str; 2], &'static str, [i64; 2]);

/// Domains on which the function is most of what it is elsewhere: a period, an octave or some, what lies between flat tails.
const PRESETS: [Preset; 16] = [
    ("exp2", "2^x", ["-8", "0"], "clamp", [13, 16]),
    ("exp", "exp(x)", ["-8", "0"], "clamp", [13, 16]),
    ("log2", "log2(x)", ["1", "16"], "clamp", [12, 13]),
    ("ln", "ln(x)", ["1", "16"], "clamp", [12, 13]),
    ("reciprocal", "1 / x", ["1", "2"], "clamp", [16, 16]),
    ("rsqrt", "1 / sqrt(x)", ["1", "4"], "clamp", [16, 16]),
    ("sqrt", "sqrt(x)", ["0", "4"], "clamp", [14, 14]),
    ("sin", "sin(2 * pi * x)", ["0", "1"], "wrap", [16, 15]),
    ("cos", "cos(2 * pi * x)", ["0", "1"], "wrap", [16, 15]),
    ("atan", "atan(x)", ["-8", "8"], "clamp", [12, 14]),
    ("sigmoid", "sigmoid(x)", ["-8", "8"], "clamp", [12, 16]),
    ("tanh", "tanh(x)", ["-4", "4"], "clamp", [13, 15]),
    ("gelu", "gelu(x)", ["-8", "8"], "clamp", [12, 12]),
    ("silu", "silu(x)", ["-8", "8"], "clamp", [12, 12]),
    ("softplus", "softplus(x)", ["-8", "8"], "clamp", [12, 12]),
    ("gamma", "x^(1 / 2.2)", ["0", "1"], "clamp", [12, 12]),
];

/// All names.
pub fn names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|preset| preset.0)
}

/// The values of the keys of a name.
pub fn values(name: &str) -> Option<Vec<(String, Value)>> {
    let (_, formula, [from, to], outside, [operand, result]) =
        PRESETS.into_iter().find(|preset| preset.0 == name)?;
    let text = |key: &str, value: &str| (key.to_owned(), Value::Text(value.to_owned()));
    let number = |key: &str, value: i64| (key.to_owned(), Value::Integer(value));
    Some(vec![
        text("function.formula", formula),
        text("function.from", from),
        text("function.to", to),
        text("function.outside", outside),
        number("operand.fraction", operand),
        number("result.fraction", result),
    ])
}

//! Holds configurations of `function` to start from, by the name of the function: `exp2`, `sqrt`, `sigmoid`, ….

use glint_config::Value;

/// The device that they are configurations of.
pub const DEVICE: &str = "function";

/// The name, the formula, the ends of the domain, the value of `outside`, the fraction bits of operand and result, and the
/// range reduction.
type Preset = (&'static str, &'static str, [&'static str; 2], &'static str, [i64; 2], &'static str);

/// Whole formats, but for functions that have no identity: these are between their flat tails.
const PRESETS: [Preset; 16] = [
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

/// Returns all names.
pub fn names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|preset| preset.0)
}

/// Returns the values of the keys of a name. For example, `sqrt` gives `function.formula = "sqrt(x)"`, `function.to = "256"`
/// and five more.
pub fn values(name: &str) -> Option<Vec<(String, Value)>> {
    let (_, formula, [from, to], outside, [operand, result], reduction) =
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
        text("approximation.reduction", reduction),
    ])
}

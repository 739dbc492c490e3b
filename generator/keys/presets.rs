//! Lists the configurations from which a user can start, by name. A function, such as `exp2` or `sigmoid`, is for the device
//! `function`, and a computation, such as `divide` or `rotate`, for `expression`. A preset states some keys; the others have
//! their defaults.

use glint_config::{TableEntries, TableEntry, Value};

pub const FUNCTION: &str = "function";

#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// The device `function`, `expression` or `unit`.
    pub device: &'static str,
    /// The purpose of a preset of `expression`; `None` for the others.
    pub purpose: Option<&'static str>,
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
    /// What a user needs the expression for, as the end of the sentence "An expression for …".
    purpose: &'static str,
    operands: &'static [OperandPreset],
    parts: &'static [(&'static str, &'static str)],
    results: &'static [ResultPreset],
}

/// Whether the operand has a sign, its width in bits, and its number of fraction bits.
type OperandFormat = (bool, i64, i64);

/// An operand: a number, or a list with a size or with axes.
struct OperandPreset {
    name: &'static str,
    format: OperandFormat,
    size: Option<i64>,
    /// A letter for each number of a list with axes; empty for the others.
    axes: &'static str,
}

const fn number(name: &'static str, format: OperandFormat) -> OperandPreset {
    OperandPreset { name, format, size: None, axes: "" }
}

const fn list(name: &'static str, size: i64, format: OperandFormat) -> OperandPreset {
    OperandPreset { name, format, size: Some(size), axes: "" }
}

const fn vector(name: &'static str, axes: &'static str, format: OperandFormat) -> OperandPreset {
    OperandPreset { name, format, size: None, axes }
}

/// A result with an error below one unit, if [`ResultPreset::within`] states no other.
struct ResultPreset {
    name: &'static str,
    formula: &'static str,
    fraction: i64,
    error: f64,
    /// A letter for each number of a list with axes of its own; empty for the others.
    axes: &'static str,
    /// The condition under which the error is promised. An empty condition promises it for all operands.
    promise: &'static str,
    /// The width of a signed result that saturates; `None` if the width follows from the values.
    saturated_bits: Option<i64>,
    /// Whether the numbers of a list have the order of their values.
    is_ordered: bool,
}

impl ResultPreset {
    const fn new(name: &'static str, formula: &'static str, fraction: i64) -> Self {
        Self {
            name,
            formula,
            fraction,
            error: 1.0,
            axes: "",
            promise: "",
            saturated_bits: None,
            is_ordered: false,
        }
    }

    const fn promised(mut self, condition: &'static str) -> Self {
        self.promise = condition;
        self
    }

    const fn within(mut self, error: f64) -> Self {
        self.error = error;
        self
    }

    const fn ordered(mut self) -> Self {
        self.is_ordered = true;
        self
    }

    const fn on(mut self, axes: &'static str) -> Self {
        self.axes = axes;
        self
    }

    const fn saturated(mut self, bits: i64) -> Self {
        self.saturated_bits = Some(bits);
        self
    }
}

/// The format of numbers from −1 to below 1.
const COORDINATE: OperandFormat = (true, 16, 15);

/// The format of numbers from 0 to below 1.
const PART_OF_ONE: OperandFormat = (false, 16, 16);

/// The format of signals in motor control: numbers from −8 to below 8.
const SIGNAL: OperandFormat = (true, 16, 12);

/// The format of numbers in a neural network: from −8 to below 8.
const ACTIVATION: OperandFormat = (true, 12, 8);

/// The format of the coordinates of a normal, which may be shorter than 1.
const NORMAL: OperandFormat = (true, 14, 13);

/// The format of a colour of eight bits, from 0 to 255.
const COLOUR: OperandFormat = (false, 8, 0);

const EXPRESSIONS: [ExpressionPreset; 29] = [
    ExpressionPreset {
        name: "divide",
        purpose: "a fraction of a whole, x / y for x below y",
        operands: &[number("x", PART_OF_ONE), number("y", PART_OF_ONE)],
        parts: &[],
        results: &[ResultPreset::new("q", "x / y", 15).promised("x < y")],
    },
    ExpressionPreset {
        name: "quotient",
        purpose: "the integer quotient and the remainder, both exact",
        operands: &[number("a", (false, 16, 0)), number("b", (false, 8, 0))],
        parts: &[],
        results: &[
            ResultPreset::new("quotient", "floor(a / b)", 0).promised("b > 0"),
            ResultPreset::new("remainder", "a % b", 0).promised("b > 0"),
        ],
    },
    ExpressionPreset {
        name: "perspective",
        purpose: "perspective-correct interpolation: 1 / w, and an attribute that was divided by w",
        operands: &[number("w", (false, 20, 12)), number("u_over_w", (true, 16, 12))],
        parts: &[],
        results: &[
            ResultPreset::new("depth", "1 / w", 15).promised("w >= 1"),
            ResultPreset::new("u", "u_over_w / w", 12).promised("w >= 1"),
        ],
    },
    ExpressionPreset {
        name: "hypot",
        purpose: "the length of a vector of two coordinates",
        operands: &[number("x", COORDINATE), number("y", COORDINATE)],
        parts: &[],
        results: &[ResultPreset::new("r", "hypot(x, y)", 15)],
    },
    ExpressionPreset {
        name: "atan2",
        purpose: "the direction of a vector, in half turns",
        operands: &[number("x", COORDINATE), number("y", COORDINATE)],
        parts: &[],
        results: &[ResultPreset::new("angle", "atan2(y, x) / pi", 15).promised("x^2 + y^2 > 0")],
    },
    ExpressionPreset {
        name: "polar",
        purpose: "the length and the direction of a vector, as of an I/Q sample",
        operands: &[number("x", COORDINATE), number("y", COORDINATE)],
        parts: &[("s", "x^2 + y^2")],
        results: &[
            ResultPreset::new("r", "sqrt(s)", 15),
            ResultPreset::new("angle", "atan2(y, x) / pi", 15).promised("s > 0"),
        ],
    },
    ExpressionPreset {
        name: "normalise2",
        purpose: "the unit vector in the direction of a vector of two coordinates",
        operands: &[number("x", COORDINATE), number("y", COORDINATE)],
        parts: &[("s", "x^2 + y^2")],
        results: &[
            ResultPreset::new("u", "x / sqrt(s)", 14).promised("s >= 1/256"),
            ResultPreset::new("v", "y / sqrt(s)", 14).promised("s >= 1/256"),
        ],
    },
    ExpressionPreset {
        name: "normalise3",
        purpose: "the unit vector of a normal that was interpolated",
        operands: &[
            number("x", (true, 14, 13)),
            number("y", (true, 14, 13)),
            number("z", (true, 14, 13)),
        ],
        parts: &[("s", "x^2 + y^2 + z^2")],
        results: &[
            ResultPreset::new("u", "x / sqrt(s)", 12).promised("s >= 1/16"),
            ResultPreset::new("v", "y / sqrt(s)", 12).promised("s >= 1/16"),
            ResultPreset::new("w", "z / sqrt(s)", 12).promised("s >= 1/16"),
        ],
    },
    ExpressionPreset {
        name: "sincos",
        purpose: "the sine and the cosine of the same angle, in turns",
        operands: &[number("turn", PART_OF_ONE)],
        parts: &[],
        results: &[
            ResultPreset::new("sine", "sin(2 * pi * turn)", 15),
            ResultPreset::new("cosine", "cos(2 * pi * turn)", 15),
        ],
    },
    ExpressionPreset {
        name: "rotate",
        purpose: "a rotation in the plane by an angle in turns",
        operands: &[number("x", COORDINATE), number("y", COORDINATE), number("turn", PART_OF_ONE)],
        parts: &[("s", "sin(2 * pi * turn)"), ("c", "cos(2 * pi * turn)")],
        results: &[
            ResultPreset::new("u", "x * c - y * s", 15),
            ResultPreset::new("v", "x * s + y * c", 15),
        ],
    },
    ExpressionPreset {
        name: "clarke",
        purpose: "the Clarke transform of three phase currents whose sum is 0",
        operands: &[number("a", COORDINATE), number("b", COORDINATE)],
        parts: &[],
        results: &[
            ResultPreset::new("alpha", "a", 15),
            ResultPreset::new("beta", "(a + 2 * b) / sqrt(3)", 15),
        ],
    },
    ExpressionPreset {
        name: "park",
        purpose: "the Park transform of field-oriented motor control",
        operands: &[
            number("alpha", COORDINATE),
            number("beta", COORDINATE),
            number("turn", PART_OF_ONE),
        ],
        parts: &[("s", "sin(2 * pi * turn)"), ("c", "cos(2 * pi * turn)")],
        results: &[
            ResultPreset::new("d", "alpha * c + beta * s", 15),
            ResultPreset::new("q", "beta * c - alpha * s", 15),
        ],
    },
    ExpressionPreset {
        name: "pi",
        purpose: "one step of a PI controller with saturation",
        operands: &[
            number("err", SIGNAL),
            number("sum", SIGNAL),
            number("kp", (false, 8, 6)),
            number("ki", (false, 8, 8)),
        ],
        parts: &[],
        results: &[
            ResultPreset::new("u", "kp * err + sum", 12).saturated(16),
            ResultPreset::new("next", "sum + ki * err", 12).saturated(16),
        ],
    },
    ExpressionPreset {
        name: "pow",
        purpose: "a power with a variable exponent",
        operands: &[number("x", PART_OF_ONE), number("y", PART_OF_ONE)],
        parts: &[],
        results: &[ResultPreset::new("r", "x ^ y", 15).promised("x > 0")],
    },
    ExpressionPreset {
        name: "srgb",
        purpose: "a colour from linear light to sRGB",
        operands: &[number("c", (false, 12, 12))],
        parts: &[],
        results: &[ResultPreset::new(
            "v",
            "if(c <= 0.0031308, 12.92 * c, 1.055 * c^(1 / 2.4) - 0.055)",
            8,
        )],
    },
    ExpressionPreset {
        name: "fog",
        purpose: "linear fog between a near and a far distance",
        operands: &[
            number("z", (false, 16, 8)),
            number("near", (false, 16, 8)),
            number("far", (false, 16, 8)),
        ],
        parts: &[],
        results: &[ResultPreset::new("f", "clamp((far - z) / (far - near), 0, 1)", 8)
            .promised("far - near >= 1")],
    },
    ExpressionPreset {
        name: "multiply-add",
        purpose: "the sum of two products, as in a complex product",
        operands: &[
            number("a", COORDINATE),
            number("b", COORDINATE),
            number("c", COORDINATE),
            number("d", COORDINATE),
        ],
        parts: &[],
        results: &[ResultPreset::new("r", "a * b + c * d", 15)],
    },
    ExpressionPreset {
        name: "lerp",
        purpose: "the linear interpolation between two values",
        operands: &[number("a", COORDINATE), number("b", COORDINATE), number("t", PART_OF_ONE)],
        parts: &[],
        results: &[ResultPreset::new("r", "a + t * (b - a)", 15)],
    },
    ExpressionPreset {
        name: "bilinear",
        purpose: "the bilinear interpolation of four texels of eight bits",
        operands: &[
            number("a", COLOUR),
            number("b", COLOUR),
            number("c", COLOUR),
            number("d", COLOUR),
            number("u", (false, 8, 8)),
            number("v", (false, 8, 8)),
        ],
        parts: &[("upper", "a + u * (b - a)"), ("lower", "c + u * (d - c)")],
        results: &[ResultPreset::new("r", "upper + v * (lower - upper)", 0)],
    },
    ExpressionPreset {
        name: "attenuation",
        purpose: "the attenuation of a light with the distance",
        operands: &[number("d", (false, 16, 12)), number("k", PART_OF_ONE)],
        parts: &[],
        results: &[ResultPreset::new("a", "1 / (1 + d + k * d^2)", 16)],
    },
    ExpressionPreset {
        name: "softmax4",
        purpose: "the softmax of four numbers, as in attention",
        operands: &[list("v", 4, SIGNAL)],
        parts: &[],
        results: &[ResultPreset::new("p", "softmax(v)", 15).within(2.0).ordered()],
    },
    ExpressionPreset {
        name: "softmax8",
        purpose: "the softmax of eight numbers",
        operands: &[list("v", 8, SIGNAL)],
        parts: &[],
        results: &[ResultPreset::new("p", "softmax(v)", 15).within(2.0).ordered()],
    },
    ExpressionPreset {
        name: "layernorm8",
        purpose: "the layer normalisation of eight numbers",
        operands: &[list("v", 8, ACTIVATION)],
        parts: &[("centred", "v - mean(v)")],
        results: &[ResultPreset::new("r", "centred / sqrt(variance(v) + 1/16)", 10)],
    },
    ExpressionPreset {
        name: "rmsnorm8",
        purpose: "eight numbers divided by their root mean square",
        operands: &[list("v", 8, ACTIVATION)],
        parts: &[],
        results: &[ResultPreset::new("r", "v / sqrt(mean(v^2) + 1/16)", 10)],
    },
    ExpressionPreset {
        name: "transform",
        purpose: "a matrix of three rows and four columns times a point",
        operands: &[
            vector("p", "xyz", SIGNAL),
            list("a", 4, SIGNAL),
            list("b", 4, SIGNAL),
            list("c", 4, SIGNAL),
        ],
        parts: &[("q", "[p.x, p.y, p.z, 1]")],
        results: &[ResultPreset::new("r", "[dot(a, q), dot(b, q), dot(c, q)]", 12).on("xyz")],
    },
    ExpressionPreset {
        name: "diffuse",
        purpose: "the diffuse light on a surface whose normal has any length",
        operands: &[vector("n", "xyz", NORMAL), vector("l", "xyz", NORMAL)],
        parts: &[("s", "dot(n, n)")],
        results: &[ResultPreset::new("c", "max(0, dot(n, l)) / sqrt(s)", 12).promised("s >= 1/16")],
    },
    ExpressionPreset {
        name: "blinn-phong",
        purpose: "the highlight c^n of Blinn and Phong with a variable exponent",
        operands: &[number("c", PART_OF_ONE), number("n", (false, 8, 0))],
        parts: &[],
        results: &[ResultPreset::new("h", "c^n", 12)],
    },
    ExpressionPreset {
        name: "fresnel",
        purpose: "the reflectance of a surface by Schlick's approximation",
        operands: &[number("c", PART_OF_ONE), number("f", (false, 8, 8))],
        parts: &[],
        results: &[ResultPreset::new("r", "f + (1 - f) * (1 - c)^5", 12)],
    },
    ExpressionPreset {
        name: "ggx",
        purpose: "the GGX distribution of the normals of small facets",
        operands: &[number("c", PART_OF_ONE), number("a", (false, 8, 8))],
        parts: &[("b", "c^2 * (a^2 - 1) + 1")],
        results: &[ResultPreset::new("d", "a^2 / (pi * b^2)", 8).promised("a >= 1/4")],
    },
];

/// The functions of the preset `unit`.
const FUNCTIONS_OF_UNIT: [UnitFunctionPreset; 8] = [
    UnitFunctionPreset {
        name: "rcp",
        operands: &[number("x", (false, 16, 8))],
        results: &[ResultPreset::new("r", "1 / x", 8).promised("x > 0")],
    },
    UnitFunctionPreset {
        name: "rsqrt",
        operands: &[number("x", (false, 16, 8))],
        results: &[ResultPreset::new("r", "1 / sqrt(x)", 12).promised("x > 0")],
    },
    UnitFunctionPreset {
        name: "sqrt",
        operands: &[number("x", (false, 16, 8))],
        results: &[ResultPreset::new("r", "sqrt(x)", 12)],
    },
    UnitFunctionPreset {
        name: "exp2",
        operands: &[number("x", (true, 16, 12))],
        results: &[ResultPreset::new("r", "2^x", 8)],
    },
    UnitFunctionPreset {
        name: "log2",
        operands: &[number("x", (false, 16, 8))],
        results: &[ResultPreset::new("r", "log2(x)", 12).promised("x > 0")],
    },
    UnitFunctionPreset {
        name: "sincos",
        operands: &[number("turn", PART_OF_ONE)],
        results: &[
            ResultPreset::new("sine", "sin(2 * pi * turn)", 15),
            ResultPreset::new("cosine", "cos(2 * pi * turn)", 15),
        ],
    },
    UnitFunctionPreset {
        name: "atan2",
        operands: &[number("x", COORDINATE), number("y", COORDINATE)],
        results: &[ResultPreset::new("angle", "atan2(y, x) / pi", 15).promised("x^2 + y^2 > 0")],
    },
    UnitFunctionPreset {
        name: "divide",
        operands: &[number("x", PART_OF_ONE), number("y", PART_OF_ONE)],
        results: &[ResultPreset::new("q", "x / y", 15).promised("x < y")],
    },
];

struct UnitFunctionPreset {
    name: &'static str,
    operands: &'static [OperandPreset],
    results: &'static [ResultPreset],
}

/// The device and the preset of several functions behind one datapath.
const UNIT: &str = "unit";

/// Returns the names of the presets of `function`, then of `expression`. The preset `unit` is left out.
pub fn names() -> impl Iterator<Item = &'static str> {
    names_of_functions().chain(names_of_expressions())
}

pub fn names_of_expressions() -> impl Iterator<Item = &'static str> {
    EXPRESSIONS.iter().map(|preset| preset.name)
}

pub fn names_of_functions() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|preset| preset.0)
}

/// Returns each preset of `expression` with its purpose, as lines for a help text.
pub fn purposes_of_expressions() -> String {
    let width = EXPRESSIONS.iter().map(|preset| preset.name.len()).max().unwrap_or(0);
    let mut lines = String::new();
    for ExpressionPreset { name, purpose, .. } in &EXPRESSIONS {
        lines += &format!("  {name:width$}  {purpose}\n");
    }
    lines
}

/// Returns the preset with this name. `sqrt` is a preset of the device `function` with `function.formula = "sqrt(x)"`,
/// `function.to = "256"` and five more keys.
pub fn find(name: &str) -> Option<Preset> {
    if let Some(preset) = FUNCTIONS.iter().find(|preset| preset.0 == name) {
        return Some(Preset { device: FUNCTION, purpose: None, values: of_function(preset) });
    }
    if name == UNIT {
        return Some(Preset { device: UNIT, purpose: None, values: of_unit() });
    }
    let preset = EXPRESSIONS.iter().find(|preset| preset.name == name)?;
    Some(Preset {
        device: "expression",
        purpose: Some(preset.purpose),
        values: of_expression(preset),
    })
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

fn of_unit() -> Vec<(String, Value)> {
    let mut functions = Vec::new();
    for UnitFunctionPreset { name, operands, results } in &FUNCTIONS_OF_UNIT {
        let tables = [
            ("operands", Value::Table(operand_entries(operands))),
            ("results", Value::Table(result_entries(results))),
        ];
        functions.push(TableEntry::new(name, &tables));
    }
    vec![("functions".to_owned(), Value::Table(TableEntries(functions)))]
}

fn operand_entries(presets: &[OperandPreset]) -> TableEntries {
    let mut operands = Vec::new();
    for OperandPreset { name, format: (signed, bits, fraction), size, axes } in presets {
        let mut fields = Vec::new();
        if let Some(size) = size {
            fields.push(("size", Value::Integer(*size)));
        }
        if !axes.is_empty() {
            fields.push(("axes", Value::Text((*axes).to_owned())));
        }
        fields.push(("bits", Value::Integer(*bits)));
        fields.push(("fraction", Value::Integer(*fraction)));
        if *signed {
            fields.push(("signed", Value::Flag(true)));
        }
        operands.push(TableEntry::new(name, &fields));
    }
    TableEntries(operands)
}

fn result_entries(presets: &[ResultPreset]) -> TableEntries {
    let text = |text: &str| Value::Text(text.to_owned());
    let mut results = Vec::new();
    for result in presets {
        let mut fields = vec![("formula", text(result.formula))];
        if !result.axes.is_empty() {
            fields.push(("axes", text(result.axes)));
        }
        fields.push(("fraction", Value::Integer(result.fraction)));
        fields.push(("error", Value::Number(result.error)));
        if let Some(bits) = result.saturated_bits {
            fields.push(("bits", Value::Integer(bits)));
            fields.push(("signed", Value::Flag(true)));
            fields.push(("overflow", text("saturate")));
        }
        if result.is_ordered {
            fields.push(("ordered", Value::Flag(true)));
        }
        if !result.promise.is_empty() {
            fields.push(("where", text(result.promise)));
        }
        results.push(TableEntry::new(result.name, &fields));
    }
    TableEntries(results)
}

fn of_expression(preset: &ExpressionPreset) -> Vec<(String, Value)> {
    let mut parts = Vec::new();
    for (name, formula) in preset.parts {
        let formula = Value::Text((*formula).to_owned());
        parts.push(TableEntry::new(name, &[("formula", formula)]));
    }
    let operands = operand_entries(preset.operands);
    let mut values = vec![("operands".to_owned(), Value::Table(operands))];
    if !parts.is_empty() {
        values.push(("let".to_owned(), Value::Table(TableEntries(parts))));
    }
    values.push(("results".to_owned(), Value::Table(result_entries(preset.results))));
    values
}

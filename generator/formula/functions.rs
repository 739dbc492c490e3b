//! Lists the functions of numbers that a formula may call, by name.

use super::highlights::{HIGHLIGHTS, HIGHLIGHTS_WITH_POWER};
use super::list;
use super::{Function, Operator};

/// The functions of one number that a formula may call.
pub const FUNCTIONS: [(&str, Function); 13] = [
    ("abs", Function::Abs),
    ("sqrt", Function::Sqrt),
    ("exp", Function::Exp),
    ("exp2", Function::Exp2),
    // A formula is printed with the first name of a function, which Python has too.
    ("log", Function::Ln),
    ("ln", Function::Ln),
    ("log2", Function::Log2),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("atan", Function::Atan),
    ("tanh", Function::Tanh),
    ("erf", Function::Erf),
];

/// Functions of one number u that are combinations of other functions. For example, `2 * x` replaces u in `cosh(2 * x)`.
const DEFINED: [(&str, &str); 26] = [
    ("reciprocal", "1 / u"),
    ("rsqrt", "1 / sqrt(u)"),
    ("sigmoid", "1 / (1 + exp(-u))"),
    ("gelu", "u / 2 * (1 + erf(u / sqrt(2)))"),
    ("silu", "u / (1 + exp(-u))"),
    ("softplus", "ln(1 + exp(u))"),
    ("erfc", "1 - erf(u)"),
    ("log1p", "ln(1 + u)"),
    ("expm1", "exp(u) - 1"),
    ("radians", "u * pi / 180"),
    ("degrees", "u * 180 / pi"),
    ("sinh", "(exp(u) - exp(-u)) / 2"),
    ("cosh", "(exp(u) + exp(-u)) / 2"),
    ("asin", "2 * atan(u / (1 + sqrt((1 - u) * (1 + u))))"),
    ("acos", "pi / 2 - 2 * atan(u / (1 + sqrt((1 - u) * (1 + u))))"),
    ("log10", "ln(u) / ln(10)"),
    ("cbrt", "if(u < 0, -(-u) ^ (1 / 3), u ^ (1 / 3))"),
    ("floor", "u - u % 1"),
    // As in Python, `int` rounds toward 0.
    ("int", "if(u < 0, u + -u % 1, u - u % 1)"),
    ("trunc", "if(u < 0, u + -u % 1, u - u % 1)"),
    ("ceil", "-(-u - -u % 1)"),
    // Halves are rounded up.
    ("round", "u + 1/2 - (u + 1/2) % 1"),
    ("fract", "u % 1"),
    ("frac", "u % 1"),
    ("sign", "if(u < 0, -1, if(u > 0, 1, 0))"),
    ("saturate", "min(max(u, 0), 1)"),
];

/// The functions of two numbers that a formula may call.
pub(super) const FUNCTIONS_OF_TWO: [(&str, Operator); 4] = [
    ("min", Operator::Min),
    ("max", Operator::Max),
    ("atan2", Operator::Atan2),
    ("pow", Operator::Power),
];

/// Functions of two numbers u and v that are combinations of other functions.
const DEFINED_OF_TWO: [(&str, &str); 3] =
    [("hypot", "sqrt(u^2 + v^2)"), ("mod", "u % v"), ("step", "if(v < u, 0, 1)")];

/// Functions of three numbers u, v and w that are combinations of other functions, as in shading languages.
const DEFINED_OF_THREE: [(&str, &str); 4] = [
    ("clamp", "min(max(u, v), w)"),
    ("mix", "u + (v - u) * w"),
    ("lerp", "u + (v - u) * w"),
    (
        "smoothstep",
        "min(max((w - u) / (v - u), 0), 1)^2 * (3 - 2 * min(max((w - u) / (v - u), 0), 1))",
    ),
];

/// The functions of two numbers that also take more numbers.
pub(super) const FUNCTIONS_OF_MANY: [&str; 3] = ["min", "max", "hypot"];

/// Functions that a formula cannot call, each with a formula to write instead.
const INSTEAD: [(&str, &str); 15] = [
    ("exp10", "10^x"),
    ("square", "x^2"),
    ("sqr", "x^2"),
    ("inversesqrt", "rsqrt(x)"),
    ("arcsin", "asin(x)"),
    ("arccos", "acos(x)"),
    ("arctan", "atan(x)"),
    ("arctan2", "atan2(y, x)"),
    ("fabs", "abs(x)"),
    ("fmod", "mod(x, y), or x % y"),
    ("remainder", "mod(x, y), or x % y"),
    ("fmin", "min(x, y)"),
    ("fmax", "max(x, y)"),
    ("sgn", "sign(x)"),
    ("logistic", "sigmoid(x)"),
];

/// Returns the least number of arguments of a function of numbers, or `None` for an unknown `name`.
pub(super) fn arguments_of(name: &str) -> Option<usize> {
    if named(&FUNCTIONS, name).is_some() {
        return Some(1);
    }
    if named(&FUNCTIONS_OF_TWO, name).is_some() {
        return Some(2);
    }
    definition_of(name).map(|(count, _)| count)
}

/// Returns the number of arguments of a function that is a combination of other functions, and its formula. Returns `None` for
/// any other function.
pub(super) fn definition_of(name: &str) -> Option<(usize, &'static str)> {
    let tables: [(usize, &[(&str, &'static str)]); 5] = [
        (1, &DEFINED),
        (2, &DEFINED_OF_TWO),
        (2, &HIGHLIGHTS),
        (3, &DEFINED_OF_THREE),
        (3, &HIGHLIGHTS_WITH_POWER),
    ];
    tables.into_iter().find_map(|(count, table)| Some((count, named(table, name)?)))
}

/// Returns the entry of a table with the given name, or `None` for an unknown name.
pub(super) fn named<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    table.iter().find(|(own, _)| *own == name).map(|(_, entry)| *entry)
}

/// Returns a formula to write instead of an unknown function, or a list of all functions.
pub(super) fn unknown_function(name: &str) -> String {
    if let Some(text) = named(&INSTEAD, name) {
        return format!("there is no function `{name}`: write {text}");
    }
    let mut all: Vec<&str> = Vec::new();
    all.extend(FUNCTIONS.map(|(own, _)| own));
    all.extend(DEFINED.map(|(own, _)| own));
    all.extend(FUNCTIONS_OF_TWO.map(|(own, _)| own));
    all.extend(DEFINED_OF_TWO.map(|(own, _)| own));
    all.extend(DEFINED_OF_THREE.map(|(own, _)| own));
    all.extend(HIGHLIGHTS.map(|(own, _)| own));
    all.extend(HIGHLIGHTS_WITH_POWER.map(|(own, _)| own));
    all.push("if");
    all.extend(list::names_of_list_functions());
    format!("there is no function `{name}`; there are {}", all.join(", "))
}

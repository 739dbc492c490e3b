//! A formula in the languages of other tools.

use super::{Comparison, Formula, Function, Kind, Operator};

/// A language that formulas are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// As [`super::parse()`] reads it, and Python with `from math import *`.
    Python,
    /// NumPy, imported as `np`, on arrays.
    Numpy,
    /// C99, with `math.h`.
    C,
    /// Gappa, which has roots and no other functions.
    Gappa,
    /// MathML of one expression, without the element `math` around it.
    MathMl,
}

/// How strongly a part holds together: sums, products, signs, powers, and what needs no parentheses.
const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const SIGN: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

impl Formula {
    /// The text in a language, if the language has all of its functions.
    pub fn print(&self, language: Language) -> Option<String> {
        let printed = match language {
            Language::MathMl => mathml(self),
            _ => plain(self, language),
        };
        printed.map(|(text, _)| text)
    }
}

/// A part in parentheses where it holds together less than `least`.
fn within((text, rank): (String, u8), least: u8) -> String {
    if rank < least { format!("({text})") } else { text }
}

fn plain(formula: &Formula, language: Language) -> Option<(String, u8)> {
    use Language::{C, Gappa, Numpy};
    let part = |part: &Formula, least: u8| Some(within(plain(part, language)?, least));
    let call = |name: &str, parts: &[&Formula]| {
        let parts: Option<Vec<String>> = parts.iter().map(|it| part(it, SUM)).collect();
        let space = if language == Numpy { "np." } else { "" };
        Some((format!("{space}{name}({})", parts?.join(", ")), ATOM))
    };
    match &formula.kind {
        Kind::Number(value, _) => Some((format!("{value:?}"), ATOM)),
        Kind::Constant(name, value) => Some(match language {
            Numpy => (format!("np.{name}"), ATOM),
            C => (format!("{value:?}"), ATOM),
            // A number that is no decimal of a few digits has no exact text.
            Gappa => return None,
            _ => ((*name).to_owned(), ATOM),
        }),
        Kind::Operand(name) => Some((name.clone(), ATOM)),
        Kind::Word(..) if matches!(language, C | Gappa) => None,
        Kind::Word(rom, at) => Some((format!("{rom}[int({})]", part(at, SUM)?), ATOM)),
        Kind::Unary(Function::Negate, a) => Some((format!("-{}", part(a, SIGN)?), SIGN)),
        Kind::Unary(function, a) => match (language, name(*function)) {
            (Gappa, name @ "sqrt") => call(name, &[a]),
            (Gappa, "abs") => Some((format!("|{}|", part(a, SUM)?), ATOM)),
            (Gappa, _) => None,
            (C, "abs") => call("fabs", &[a]),
            (C | Numpy, "ln") => call("log", &[a]),
            // NumPy has none; SciPy has.
            (Numpy, "erf") => Some((format!("scipy.special.erf({})", part(a, SUM)?), ATOM)),
            (_, name) => call(name, &[a]),
        },
        Kind::Binary(operator, a, b) => {
            let infix = |sign: &str, left: u8, right: u8, own: u8| {
                Some((format!("{} {sign} {}", part(a, left)?, part(b, right)?), own))
            };
            match (operator, language) {
                (Operator::Add, _) => infix("+", SUM, PRODUCT, SUM),
                (Operator::Sub, _) => infix("-", SUM, PRODUCT, SUM),
                (Operator::Mul, _) => infix("*", PRODUCT, SIGN, PRODUCT),
                (Operator::Div, _) => infix("/", PRODUCT, SIGN, PRODUCT),
                (Operator::Mod | Operator::Power | Operator::Min | Operator::Max, Gappa) => None,
                (Operator::Mod, C) => None,
                (Operator::Mod, _) => infix("%", PRODUCT, SIGN, PRODUCT),
                (Operator::Power, C) => call("pow", &[a, b]),
                (Operator::Power, _) => infix("**", ATOM, SIGN, POWER),
                (Operator::Min, C) => call("fmin", &[a, b]),
                (Operator::Max, C) => call("fmax", &[a, b]),
                (Operator::Min, Numpy) => call("minimum", &[a, b]),
                (Operator::Max, Numpy) => call("maximum", &[a, b]),
                (Operator::Min, _) => call("min", &[a, b]),
                (Operator::Max, _) => call("max", &[a, b]),
            }
        }
        Kind::If(comparison, yes, no) => {
            let Comparison { left, right, or_equal } = comparison;
            let sign = if *or_equal { ">=" } else { ">" };
            let test = format!("{} {sign} {}", part(left, SUM)?, part(right, SUM)?);
            let (yes, no) = (part(yes, SUM)?, part(no, SUM)?);
            Some(match language {
                Gappa => return None,
                C => (format!("({test} ? {yes} : {no})"), ATOM),
                Numpy => (format!("np.where({test}, {yes}, {no})"), ATOM),
                _ => (format!("({yes} if {test} else {no})"), ATOM),
            })
        }
    }
}

/// The name of a function as formulas have it.
fn name(function: Function) -> &'static str {
    let mut all = super::FUNCTIONS.iter();
    all.find(|(_, own)| *own == function).map_or("-", |(name, _)| name)
}

fn mathml(formula: &Formula) -> Option<(String, u8)> {
    let row = |part: &Formula| Some(format!("<mrow>{}</mrow>", mathml(part)?.0));
    let part = |part: &Formula, least: u8| {
        let (text, rank) = mathml(part)?;
        Some(if rank < least { format!("<mo>(</mo>{text}<mo>)</mo>") } else { text })
    };
    let apply = |name: &str, inner: String| {
        (format!("<mi>{name}</mi><mo>&#x2061;</mo><mo>(</mo>{inner}<mo>)</mo>"), ATOM)
    };
    Some(match &formula.kind {
        Kind::Number(value, _) => (format!("<mn>{value}</mn>"), ATOM),
        Kind::Constant("pi", _) => ("<mi>π</mi>".to_owned(), ATOM),
        Kind::Constant(name, _) => (format!("<mi>{name}</mi>"), ATOM),
        Kind::Operand(name) => (format!("<mi>{name}</mi>"), ATOM),
        Kind::Word(rom, at) => (format!("<msub><mi>{rom}</mi>{}</msub>", row(at)?), ATOM),
        Kind::Unary(Function::Negate, a) => (format!("<mo>−</mo>{}", part(a, SIGN)?), SIGN),
        Kind::Unary(Function::Sqrt, a) => (format!("<msqrt>{}</msqrt>", row(a)?), ATOM),
        Kind::Unary(Function::Abs, a) => (format!("<mo>|</mo>{}<mo>|</mo>", row(a)?), ATOM),
        Kind::Unary(Function::Exp, a) => (format!("<msup><mi>e</mi>{}</msup>", row(a)?), POWER),
        Kind::Unary(Function::Exp2, a) => (format!("<msup><mn>2</mn>{}</msup>", row(a)?), POWER),
        Kind::Unary(function, a) => apply(name(*function), row(a)?),
        Kind::Binary(Operator::Add, a, b) => {
            (format!("{}<mo>+</mo>{}", part(a, SUM)?, part(b, PRODUCT)?), SUM)
        }
        Kind::Binary(Operator::Sub, a, b) => {
            (format!("{}<mo>−</mo>{}", part(a, SUM)?, part(b, PRODUCT)?), SUM)
        }
        Kind::Binary(Operator::Mul, a, b) => {
            (format!("{}<mo>⋅</mo>{}", part(a, PRODUCT)?, part(b, SIGN)?), PRODUCT)
        }
        Kind::Binary(Operator::Mod, a, b) => {
            (format!("{}<mo>mod</mo>{}", part(a, PRODUCT)?, part(b, SIGN)?), PRODUCT)
        }
        Kind::Binary(Operator::Div, a, b) => {
            (format!("<mfrac>{}{}</mfrac>", row(a)?, row(b)?), ATOM)
        }
        Kind::Binary(Operator::Power, a, b) => {
            (format!("<msup><mrow>{}</mrow>{}</msup>", part(a, ATOM)?, row(b)?), POWER)
        }
        Kind::Binary(Operator::Min | Operator::Max, a, b) => {
            let name =
                if plain(formula, Language::Python)?.0.starts_with("min") { "min" } else { "max" };
            apply(name, format!("{}<mo>,</mo>{}", row(a)?, row(b)?))
        }
        Kind::If(Comparison { left, right, or_equal }, yes, no) => {
            let sign = if *or_equal { "≥" } else { "&gt;" };
            let line = |value: String, when: String| {
                format!("<mtr><mtd>{value}</mtd><mtd>{when}</mtd></mtr>")
            };
            let test = format!("{}<mo>{sign}</mo>{}", row(left)?, row(right)?);
            let rows =
                line(row(yes)?, test) + &line(row(no)?, "<mtext>otherwise</mtext>".to_owned());
            (format!("<mo>{{</mo><mtable>{rows}</mtable>"), ATOM)
        }
    })
}

//! Prints a formula as an expression of Python or of C.

use super::{Comparison, Expression, Function, Kind, Operator};

/// The precedence of a part: sums, products, signs, powers, and parts that need no parentheses.
const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const SIGN: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

impl Expression {
    /// Returns the formula as Python, to be evaluated after `from math import *`; [`super::parse()`] reads it too. For example,
    /// `x^2 + 1` becomes `x ** 2.0 + 1.0`.
    pub fn python(&self) -> String {
        python(self).0
    }
}

impl Expression {
    /// Returns the formula as C: calls of the interval functions in `templates/recompute.c`.
    pub fn c(&self) -> String {
        let call = |name: &str, parts: &[&Self]| {
            let parts: Vec<String> = parts.iter().map(|it| it.c()).collect();
            format!("{name}({})", parts.join(", "))
        };
        match &self.kind {
            Kind::Number(literal) => format!("number(\"{}\")", literal.digits()),
            Kind::Constant("pi", _) => "constant(mpfr_const_pi)".to_owned(),
            Kind::Constant(..) => "rising(mpfr_exp, number(\"1\"))".to_owned(),
            Kind::Operand(name) | Kind::Word(name, _) => name.clone(),
            Kind::Unary(Function::Negate, a) => call("negate", &[a]),
            Kind::Unary(Function::Abs, a) => call("absolute", &[a]),
            Kind::Unary(Function::Tan, a) => call("tangent", &[a]),
            Kind::Unary(function @ (Function::Sin | Function::Cos), a) => {
                format!("wave(mpfr_{}, {})", function.name(), a.c())
            }
            Kind::Unary(function, a) => format!("rising(mpfr_{}, {})", function.name(), a.c()),
            Kind::Binary(operator, a, b) => {
                let name = match operator {
                    Operator::Add => "add",
                    Operator::Sub => "subtract",
                    Operator::Mul => "multiply",
                    Operator::Div => "divide",
                    Operator::Mod => "remainder_of",
                    Operator::Power => "power",
                    Operator::Min => "minimum",
                    Operator::Max => "maximum",
                    Operator::Atan2 => "direction",
                };
                call(name, &[a, b])
            }
            Kind::If(Comparison { left, right, or_equal }, yes, no) => {
                let [left, right] = [left.c(), right.c()];
                format!("choose({left}, {right}, {}, {}, {})", u8::from(*or_equal), yes.c(), no.c())
            }
        }
    }
}

/// Returns a part in parentheses where it holds together less than `least`.
fn within((text, rank): (String, u8), least: u8) -> String {
    if rank < least { format!("({text})") } else { text }
}

fn python(formula: &Expression) -> (String, u8) {
    let part = |part: &Expression, least: u8| within(python(part), least);
    let call = |name: &str, parts: &[&Expression]| {
        let parts: Vec<String> = parts.iter().map(|it| part(it, SUM)).collect();
        (format!("{name}({})", parts.join(", ")), ATOM)
    };
    match &formula.kind {
        Kind::Number(literal) => (literal.digits(), ATOM),
        Kind::Constant(name, _) => ((*name).to_owned(), ATOM),
        Kind::Operand(name) => (name.clone(), ATOM),
        Kind::Word(rom, at) => (format!("{rom}[int({})]", part(at, SUM)), ATOM),
        Kind::Unary(Function::Negate, a) => (format!("-{}", part(a, SIGN)), SIGN),
        Kind::Unary(function, a) => call(function.name(), &[a]),
        Kind::Binary(operator, a, b) => {
            let infix = |sign: &str, left: u8, right: u8, own: u8| {
                (format!("{} {sign} {}", part(a, left), part(b, right)), own)
            };
            match operator {
                Operator::Add => infix("+", SUM, PRODUCT, SUM),
                Operator::Sub => infix("-", SUM, PRODUCT, SUM),
                Operator::Mul => infix("*", PRODUCT, SIGN, PRODUCT),
                Operator::Div => infix("/", PRODUCT, SIGN, PRODUCT),
                Operator::Mod => infix("%", PRODUCT, SIGN, PRODUCT),
                Operator::Power => infix("**", ATOM, SIGN, POWER),
                Operator::Min => call("min", &[a, b]),
                Operator::Max => call("max", &[a, b]),
                Operator::Atan2 => call("atan2", &[a, b]),
            }
        }
        Kind::If(Comparison { left, right, or_equal }, yes, no) => {
            let sign = if *or_equal { ">=" } else { ">" };
            let test = format!("{} {sign} {}", part(left, SUM), part(right, SUM));
            (format!("({} if {test} else {})", part(yes, SUM), part(no, SUM)), ATOM)
        }
    }
}

impl Function {
    /// Returns the name of the function in formulas.
    pub fn name(self) -> &'static str {
        super::FUNCTIONS.iter().find(|(_, own)| *own == self).map_or("-", |(name, _)| name)
    }
}

//! Prints a formula as an expression of Python or of C.

use super::{Comparison, Expression, Function, Kind, Literal, Operator};

/// The precedences of parts, the weakest first: sums, products, signs, powers, and parts that need no parentheses.
const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const SIGN: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

impl Expression {
    /// Returns an expression that Python evaluates after `from math import *`, and that [`super::parse()`] also parses. For
    /// example, `x^2 + 1` becomes `x ** 2.0 + 1.0`. The function `exp2` needs Python 3.11.
    pub fn python(&self) -> String {
        python(self).0
    }
}

/// The C functions that evaluate a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CArithmetic {
    /// Intervals of MPFR numbers, with the functions in `templates/recompute_limits.c`, such as `add(x, number("1.0"))`.
    Limits,
    /// Doubles with a margin of error, with the functions in `templates/recompute_near.c`, such as `near_add(x,
    /// near_exactly(1.0))`.
    Near,
}

impl CArithmetic {
    /// Returns the prefix of the names of all functions of this arithmetic.
    fn prefix(self) -> &'static str {
        match self {
            Self::Limits => "",
            Self::Near => "near_",
        }
    }

    fn number(self, literal: &Literal) -> String {
        match self {
            Self::Limits => format!("number(\"{}\")", literal.digits()),
            Self::Near if literal.is_exact() => format!("near_exactly({:?})", literal.nearest()),
            Self::Near => format!("near_rounded({:?})", literal.nearest()),
        }
    }

    /// Returns the C expression of a constant. `below` is the largest `f64` that is not above the constant.
    fn constant(self, name: &str, below: f64) -> String {
        match (self, name) {
            (Self::Limits, "pi") => "constant(mpfr_const_pi)".to_owned(),
            (Self::Limits, _) => "rising(mpfr_exp, number(\"1\"))".to_owned(),
            (Self::Near, _) => format!("near_rounded({below:?})"),
        }
    }

    /// Returns the library function that computes a function of a formula. For example, the sine is `mpfr_sin` or `sin`.
    fn library_function(self, function: Function) -> String {
        match self {
            Self::Limits => format!("mpfr_{}", function.name()),
            Self::Near => function.name().to_owned(),
        }
    }
}

impl Expression {
    /// Returns a C expression, which calls the functions of `arithmetic`. A word of a ROM becomes its name.
    pub fn c(&self, arithmetic: CArithmetic) -> String {
        match &self.kind {
            Kind::Number(literal) => arithmetic.number(literal),
            Kind::Constant(name, below) => arithmetic.constant(name, *below),
            Kind::Operand(name) | Kind::Word(name, _) => name.clone(),
            Kind::Unary(function, a) => c_of_unary(arithmetic, *function, a),
            Kind::Binary(Operator::Power, a, b) if arithmetic == CArithmetic::Near && is_two(b) => {
                c_call(arithmetic, "square", &[a], "")
            }
            Kind::Binary(operator, a, b) => c_call(arithmetic, c_operator(*operator), &[a, b], ""),
            Kind::If(comparison, yes, no) => {
                let Comparison { left, right, or_equal } = comparison;
                let (or_equal, yes, no) =
                    (u8::from(*or_equal), yes.c(arithmetic), no.c(arithmetic));
                let more = format!(", {or_equal}, {yes}, {no}");
                c_call(arithmetic, "choose", &[left, right], &more)
            }
        }
    }
}

impl Comparison {
    /// Returns a call of a C function that returns whether the comparison holds. For example, `x >= 0` becomes `exceeds(x,
    /// number("0.0"), 1)`. The last argument is 1 for `>=`, and 0 for `>`.
    pub fn c(&self, arithmetic: CArithmetic) -> String {
        let or_equal = format!(", {}", u8::from(self.or_equal));
        c_call(arithmetic, "exceeds", &[&self.left, &self.right], &or_equal)
    }

    /// Returns a Python expression such as `x >= 0.0`.
    pub fn python(&self) -> String {
        let sign = if self.or_equal { ">=" } else { ">" };
        format!("{} {sign} {}", self.left.python(), self.right.python())
    }
}

/// Returns whether a formula is the number 2. For doubles, a square is printed as a product, which is faster than a power.
fn is_two(formula: &Expression) -> bool {
    matches!(&formula.kind, Kind::Number(literal) if literal.is_exact() && literal.nearest() == 2.0)
}

/// Returns a call of the C function `name` with formulas as arguments, followed by the text `more`.
fn c_call(arithmetic: CArithmetic, name: &str, parts: &[&Expression], more: &str) -> String {
    let parts: Vec<String> = parts.iter().map(|part| part.c(arithmetic)).collect();
    format!("{}{name}({}{more})", arithmetic.prefix(), parts.join(", "))
}

fn c_of_unary(arithmetic: CArithmetic, function: Function, a: &Expression) -> String {
    match function {
        Function::Negate => c_call(arithmetic, "negate", &[a], ""),
        Function::Abs => c_call(arithmetic, "absolute", &[a], ""),
        Function::Tan => c_call(arithmetic, "tangent", &[a], ""),
        _ => {
            let is_wave = matches!(function, Function::Sin | Function::Cos);
            let name = if is_wave { "wave" } else { "rising" };
            let library = arithmetic.library_function(function);
            format!("{}{name}({library}, {})", arithmetic.prefix(), a.c(arithmetic))
        }
    }
}

fn c_operator(operator: Operator) -> &'static str {
    match operator {
        Operator::Add => "add",
        Operator::Sub => "subtract",
        Operator::Mul => "multiply",
        Operator::Div => "divide",
        Operator::Mod => "remainder_of",
        Operator::Power => "power",
        Operator::Min => "minimum",
        Operator::Max => "maximum",
        Operator::Atan2 => "direction",
    }
}

/// Returns a part's text, in parentheses if its precedence is weaker than `least`.
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
        Kind::If(comparison, yes, no) => {
            let test = comparison.python();
            (format!("({} if {test} else {})", part(yes, SUM), part(no, SUM)), ATOM)
        }
    }
}

impl Function {
    /// Returns the name in formulas, or `-` for [`Function::Negate`].
    pub fn name(self) -> &'static str {
        super::FUNCTIONS.iter().find(|(_, own)| *own == self).map_or("-", |(name, _)| name)
    }
}

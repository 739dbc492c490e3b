//! Parses formulas such as `1 / sqrt(x)` to trees, evaluates the trees with interval arithmetic, and prints them as Python and
//! C.
//!
//! The formulas come from configurations and from accuracy contracts; another example is `max(x, 0) if x > 1 else 2 ** -x`. An
//! evaluation gives an interval that contains the exact value, or fails if there is no value. Each node of a tree knows its
//! range of bytes in the text, so that a message can point at a mistake.

mod arithmetic;
mod enclosure;
mod evaluate;
mod exact;
mod literal;
mod parse;
mod precise;
mod print;
mod slope;

use std::fmt;
use std::ops::Range;

pub use dashu_ratio::RBig;
pub use enclosure::Enclosure;
pub use literal::Literal;
pub use parse::{FUNCTIONS, parse};
pub use print::CArithmetic;

/// A formula, or a part of a formula, as a tree. Two formulas are equal if their kinds are equal, even if they have different
/// locations.
#[derive(Clone, Debug)]
pub struct Expression {
    /// The operation, the operand or the number at the root of the tree. For example, the root of `1 / x` is a division.
    pub kind: Kind,
    /// The range of bytes in the text from which this part was parsed; 0..0 if it comes from no text.
    pub span: Range<usize>,
    /// The value, if the part contains no operand and no word of a ROM, and has a value. The value is computed only once,
    /// because formulas are evaluated at millions of operands.
    constant: Option<Enclosure>,
}

/// The kinds of parts of a formula, such as a number, an operand or an operation.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number, exactly as the text states it.
    Number(Literal),
    /// A named constant such as `pi`, with the largest `f64` that is not above its value.
    Constant(&'static str, f64),
    /// An operand, by its name. Its value is a real number, not a raw integer.
    Operand(String),
    /// A word of a ROM as a real number. The fields are the name of the ROM, and the formula for the index of the word.
    Word(String, Box<Expression>),
    /// A function of one number.
    Unary(Function, Box<Expression>),
    /// A function of two numbers.
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// The first formula if the comparison holds, otherwise the second.
    If(Comparison, Box<Expression>, Box<Expression>),
}

/// A comparison: whether the left number is larger than the right number.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The number on the left of `>`.
    pub left: Box<Expression>,
    /// The number on the right of `>`.
    pub right: Box<Expression>,
    /// Whether the comparison also holds for equal numbers (`>=`).
    pub or_equal: bool,
}

/// The elementary functions of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are those of mathematics")]
pub enum Function {
    Negate,
    Abs,
    Sqrt,
    Exp,
    Exp2,
    Ln,
    Log2,
    Sin,
    Cos,
    Tan,
    Atan,
    Tanh,
    Erf,
}

/// The functions of two numbers, such as a sum or a power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are those of mathematics")]
pub enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    /// The remainder of the first number divided by the second. The remainder lies between 0 and the second number. For
    /// example, −1 and 4 give 3.
    Mod,
    Power,
    Min,
    Max,
    /// The direction of a point as an angle from −π to π. The first number is the y coordinate, the second the x coordinate.
    Atan2,
}

/// A mistake in a formula, with its location in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The range of bytes in the text that is wrong.
    pub span: Range<usize>,
    /// The description of the mistake, for the user.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl Fault {
    fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { span, message: message.into() }
    }

    /// Returns the text on one line, and on the next line carets under the mistake and the message. For example, in `sqrt(y)`
    /// the operand y has the mistake "there is no `y`: the operand is `x`", and a caret is under the y.
    pub fn under(&self, text: &str) -> String {
        let count = |range: Range<usize>| text.get(range).map_or(0, |it| it.chars().count());
        let carets = count(self.span.clone()).max(1);
        let before = " ".repeat(count(0..self.span.start.min(text.len())));
        format!("{text}\n{before}{} {}", "^".repeat(carets), self.message)
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

impl Expression {
    /// Makes the formula that consists only of the operand `name`. Its location is 0..0.
    pub fn operand(name: &str) -> Self {
        Self::new(Kind::Operand(name.to_owned()), 0..0)
    }

    /// Makes a formula of this kind, which was parsed from the bytes `span` of a text. The function also computes the value of
    /// a constant formula.
    pub fn new(kind: Kind, span: Range<usize>) -> Self {
        let mut formula = Self { kind, span, constant: None };
        let is_constant = formula.parts().iter().all(|part| part.constant.is_some())
            && !matches!(formula.kind, Kind::Operand(_) | Kind::Word(..));
        if is_constant {
            formula.constant = formula.enclose(&[]).ok();
        }
        formula
    }

    /// Returns the formulas directly below the root of the tree, in the order of the text. A number, a constant or an operand
    /// has none.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            Kind::Number(..) | Kind::Constant(..) | Kind::Operand(_) => Vec::new(),
            Kind::Word(_, a) | Kind::Unary(_, a) => vec![a],
            Kind::Binary(_, a, b) => vec![a, b],
            Kind::If(Comparison { left, right, .. }, a, b) => vec![left, right, a, b],
        }
    }

    /// Calls `visit` for every part of the formula and then for the formula itself, each part before the operation that uses
    /// it.
    pub fn walk<'f>(&'f self, visit: &mut dyn FnMut(&'f Self)) {
        self.parts().into_iter().for_each(|part| part.walk(visit));
        visit(self);
    }

    /// Returns the `f64` from which a decimal of 17 or more significant digits was printed, with its sign. Returns `None` for
    /// any other formula.
    ///
    /// For example, NumPy's `savetxt` prints 1 − 2^−20 as `9.999990463256835938e-01`, which is the nearest decimal of 19
    /// digits.
    pub fn printed_double(&self) -> Option<f64> {
        match &self.kind {
            Kind::Number(literal) if literal.significant_digits() >= 17 => Some(literal.nearest()),
            Kind::Unary(Function::Negate, a) => a.printed_double().map(|value| -value),
            _ => None,
        }
    }

    /// Returns the number of parts for which `is` returns true. The formula itself is also a part.
    pub fn count(&self, is: &dyn Fn(&Self) -> bool) -> usize {
        let mut count = 0;
        self.walk(&mut |part| count += usize::from(is(part)));
        count
    }

    /// Returns the formula unchanged if it has no operand except `operand` and no words of ROMs. A formula without operands is
    /// accepted too.
    ///
    /// # Errors
    /// Fails at the first other operand or word of a ROM. The error has its location.
    pub fn of_operand(self, operand: &str) -> Result<Self, Fault> {
        let mut fault = None;
        self.walk(&mut |part| {
            if let Kind::Operand(name) | Kind::Word(name, _) = &part.kind
                && (name != operand || matches!(part.kind, Kind::Word(..)))
            {
                let message = format!("there is no `{name}`: the operand is `{operand}`");
                fault.get_or_insert(Fault::new(part.span.clone(), message));
            }
        });
        fault.map_or(Ok(self), Err)
    }

    /// Returns the names of the operands that the formula reads, each once, in the order in which they first occur. For
    /// example, `y / (x + y)` gives y and x.
    pub fn operands(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        self.walk(&mut |part| {
            if let Kind::Operand(name) = &part.kind
                && !names.contains(&name.as_str())
            {
                names.push(name);
            }
        });
        names
    }

    /// Returns whether `is` returns true for the kind of some part of the formula. The formula itself is also a part.
    pub fn has(&self, is: &dyn Fn(&Kind) -> bool) -> bool {
        is(&self.kind) || self.parts().into_iter().any(|part| part.has(is))
    }

    /// Returns the formula with operands replaced by formulas. `replacement` returns the formula for the name of an operand, or
    /// `None` for an operand that stays. A replacement gets the location of the operand in the text; all other parts keep their
    /// locations.
    pub fn with_operands(&self, replacement: &dyn Fn(&str) -> Option<Self>) -> Self {
        if let Kind::Operand(name) = &self.kind {
            return match replacement(name) {
                Some(formula) => formula.at(&self.span),
                None => self.clone(),
            };
        }
        let kind = self.kind.with_parts(&|part| part.with_operands(replacement));
        Self::new(kind, self.span.clone())
    }

    /// Returns the formula in which all parts have the same location `place`.
    fn at(&self, place: &Range<usize>) -> Self {
        let nothing = Self::new(Kind::Operand(String::new()), 0..0);
        let moved = self.substitute(&nothing, &nothing, place);
        Self { span: place.clone(), ..moved }
    }

    /// Returns the formula in which every part that equals `old` is replaced by `new`. All other parts get the location `call`.
    pub fn substitute(&self, old: &Self, new: &Self, call: &Range<usize>) -> Self {
        if self == old {
            return new.clone();
        }
        let kind = self.kind.with_parts(&|part| part.substitute(old, new, call));
        Self::new(kind, call.clone())
    }
}

impl Kind {
    /// Returns the kind with its direct parts replaced. `new` returns the replacement of a part.
    fn with_parts(&self, new: &dyn Fn(&Expression) -> Expression) -> Self {
        let inner = |part: &Expression| Box::new(new(part));
        match self {
            Kind::Word(rom, at) => Kind::Word(rom.clone(), inner(at)),
            Kind::Unary(function, a) => Kind::Unary(*function, inner(a)),
            Kind::Binary(operator, a, b) => Kind::Binary(*operator, inner(a), inner(b)),
            Kind::If(it, a, b) => {
                let (left, right) = (inner(&it.left), inner(&it.right));
                Kind::If(Comparison { left, right, or_equal: it.or_equal }, inner(a), inner(b))
            }
            leaf => leaf.clone(),
        }
    }
}

#[cfg(test)]
mod tests;

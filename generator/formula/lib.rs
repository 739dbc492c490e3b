//! Parses formulas such as `1 / sqrt(x)` to trees, evaluates the trees with interval arithmetic, and prints them as Python and
//! C.
//!
//! The formulas come from configurations and from accuracy contracts, such as `max(x, 0) if x > 1 else 2 ** -x`. An evaluation
//! gives an interval that contains the exact value, or fails if there is no value. Each node of a tree knows its range of bytes
//! in the text, for messages about mistakes.

mod arithmetic;
mod condition;
mod enclosure;
mod evaluate;
mod exact;
mod functions;
mod highlights;
mod list;
mod literal;
mod parse;
mod precise;
mod print;
mod slope;

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::mem;
use std::ops::Range;
use std::ptr;
use std::sync::Arc;

pub use dashu_ratio::RBig;
pub use enclosure::Enclosure;
pub use functions::FUNCTIONS;
pub use list::{LONGEST_LIST, NumberList, NumberOrList};
pub use literal::Literal;
pub use parse::{
    EULER, NamedLists, parse, parse_condition, parse_condition_with_lists, parse_with_lists,
};
pub use print::CArithmetic;

/// A formula, or a part of a formula, as a tree. Two formulas are equal if their kinds are equal, even at different locations.
///
/// Several operations may read the same part. For example, with `p = x + 1`, both factors of `p * p` are one part. Methods visit
/// such a part only once, so their cost grows with the number of different parts.
#[derive(Clone)]
pub struct Expression {
    /// The root of the tree, for example a division for `1 / x`.
    pub kind: Kind,
    /// The location in the text from which this part was parsed. The location is empty if the part comes from no text.
    pub span: TextSpan,
    /// The hash, which is equal for equal formulas, and nearly always different for different ones.
    hash: u64,
    /// The number of parts, at most `u32::MAX`. A part that several operations read counts once for each of them.
    size: u32,
    varies: bool,
    /// The value of a part without operands and words of ROMs, or `None` without a value. The value is computed only once,
    /// because formulas are evaluated at millions of operands.
    constant: Option<Enclosure>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextSpan {
    /// The number of the text, which is 0 for the formula itself. A caller that combines formulas numbers the other texts.
    pub text: usize,
    /// The range of bytes in this text.
    pub bytes: Range<usize>,
}

impl From<Range<usize>> for TextSpan {
    fn from(bytes: Range<usize>) -> Self {
        Self { text: 0, bytes }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number exactly as the text states it.
    Number(Literal),
    /// A constant such as `pi`, with the largest `f64` that is not above its value.
    Constant(&'static str, f64),
    /// An operand, whose value is a real number, not a raw integer.
    Operand(String),
    /// A word of a ROM as a real number: the name of the ROM, and the word's index.
    Word(String, Arc<Expression>),
    /// A function of one number.
    Unary(Function, Arc<Expression>),
    /// A function of two numbers.
    Binary(Operator, Arc<Expression>, Arc<Expression>),
    /// The first formula if the comparison holds, and otherwise the second.
    If(Comparison, Arc<Expression>, Arc<Expression>),
}

/// A comparison that holds if the left number is larger than the right one.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    pub left: Arc<Expression>,
    pub right: Arc<Expression>,
    /// Whether the comparison also holds for equal numbers (`>=`).
    pub or_equal: bool,
}

/// The elementary functions of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are those of mathematics")]
pub enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    /// The remainder, which lies between 0 and the second number. For example, −1 and 4 give 3.
    Mod,
    Power,
    Min,
    Max,
    /// A point's direction as an angle from −π to π. The first number is the y coordinate, the second the x coordinate.
    Atan2,
}

/// A mistake in a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    pub span: TextSpan,
    /// A message for the user.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl Fault {
    fn new(span: impl Into<TextSpan>, message: impl Into<String>) -> Self {
        Self { span: span.into(), message: message.into() }
    }

    /// Returns `text` on one line, and carets under the mistake with the message on the next line.
    pub fn under(&self, text: &str) -> String {
        let count = |range: Range<usize>| text.get(range).map_or(0, |it| it.chars().count());
        let bytes = self.span.bytes.clone();
        let carets = count(bytes.clone()).max(1);
        let before = " ".repeat(count(0..bytes.start.min(text.len())));
        format!("{text}\n{before}{} {}", "^".repeat(carets), self.message)
    }
}

/// Prints a formula of few parts in Python. A formula of many parts, which may be shared, prints its hash.
impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MOST_PARTS: u32 = 1000;
        match self.size {
            0..=MOST_PARTS => f.write_str(&self.python()),
            size => write!(f, "a formula of {size} parts with the hash {:#x}", self.hash),
        }
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        ptr::eq(self, other) || self.hash == other.hash && self.kind == other.kind
    }
}

impl Expression {
    /// Makes the formula that consists only of the operand `name`.
    pub fn operand(name: &str) -> Self {
        Self::new(Kind::Operand(name.to_owned()), 0..0)
    }

    /// Returns a number that is equal for equal formulas, and nearly always different for different ones. Locations do not count.
    pub fn digest(&self) -> u64 {
        self.hash
    }

    /// Returns the formula with the location `span` in the text.
    pub fn at(self, span: impl Into<TextSpan>) -> Self {
        Self { span: span.into(), ..self }
    }

    /// Makes a formula that was parsed from the location `span` of a text. The value of a constant formula is computed at once.
    pub fn new(kind: Kind, span: impl Into<TextSpan>) -> Self {
        let varies = matches!(kind, Kind::Operand(_));
        let mut formula =
            Self { kind, span: span.into(), hash: 0, size: 1, varies, constant: None };
        let mut hasher = DefaultHasher::new();
        formula.kind.hash_root(&mut hasher);
        for part in formula.parts() {
            part.hash.hash(&mut hasher);
        }
        formula.hash = hasher.finish();
        let sizes = formula.parts().into_iter().map(|part| part.size);
        formula.size = sizes.fold(1, u32::saturating_add);
        formula.varies |= formula.parts().iter().any(|part| part.varies);
        let is_constant = formula.parts().iter().all(|part| part.constant.is_some())
            && !matches!(formula.kind, Kind::Operand(_) | Kind::Word(..));
        if is_constant {
            formula.constant = formula.enclose(&[]).ok();
        }
        formula
    }

    /// Returns the number of parts as a text would state them. A part that several operations read counts once for each of them.
    /// For example, `x * x + 1` has five parts.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Returns whether the formula reads an operand.
    pub fn varies(&self) -> bool {
        self.varies
    }

    /// Returns the formulas directly below the root of the tree, in the order of the text.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            Kind::Number(..) | Kind::Constant(..) | Kind::Operand(_) => Vec::new(),
            Kind::Word(_, a) | Kind::Unary(_, a) => vec![a],
            Kind::Binary(_, a, b) => vec![a, b],
            Kind::If(Comparison { left, right, .. }, a, b) => vec![left, right, a, b],
        }
    }

    /// Calls `visit` once for every part, including the formula itself. Each part comes before the operations that use it.
    pub fn walk<'f>(&'f self, visit: &mut dyn FnMut(&'f Self)) {
        self.walk_unseen(&mut HashSet::new(), visit);
    }

    fn walk_unseen<'f>(&'f self, seen: &mut HashSet<*const Self>, visit: &mut dyn FnMut(&'f Self)) {
        if !seen.insert(ptr::from_ref(self)) {
            return;
        }
        for part in self.parts() {
            part.walk_unseen(seen, visit);
        }
        visit(self);
    }

    /// Returns the `f64`, with its sign, from which a decimal of 17 or more significant digits was printed. Returns `None` if the
    /// formula is no such decimal. For example, NumPy's `savetxt` prints 1 − 2^−20 as `9.999990463256835938e-01`, the nearest
    /// decimal of 19 digits.
    pub fn printed_double(&self) -> Option<f64> {
        match &self.kind {
            Kind::Number(literal) if literal.significant_digits() >= 17 => Some(literal.nearest()),
            Kind::Unary(Function::Negate, a) => a.printed_double().map(|value| -value),
            _ => None,
        }
    }

    /// Returns the number of different parts, including the formula itself, for which `is` returns true.
    pub fn count(&self, is: &dyn Fn(&Self) -> bool) -> usize {
        let mut count = 0;
        self.walk(&mut |part| count += usize::from(is(part)));
        count
    }

    /// Returns the formula unchanged. Fails at the first operand other than `operand`, or at the first word of a ROM.
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

    /// Returns the names of the operands, each once, in the order in which they first occur. For example, `y / (x + y)` gives y
    /// and x.
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

    /// Returns whether `is` returns true for the kind of some part, or of the formula itself.
    pub fn has(&self, is: &dyn Fn(&Kind) -> bool) -> bool {
        self.count(&|part| is(&part.kind)) > 0
    }

    /// Replaces operands by formulas. `replacement` returns `None` for an operand that stays. All parts keep their locations.
    pub fn with_operands(&self, replacement: &dyn Fn(&str) -> Option<Arc<Self>>) -> Self {
        let replaced = |part: &Self| match &part.kind {
            Kind::Operand(name) => replacement(name),
            _ => None,
        };
        let span = |part: &Self| part.span.clone();
        Arc::unwrap_or_clone(Rewriting::new(&replaced, &span).of(self))
    }

    /// Moves all parts to the text with the number `text`, at the same ranges of bytes.
    pub fn in_text(&self, text: usize) -> Self {
        let span = |part: &Self| TextSpan { text, bytes: part.span.bytes.clone() };
        Arc::unwrap_or_clone(Rewriting::new(&|_| None, &span).of(self))
    }

    /// Replaces every part that equals `old` by `new`. All other parts get the location `call`.
    pub fn substitute(&self, old: &Self, new: &Self, call: &TextSpan) -> Self {
        let new = Arc::new(new.clone());
        let replaced = |part: &Self| (part == old).then(|| new.clone());
        let span = |_: &Self| call.clone();
        Arc::unwrap_or_clone(Rewriting::new(&replaced, &span).of(self))
    }
}

/// Replaces parts of a formula. A part that several operations share stays shared.
struct Rewriting<'r> {
    /// Returns the formula that replaces a part, or `None` if only the parts of the part are rewritten.
    replaced: &'r dyn Fn(&Expression) -> Option<Arc<Expression>>,
    /// Returns the location of a part that is not replaced.
    span: &'r dyn Fn(&Expression) -> TextSpan,
    known: HashMap<*const Expression, Arc<Expression>>,
}

impl<'r> Rewriting<'r> {
    fn new(
        replaced: &'r dyn Fn(&Expression) -> Option<Arc<Expression>>,
        span: &'r dyn Fn(&Expression) -> TextSpan,
    ) -> Self {
        Self { replaced, span, known: HashMap::new() }
    }

    fn of(&mut self, part: &Expression) -> Arc<Expression> {
        let place = ptr::from_ref(part);
        if let Some(known) = self.known.get(&place) {
            return known.clone();
        }
        let rewritten = match (self.replaced)(part) {
            Some(replacement) => replacement,
            None => {
                let kind = part.kind.with_parts(&mut |part| self.of(part));
                Arc::new(Expression::new(kind, (self.span)(part)))
            }
        };
        self.known.insert(place, rewritten.clone());
        rewritten
    }
}

impl Kind {
    /// Adds the root's kind to a hash, without the formulas below it.
    fn hash_root(&self, hasher: &mut DefaultHasher) {
        mem::discriminant(self).hash(hasher);
        match self {
            Self::Number(literal) => literal.nearest().to_bits().hash(hasher),
            Self::Constant(name, _) => name.hash(hasher),
            Self::Operand(name) | Self::Word(name, _) => name.hash(hasher),
            Self::Unary(function, _) => function.hash(hasher),
            Self::Binary(operator, ..) => operator.hash(hasher),
            Self::If(comparison, ..) => comparison.or_equal.hash(hasher),
        }
    }

    /// Returns the kind with each direct part replaced by the result of `new`.
    fn with_parts(&self, new: &mut dyn FnMut(&Expression) -> Arc<Expression>) -> Self {
        match self {
            Self::Word(rom, at) => Self::Word(rom.clone(), new(at)),
            Self::Unary(function, a) => Self::Unary(*function, new(a)),
            Self::Binary(operator, a, b) => {
                let first = new(a);
                Self::Binary(*operator, first, new(b))
            }
            Self::If(it, a, b) => {
                let (left, right) = (new(&it.left), new(&it.right));
                let yes = new(a);
                Self::If(Comparison { left, right, or_equal: it.or_equal }, yes, new(b))
            }
            leaf => leaf.clone(),
        }
    }
}

#[cfg(test)]
mod tests;

//! Parses a formula's text, such as `1 / sqrt(x)`, to a tree.

use std::ops::Range;
use std::sync::Arc;

use super::condition::JoinedCondition;
use super::functions::{
    FUNCTIONS, FUNCTIONS_OF_MANY, FUNCTIONS_OF_TWO, arguments_of, definition_of, named,
    unknown_function,
};
use super::list::{self, NumberList, NumberOrList};
use super::{Comparison, Expression, Fault, Function, Kind, Literal, Operator, TextSpan};

/// The constants, each with the largest `f64` that is not above it.
const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), (EULER, std::f64::consts::E)];

/// The name of the base of the natural logarithm. An operand may also have this name, because controllers often call their error
/// `e`.
pub const EULER: &str = "e";

const SIGNS_OF_COMPARISONS: [&str; 6] = ["<", ">", "<=", ">=", "==", "!="];

const PI: &str = "π";

/// The largest depth of nested parts, because the parser recurses for each level.
const DEEPEST: usize = 200;

/// The largest number of comparisons and of joining signs in a formula, because each can be a level of the tree.
const MOST_CONDITIONS: usize = 400;

/// The largest number of parts of a formula after functions are replaced. For example, `silu(x)` has 6 parts more than x and
/// contains x twice.
const MOST_PARTS: usize = 4096;

/// Parses a formula with sums, products, powers (`^` or `**`), parentheses, numbers, `pi`, `e`, names of operands, functions, and
/// `if(a < b, x, y)`. A choice may also have the notation of Python or C: `x if a < b else y` or `a < b ? x : y`.
///
/// # Errors
///
/// Fails at the first mistake, with its location. Also fails for a list of numbers.
pub fn parse(text: &str) -> Result<Expression, Fault> {
    let formula = parse_with_lists(text, &|_| None)?.number()?;
    Ok(Arc::unwrap_or_clone(formula))
}

/// Parses a formula whose operands and parts can be lists. `lists` returns the list with a given name, or `None` for a number's
/// name. `lists` may return a number for a name that is otherwise a constant. An operator on lists gives a list. For example,
/// `2 * v` is `[2 * v_0, 2 * v_1]`.
///
/// # Errors
///
/// Fails at the first mistake, with its location.
pub fn parse_with_lists(text: &str, lists: NamedLists<'_>) -> Result<NumberOrList, Fault> {
    let mut parser = Parser::new(text, lists)?;
    let formula = parser.choice()?;
    match parser.tokens.get(parser.at) {
        None => Ok(formula),
        Some(rest) => {
            let begins = |c: char| c.is_ascii_alphanumeric() || matches!(c, '(' | '_');
            let rest_of_text = &text[rest.clone()];
            let remedy = if rest_of_text.starts_with(begins) {
                ": write the sign of a product, as in `2*x`"
            } else if rest_of_text.starts_with(['.', '[']) {
                ": it is a number of a list, and only an operand with `axes` or `size` is a list"
            } else {
                ""
            };
            Err(Fault::new(rest.clone(), format!("this does not belong here{remedy}")))
        }
    }
}

/// Parses a condition, such as `x < y`, `0 < x <= 2`, or `x > 0 and y != 0`, into a single equivalent comparison. Fails at the
/// first mistake, with its location.
pub fn parse_condition(text: &str) -> Result<Comparison, Fault> {
    parse_condition_with_lists(text, &|_| None)
}

/// Parses a condition into a comparison. `lists` returns the lists by their names, see [`parse_with_lists`]. The condition must
/// compare numbers, such as `dot(a, b) > 0`. Fails at the first mistake, with its location.
pub fn parse_condition_with_lists(text: &str, lists: NamedLists<'_>) -> Result<Comparison, Fault> {
    let mut parser = Parser::new(text, lists)?;
    let condition = parser.condition()?;
    match parser.tokens.get(parser.at) {
        None => Ok(condition.comparison()),
        Some(rest) => Err(Fault::new(rest.clone(), "this does not belong here")),
    }
}

/// A function from a name to its list. It may return a number for a name that is otherwise a constant, such as `e`.
pub type NamedLists<'t> = &'t dyn Fn(&str) -> Option<NumberOrList>;

/// Returns the ranges of bytes of all names, numbers and signs. For example, `2*x` gives 0..1, 1..2 and 2..3. Fails at a
/// character that no formula can have.
fn tokens(text: &str) -> Result<Vec<Range<usize>>, Fault> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let run =
            |belongs: &dyn Fn(char) -> bool| rest.find(|c: char| !belongs(c)).unwrap_or(rest.len());
        let length = match first {
            'a'..='z' | 'A'..='Z' | '_' => run(&|c| c.is_ascii_alphanumeric() || c == '_'),
            '0'..='9' | '.' => number(rest),
            _ if ["**", "<=", ">=", "==", "!=", "&&", "||"]
                .iter()
                .any(|two| rest.starts_with(two)) =>
            {
                2
            }
            '+' | '-' | '*' | '/' | '%' | '^' | '(' | ')' | '[' | ']' | ',' | '<' | '>' | '?'
            | ':' | '!' => 1,
            '−' | '·' | '×' | 'π' => first.len_utf8(),
            _ if first.is_ascii_whitespace() => {
                at += first.len_utf8();
                continue;
            }
            _ => {
                let remedy =
                    instead_of_sign(first).map_or(String::new(), |text| format!(": {text}"));
                let message = format!("`{first}` cannot be a part of a formula{remedy}");
                return Err(Fault::new(at..at + first.len_utf8(), message));
            }
        };
        tokens.push(at..at + length);
        at += length;
    }
    Ok(tokens)
}

/// Returns advice about the notation that replaces `sign`, or `None` for a sign without advice.
fn instead_of_sign(sign: char) -> Option<&'static str> {
    Some(match sign {
        '=' => "compare with `<`, `>`, `<=`, `>=`, `==` or `!=`",
        '&' => "two conditions are joined by `and` or `&&`",
        '²' => "a square is written `x^2`",
        '³' => "a cube is written `x^3`",
        '⁰' | '¹' | '⁴'..='⁹' | '⁻' | 'ⁿ' => "a power is written `x^4`",
        '√' => "a root is written `sqrt(x)`",
        '∛' => "a cube root is written `cbrt(x)`",
        '÷' | '∕' | '⁄' => "a quotient is written `a / b`",
        '∗' | '⋅' | '∙' => "a product is written `a * b`",
        '|' => {
            "an absolute value is written `abs(x)`; one of two conditions is written with `or` or `||`"
        }
        '≤' => "write `<=`",
        '≥' => "write `>=`",
        '–' | '—' | '‐' | '‑' => "a minus sign is written `-`",
        '½' => "write `1/2`",
        '¼' => "write `1/4`",
        '∞' => "a formula has only finite numbers",
        _ => return None,
    })
}

/// Returns the length in bytes of the number at the beginning of `text`: digits with a point, and a power of ten. For example,
/// `1.5e3*x` gives 5.
fn number(text: &str) -> usize {
    let digits = |from: usize, also: char| {
        let rest = &text[from..];
        from + rest.find(|c: char| !c.is_ascii_digit() && c != also).unwrap_or(rest.len())
    };
    let end = digits(0, '.');
    if !text[end..].starts_with(['e', 'E']) {
        return end;
    }
    let sign = match text[end + 1..].chars().next() {
        Some(sign @ ('+' | '-' | '−')) => sign.len_utf8(),
        _ => 0,
    };
    let power = digits(end + 1 + sign, '0');
    // If the constant e directly follows a number, the parser reports the mistake.
    if power > end + 1 + sign { power } else { end }
}

/// Returns the number 0.
fn zero() -> Expression {
    Expression::new(Kind::Number(Literal::zero()), 0..0)
}

/// Returns whether a formula is the number 0 as a text states it.
fn is_zero(number: &Expression) -> bool {
    matches!(&number.kind, Kind::Number(literal) if literal.is_exact() && literal.nearest() == 0.0)
}

/// Returns the square of the distance between two lists, or between a list and a number that stands for each of its numbers. The square
/// is exact for operands, unlike the distance. Fails for lists of different sizes.
fn square_of_distance(
    first: &NumberOrList,
    second: &NumberOrList,
) -> Result<Arc<Expression>, Fault> {
    let place = |list: &NumberOrList| list.elements()[0].span.bytes.clone();
    let span = place(first).start..place(second).end;
    let differences = list::for_each_element(&[first.clone(), second.clone()], &span, |pair| {
        let [a, b] = [0, 1].map(|at| Arc::new(pair[at].clone()));
        Ok(match is_zero(&b) {
            true => Arc::unwrap_or_clone(a),
            false => Expression::new(Kind::Binary(Operator::Sub, a, b), span.clone()),
        })
    })?;
    list::list_function("dot", &[differences.clone(), differences], span)?.number()
}

fn ends_number(token: &str) -> bool {
    let last = token.chars().last();
    last.is_some_and(|last| last.is_alphanumeric() || matches!(last, '_' | ')' | ']' | '.'))
}

struct Parser<'t> {
    text: &'t str,
    tokens: Vec<Range<usize>>,
    at: usize,
    depth: usize,
    conditions: usize,
    lists: NamedLists<'t>,
}

impl<'t> Parser<'t> {
    fn new(text: &'t str, lists: NamedLists<'t>) -> Result<Self, Fault> {
        Ok(Self { text, tokens: tokens(text)?, at: 0, depth: 0, conditions: 0, lists })
    }

    /// Returns the text of the next token, or an empty text at the end.
    fn peek(&self) -> &str {
        self.tokens.get(self.at).map_or("", |token| &self.text[token.clone()])
    }

    fn taken(&mut self, tokens: &[&str]) -> bool {
        let taken = tokens.contains(&self.peek());
        self.at += usize::from(taken);
        taken
    }

    fn here(&self) -> Range<usize> {
        self.tokens.get(self.at).cloned().unwrap_or(self.text.len()..self.text.len())
    }

    fn fault<T>(&self, message: impl Into<String>) -> Result<T, Fault> {
        Err(Fault::new(self.here(), message))
    }

    fn expect(&mut self, token: &str) -> Result<(), Fault> {
        if self.taken(&[token]) { Ok(()) } else { self.fault(format!("`{token}` is missing")) }
    }

    /// Makes a part from the tokens from number `from` to the last read token.
    fn made(&self, from: usize, kind: Kind) -> Expression {
        Expression::new(kind, self.span(from))
    }

    /// Returns the range of bytes of the tokens from number `from` to the last read token.
    fn span(&self, from: usize) -> Range<usize> {
        self.tokens[from].start..self.tokens[self.at - 1].end
    }

    fn choice(&mut self) -> Result<NumberOrList, Fault> {
        if self.depth == DEEPEST {
            return self.fault(format!("the formula is nested more than {DEEPEST} deep"));
        }
        self.depth += 1;
        let from = self.at;
        let mut choice = if self.begins_condition() {
            // As in C: `(a < b) && (c < d) ? x : y`.
            let condition = self.condition()?;
            self.cases_in_c(from, &condition)?
        } else {
            self.sum()?
        };
        if SIGNS_OF_COMPARISONS.contains(&self.peek()) {
            // As in C: `a < b ? x : y`.
            let condition = self.condition_of(choice)?;
            choice = self.cases_in_c(from, &condition)?;
        } else if self.taken(&["if"]) {
            let condition = self.condition()?;
            self.expect("else")?;
            let other = self.choice()?;
            choice = self.chosen(from, &condition, choice, other)?;
        }
        self.depth -= 1;
        Ok(choice)
    }

    /// Parses `? x : y` after a condition that begins at token number `from`.
    fn cases_in_c(
        &mut self,
        from: usize,
        condition: &JoinedCondition,
    ) -> Result<NumberOrList, Fault> {
        self.expect("?")?;
        let yes = self.choice()?;
        self.expect(":")?;
        let no = self.choice()?;
        self.chosen(from, condition, yes, no)
    }

    /// Makes a choice between the cases `yes` and `no`. The choice begins at token number `from`. Fails if the cases are lists of
    /// different sizes.
    fn chosen(
        &self,
        from: usize,
        condition: &JoinedCondition,
        yes: NumberOrList,
        no: NumberOrList,
    ) -> Result<NumberOrList, Fault> {
        let span = self.span(from);
        list::for_each_element(&[yes, no], &span, |cases| {
            let [yes, no] = [0, 1].map(|case| Arc::new(cases[case].clone()));
            Ok(condition.choice(yes, no, span.clone()))
        })
    }

    fn condition(&mut self) -> Result<JoinedCondition, Fault> {
        if self.depth == DEEPEST {
            return self.fault(format!("the formula is nested more than {DEEPEST} deep"));
        }
        self.depth += 1;
        let first = self.single_condition()?;
        let condition = self.joined(first);
        self.depth -= 1;
        condition
    }

    fn condition_of(&mut self, first: NumberOrList) -> Result<JoinedCondition, Fault> {
        let comparison = self.comparisons(first)?;
        self.joined(comparison)
    }

    /// Parses the conditions that `and` and `or` join to `first`. `and` binds closer.
    fn joined(&mut self, first: JoinedCondition) -> Result<JoinedCondition, Fault> {
        let mut either = self.all_of(first)?;
        while self.taken(&["or", "||"]) {
            self.count_joined()?;
            let next = self.single_condition()?;
            either = JoinedCondition::Either(Box::new(either), Box::new(self.all_of(next)?));
        }
        Ok(either)
    }

    fn all_of(&mut self, first: JoinedCondition) -> Result<JoinedCondition, Fault> {
        let mut both = first;
        while self.taken(&["and", "&&"]) {
            self.count_joined()?;
            both = JoinedCondition::Both(Box::new(both), Box::new(self.single_condition()?));
        }
        Ok(both)
    }

    /// Counts a comparison or a joining sign. Fails if there are more than [`MOST_CONDITIONS`].
    fn count_joined(&mut self) -> Result<(), Fault> {
        self.conditions += 1;
        if self.conditions > MOST_CONDITIONS {
            return self.fault(format!("the formula has more than {MOST_CONDITIONS} conditions"));
        }
        Ok(())
    }

    /// Parses a condition without `and` or `or` at its top level.
    fn single_condition(&mut self) -> Result<JoinedCondition, Fault> {
        let mut negations = 0;
        while self.taken(&["not", "!"]) {
            negations += 1;
        }
        let condition = self.condition_without_sign()?;
        Ok(if negations % 2 == 1 { condition.negated() } else { condition })
    }

    fn condition_without_sign(&mut self) -> Result<JoinedCondition, Fault> {
        if self.begins_condition() {
            self.expect("(")?;
            let inner = self.condition()?;
            self.expect(")")?;
            return Ok(inner);
        }
        let first = self.sum()?;
        self.comparisons(first)
    }

    /// Returns whether the next tokens are a condition in parentheses. Such parentheses have a comparison directly inside, which
    /// is not a choice's condition.
    fn begins_condition(&self) -> bool {
        if self.peek() != "(" {
            return false;
        }
        let mut depth = 0;
        let mut has_comparison = false;
        let mut before = "";
        for token in &self.tokens[self.at..] {
            let token = &self.text[token.clone()];
            match token {
                "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                "?" if depth == 1 => return false,
                // The choice of Python follows a number; the function `if` follows a sign.
                "if" if depth == 1 && ends_number(before) => return false,
                "and" | "&&" | "or" | "||" | "not" | "!" => has_comparison |= depth == 1,
                sign => has_comparison |= depth == 1 && SIGNS_OF_COMPARISONS.contains(&sign),
            }
            if depth == 0 {
                break;
            }
            before = token;
        }
        has_comparison
    }

    /// Parses the comparisons that follow a number or a list, for example `< x <= 2`.
    fn comparisons(&mut self, first: NumberOrList) -> Result<JoinedCondition, Fault> {
        let mut first = first;
        let mut all: Option<JoinedCondition> = None;
        loop {
            let sign = self.peek().to_owned();
            if !self.taken(&SIGNS_OF_COMPARISONS) {
                let missing = "a comparison sign is missing: `<`, `>`, `<=`, `>=`, `==` or `!=`";
                return all.map_or_else(|| self.fault(missing), Ok);
            }
            self.count_joined()?;
            let second = self.sum()?;
            let comparison = JoinedCondition::Is(self.compared(first, &sign, second.clone())?);
            all = Some(match all {
                None => comparison,
                Some(before) => JoinedCondition::Both(Box::new(before), Box::new(comparison)),
            });
            first = second;
        }
    }

    /// Returns a comparison by `sign`. Lists are equal if all their numbers are, and a list equals a number if all its numbers do. Fails
    /// for lists of different sizes, and for lists with another sign than `==` and `!=`.
    fn compared(
        &self,
        first: NumberOrList,
        sign: &str,
        second: NumberOrList,
    ) -> Result<Comparison, Fault> {
        let is_equality = sign == "==" || sign == "!=";
        let has_list = [&first, &second].iter().any(|it| matches!(it, NumberOrList::List(_)));
        if is_equality && has_list {
            let distance = square_of_distance(&first, &second)?;
            return Ok(self.equality(distance, Arc::new(zero()), sign == "=="));
        }
        let (first, second) = (first.number()?, second.number()?);
        if is_equality {
            return Ok(self.equality(first, second, sign == "=="));
        }
        let (left, right) = if sign.starts_with('>') { (first, second) } else { (second, first) };
        Ok(Comparison { left, right, or_equal: sign.len() == 2 })
    }

    /// Returns whether two numbers are equal (`is_equal`) or differ, as a comparison of their distance with 0.
    fn equality(
        &self,
        first: Arc<Expression>,
        second: Arc<Expression>,
        is_equal: bool,
    ) -> Comparison {
        let span =
            TextSpan { bytes: first.span.bytes.start..second.span.bytes.end, ..first.span.clone() };
        let part = |kind: Kind| Arc::new(Expression::new(kind, span.clone()));
        let difference = match is_zero(&second) {
            true => first,
            false => part(Kind::Binary(Operator::Sub, first, second)),
        };
        let distance = match &difference.kind {
            // A root or an absolute value is not below 0.
            Kind::Unary(Function::Sqrt | Function::Abs, _) => difference,
            _ => part(Kind::Unary(Function::Abs, difference)),
        };
        let zero = part(zero().kind);
        match is_equal {
            true => Comparison { left: zero, right: distance, or_equal: true },
            false => Comparison { left: distance, right: zero, or_equal: false },
        }
    }

    /// Parses operators of the same precedence, which are applied from left to right. `part` parses an operand.
    fn chain(
        &mut self,
        signs: &[(&str, Operator)],
        part: fn(&mut Self) -> Result<NumberOrList, Fault>,
    ) -> Result<NumberOrList, Fault> {
        let from = self.at;
        let mut all = part(self)?;
        while let Some((_, operator)) = signs.iter().find(|(sign, _)| *sign == self.peek()) {
            self.at += 1;
            let next = part(self)?;
            all = self.joined_by(from, *operator, all, next)?;
        }
        Ok(all)
    }

    /// Applies `operator` to two numbers, or to each pair of elements. The result's text begins at token number `from`. Fails for
    /// lists of different sizes.
    fn joined_by(
        &self,
        from: usize,
        operator: Operator,
        a: NumberOrList,
        b: NumberOrList,
    ) -> Result<NumberOrList, Fault> {
        let span = self.span(from);
        list::for_each_element(&[a, b], &span, |pair| {
            let [a, b] = [0, 1].map(|at| Arc::new(pair[at].clone()));
            Ok(Expression::new(Kind::Binary(operator, a, b), span.clone()))
        })
    }

    fn sum(&mut self) -> Result<NumberOrList, Fault> {
        let signs = [("+", Operator::Add), ("-", Operator::Sub), ("−", Operator::Sub)];
        self.chain(&signs, Self::product)
    }

    fn product(&mut self) -> Result<NumberOrList, Fault> {
        use Operator::{Div, Mod, Mul};
        let signs = [("*", Mul), ("·", Mul), ("×", Mul), ("/", Div), ("%", Mod)];
        self.chain(&signs, Self::signed)
    }

    /// Parses a power with signs before it, which are applied after the power. For example, `-x^2` is −(x²).
    fn signed(&mut self) -> Result<NumberOrList, Fault> {
        let from = self.at;
        let mut negations = 0;
        loop {
            if self.taken(&["-", "−"]) {
                negations += 1;
            } else if !self.taken(&["+"]) {
                break;
            }
        }
        let base = self.at;
        let mut part = self.element()?;
        if self.taken(&["^", "**"]) {
            if self.depth == DEEPEST {
                return self.fault(format!("the formula is nested more than {DEEPEST} deep"));
            }
            self.depth += 1;
            let exponent = self.signed()?;
            self.depth -= 1;
            part = self.joined_by(base, Operator::Power, part, exponent)?;
        }
        if negations % 2 == 1 {
            let span = self.span(from);
            part = list::for_each_element(&[part], &span, |numbers| {
                let number = Arc::new(numbers[0].clone());
                Ok(Expression::new(Kind::Unary(Function::Negate, number), span.clone()))
            })?;
        }
        Ok(part)
    }

    /// Parses a number or a list with an optional index or axes, as in `v[2]` and `n.xy`.
    fn element(&mut self) -> Result<NumberOrList, Fault> {
        let from = self.at;
        let mut part = self.atom()?;
        while let NumberOrList::List(list) = &part {
            if self.taken(&["["]) {
                if self.peek() == "]" {
                    return self
                        .fault("the place of a number is missing before this: the first is `[0]`");
                }
                let index = self.choice()?.number()?;
                self.expect("]")?;
                part = list.element(&index)?.at(self.span(from)).into();
            } else if self.taken(&["."]) {
                let letters = self.peek().to_owned();
                self.at = (self.at + 1).min(self.tokens.len());
                part = list.on_axes(&letters, self.span(from))?;
            } else {
                break;
            }
        }
        Ok(part)
    }

    fn atom(&mut self) -> Result<NumberOrList, Fault> {
        let from = self.at;
        let token = self.peek().to_owned();
        if token.is_empty() {
            return self.fault("a number, an operand or a function is missing");
        }
        if self.taken(&["("]) {
            let inner = self.choice()?;
            self.expect(")")?;
            return Ok(inner);
        }
        if self.taken(&["["]) {
            let mut parts = vec![self.choice()?];
            while self.taken(&[","]) {
                parts.push(self.choice()?);
            }
            self.expect("]")?;
            return list::list_of(parts, self.span(from));
        }
        if token.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            let Some(literal) = Literal::read(&token) else {
                return self.fault("this is not a number");
            };
            self.at += 1;
            return Ok(self.made(from, Kind::Number(literal)).into());
        }
        if self.taken(&[PI]) {
            return Ok(self.made(from, Kind::Constant(CONSTANTS[0].0, CONSTANTS[0].1)).into());
        }
        if !token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
            return self.fault("a number, an operand or a function is missing before this");
        }
        self.at += 1;
        if self.peek() != "("
            && let Some(named) = (self.lists)(&token)
        {
            let span = self.span(from);
            return Ok(match named {
                NumberOrList::List(list) => {
                    NumberOrList::List(NumberList { span: span.into(), ..list })
                }
                NumberOrList::Number(number) => Expression::new(number.kind.clone(), span).into(),
            });
        }
        if self.taken(&["["]) {
            // A word's index is an integer. In Python, `int` makes it one.
            self.taken(&["int"]);
            let place = self.choice()?.number()?;
            self.expect("]")?;
            return Ok(self.made(from, Kind::Word(token, place)).into());
        }
        if !self.taken(&["("]) {
            let constant = CONSTANTS.iter().find(|(name, _)| *name == token);
            let kind = match constant {
                Some((name, value)) => Kind::Constant(name, *value),
                None => Kind::Operand(token),
            };
            return Ok(self.made(from, kind).into());
        }
        self.call(from, &token)
    }

    /// Parses the arguments of a call of the function `name`, after the opening parenthesis. Fails if there is no such function,
    /// or at the first mistake in an argument.
    fn call(&mut self, from: usize, name: &str) -> Result<NumberOrList, Fault> {
        if name == "if" {
            let condition = self.condition()?;
            self.expect(",")?;
            let yes = self.choice()?;
            self.expect(",")?;
            let no = self.choice()?;
            self.expect(")")?;
            return self.chosen(from, &condition, yes, no);
        }
        let of_lists = list::arguments_of(name);
        let Some(count) = of_lists.or_else(|| arguments_of(name)) else {
            return Err(Fault::new(self.tokens[from].clone(), unknown_function(name)));
        };
        let takes_many = FUNCTIONS_OF_MANY.contains(&name);
        let mut arguments = vec![self.choice()?];
        let is_of_one_list =
            takes_many && self.peek() == ")" && matches!(arguments[0], NumberOrList::List(_));
        while !is_of_one_list && (arguments.len() < count || takes_many && self.peek() == ",") {
            self.expect(",")?;
            arguments.push(self.choice()?);
        }
        self.expect(")")?;
        let span = self.span(from);
        if is_of_one_list || of_lists.is_some() {
            return list::list_function(name, &arguments, span);
        }
        list::for_each_element(&arguments, &span, |numbers| {
            function_of_numbers(name, numbers, span.clone())
        })
    }
}

/// Returns a call of a function of numbers. `span` is the call's location. Fails if the result has more than [`MOST_PARTS`]
/// parts.
fn function_of_numbers(
    name: &str,
    arguments: &[Expression],
    span: Range<usize>,
) -> Result<Expression, Fault> {
    if name == "hypot" && arguments.len() > 2 {
        return length_of_many(arguments, span);
    }
    if let Some((_, body)) = definition_of(name) {
        return written_out(name, body, arguments, span);
    }
    let mut arguments = arguments.iter().cloned().map(Arc::new);
    let first = arguments.next().expect("a call has an argument");
    if let Some(function) = named(&FUNCTIONS, name) {
        return Ok(Expression::new(Kind::Unary(function, first), span));
    }
    let operator = named(&FUNCTIONS_OF_TWO, name).expect("a function of one number or of two");
    let mut all = first;
    for argument in arguments {
        all = Arc::new(Expression::new(Kind::Binary(operator, all, argument), span.clone()));
    }
    Ok(Arc::unwrap_or_clone(all))
}

/// Returns the root of the sum of the squares of a vector's coordinates. `span` is the call's location.
fn length_of_many(arguments: &[Expression], span: Range<usize>) -> Result<Expression, Fault> {
    let mut sum = written_out("hypot", "u^2", &arguments[..1], span.clone())?;
    for argument in &arguments[1..] {
        let square = written_out("hypot", "u^2", std::slice::from_ref(argument), span.clone())?;
        let kind = Kind::Binary(Operator::Add, Arc::new(sum), Arc::new(square));
        sum = Expression::new(kind, span.clone());
    }
    Ok(Expression::new(Kind::Unary(Function::Sqrt, Arc::new(sum)), span))
}

/// Returns the formula `body` of the function `name`, with the arguments of a call in place of u, v and w. For example, `hypot(a,
/// 2)` becomes `sqrt(a^2 + 2^2)`. `span` is the call's location. Fails if the result has more than [`MOST_PARTS`] parts.
fn written_out(
    name: &str,
    body: &str,
    arguments: &[Expression],
    span: Range<usize>,
) -> Result<Expression, Fault> {
    let mut formula = parse(body)?;
    let span = TextSpan::from(span);
    let mut parts = formula.size() as usize;
    let parameters = ["u", "v", "w"].map(Expression::operand);
    let mut most_uses = 0;
    for (parameter, argument) in parameters.iter().zip(arguments) {
        let uses = formula.count(&|part| part == parameter);
        parts += uses * argument.size() as usize;
        most_uses = most_uses.max(uses);
    }
    if parts > MOST_PARTS {
        let message = format!(
            "`{name}` expands to more than {MOST_PARTS} parts of a formula, because it uses its operand \
             {most_uses} times"
        );
        return Err(Fault::new(span, message));
    }
    // An argument may itself contain an operand u, v or w. Temporary names that no text can contain keep these apart from the
    // parameters.
    let marks = ["(u)", "(v)", "(w)"].map(Expression::operand);
    for (parameter, mark) in parameters.iter().zip(&marks) {
        formula = formula.substitute(parameter, mark, &span);
    }
    for (mark, argument) in marks.iter().zip(arguments) {
        formula = formula.substitute(mark, argument, &span);
    }
    Ok(formula)
}

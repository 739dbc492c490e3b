//! A contract's formula as a tree: the expressions that the Python benches evaluate, parsed.

use std::sync::LazyLock;

use anyhow::{Result, anyhow, bail};
use regex::Regex;

/// A real number.
#[derive(Clone, Debug, PartialEq)]
pub enum Real {
    /// A constant.
    Number(f64),
    /// An operand, as a value and not raw.
    Operand(String),
    /// A word of a ROM, as a value, by the name of the ROM and the operand that numbers it.
    Word(String, Box<Real>),
    /// The sum.
    Add(Box<Real>, Box<Real>),
    /// The difference.
    Sub(Box<Real>, Box<Real>),
    /// The product.
    Mul(Box<Real>, Box<Real>),
    /// The quotient.
    Div(Box<Real>, Box<Real>),
    /// The remainder of the first modulo the second, between 0 and the second.
    Mod(Box<Real>, Box<Real>),
    /// The first to the power of the second.
    Power(Box<Real>, Box<Real>),
    /// Without its sign.
    Abs(Box<Real>),
    /// The cosine of an angle in radians.
    Cos(Box<Real>),
    /// The larger of the two.
    Max(Box<Real>, Box<Real>),
    /// The first where the comparison holds, else the second.
    If(Comparison, Box<Real>, Box<Real>),
}

/// Whether one number exceeds another.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The number.
    pub left: Box<Real>,
    /// The other.
    pub right: Box<Real>,
    /// Whether equal ones count.
    pub or_equal: bool,
}

impl Real {
    /// The numbers that it is made of.
    pub fn parts(&self) -> Vec<&Self> {
        match self {
            Self::Number(_) | Self::Operand(_) => Vec::new(),
            Self::Word(_, a) | Self::Abs(a) | Self::Cos(a) => vec![a],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Div(a, b)
            | Self::Mod(a, b)
            | Self::Max(a, b)
            | Self::Power(a, b) => vec![a, b],
            Self::If(Comparison { left, right, .. }, a, b) => vec![left, right, a, b],
        }
    }

    /// Whether words of the table are read.
    pub fn reads(&self, rom: &str) -> bool {
        matches!(self, Self::Word(name, _) if name == rom)
            || self.parts().into_iter().any(|part| part.reads(rom))
    }

    /// Whether the operand is an exponent.
    pub fn has_exponent(&self, name: &str) -> bool {
        matches!(self, Self::Power(_, exponent) if **exponent == Self::Operand(name.to_owned()))
            || self.parts().into_iter().any(|part| part.has_exponent(name))
    }
}

/// The expression as a tree.
///
/// # Errors
/// The text is no expression, or has a function that is none of `max`, `min`, `int`, `abs` and `cos`.
pub fn parse(text: &str) -> Result<Real> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0 };
    let real = parser.choice()?;
    match parser.next() {
        None => Ok(real),
        Some(rest) => bail!("`{rest}` does not belong into `{text}`"),
    }
}

static TOKEN: LazyLock<Result<Regex, regex::Error>> = LazyLock::new(|| {
    Regex::new(
        r"\s*([A-Za-z_][A-Za-z_0-9]*|[0-9]+\.?[0-9]*(?:e[-+]?[0-9]+)?|\*\*|>=|<=|[-+*/%()\[\],<>])",
    )
});

fn tokens(text: &str) -> Result<Vec<String>> {
    let pattern = TOKEN.as_ref().map_err(|error| anyhow!("{error}"))?;
    let mut tokens = Vec::new();
    let mut rest = text.trim_end();
    while !rest.is_empty() {
        let found =
            pattern.captures(rest).filter(|found| found.get(0).is_some_and(|it| it.start() == 0));
        let Some(found) = found else {
            let (rest, short) =
                (rest.trim_start(), |text: &str| match text.char_indices().nth(40) {
                    Some((at, _)) => format!("{} …", &text[..at]),
                    None => text.to_owned(),
                });
            bail!("`{}` in `{}` is not understood", short(rest), short(text))
        };
        tokens.push(found[1].to_owned());
        rest = &rest[found[0].len()..];
    }
    Ok(tokens)
}

struct Parser {
    tokens: Vec<String>,
    at: usize,
}

impl Parser {
    fn peek(&self) -> &str {
        self.tokens.get(self.at).map_or("", String::as_str)
    }

    fn next(&mut self) -> Option<String> {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        token
    }

    fn taken(&mut self, token: &str) -> bool {
        let taken = self.peek() == token;
        self.at += usize::from(taken);
        taken
    }

    fn expect(&mut self, token: &str) -> Result<()> {
        if !self.taken(token) {
            bail!("`{token}` is missing before `{}`", self.peek());
        }
        Ok(())
    }

    /// `sum`, or `sum if sum > sum else choice`.
    fn choice(&mut self) -> Result<Real> {
        let yes = self.sum()?;
        if !self.taken("if") {
            return Ok(yes);
        }
        let left = Box::new(self.sum()?);
        let or_equal = self.peek() == ">=";
        if !or_equal && self.peek() != ">" {
            bail!("`{}` is no comparison that is understood", self.peek());
        }
        self.at += 1;
        let right = Box::new(self.sum()?);
        self.expect("else")?;
        let no = self.choice()?;
        Ok(Real::If(Comparison { left, right, or_equal }, Box::new(yes), Box::new(no)))
    }

    fn sum(&mut self) -> Result<Real> {
        let mut sum = self.product()?;
        loop {
            let plus = self.taken("+");
            if !plus && !self.taken("-") {
                return Ok(sum);
            }
            let (left, right) = (Box::new(sum), Box::new(self.product()?));
            sum = if plus { Real::Add(left, right) } else { Real::Sub(left, right) };
        }
    }

    fn product(&mut self) -> Result<Real> {
        let mut product = self.power()?;
        loop {
            let operation = match self.peek() {
                "*" => Real::Mul,
                "/" => Real::Div,
                "%" => Real::Mod,
                _ => return Ok(product),
            };
            self.at += 1;
            product = operation(Box::new(product), Box::new(self.power()?));
        }
    }

    fn power(&mut self) -> Result<Real> {
        let base = self.atom()?;
        if !self.taken("**") {
            return Ok(base);
        }
        Ok(Real::Power(Box::new(base), Box::new(self.power()?)))
    }

    fn atom(&mut self) -> Result<Real> {
        let Some(token) = self.next() else { bail!("the expression ends too early") };
        if token == "(" {
            let inner = self.choice()?;
            self.expect(")")?;
            return Ok(inner);
        }
        if token == "-" {
            return Ok(Real::Sub(Box::new(Real::Number(0.0)), Box::new(self.power()?)));
        }
        if let Ok(number) = token.parse() {
            return Ok(Real::Number(number));
        }
        if !token.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') {
            bail!("`{token}` stands where a number is expected");
        }
        if self.taken("[") {
            let place = self.choice()?;
            self.expect("]")?;
            return Ok(Real::Word(token, Box::new(place)));
        }
        if !self.taken("(") {
            return Ok(Real::Operand(token));
        }
        let first = self.choice()?;
        let real = match token.as_str() {
            // Of an operand that is an integer.
            "int" => first,
            "abs" => Real::Abs(Box::new(first)),
            "cos" => Real::Cos(Box::new(first)),
            "max" => {
                self.expect(",")?;
                Real::Max(Box::new(first), Box::new(self.choice()?))
            }
            "min" => {
                self.expect(",")?;
                let (left, right) = (Box::new(first.clone()), Box::new(self.choice()?));
                let comparison = Comparison { left, right: right.clone(), or_equal: false };
                Real::If(comparison, right, Box::new(first))
            }
            other => bail!("the function `{other}` has no translation"),
        };
        self.expect(")")?;
        Ok(real)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> Box<Real> {
        Box::new(Real::Number(value))
    }

    fn operand(name: &str) -> Box<Real> {
        Box::new(Real::Operand(name.to_owned()))
    }

    #[test]
    fn operators_bind_as_in_python() {
        let product = Real::Mul(number(2.0), Box::new(Real::Power(operand("x"), number(3.0))));
        assert_eq!(parse("1 - 2 * x ** 3").unwrap(), Real::Sub(number(1.0), Box::new(product)));
        let left = Real::Sub(number(4.0), number(2.0));
        assert_eq!(parse("4 - 2 - 1").unwrap(), Real::Sub(Box::new(left), number(1.0)));
        let choice = parse("max(x, 0) if x > 0 else levels[int(n)]").unwrap();
        let comparison = Comparison { left: operand("x"), right: number(0.0), or_equal: false };
        let rest = Real::Mod(Box::new(Real::Abs(operand("x"))), number(2.0));
        assert_eq!(parse("cos(abs(x) % 2)").unwrap(), Real::Cos(Box::new(rest)));
        let yes = Box::new(Real::Max(operand("x"), number(0.0)));
        let no = Box::new(Real::Word("levels".to_owned(), operand("n")));
        assert_eq!(choice, Real::If(comparison, yes, no));
    }

    #[test]
    fn what_has_no_translation_is_named() {
        for (text, what) in [
            ("sqrt(x)", "the function `sqrt` has no translation"),
            ("x +", "the expression ends too early"),
            ("x $ y", "`$ y` in `x $ y` is not understood"),
            ("x y", "`y` does not belong into `x y`"),
            ("(x", "`)` is missing before ``"),
        ] {
            assert_eq!(parse(text).unwrap_err().to_string(), what);
        }
    }
}

//! Converts a formula in plain text to MathML.
//!
//! A device's description writes a formula in the syntax of programs, for example `out = colour * (n/2 * (c - 1) + 1)^2`. If the
//! parser does not understand a formula, `mathml` returns `None`, and the page shows plain text.

use super::markup::html;

/// Functions that may have an exponent after the name, such as `cos^2(x)`. Parentheses around a single name are not shown.
const FUNCTIONS: [&str; 4] = ["cos", "sin", "tan", "log"];

/// Words that may occur between formulas, which the page shows as text.
const PROSE: [&str; 10] =
    ["by", "where", "stretched", "if", "for", "with", "when", "and", "or", "otherwise"];

const GREEK: [(&str, &str); 12] = [
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("zeta", "ζ"),
    ("eta", "η"),
    ("theta", "θ"),
    ("pi", "π"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("phi", "φ"),
    ("psi", "ψ"),
];

/// Returns a formula as `math` elements with commas or semicolons between them, at which a line may break. Returns `None` if the
/// parser does not understand the formula.
pub fn mathml(text: &str) -> Option<String> {
    let mut reader = FormulaReader { tokens: tokens(text)?, at: 0 };
    let mut clauses = String::new();
    loop {
        let clause = reader.clause()?;
        clauses += &format!("<math displaystyle=\"true\"><mrow>{clause}</mrow></math>");
        match reader.next() {
            None => return Some(clauses),
            Some(sign @ ("," | ";")) => clauses += &format!("<span>{sign} </span>"),
            Some(_) => return None,
        }
    }
}

/// Returns a formula as HTML: typeset if the parser understands it, otherwise the plain text as code.
pub fn typeset(text: &str) -> String {
    match mathml(text) {
        Some(formula) => format!("<div class=\"formula\">{formula}</div>"),
        None => format!("<pre class=\"formula\">{}</pre>", html(text)),
    }
}

/// Splits a formula into names, numbers and signs: `n/2 + 1` has the tokens `n`, `/`, `2`, `+` and `1`.
fn tokens(text: &str) -> Option<Vec<&str>> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let run = |belongs: fn(char) -> bool| {
            rest.find(|sign: char| !belongs(sign)).unwrap_or(rest.len())
        };
        let length = match first {
            'a'..='z' | 'A'..='Z' => run(|sign| sign.is_ascii_alphanumeric() || sign == '_'),
            '0'..='9' => run(|sign| sign.is_ascii_digit() || sign == '.'),
            _ if ["+-", "<=", ">="].iter().any(|two| rest.starts_with(two)) => 2,
            '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' | ';' | '=' | '<' | '>' => 1,
            _ => return None,
        };
        let (token, after) = rest.split_at(length);
        tokens.push(token);
        rest = after.trim_start();
    }
    Some(tokens)
}

/// The MathML of a part, and the MathML inside its parentheses if it has some.
struct FormulaPart {
    mathml: String,
    inside: Option<String>,
}

impl FormulaPart {
    fn new(mathml: String) -> Self {
        Self { mathml, inside: None }
    }

    /// Returns the MathML without the parentheses around it. A numerator, a denominator, an exponent and the operand of a root
    /// need no parentheses. For example, `(a + b) / 2` becomes a fraction with a + b above the line.
    fn bare(self) -> String {
        format!("<mrow>{}</mrow>", self.inside.unwrap_or(self.mathml))
    }
}

struct FormulaReader<'a> {
    tokens: Vec<&'a str>,
    at: usize,
}

impl<'a> FormulaReader<'a> {
    fn peek(&self) -> Option<&'a str> {
        self.tokens.get(self.at).copied()
    }

    fn next(&mut self) -> Option<&'a str> {
        let token = self.peek()?;
        self.at += 1;
        Some(token)
    }

    /// Reads the next token only if it is one of `signs`.
    fn sign(&mut self, signs: &[&str]) -> Option<&'a str> {
        let found = self.peek().filter(|token| signs.contains(token))?;
        self.at += 1;
        Some(found)
    }

    /// Parses a clause, up to a comma outside parentheses, a semicolon or the end. A clause consists of relations and words of
    /// [`PROSE`], with at least one word between two relations.
    fn clause(&mut self) -> Option<String> {
        let mut clause = String::new();
        let mut after_relation = false;
        loop {
            match self.peek() {
                None | Some("," | ";") => break,
                Some(word) if PROSE.contains(&word) => {
                    self.at += 1;
                    clause += &format!("<mtext>&#xa0;{word}&#xa0;</mtext>");
                    after_relation = false;
                }
                Some(_) if after_relation => return None,
                Some(_) => {
                    clause += &self.relation()?;
                    after_relation = true;
                }
            }
        }
        (!clause.is_empty()).then_some(clause)
    }

    /// Parses sums with relations such as `=` and `<=` between them.
    fn relation(&mut self) -> Option<String> {
        let mut relation = self.sum()?;
        while let Some(sign) = self.sign(&["=", "<", ">", "<=", ">="]) {
            let sign = match sign {
                "<" => "&lt;",
                ">" => "&gt;",
                "<=" => "≤",
                ">=" => "≥",
                other => other,
            };
            relation += &format!("<mo>{sign}</mo>{}", self.sum()?);
        }
        Some(relation)
    }

    /// Parses products with `+`, `-` and `+-` between them. A minus may precede the first product.
    fn sum(&mut self) -> Option<String> {
        let mut sum = match self.sign(&["-"]) {
            Some(_) => "<mo>−</mo>".to_owned(),
            None => String::new(),
        };
        sum += &self.product()?;
        while let Some(sign) = self.sign(&["+", "-", "+-"]) {
            let sign = match sign {
                "-" => "−",
                "+-" => "±",
                other => other,
            };
            sum += &format!("<mo>{sign}</mo>{}", self.product()?);
        }
        Some(sum)
    }

    /// Parses products and quotients from left to right. The whole product before a `/` is the numerator. For example, `a * b /
    /// c` is a fraction with a·b above c.
    fn product(&mut self) -> Option<String> {
        let mut product = self.power()?;
        while let Some(sign) = self.sign(&["*", "/"]) {
            let factor = self.power()?;
            product = FormulaPart::new(match sign {
                "*" => format!("{}<mo>⋅</mo>{}", product.mathml, factor.mathml),
                _ => format!("<mfrac>{}{}</mfrac>", product.bare(), factor.bare()),
            });
        }
        Some(product.mathml)
    }

    /// Parses a base with an optional exponent, or one of [`FUNCTIONS`] with its argument.
    fn power(&mut self) -> Option<FormulaPart> {
        let name = self.peek().filter(|name| FUNCTIONS.contains(name));
        let Some(name) = name else {
            let base = self.atom()?;
            return Some(match self.sign(&["^"]) {
                Some(_) => {
                    let exponent = self.atom()?.bare();
                    FormulaPart::new(format!("<msup><mrow>{}</mrow>{exponent}</msup>", base.mathml))
                }
                None => base,
            });
        };
        // cos^2(x) and cos(x)^2 are the same.
        self.at += 1;
        let mut exponent = None;
        if self.sign(&["^"]).is_some() {
            // Parentheses after the exponent contain the function's argument: in `cos^n(gamma)`, n is not applied to gamma.
            exponent = Some(match self.peek()? {
                "(" => self.parentheses()?.bare(),
                _ => self.single()?.bare(),
            });
        }
        let single = self.tokens.get(self.at + 2) == Some(&")");
        let argument = self.parentheses()?;
        if exponent.is_none() && self.sign(&["^"]).is_some() {
            exponent = Some(self.atom()?.bare());
        }
        let name = match exponent {
            Some(exponent) => format!("<msup><mi>{name}</mi>{exponent}</msup>"),
            None => format!("<mi>{name}</mi>"),
        };
        let argument = match argument {
            FormulaPart { inside: Some(inside), .. } if single => {
                format!("<mspace width=\"0.17em\"/>{inside}")
            }
            part => part.mathml,
        };
        Some(FormulaPart::new(format!("{name}<mo>&#x2061;</mo>{argument}")))
    }

    /// Parses a number, a name, a function call, or an expression in parentheses.
    fn atom(&mut self) -> Option<FormulaPart> {
        let token = self.peek()?;
        if token == "(" {
            return self.parentheses();
        }
        let single = self.single()?;
        if self.peek() != Some("(") {
            return Some(single);
        }
        let argument = self.parentheses()?;
        Some(FormulaPart::new(match token {
            "sqrt" => format!("<msqrt>{}</msqrt>", argument.bare()),
            _ => format!("{}<mo>&#x2061;</mo>{}", single.mathml, argument.mathml),
        }))
    }

    fn single(&mut self) -> Option<FormulaPart> {
        let token = self.next()?;
        let first = token.chars().next()?;
        if first.is_ascii_digit() {
            return Some(FormulaPart::new(format!("<mn>{token}</mn>")));
        }
        let is_name = first.is_ascii_alphabetic() && !PROSE.contains(&token);
        is_name.then(|| FormulaPart::new(name(token)))
    }

    /// Parses parentheses with one expression, or with several and commas between them.
    fn parentheses(&mut self) -> Option<FormulaPart> {
        self.sign(&["("])?;
        let mut inside = self.sum()?;
        while self.sign(&[","]).is_some() {
            inside += &format!("<mo separator=\"true\">,</mo>{}", self.sum()?);
        }
        self.sign(&[")"])?;
        // The font size makes parentheses around a fraction as high as the fraction, because few fonts have glyphs that a
        // browser can stretch.
        let around = |sign: &str| match inside.contains("<mfrac>") {
            true => format!(
                "<mpadded voffset=\"-0.35em\"><mo class=\"tall\" stretchy=\"false\">{sign}</mo></mpadded>"
            ),
            false => format!("<mo>{sign}</mo>"),
        };
        let mathml = format!("<mrow>{}{inside}{}</mrow>", around("("), around(")"));
        Some(FormulaPart { mathml, inside: Some(inside) })
    }
}

/// Returns a name's MathML. The name of a Greek letter becomes the letter, and `delta_x` becomes Δx. The part after `_`, or a
/// number at the end, becomes a subscript. For example, `zeta_start` is ζ with the subscript "start", and `dgamma` is dγ.
fn name(token: &str) -> String {
    if let Some(of) = token.strip_prefix("delta_") {
        return format!("<mrow><mi mathvariant=\"normal\">Δ</mi>{}</mrow>", name(of));
    }
    let digits = token.len() - token.trim_end_matches(|sign: char| sign.is_ascii_digit()).len();
    let split = match token.split_once('_') {
        Some(split) => Some(split),
        None => (digits > 0).then(|| token.split_at(token.len() - digits)),
    };
    if let Some((base, index)) = split {
        let index = index.replace('_', " ");
        return format!("<msub>{}<mtext>{index}</mtext></msub>", name(base));
    }
    let letter = |name: &str| GREEK.iter().find(|(other, _)| *other == name).map(|it| it.1);
    match (letter(token), token.strip_prefix('d').and_then(letter)) {
        (Some(letter), _) => format!("<mi>{letter}</mi>"),
        (None, Some(letter)) => {
            format!("<mrow><mi mathvariant=\"normal\">d</mi><mi>{letter}</mi></mrow>")
        }
        (None, None) => format!("<mi>{token}</mi>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_core::registry::Registry;

    fn plain(text: &str) -> Option<String> {
        let mut plain = String::new();
        let mut markup = false;
        for sign in mathml(text)?.chars() {
            match sign {
                '<' => markup = true,
                '>' => markup = false,
                _ if !markup => plain.push(sign),
                _ => {}
            }
        }
        Some(plain.replace("&#x2061;", ""))
    }

    #[test]
    fn parts_are_set_as_books_do() {
        let set = |text: &str| mathml(text).unwrap_or_else(|| panic!("{text}"));
        assert!(
            set("n/2").contains("<mfrac><mrow><mi>n</mi></mrow><mrow><mn>2</mn></mrow></mfrac>")
        );
        // A denominator loses its parentheses, and a base keeps them.
        let quotient = set("c / (n + c)");
        assert!(!quotient.contains("<mo>(</mo>"), "{quotient}");
        assert_eq!(set("(a + b)^2").matches("<mo>(</mo>").count(), 1);
        // The whole product before the `/` is the numerator.
        assert!(set("a * b / c").contains("<mfrac><mrow><mi>a</mi><mo>⋅</mo><mi>b</mi></mrow>"));
        assert!(set("a / b * c").starts_with("<math displaystyle=\"true\"><mrow><mfrac>"));
        assert_eq!(set("cos(gamma)^n"), set("cos^n(gamma)"));
        // Parentheses around a fraction are higher.
        let factor = set("(n/2 + (c - 1))^2");
        assert_eq!((factor.matches("tall").count(), factor.matches("<mo>(</mo>").count()), (2, 1));
        assert!(set("sqrt(n/k)").contains("<msqrt><mrow><mfrac>"));
        assert!(set("zeta_start").contains("<msub><mi>ζ</mi><mtext>start</mtext></msub>"));
        assert!(set("f0").contains("<msub><mi>f</mi><mtext>0</mtext></msub>"));
        assert_eq!(plain("-a +- dgamma").as_deref(), Some("−a±dγ"));
        assert_eq!(plain("0 where f < ROM(n)").as_deref(), Some("0&#xa0;where&#xa0;f&lt;ROM(n)"));
        assert_eq!(plain("k = 1, 2; i <= n").as_deref(), Some("k=1, 2; i≤n"));
    }

    #[test]
    fn what_is_not_understood_stays_text() {
        for text in
            ["", "a b", "f(", "(a", "a +", "a ^", "|x|", "x²", "a = , b", "sum over all i", "a)"]
        {
            assert_eq!(mathml(text), None, "{text}");
        }
        assert_eq!(typeset("a < b c"), "<pre class=\"formula\">a &lt; b c</pre>");
    }

    #[test]
    fn the_formulas_of_all_devices_are_understood() {
        let registry = Registry::catalogue();
        for device in registry.devices() {
            let config = glint_config::Config::defaults(&(device.schema)(), "core");
            let core = glint_core::core::Core::new(*device, config).expect("the defaults work");
            let formula = &core.design.about.formula;
            assert!(mathml(formula).is_some(), "{}: {formula}", device.name);
        }
    }
}

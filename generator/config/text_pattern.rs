//! Defines patterns for texts in a configuration. All texts except formulas lack quotes, backslashes, `$`, `[`, `{`, `<` and `&`,
//! so a generated file can quote them without escapes.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextPattern {
    /// A vendor: a letter, followed by letters, digits, `.`, `-` and `_`; 60 characters at most.
    Name,
    /// Three numbers from 0 to 9999 without leading zeros, separated by dots, such as `0.1.0`.
    Version,
    /// An SPDX licence expression, such as `MIT OR Apache-2.0`. Only the characters are checked: at most 60 letters, digits,
    /// blanks, `.`, `-`, `+` and parentheses, beginning with a letter or an opening parenthesis.
    Licence,
    /// A formula or a number, of 1 to 500 characters without control characters.
    Formula,
    /// A remark in one line: 1 to 80 ASCII letters, digits, blanks and `.,:;()+-_%=/`, beginning with a letter.
    Remark,
    /// Samples as pairs `x,y x,y`, or an empty text. Only the characters and the length (at most 2^20 bytes) are checked. A
    /// configuration file may state the path of a CSV file instead, and the reader then takes the points from that file.
    Samples,
}

/// The largest length of a formula in characters.
const LONGEST_FORMULA: usize = 500;

/// The largest length of samples in bytes.
const LONGEST_SAMPLES: usize = 1 << 20;

/// The largest length of a remark in characters.
const LONGEST_REMARK: usize = 80;

/// The largest length of a name or a licence in bytes.
const LONGEST: usize = 60;

/// The largest number of digits of each number in a version.
const DIGITS: usize = 4;

impl TextPattern {
    pub fn fits(self, text: &str) -> bool {
        let more = |also: &str| {
            let good = |c: char| c.is_ascii_alphanumeric() || also.contains(c);
            text.len() <= LONGEST && text.chars().all(good)
        };
        let first =
            |also: &str| text.starts_with(|c: char| c.is_ascii_alphabetic() || also.contains(c));
        match self {
            TextPattern::Name => first("") && more(".-_"),
            TextPattern::Licence => first("(") && more(" .-+()"),
            TextPattern::Formula => {
                // The formula parser checks the signs, and marks the first wrong one in its message.
                let count = text.chars().count();
                (1..=LONGEST_FORMULA).contains(&count) && !text.chars().any(char::is_control)
            }
            TextPattern::Remark => {
                let good = |c: char| c.is_ascii_alphanumeric() || " .,:;()+-_%=/".contains(c);
                first("") && text.len() <= LONGEST_REMARK && text.chars().all(good)
            }
            TextPattern::Samples => {
                let good = |c: char| c.is_ascii_digit() || " .,+-eE".contains(c);
                text.len() <= LONGEST_SAMPLES && text.chars().all(good)
            }
            TextPattern::Version => {
                let numbers: Vec<&str> = text.split('.').collect();
                numbers.len() == 3 && numbers.into_iter().all(is_number)
            }
        }
    }

    /// Returns a regular expression that both JavaScript and Rust understand. For `Samples`, the expression also matches the path
    /// of a file with points, and does not limit the length.
    pub fn regex(self) -> &'static str {
        match self {
            TextPattern::Name => "^[A-Za-z][A-Za-z0-9._-]{0,59}$",
            TextPattern::Licence => "^[A-Za-z(][A-Za-z0-9 .+()-]{0,59}$",
            TextPattern::Formula => "^[^\\x00-\\x1f\\x7f-\\x9f]{1,500}$",
            TextPattern::Remark => "^[A-Za-z][A-Za-z0-9 .,:;()+_%=/-]{0,79}$",
            TextPattern::Samples => {
                "^([0-9 .,+eE-]*|.+[.]([cC][sS][vV]|[tT][xX][tT]|[tT][sS][vV]|[dD][aA][tT]))$"
            }
            TextPattern::Version => "^(0|[1-9][0-9]{0,3})(\\.(0|[1-9][0-9]{0,3})){2}$",
        }
    }

    /// Returns a description of the pattern for messages.
    pub fn text(self) -> &'static str {
        match self {
            TextPattern::Name => {
                "a name of at most 60 letters, digits, `.`, `-` and `_`, beginning with a letter"
            }
            TextPattern::Licence => {
                "an SPDX licence expression of at most 60 characters, as \"MIT OR Apache-2.0\""
            }
            TextPattern::Formula => {
                "a formula of at most 500 characters, as \"1 / sqrt(x)\", or a number"
            }
            TextPattern::Remark => {
                "a remark of at most 80 letters, digits, blanks and .,:;()+-_%=/, beginning with a letter"
            }
            TextPattern::Samples => {
                "the path of a file that ends in .csv, .tsv, .txt or .dat, from the configuration's directory, or points as \"0,0 1,0.5\""
            }
            TextPattern::Version => "a version of three numbers up to 9999, as \"1.0.0\"",
        }
    }
}

/// Returns whether `text` is the path of a file with points. Such a path ends, in small or capital letters, in .csv, .tsv, .txt
/// or .dat.
pub(super) fn is_path_of_points(text: &str) -> bool {
    let ending = text.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ["csv", "tsv", "txt", "dat"].contains(&ending.as_str()))
}

fn is_number(text: &str) -> bool {
    let digits = !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    digits && text.len() <= DIGITS && (text == "0" || !text.starts_with('0'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_fit_their_patterns() {
        for (pattern, good, bad) in [
            (
                TextPattern::Name,
                vec!["a", "example.org", "A-1_b"],
                vec!["", "1a", "a b", "é", "a\"", "[exit]"],
            ),
            (
                TextPattern::Version,
                vec!["0.0.0", "1.20.9999"],
                vec!["", "1.0", "1.0.0.0", "01.0.0", "1.0.10000", "1.0.x"],
            ),
            (
                TextPattern::Formula,
                vec!["1 / sqrt(x)", "if(x <= 2, -x, 3 · x^2 % 4)"],
                vec!["", "x\n", "x\u{85}"],
            ),
            (
                TextPattern::Remark,
                vec!["distance of the lamp in mm", "U (0 to 3.3 V), 12 bits"],
                vec!["", " x", "a\nb", "a \"b\"", "*/ x", "é"],
            ),
            (
                TextPattern::Samples,
                vec!["", "0,0 1,-0.5e-3"],
                vec!["points.csv", "0;1", "x,y", "0,0\n1,1"],
            ),
            (
                TextPattern::Licence,
                vec!["MIT", "MIT OR Apache-2.0", "(0BSD) AND GPL-2.0+"],
                vec!["", " MIT", "M<T", "MIT\n", "$a"],
            ),
        ] {
            for text in good {
                assert!(pattern.fits(text), "{text}");
            }
            for text in bad {
                assert!(!pattern.fits(text), "{text}");
            }
            assert!(!pattern.fits(&"a".repeat(501)));
        }
        assert!(
            TextPattern::Name.fits(&"a".repeat(60)) && !TextPattern::Name.fits(&"a".repeat(61))
        );
    }
}

//! Reads decimal numbers without rounding. For example, `1.25e-3` becomes the fraction 1/800.

use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

/// The largest power of ten, positive or negative, in a number. A larger power is a mistake in every formula.
const LARGEST_EXPONENT: i32 = 400;

/// A number in a formula, exactly as its text states it, and the nearest `f64`. For example, `0.1` is the fraction 1/10, which no
/// `f64` represents. Two literals are equal if they state the same number, such as `1` and `1.0e0`.
#[derive(Clone, Debug)]
pub struct Literal {
    text: String,
    value: RBig,
    nearest: f64,
    is_exact: bool,
}

impl PartialEq for Literal {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl Literal {
    pub(super) fn one() -> Self {
        Self::read("1").expect("digits")
    }

    /// Parses digits with an optional decimal point and an optional power of ten, such as `3`, `.5` or `1.52587890625e-05`.
    /// Returns `None` for any other text, for a power of ten beyond ±400, or for more than 400 digits after the point.
    pub fn read(text: &str) -> Option<Self> {
        let text = text.replace('−', "-");
        let (digits, exponent) = match text.split_once(['e', 'E']) {
            Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
            None => (text.as_str(), 0),
        };
        let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
        let all_digits = format!("{whole}{part}");
        if all_digits.is_empty() || !all_digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        if exponent.abs() > LARGEST_EXPONENT || part.len() > LARGEST_EXPONENT as usize {
            return None;
        }
        let numerator: IBig = all_digits.parse().ok()?;
        let power = exponent - part.len() as i32;
        let ten_to_power = UBig::from(10u8).pow(power.unsigned_abs() as usize);
        let value = if power < 0 {
            RBig::from_parts(numerator, ten_to_power)
        } else {
            RBig::from(numerator * IBig::from(ten_to_power))
        };
        let nearest = text.parse().ok()?;
        let is_exact = RBig::try_from(nearest).is_ok_and(|nearest| nearest == value);
        Some(Self { text, value, nearest, is_exact })
    }

    pub fn zero() -> Self {
        Self { text: "0".to_owned(), value: RBig::ZERO, nearest: 0.0, is_exact: true }
    }

    /// Returns the exact number as a fraction.
    pub fn value(&self) -> &RBig {
        &self.value
    }

    pub fn nearest(&self) -> f64 {
        self.nearest
    }

    /// Returns whether the nearest `f64` equals the exact number.
    pub fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// Returns the number of significant digits in the text, from the first digit that is not 0, without the exponent. For
    /// example, `0.0125` and `1.25e-2` both have three.
    pub(super) fn significant_digits(&self) -> usize {
        let digits = self.text.split(['e', 'E']).next().unwrap_or_default();
        let from_first = digits.trim_start_matches(['0', '.']);
        from_first.bytes().filter(u8::is_ascii_digit).count()
    }

    /// Returns a decimal that C and Python can parse. This is the shortest decimal if it is exact, such as `0.00125` for
    /// `1.25e-3`, and otherwise the formula's text.
    pub fn digits(&self) -> String {
        let shortest = format!("{:?}", self.nearest);
        match Self::read(&shortest) {
            Some(read) if read.value == self.value => shortest,
            _ => self.text.clone(),
        }
    }
}

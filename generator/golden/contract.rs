//! Makes parts of accuracy contracts that several devices need: the operands `cos_gamma` and `exponent`, the error bound of a
//! device that multiplies colours, and Python expressions.

use super::{Bound, Operand, Term};
use glint_base::fixed::{Format, Rounding, exp2};

/// The name of the operand cos γ in every device that has it.
pub const COSINE: &str = "cos_gamma";

/// The name of the operand n, the specular exponent, in every device that has it.
pub const EXPONENT: &str = "exponent";

/// A contribution to the error of the reflectance `f`: the configuration key that governs it, its description, and its size as a
/// value (not in units).
pub type ErrorShare = (&'static str, &'static str, f64);

/// Returns the operand `cos_gamma` with `domain`, its smallest and largest raw value.
pub fn cosine_operand(format: Format, domain: (i64, i64)) -> Operand {
    let doc = "cosine of the angle between the normal and the half vector";
    control(COSINE, format, domain, doc)
}

/// Returns the operand `exponent` with `domain`, its smallest and largest raw value.
pub fn exponent_operand(format: Format, domain: (i64, i64)) -> Operand {
    control(EXPONENT, format, domain, "specular exponent n")
}

/// Returns an operand that determines the reflectance `f`, unlike a colour operand.
pub fn control(name: &str, format: Format, domain: (i64, i64), doc: &str) -> Operand {
    let doc = doc.to_owned();
    Operand { name: name.to_owned(), format, domain, clamped: false, colour: false, doc }
}

/// Returns the error bounds of a device that multiplies colours by a reflectance `f` with `frac` fraction bits: the bound of `f`
/// as a value, and the bound of each output in units. `shares` are the contributions to the error of `f`.
///
/// An output is `f` times a colour of `colour_bits` bits, rounded by `output_rounding`. Its bound is therefore the error of `f`
/// times the largest colour, plus the error of that rounding. Both `f` and the formula lie in 0 … 1, so shares whose sum exceeds
/// 1.0 are scaled down to 1.0. The term of the rounding names the key `output.rounding`, which the device must have. Empty
/// `shares` mean that no bound is known: the bound is then infinite and has no terms.
pub fn bound(
    shares: &[ErrorShare],
    frac: u32,
    colour_bits: u32,
    output_rounding: Rounding,
) -> (f64, Bound) {
    if shares.is_empty() {
        return (f64::INFINITY, Bound::of(Vec::new()));
    }
    let sum: f64 = shares.iter().map(|share| share.2).sum();
    let cap = if sum > 1.0 { 1.0 / sum } else { 1.0 };
    let largest = exp2(colour_bits as i32) - 1.0;
    let mut terms: Vec<Term> = shares
        .iter()
        .map(|&(key, what, error)| Term { key, what, units: error * cap * largest })
        .collect();
    terms.push(Term {
        key: "output.rounding",
        what: "rounding of the colour outputs",
        units: match output_rounding {
            // The product has `frac` fraction bits, so truncation loses at most `1 − 2^−frac`.
            Rounding::Truncate => 1.0 - exp2(-(frac as i32)),
            Rounding::Nearest => 0.5,
        },
    });
    let f = if sum.is_nan() { f64::INFINITY } else { sum * cap };
    (f, Bound::of(terms))
}

/// Returns a Python expression that is 0 if `expression` is negative: `x - 1` becomes `max(x - 1, 0)`.
pub fn clamped_at_0(expression: &str) -> String {
    format!("max({expression}, 0)")
}

/// Returns a Python expression that is 0 if the surface faces away: `f` becomes `f if cos_gamma > 0 else 0`.
pub fn where_it_faces(expression: &str) -> String {
    format!("{expression} if {COSINE} > 0 else 0")
}

/// Returns the raw value of `operand` for the specular exponent `n`. Returns `None` if the format cannot represent `n` exactly,
/// or if `n` is outside the domain. For example, in `u10.0` n = 20 gives 20, and n = 20.5 gives `None`.
pub fn exponent_at(operand: &Operand, n: f64) -> Option<i64> {
    let raw = operand.format.quantise(n);
    let held = operand.format.to_f64(raw) == n;
    let (raw, (low, high)) = (raw as i64, operand.domain);
    (held && (low..=high).contains(&raw)).then_some(raw)
}

/// Returns the raw values of the control operands for an angle `gamma` (in radians) and an exponent `n`, in the order of
/// `operands`. A control operand besides `cos_gamma` and `exponent` takes its raw value in `neutral`. Without an entry, it takes
/// the value of its domain that is nearest to 0.
///
/// Returns `None` if `cos_gamma` or `exponent` is missing, or if `exponent_at` returns `None` for `n`.
pub fn operands_at(
    operands: &[Operand],
    gamma: f64,
    n: f64,
    neutral: &[(&str, i64)],
) -> Option<Vec<i64>> {
    for needed in [COSINE, EXPONENT] {
        if !operands.iter().any(|operand| operand.name == needed) {
            return None;
        }
    }
    let mut control = Vec::new();
    for operand in operands {
        if operand.colour {
            continue;
        }
        let (low, high) = operand.domain;
        control.push(match operand.name.as_str() {
            COSINE => (operand.format.quantise(libm::cos(gamma)) as i64).clamp(low, high),
            EXPONENT => exponent_at(operand, n)?,
            name => {
                let given = neutral.iter().find(|(other, _)| *other == name);
                given.map_or(0, |(_, raw)| *raw).clamp(low, high)
            }
        });
    }
    Some(control)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operands_stand_for_an_angle_and_an_exponent() {
        let operand = |name: &str, format, domain| control(name, format, domain, "");
        let mut operands = vec![
            operand("exponent", Format::unsigned(6, 0), (2, 50)),
            operand("cos_gamma", Format::unsigned(1, 4), (0, 16)),
            operand("turn", Format::signed(2, 2), (1, 7)),
            operand("tint", Format::unsigned(2, 2), (0, 15)),
        ];
        operands.push(Operand { colour: true, ..operand("red", Format::unsigned(8, 0), (0, 255)) });
        let at = |gamma: f64, n| operands_at(&operands, gamma, n, &[("tint", 5)]);
        // cos 60° = 8/16; 0 is not in the domain of `turn`, and 1 is nearest to it.
        let third = std::f64::consts::FRAC_PI_3;
        assert_eq!(at(third, 35.0), Some(vec![35, 8, 1, 5]));
        assert_eq!(at(0.0, 2.0), Some(vec![2, 16, 1, 5]));
        // Beyond the domain, beyond the format, and between integers.
        assert_eq!([1.0, 51.0, 64.0, 1e9, 2.5].map(|n| at(0.0, n)), [const { None }; 5]);
        assert_eq!(operands_at(&operands[1..], 0.0, 2.0, &[]), None);
    }

    #[test]
    fn terms_add_up_and_are_capped() {
        let shares = [("a", "one", 0.25), ("b", "another", 0.125)];
        let (f, sum) = bound(&shares, 8, 4, Rounding::Nearest);
        // 15 · 0.375 + 0.5.
        assert_eq!((f, sum.units), (0.375, 6.125));
        let (f, capped) =
            bound(&[("a", "one", 3.0), ("b", "another", 1.0)], 8, 4, Rounding::Truncate);
        let units: Vec<f64> = capped.terms.iter().map(|term| term.units).collect();
        assert_eq!(f, 1.0);
        assert_eq!(units, [11.25, 3.75, 255.0 / 256.0]);
    }
}

//! What the contracts of all devices share: colour operands and the sum of a bound.

use super::{Bound, Operand, Term};
use crate::fixed::{Format, Rounding, exp2};

/// The colours, in the order of operands and outputs.
const COLOURS: [&str; 3] = ["red", "green", "blue"];

/// One contribution to the error of `f`: its configuration key, what it is, and its size.
pub type Share = (&'static str, &'static str, f64);

/// The operands of [`crate::dsl::blocks::colour::Colours`]; every value is in the domain.
pub fn colour_operands(format: Format) -> impl Iterator<Item = Operand> {
    COLOURS.into_iter().map(move |colour| Operand {
        name: colour.to_string(),
        format,
        domain: (0, format.max_raw() as i64),
        colour: true,
        doc: format!("{colour} of the light times the surface's specular coefficient"),
    })
}

/// The outputs of [`crate::dsl::blocks::colour::Colours`].
pub fn colour_outputs() -> Vec<String> {
    COLOURS.map(|colour| format!("{colour}_out")).to_vec()
}

/// The operand of [`crate::dsl::blocks::colour::Colours::amplitude`]; every value is in the domain.
pub fn amplitude_operand(format: Format) -> Operand {
    Operand {
        name: "amplitude".to_string(),
        format,
        domain: (0, format.max_raw() as i64),
        colour: true,
        doc: "intensity of the light times the surface's specular coefficient, at the peak"
            .to_string(),
    }
}

/// The output of [`crate::dsl::blocks::colour::Colours::amplitude`].
pub fn intensity_output() -> Vec<String> {
    vec!["intensity_out".to_string()]
}

/// The bound from the errors of `f`, a word with `frac` fraction bits.
///
/// `f` and the formula both lie in 0 … 1, so that no word is off by more than 1.0: where the shares
/// exceed it, they are scaled down to it. An output is `f` times a colour, which multiplies the error
/// by the largest colour, and a rounding. It never saturates, for `f` < 1. The rounding's share is
/// attributed to a key `output.rounding`, which the device must have.
pub fn bound(shares: &[Share], frac: u32, colour_bits: u32, output_rounding: Rounding) -> Bound {
    let sum: f64 = shares.iter().map(|share| share.2).sum();
    let cap = if sum > 1.0 { 1.0 / sum } else { 1.0 };
    let largest = exp2(colour_bits as i32) - 1.0;
    let mut terms: Vec<Term> = shares
        .iter()
        .map(|&(key, what, error)| Term {
            key,
            what,
            units: error * cap * largest,
        })
        .collect();
    terms.push(Term {
        key: "output.rounding",
        what: "rounding of the colour outputs",
        units: match output_rounding {
            // The product has `frac` fraction bits, and its last ulp is never dropped.
            Rounding::Truncate => 1.0 - exp2(-(frac as i32)),
            Rounding::Nearest => 0.5,
        },
    });
    Bound {
        f: sum * cap,
        units: terms.iter().map(|term| term.units).sum(),
        terms,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_add_up_and_are_capped() {
        let shares = [("a", "one", 0.25), ("b", "another", 0.125)];
        let sum = bound(&shares, 8, 4, Rounding::Nearest);
        // 15 · 0.375 + 0.5.
        assert_eq!((sum.f, sum.units), (0.375, 6.125));
        let capped = bound(
            &[("a", "one", 3.0), ("b", "another", 1.0)],
            8,
            4,
            Rounding::Truncate,
        );
        let units: Vec<f64> = capped.terms.iter().map(|term| term.units).collect();
        assert_eq!(capped.f, 1.0);
        assert_eq!(units, [11.25, 3.75, 255.0 / 256.0]);
    }
}

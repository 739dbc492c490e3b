//! The hardware description of the device `function`, which computes y = g(x) for one operand x.
//!
//! A configuration states g as a formula, such as `sqrt(x)`, or as samples of a curve. A table gives the coefficients of a
//! polynomial for the segment of x, and Horner's rule evaluates the polynomial with one multiplier.

mod reduction;

use glint_approximate::{Outside, Piecewise};
use glint_base::text;
use glint_config::{Config, Shared};
use glint_keys::function::{Keys, found};
use glint_rtl::dsl::{Designer, end, step, valid};
use glint_rtl::netlist::About;

use crate::piecewise::{PolynomialDatapath, StepMultiplier, Tables, number};

/// Describes the hardware of `function`: a table of coefficients, and Horner's rule with one multiplier.
///
/// # Panics
/// Panics if the check of the schema has not accepted the configuration. The caller must check it first.
pub fn describe(d: &Designer, config: &Config) {
    let (function, it) = found(config).expect("a configuration that is checked");
    d.about(about(&Keys::of(config), function.proof(), &it));
    let (first, last) = it.domain;
    let operand = match it.outside {
        Outside::Clamp => {
            let [first, last] = [first, last].map(|raw| it.operand.to_f64(raw.into()));
            d.operand_clamped("x", it.operand, first, last)
        }
        Outside::Wrap | Outside::Anything => d.operand("x", it.operand),
    };
    let x = operand.doc("the operand").q();
    let (number, restoring) = match &it.reduction {
        None => (number(d, "number", x, &it), None),
        Some(reduction) => {
            let (number, restoring) = reduction::reduced(d, x, &it, reduction);
            (number, Some(restoring))
        }
    };
    let tables = Tables::of(&it, Shared::of(config).architecture == "pipelined");
    let polynomial = PolynomialDatapath::new(d, "", &it.registers(), number, &it, tables);
    let names = ["factors_select", "factor", "offset_of_step", "product"];
    let multiplier = StepMultiplier::new(d, names, &[&polynomial], &[]);
    let mut steps = vec![step("operand; table addressed", [])];
    for k in polynomial.steps() {
        let name = match k {
            0 if it.reduction.is_some() => "polynomial <- all coefficients".to_owned(),
            0 => "result <- the polynomial".to_owned(),
            _ => format!("sum{k} <- coefficients from {k} on"),
        };
        steps.push(step(&name, multiplier.step(&polynomial, k)));
    }
    let mut result = polynomial.q();
    if let Some(restoring) = restoring {
        let register = d.register("result", it.result);
        register.takes(restoring.result(d, result, it.result));
        steps.push(step("result <- the polynomial", [register.load()]));
        result = register.q();
    }
    steps.push(step("result", [valid(), end()]));
    d.output("result_out", result);
    d.microprogram(steps);
}

fn about(keys: &Keys, proof: &str, it: &Piecewise) -> About {
    let Keys { from, to, .. } = keys;
    let formula = if keys.samples.is_empty() { &keys.formula } else { "samples(x)" };
    let ends = if keys.to_included { "both ends included" } else { "the end not included" };
    let reduced = it.reduction.as_ref().map_or_else(String::new, |it| {
        format!("Operands are reduced ({}) to {} bits. ", keys.reduction.word(), it.bits)
    });
    let shape = match it.degree() {
        0 => format!("A table of {} results", it.words.len()),
        degree => format!(
            "{} segments ({}) with polynomials of degree {degree}, {} bits of coefficients",
            it.words.len(),
            it.segments.layout.name(),
            it.rom_bits()
        ),
    };
    About {
        device: "function".to_owned(),
        title: format!("{formula}, by piecewise polynomials"),
        formula: format!("result = {formula}"),
        source: "The configuration".to_owned(),
        notes: vec![
            format!("The domain is x from {from} to {to}, {ends}.").into(),
            format!(
                "{reduced}{shape}. {proof}: no result is further off than {} units of the last place.",
                text::rounded_up(it.bound, 4)
            )
            .into(),
        ],
    }
}

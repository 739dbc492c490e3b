//! The hardware description of the device `function`, which computes y = g(x) for one operand x.
//!
//! A configuration states g as a formula, such as `sqrt(x)`, or as samples of a curve. A table has the coefficients of a
//! polynomial for each segment of x, and Horner's rule evaluates it, in the sequential core with one multiplier. The hardware is
//! built from a plan with this one function, like the hardware of `expression`.

use glint_approximate::Piecewise;
use glint_base::text;
use glint_config::{Config, Shared};
use glint_keys::function::{FunctionPlan, Keys, operand};
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::About;

use crate::piecewise::WRITABLE_TABLE;
use crate::plan::{PlanOutput, describe_plan};

/// Builds the hardware. `planned` must be the plan of the function that the configuration states.
pub fn describe(d: &Designer, config: &Config, planned: &FunctionPlan) {
    let polynomials = &planned.polynomials;
    d.about(about(&Keys::of(config), planned.function.proof(), polynomials));
    let operand = operand(polynomials);
    let is_pipelined = Shared::of(config).architecture == "pipelined";
    let output = PlanOutput { name: "result_out".to_owned(), doc: String::new() };
    describe_plan(d, &[operand], &planned.plan, &[output], is_pipelined);
}

fn about(keys: &Keys, proof: &str, it: &Piecewise) -> About {
    let Keys { from, to, .. } = keys;
    let formula = if keys.samples.is_empty() { &keys.formula } else { "samples(x)" };
    let ends = if keys.to_included { "both ends included" } else { "without the end" };
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
    let mut notes = vec![
        format!("The domain is x from {from} to {to}, {ends}.").into(),
        format!(
            "{reduced}{shape}. {proof}: the error is at most {} units of the last place.",
            text::rounded_up(it.bound, 4)
        )
        .into(),
    ];
    if it.is_writable {
        notes.push(WRITABLE_TABLE.to_owned().into());
    }
    About {
        device: "function".to_owned(),
        title: format!("{formula}, by piecewise polynomials"),
        formula: format!("result = {formula}"),
        source: "The configuration".to_owned(),
        notes,
    }
}

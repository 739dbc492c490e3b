//! The hardware description of the device `function`, which computes y = g(x) for one operand x.
//!
//! A configuration states g as a formula, such as `sqrt(x)`, or as samples of a curve. A table gives the coefficients of a
//! polynomial for the segment of x, and Horner's rule evaluates the polynomial with one multiplier.

mod reduction;

use glint_approximate::{Outside, Piecewise};
use glint_base::fixed::Format;
use glint_base::text;
use glint_config::{Config, Shared};
use glint_keys::function::{Keys, found};
use glint_rtl::dsl::{Designer, Signal, end, step, valid};
use glint_rtl::netlist::About;

use crate::piecewise::{PolynomialDatapath, StepMultiplier, Tables, flipped};

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
        None => (number(d, x, &it), None),
        Some(reduction) => {
            let (number, restoring) = reduction::reduced(d, x, &it, reduction);
            (number, Some(restoring))
        }
    };
    let tables = Tables { split: is_split(config, &it), synchronous: true };
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

/// Returns an operand's raw value.
fn whole(x: Signal) -> Signal {
    let Format { signed, .. } = x.format();
    let int = x.format().width() as i32 - i32::from(signed);
    x.read_as(Format { int, frac: 0, ..x.format() })
}

/// Returns the operand's number within the domain, without a sign.
fn number<'d>(d: &'d Designer, x: Signal<'d>, it: &Piecewise) -> Signal<'d> {
    let width = x.format().width() as i32;
    let integer = |bits: i32| Format::unsigned(bits, 0);
    let bits = it.segments.bits as i32;
    let origin = i128::from(it.origin);
    if origin == it.operand.min_raw() {
        return if it.operand.signed {
            flipped(d, "number", x, integer(width))
        } else {
            x.read_as(integer(width))
        };
    }
    let first = d.raw_constant("first", origin, Format::holding(origin, origin, 0));
    let number = d.sub("number", whole(x), first);
    if number.format() == integer(bits) { number } else { number.bits(0, integer(bits)) }
}

/// The fewest bits of a table that a family of FPGAs has a block memory for.
const BLOCK: u64 = 2048;

/// Returns whether each coefficient has a table of its own: in a pipeline the address then waits in place of the coefficient,
/// which is wider. A block memory has all.
fn is_split(config: &Config, it: &Piecewise) -> bool {
    Shared::of(config).architecture == "pipelined" && it.rom_bits() < BLOCK
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

//! The keys of a function, and what a configuration asks for by them.

use super::{Function, Layout, Outside, Refusal, Target, Wish};
use crate::base::fixed::{Format, MAX_WIDTH, exp2};
use crate::config::{Config, Key, TextPattern};
use crate::formula::{Enclosure, Fault, Formula, parse};

/// The keys of a function of one operand.
pub fn keys() -> Vec<Key> {
    let number = |name, default, doc| Key::text(name, default, TextPattern::Formula, doc);
    vec![
        number("function.formula", "1 / sqrt(x)", "The function of the operand x."),
        number(
            "function.from",
            "1",
            "The smallest operand of the domain; a number or a formula of numbers.",
        ),
        number("function.to", "4", "The end of the domain."),
        Key::flag("function.to_included", false, "Whether the end belongs to the domain."),
        Key::choice(
            "function.outside",
            "clamp",
            &["clamp", "wrap", "anything"],
            "What operands outside the domain give: the result of its nearer end, that of a period of the domain's length, or any.",
        ),
        Key::integer("operand.fraction", 16, 0..=40, "Fraction bits of the operand.").drawn(4, 10),
        Key::integer("result.fraction", 16, 0..=40, "Fraction bits of the result.").drawn(4, 12),
        Key::number(
            "result.error",
            1.0,
            0.5..=1024.0,
            "Every result is nearer to the function than this, in units of its last place: 1.0 for one of the two neighbours, 0.51 \
             for nearly always the nearer.",
        ),
        Key::choice(
            "approximation.degree",
            "auto",
            &["auto", "0", "1", "2", "3"],
            "The degree of the polynomials: 0 is a table of results. By default that of the least cost.",
        ),
        Key::choice(
            "approximation.segments",
            "auto",
            &["auto", "uniform", "octaves", "halving"],
            "How the domain is cut: evenly, or ever shorter toward its low end (octaves) or its high end (halving), for \
             functions that are steep there.",
        ),
    ]
}

/// The function that a configuration states, and what it asks of the approximation.
///
/// # Errors
/// What is wrong with the formula or the domain.
pub fn function(config: &Config) -> Result<(Function, Wish), Refusal> {
    let formula = parse(config.text("function.formula"))
        .and_then(|formula| formula.of_operand("x"))
        .map_err(|fault| misread("function.formula", fault))?;
    let fraction = config.integer("operand.fraction") as i32;
    let from = end(config, "function.from")?;
    let to = end(config, "function.to")?;
    let [from, to] = [from, to].map(|it| (it.low * exp2(fraction), it.high * exp2(fraction)));
    if [from, to].iter().any(|it| it.0.abs().max(it.1.abs()) >= exp2(MAX_WIDTH as i32 - 2)) {
        let message = format!("an operand of the domain has more than {} bits", MAX_WIDTH - 2);
        return Err(Refusal::new("operand.fraction", message, "fewer, or a smaller domain"));
    }
    let first = from.1.ceil() as i64;
    let last =
        if config.flag("function.to_included") { to.0.floor() } else { to.0.ceil() - 1.0 } as i64;
    if last <= first {
        let message = format!(
            "the domain from {} to {} has no two operands with {fraction} fraction bits",
            config.text("function.from"),
            config.text("function.to")
        );
        return Err(Refusal::new(
            "function.to",
            message,
            "a larger end, or more operand.fraction bits",
        ));
    }
    let outside = match config.choice("function.outside") {
        "wrap" => Outside::Wrap,
        "anything" => Outside::Anything,
        _ => Outside::Clamp,
    };
    let count = (last - first) as u64 + 1;
    if outside == Outside::Wrap && !count.is_power_of_two() {
        let message = format!("a period of {count} operands is no power of two");
        let remedy = "scale the operand so that it is, or \"clamp\" or \"anything\"";
        return Err(Refusal::new("function.outside", message, remedy));
    }
    let function = Function {
        target: Target::Formula(formula),
        domain: (first, last),
        operand: Format::holding(first.into(), last.into(), fraction),
        outside,
        fraction: config.integer("result.fraction") as u32,
        error: config.number("result.error"),
    };
    let wish = Wish {
        degree: config.choice("approximation.degree").parse().ok(),
        layout: Layout::NAMES
            .iter()
            .find(|(name, _)| *name == config.choice("approximation.segments"))
            .map(|(_, layout)| *layout),
    };
    Ok((function, wish))
}

/// An end of the domain.
fn end(config: &Config, key: &'static str) -> Result<Enclosure, Refusal> {
    let value = parse(config.text(key)).and_then(|formula: Formula| formula.enclose(&[]));
    let value = value.map_err(|fault| misread(key, fault))?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Refusal::new(
            key,
            "this is no finite number".to_owned(),
            "a number, or a formula of numbers",
        ))
    }
}

fn misread(key: &'static str, fault: Fault) -> Refusal {
    let remedy =
        "a formula has numbers, pi, e, + - * / ^, parentheses and functions; `1 / sqrt(x)`, say";
    Refusal { place: Some(fault.span), ..Refusal::new(key, fault.message, remedy) }
}

//! Declares the configuration keys of the device `function`, and finds the piecewise polynomial for its function.
//!
//! The keys state a function of one operand x, its domain and the allowed error. The function is a formula such as `1 / sqrt(x)`,
//! or samples (measured points).

use std::sync::Arc;

use glint_approximate::{
    Curve, Identity, Layout, Outside, Piecewise, Refusal, RefusalKind, TargetFunction,
    UnsuitedReduction, Wish, find, reachable_error,
};
use glint_base::config_error::ConfigError;
use glint_base::fixed::{Format, MAX_WIDTH};
use glint_config::{Config, Key, Problems, Schema, TextPattern};
use glint_formula::{Fault, parse};
use glint_plan::{ExpressionPlan, StatedOperand};

use super::samples;

glint_config::keys! {
    pub struct Keys {
        formula: String = Key::text("function.formula", "1 / sqrt(x)", TextPattern::Formula,
            "The function of the operand x."),
        samples: String = Key::text("function.samples", "", TextPattern::Samples,
            "Measured points in place of a formula: the path of a CSV file with x and the result in each line, \
             or the points themselves. Glint connects the points by monotone cubic curves and states the error \
             against these curves.")
            .joined_later(),
        from: String = Key::text("function.from", "1", TextPattern::Formula,
            "The lower end of the domain."),
        to: String = Key::text("function.to", "4", TextPattern::Formula, "The upper end of the domain."),
        to_included: bool = Key::flag("function.to_included", false,
            "Whether the upper end belongs to the domain."),
        outside: Outside = Key::choice("function.outside", "clamp", Outside::WORDS,
            "The result for operands outside the domain. clamp: the result of the nearer end. wrap: the domain \
             repeats as a period, so the result of the operand modulo the length of the domain. anything: any \
             result."),
        operand: u32 = Key::integer("operand.fraction", 16, 0..=40, "Number of fraction bits of the operand.")
            .drawn(4, 10),
        result: u32 = Key::integer("result.fraction", 16, 0..=40, "Number of fraction bits of the result.")
            .drawn(4, 12),
        error: f64 = Key::number("result.error", 1.0, 0.5..=1024.0,
            "The bound of the error of every result, in units of its last place. With 1.0, a result is one of \
             the two neighbours of the exact value. With 0.51, it is nearly always the nearer one."),
        degree: String = Key::choice("approximation.degree", "auto", &["auto", "0", "1", "2", "3"],
            "The degree of the polynomials. 0 is a table of results. The default has the least cost."),
        segments: String = Key::choice("approximation.segments", "auto",
            &["auto", "uniform", "octaves", "halving"],
            "The segments of the domain. uniform: all segments are equally long. octaves: they become shorter \
             toward the lower end. halving: they become shorter toward the upper end. Short segments suit an \
             end where the function is steep."),
        reduction: Identity = Key::choice("approximation.reduction", "none", Identity::WORDS,
            "The range reduction, an identity with which polynomials on a short domain give the whole \
             function. odd and even: symmetry about 0. quadrants: a sine or cosine over one period. octaves: \
             powers, roots, reciprocals and logarithms. exponent: an exponential function, in which the \
             integer part of the exponent becomes a shift. The error bound is proved over the whole domain.")
            .joined_later(),
    }
}

pub fn schema() -> Schema {
    Schema { device: "function", keys: Keys::keys(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    let [formula, samples] = ["function.formula", "function.samples"];
    if config.text(samples).is_empty() && problems.gives(samples) {
        // The samples could not be read, and the reader has already reported the problem. The default of the formula must not
        // replace them.
        return;
    }
    if !config.text(samples).is_empty() && problems.gives(formula) {
        let message = format!("`{formula}` and `{samples}` are both given");
        return problems.push(formula, message, "remove one of the two keys");
    }
    if let Err(error) = function(&Keys::of(config)) {
        problems.push_error(error);
    }
}

pub struct FunctionPlan {
    /// The function with its domain and the allowed error.
    pub function: TargetFunction,
    /// They approximate the function, with a proved bound of the error.
    pub polynomials: Arc<Piecewise>,
    /// The operations that evaluate the polynomials.
    pub plan: ExpressionPlan,
}

/// Finds polynomials that approximate the function of a configuration, and proves a bound of the error.
///
/// # Errors
/// Fails if the formula, the samples or the domain are wrong, if no approximation can be found, or if the planner refuses the
/// approximation. The error names a key to change.
pub fn plan(config: &Config) -> Result<FunctionPlan, ConfigError> {
    let keys = Keys::of(config);
    let function = function(&keys)?;
    let wish = Wish {
        degree: keys.degree.parse().ok(),
        layout: Layout::NAMES.iter().find(|it| it.0 == keys.segments).map(|it| it.1),
        identity: keys.reduction,
        prefix: None,
        most_cells: None,
        least_words: 0,
    };
    let polynomials = find(&function, wish).map_err(|refusal| refused(refusal, &function, wish))?;
    let plan = ExpressionPlan::of_function(&function, &polynomials).map_err(|refusal| {
        ConfigError::new("operand.fraction", refusal.message, "set a smaller operand.fraction")
    })?;
    Ok(FunctionPlan { function, polynomials, plan })
}

/// Turns the refusal of the search into an error of the key that the user should change.
fn refused(refusal: Refusal, function: &TargetFunction, wish: Wish) -> ConfigError {
    const SMALLER: &str = "set a smaller operand.fraction";
    const DIVIDED: &str = "use device = \"expression\", which divides such a domain into octaves, or set a smaller \
                           operand.fraction";
    let (key, remedy) = match refusal.kind {
        RefusalKind::NoValue => (
            "function.formula",
            "exclude such operands from the domain: change function.from or function.to".to_owned(),
        ),
        RefusalKind::OperandBits { most } => {
            ("operand.fraction", format!("set operand.fraction to at most {most}"))
        }
        RefusalKind::ManyOperandsOfSamples => ("operand.fraction", SMALLER.to_owned()),
        RefusalKind::ResultBits => {
            ("result.fraction", "set fewer fraction bits, or another domain".to_owned())
        }
        RefusalKind::Error => {
            let larger = match reachable_error(function, wish) {
                Some(error) => format!("set result.error to {error}, or "),
                None => String::new(),
            };
            ("result.error", format!("{larger}{SMALLER} or result.fraction"))
        }
        RefusalKind::ErrorExceeded => ("result.error", "allow a larger error".to_owned()),
        RefusalKind::Unproved => ("result.error", DIVIDED.to_owned()),
        RefusalKind::Reduction(why) => {
            let remedy = match why {
                UnsuitedReduction::NoReduction => "set approximation.reduction to \"none\"",
                UnsuitedReduction::NoIdentity => {
                    "set approximation.reduction to \"none\" or to another identity"
                }
                UnsuitedReduction::OneSide => {
                    "set approximation.reduction to \"none\", or change function.from"
                }
                UnsuitedReduction::FromZero => "set function.from to the smallest operand above 0",
                UnsuitedReduction::NoPeriod => {
                    "scale the operand, for example sin(2 * pi * x) from 0 to 1"
                }
                UnsuitedReduction::Bits => "set other fraction bits, or another domain",
                UnsuitedReduction::ManyOperands => DIVIDED,
            };
            ("approximation.reduction", remedy.to_owned())
        }
    };
    ConfigError::new(key, refusal.message, remedy).at(refusal.place)
}

/// Returns the operand x, with the format and the domain of the piecewise polynomial.
pub fn operand(polynomials: &Piecewise) -> StatedOperand {
    StatedOperand {
        name: "x".to_owned(),
        format: polynomials.operand,
        domain: polynomials.domain,
        outside: polynomials.outside,
        doc: String::new(),
    }
}

fn function(keys: &Keys) -> Result<TargetFunction, ConfigError> {
    let fraction = keys.operand as i32;
    let ends = [("function.from", &keys.from), ("function.to", &keys.to)];
    let [from, to] = ends.map(|(key, text)| End::read(key, text, keys.operand));
    let (from, to) = (from?, to?);
    let beyond = 1i128 << (MAX_WIDTH - 2);
    if [from, to].iter().any(|end| end.ceiling.abs() >= beyond) {
        let message = format!("an operand of the domain has more than {} bits", MAX_WIDTH - 2);
        return Err(ConfigError::new(
            "operand.fraction",
            message,
            too_wide(&from, &to, keys.operand),
        ));
    }
    let first = from.ceiling as i64;
    let last = match to.is_operand && keys.to_included {
        true => to.ceiling as i64,
        false => to.ceiling as i64 - 1,
    };
    if last <= first {
        let message = format!(
            "the domain from {} to {} has no two operands with {fraction} fraction bits",
            keys.from, keys.to
        );
        let remedy = "set a larger function.to or a larger operand.fraction";
        return Err(ConfigError::new("function.to", message, remedy));
    }
    let count = (last - first) as u64 + 1;
    if keys.outside == Outside::Wrap && !count.is_power_of_two() {
        let message = format!("the period has {count} operands, which is not a power of two");
        let remedy = "scale the operand so that the number of operands is a power of two, or set \
                      function.outside to \"clamp\" or \"anything\"";
        return Err(ConfigError::new("function.outside", message, remedy));
    }
    let curve = if keys.samples.is_empty() {
        let formula = parse(&keys.formula).and_then(|formula| formula.of_operand("x"));
        Curve::Formula(formula.map_err(|fault| misread("function.formula", fault))?)
    } else {
        Curve::Samples(samples::read(&keys.samples, keys.operand, (first, last))?)
    };
    Ok(TargetFunction {
        curve,
        domain: (first, last),
        operand: Format::holding(first.into(), last.into(), fraction),
        outside: keys.outside,
        fraction: keys.result,
        error: keys.error,
    })
}

/// An end of a domain. The end `1.5` of an operand without fraction bits has the `ceiling` 2, and is not an operand itself.
#[derive(Clone, Copy)]
pub(super) struct End {
    /// The smallest raw operand that is not below the end.
    pub(super) ceiling: i128,
    /// Whether `ceiling` is exactly the end.
    pub(super) is_operand: bool,
}

impl End {
    /// Evaluates the text of an end, for an operand with `fraction` fraction bits, without rounding errors: `0.1 * 10` is 1, and
    /// `log2(16)` is 4. `key` is the configuration key for errors.
    ///
    /// # Errors
    /// Fails if the text is not a formula, or if the formula has an operand or no value, such as `1 / 0`. Fails also if 1024 bits
    /// do not decide whether the value is an operand.
    pub(super) fn read(key: &'static str, text: &str, fraction: u32) -> Result<Self, ConfigError> {
        let formula = parse(text).map_err(|fault| misread(key, fault))?;
        let (ceiling, is_operand) = formula.ceiling(fraction).map_err(|fault| {
            let remedy =
                "write the end as a number, for example `2` or `1e-3`, or as a formula of numbers";
            ConfigError::new(key, fault.message, remedy).at(fault.span.bytes)
        })?;
        Ok(Self { ceiling, is_operand })
    }
}

/// The remedy for a domain whose raw operands have too many bits.
fn too_wide(from: &End, to: &End, fraction: u32) -> String {
    let bits = |end: &End| i128::BITS - end.ceiling.unsigned_abs().leading_zeros();
    let excess = bits(from).max(bits(to)) - (MAX_WIDTH - 2);
    match fraction.checked_sub(excess) {
        Some(fewer) => format!("set operand.fraction to at most {fewer}, or set a smaller domain"),
        None => "set a smaller domain: change function.from or function.to".to_owned(),
    }
}

fn misread(key: &'static str, fault: Fault) -> ConfigError {
    let remedy = "write a formula of numbers, pi, e, + - * / ^, parentheses and functions, for example `1 / \
                  sqrt(x)`";
    ConfigError::new(key, fault.message, remedy).at(fault.span.bytes)
}

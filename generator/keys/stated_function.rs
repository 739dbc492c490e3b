//! Declares the configuration keys of the device `function`, and reads the function that they state.
//!
//! The keys state a function of one operand x, its domain and the allowed error. The function is a formula such as `1 / sqrt(x)`,
//! or samples (measured points).

use glint_approximate::{Curve, Identity, Outside, TargetFunction};
use glint_base::config_error::ConfigError;
use glint_base::fixed::{Format, MAX_WIDTH};
use glint_config::{Key, TableEntries, TextPattern};
use glint_formula::{Fault, parse};

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
        tables: String = Key::choice("approximation.tables", "fixed", &["fixed", "writable"],
            "fixed: the table of coefficients is a ROM. writable: Glint also writes <name>_loadable.v, the core with a \
             write port for the table, into which `glint table` puts other functions.")
            .joined_later(),
        images: TableEntries = Key::records("images", &[], image_fields(), Some("formula"), 0..=16,
            "Further functions of x for a writable table, each with a name. The table is planned so that it holds every \
             one of them, and Glint writes an image of the table for each.")
            .only_when("approximation.tables", "writable")
            .joined_later(),
    }
}

fn image_fields() -> Vec<Key> {
    vec![Key::text("formula", "x^2", TextPattern::Formula, "The function of the operand x.")]
}

/// Returns the function that a configuration states, with its domain, its formats and its error.
///
/// # Errors
/// Fails if the formula, the samples or the domain are wrong. The error names the key to change.
pub(super) fn stated_function(keys: &Keys) -> Result<TargetFunction, ConfigError> {
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

/// Returns the remedy for a domain whose raw operands have too many bits.
fn too_wide(from: &End, to: &End, fraction: u32) -> String {
    let bits = |end: &End| i128::BITS - end.ceiling.unsigned_abs().leading_zeros();
    let excess = bits(from).max(bits(to)) - (MAX_WIDTH - 2);
    match fraction.checked_sub(excess) {
        Some(fewer) => format!("set operand.fraction to at most {fewer}, or set a smaller domain"),
        None => "set a smaller domain: change function.from or function.to".to_owned(),
    }
}

pub(super) fn misread(key: &'static str, fault: Fault) -> ConfigError {
    let remedy = "write a formula of numbers, pi, e, + - * / ^, parentheses and functions, for example `1 / \
                  sqrt(x)`";
    ConfigError::new(key, fault.message, remedy).at(fault.span.bytes)
}

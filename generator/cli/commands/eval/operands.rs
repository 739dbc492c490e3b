//! Parses the operands that a user gives on the command line. For example, `0.99` is a real value, and `#1038090` a raw
//! integer.

use crate::commands::none_of;
use glint_core::cosim::trial;
use glint_golden::{Contract, Operand};

/// Parses settings of the form `name=value`. Returns the raw operands in the order of `operands`, with `None` for an operand
/// without a setting.
///
/// # Errors
/// Fails if a setting has no `=`, if an operand is unknown or set twice, or if a value is not valid for the operand's format.
pub fn given(operands: &[Operand], settings: &[String]) -> Result<Vec<Option<i64>>, String> {
    let mut raw: Vec<Option<i64>> = vec![None; operands.len()];
    for setting in settings {
        let (name, text) = setting.split_once('=').ok_or_else(|| {
            format!("`{setting}` is not of the form operand=value, for example cos_gamma=0.99")
        })?;
        let at = position(operands, name)?;
        if raw[at].is_some() {
            return Err(format!("operand `{name}` is given twice"));
        }
        raw[at] = Some(named_value(&operands[at], text)?);
    }
    Ok(raw)
}

/// Returns the index of an operand. The message about an unknown name has the most similar name.
pub fn position(operands: &[Operand], name: &str) -> Result<usize, String> {
    operands.iter().position(|operand| operand.name == name).ok_or_else(|| {
        let names: Vec<&str> = operands.iter().map(|operand| operand.name.as_str()).collect();
        format!("there is no operand `{name}`{}", none_of(name, "operands", &names))
    })
}

/// Gives 0, or the value nearest to 0 in its domain, to each operand that is `None` in `given`. For example, an exponent with
/// the domain 1 to 255 gets 1.
pub fn completed(contract: &dyn Contract, given: &[Option<i64>]) -> Vec<i64> {
    let operands = contract.operands().iter().zip(given);
    let value =
        |(operand, given): (&Operand, &Option<i64>)| given.unwrap_or(nearest_to_zero(operand));
    operands.map(value).collect()
}

fn nearest_to_zero(operand: &Operand) -> i64 {
    let (low, high) = operand.domain;
    0.clamp(low, high)
}

/// Gives a value at which the results are well inside their ranges to each operand that is `None` in `given`. A colour gets
/// its largest value.
pub fn typical(contract: &dyn Contract, given: &[Option<i64>]) -> Vec<i64> {
    let typical = trial::typical(contract, given);
    let each = contract.operands().iter().zip(given).zip(typical);
    let each = each.map(|((operand, given), typical)| {
        given.unwrap_or(if operand.colour { operand.domain.1 } else { typical })
    });
    each.collect()
}

/// Returns the operands that are `None` in `given`, with the values of [`completed`]. For example, `green = 0` and `blue = 0`.
pub fn missing(contract: &dyn Contract, given: &[Option<i64>]) -> Vec<String> {
    let operands = contract.operands().iter().zip(given);
    let missing = operands.filter(|(_, given)| given.is_none()).map(|(operand, _)| {
        let value = operand.format.to_f64(i128::from(nearest_to_zero(operand)));
        format!("{} = {value}", operand.name)
    });
    missing.collect()
}

/// Parses the value of an operand to a raw value. For example, `0.5` and `#128` both give 128 for an operand with 8 fraction
/// bits.
///
/// # Errors
/// Fails if the text is not a number, if the number exceeds the format or has more than 63 bits, or if it is a fraction and the
/// format has only integers. The message names the operand.
pub fn named_value(operand: &Operand, text: &str) -> Result<i64, String> {
    value(operand, text).map_err(|why| format!("operand `{}`: {why}", operand.name))
}

fn value(operand: &Operand, text: &str) -> Result<i64, String> {
    let format = operand.format;
    let raw = if let Some(integer) = text.strip_prefix('#') {
        let raw: i128 = integer
            .parse()
            .map_err(|_| format!("`{text}` is not a raw integer, for example #1038090"))?;
        if !format.holds(raw) {
            return Err(format!(
                "the raw integer {raw} is outside the range of {format}, {} to {}",
                format.min_raw(),
                format.max_raw()
            ));
        }
        raw
    } else {
        let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
        if !value.is_finite() {
            return Err(format!("`{text}` is not a finite number"));
        }
        let Some(raw) = format.nearest_raw(value) else {
            let (least, most) = (format.to_f64(format.min_raw()), format.to_f64(format.max_raw()));
            return Err(format!("{value} is outside the range of {format}, {least} to {most}"));
        };
        // A fraction is rounded to the nearest value of the format. A user who writes a fraction for an integer probably means
        // another operand, or another scale, so this is an error.
        if format.frac == 0 && value.fract() != 0.0 {
            return Err(format!(
                "{value} is not an integer, and the format {format} has only integers"
            ));
        }
        raw
    };
    i64::try_from(raw).map_err(|_| format!("{raw} has more than 63 bits"))
}

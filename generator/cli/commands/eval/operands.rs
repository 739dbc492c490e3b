//! Parses the operands that a user gives on the command line: `0.99` is a value, `#1038090` a raw integer.

use crate::commands::none_of;
use glint_core::cosim::trial;
use glint_golden::{Contract, Operand};

/// Returns the raw operands that `name=value` settings give, in the order of `operands`; `None` for one without a
/// setting.
///
/// # Errors
/// Fails if a setting has no `=`, if an operand is unknown or set twice, or if a value is no number of its format.
pub fn given(operands: &[Operand], settings: &[String]) -> Result<Vec<Option<i64>>, String> {
    let mut raw: Vec<Option<i64>> = vec![None; operands.len()];
    for setting in settings {
        let (name, text) = setting
            .split_once('=')
            .ok_or_else(|| format!("`{setting}` is not operand=value, as in cos_gamma=0.99"))?;
        let at = position(operands, name)?;
        if raw[at].is_some() {
            return Err(format!("operand `{name}` is given twice"));
        }
        raw[at] = Some(named_value(&operands[at], text)?);
    }
    Ok(raw)
}

/// Returns the index of an operand among `operands`. It fails for any other name, and the message has the nearest name.
pub fn position(operands: &[Operand], name: &str) -> Result<usize, String> {
    operands.iter().position(|operand| operand.name == name).ok_or_else(|| {
        let names: Vec<&str> = operands.iter().map(|operand| operand.name.as_str()).collect();
        format!("there is no operand `{name}`{}", none_of(name, "operands", &names))
    })
}

/// Returns all operands. An operand that is not given is 0, or the value nearest to 0 in its domain. For example, an
/// exponent with the domain 1 to 255 is 1.
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

/// Returns all operands. An operand that is not given gets a value at which the results are well inside their ranges.
/// A colour gets the largest value.
pub fn typical(contract: &dyn Contract, given: &[Option<i64>]) -> Vec<i64> {
    let typical = trial::typical(contract, given);
    let each = contract.operands().iter().zip(given).zip(typical);
    let each = each.map(|((operand, given), typical)| {
        given.unwrap_or(if operand.colour { operand.domain.1 } else { typical })
    });
    each.collect()
}

/// Returns the operands that are not given, with the values that [`completed`] gives them. For example, `green = 0` and
/// `blue = 0`.
pub fn missing(contract: &dyn Contract, given: &[Option<i64>]) -> Vec<String> {
    let operands = contract.operands().iter().zip(given);
    let missing = operands.filter(|(_, given)| given.is_none()).map(|(operand, _)| {
        let value = operand.format.to_f64(i128::from(nearest_to_zero(operand)));
        format!("{} = {value}", operand.name)
    });
    missing.collect()
}

/// Returns the raw value that a text gives to an operand. The error message names the operand. For example, `0.5` and
/// `#128` both give 128 to an operand with 8 fraction bits.
pub fn named_value(operand: &Operand, text: &str) -> Result<i64, String> {
    value(operand, text).map_err(|why| format!("operand `{}`: {why}", operand.name))
}

fn value(operand: &Operand, text: &str) -> Result<i64, String> {
    let format = operand.format;
    let raw = if let Some(integer) = text.strip_prefix('#') {
        let raw: i128 = integer
            .parse()
            .map_err(|_| format!("`{text}` is not a raw integer, as in #1038090"))?;
        if !format.holds(raw) {
            return Err(format!(
                "raw integer {raw} is beyond {format}: {} to {}",
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
            return Err(format!("{value} is beyond {format}: {least} to {most}"));
        };
        // A fraction is rounded to the nearest that the format has; who writes one for an integer means another
        // operand, or another scale.
        if format.frac == 0 && value.fract() != 0.0 {
            return Err(format!("{value} is not an integer, and {format} holds integers"));
        }
        raw
    };
    i64::try_from(raw).map_err(|_| format!("{raw} has more than 63 bits"))
}

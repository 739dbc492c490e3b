//! Parses the operands on the command line. For example, `0.99` is a real value, and `#1038090` a raw integer.

use crate::commands::none_of;
use glint_core::cosim::trial;
use glint_golden::{Contract, Operand};

/// Parses settings of the form `name=value`, and `n=0.5,0,1` for the list `n` of an expression. Returns the raw operands in the order
/// of `operands`, with `None` for an operand without a setting.
///
/// # Errors
/// Fails if a setting has no `=`, if an operand is unknown or set twice. Fails if a value is not valid for the operand's format,
/// or if a list has another number of values.
pub fn given(operands: &[Operand], settings: &[String]) -> Result<Vec<Option<i64>>, String> {
    let mut raw: Vec<Option<i64>> = vec![None; operands.len()];
    for setting in settings {
        let (name, text) = setting.split_once('=').ok_or_else(|| {
            format!("`{setting}` is not of the form operand=value, for example cos_gamma=0.99")
        })?;
        let numbers = numbers_of_list(operands, name);
        let (places, texts) = if numbers.is_empty() {
            (vec![position(operands, name)?], vec![text])
        } else {
            (numbers, text.split(',').collect())
        };
        if places.len() != texts.len() {
            let (count, given) = (places.len(), texts.len());
            return Err(format!(
                "the list `{name}` has {count} numbers, and {given} are given: `{text}`"
            ));
        }
        for (at, text) in places.into_iter().zip(texts) {
            if raw[at].is_some() {
                return Err(format!("operand `{}` is given twice", operands[at].name));
            }
            raw[at] = Some(named_value(&operands[at], text)?);
        }
    }
    Ok(raw)
}

/// Returns the indices of the operands for the list `name`: `n_0`, `n_1` and so on, or `nx`, `ny` and so on. Returns none if an
/// operand is called `name`, or if there is only one such operand.
fn numbers_of_list(operands: &[Operand], name: &str) -> Vec<usize> {
    let is_number = |operand: &Operand| match operand.name.strip_prefix(name) {
        Some(end) => match end.strip_prefix('_') {
            Some(place) => !place.is_empty() && place.bytes().all(|digit| digit.is_ascii_digit()),
            None => end.len() == 1 && end.bytes().all(|axis| axis.is_ascii_lowercase()),
        },
        None => false,
    };
    if operands.iter().any(|operand| operand.name == name) {
        return Vec::new();
    }
    let numbers: Vec<usize> = (0..operands.len()).filter(|&at| is_number(&operands[at])).collect();
    if numbers.len() < 2 { Vec::new() } else { numbers }
}

/// Returns the name of an operand's port. For example, `n.x` and `v[0]`, as formulas write the numbers of lists, have the ports
/// `nx` and `v_0`.
fn port_name(name: &str) -> String {
    name.replace('.', "").replace('[', "_").replace(']', "")
}

/// Returns the index of the operand `name`. The error for an unknown name suggests the most similar name.
pub fn position(operands: &[Operand], name: &str) -> Result<usize, String> {
    let port = port_name(name);
    operands.iter().position(|operand| operand.name == port).ok_or_else(|| {
        let names: Vec<&str> = operands.iter().map(|operand| operand.name.as_str()).collect();
        format!("there is no operand `{name}`{}", none_of(name, "operands", &names))
    })
}

/// Returns the raw operands. An operand that is `None` in `given` is 0, or the value nearest to 0 in its domain. For example, an
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

/// Returns the raw operands. An operand that is `None` in `given` gets a value at which the results are well inside their ranges;
/// a colour gets its largest value.
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

/// Parses an operand's value to a raw value. For example, `0.5` and `#128` both give 128 for an operand with 8 fraction bits.
///
/// # Errors
///
/// Fails if the text is not a number. Fails if the number exceeds the format or has more than 63 bits, or if it is a fraction and
/// the format has only integers. The message names the operand.
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

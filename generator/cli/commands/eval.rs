//! `eval`.

use std::path::Path;

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use super::load_one;
use crate::cli::failure::Usage;
use crate::cli::{Output, tables};
use crate::config;
use crate::golden::{Model, Operand};
use crate::registry::Registry;

/// More clocks than any device takes.
const LIMIT: u64 = 1 << 16;

/// `glint eval`.
pub fn eval(
    registry: &Registry,
    output: Output,
    config: &Path,
    settings: &[String],
) -> Result<bool> {
    let one = load_one(registry, &registry.schemas(), config)?;
    let contract = one.unit.contract.as_ref();
    let operands = contract.operands();
    let raw = operand_values(operands, settings).map_err(Usage)?;
    let mut model = (one.unit.device.model)(&one.unit.config);
    let signals = point(model.as_mut(), operands, &raw)?;
    let control = operands.iter().filter(|operand| !operand.colour).count();
    let inside = operands
        .iter()
        .zip(&raw)
        .all(|(operand, raw)| (operand.domain.0..=operand.domain.1).contains(raw));
    // Of several results, the first.
    let f = contract.reference(&contract.point(&raw[..control], 0));
    let exact: Vec<f64> = operands[control..]
        .iter()
        .zip(&raw[control..])
        .map(|(operand, &raw)| f * operand.format.to_f64(i128::from(raw)))
        .collect();
    let value_of = |name: &str, bits: u64| {
        let net = one.unit.design.find(name).map(|id| one.unit.design.net(id));
        net.map_or((i128::from(bits), bits as f64, String::new()), |net| {
            let raw = net.format.raw(bits);
            (raw, net.format.to_f64(raw), net.format.to_string())
        })
    };
    if output.json {
        let signals: Vec<Value> = signals
            .iter()
            .map(|(name, bits)| {
                let (raw, value, format) = value_of(name, *bits);
                json!({ "name": name, "raw": raw as i64, "value": value, "format": format })
            })
            .collect();
        let operands: Vec<Value> = operands
            .iter()
            .zip(&raw)
            .map(|(operand, &raw)| {
                let value = operand.format.to_f64(i128::from(raw));
                json!({ "name": operand.name, "raw": raw, "value": value, "format": operand.format.to_string() })
            })
            .collect();
        tables::print_json(&json!({
            "config": one.path,
            "operands": operands,
            "inside_the_domain": inside,
            "signals": signals,
            "formula": { "f": f, "outputs": exact },
        }));
        return Ok(true);
    }
    let rows = operands.iter().zip(&raw).map(|(operand, &raw)| {
        vec![
            operand.name.clone(),
            operand.format.to_string(),
            raw.to_string(),
            operand.format.to_f64(i128::from(raw)).to_string(),
        ]
    });
    tables::print(&["operand", "format", "raw", "value"], &["raw", "value"], rows);
    let rows = signals.iter().map(|(name, bits)| {
        let (raw, value, format) = value_of(name, *bits);
        vec![name.clone(), format, raw.to_string(), value.to_string()]
    });
    tables::print(&["golden, when valid", "format", "raw", "value"], &["raw", "value"], rows);
    tables::print_line(&format!("formula in f64: f = {f}"));
    for (name, exact) in contract.outputs().iter().zip(exact) {
        tables::print_line(&format!("  {name} = {exact:.6}"));
    }
    if !inside {
        tables::print_line("The operands are outside the domain for which the contract is stated.");
    }
    Ok(true)
}

/// Raw operands from `name=value`.
fn operand_values(operands: &[Operand], settings: &[String]) -> Result<Vec<i64>, String> {
    let mut raw: Vec<Option<i64>> = vec![None; operands.len()];
    for setting in settings {
        let (name, text) = setting
            .split_once('=')
            .ok_or_else(|| format!("`{setting}` is not operand=value, as in cos_gamma=0.99"))?;
        let Some(at) = operands.iter().position(|operand| operand.name == name) else {
            let names: Vec<&str> = operands.iter().map(|operand| operand.name.as_str()).collect();
            let near = config::nearest(name, names.iter().copied())
                .map_or_else(|| ".".to_owned(), |near| format!("; did you mean `{near}`?"));
            return Err(format!(
                "there is no operand `{name}`{near} The operands are: {}",
                names.join(", ")
            ));
        };
        if raw[at].is_some() {
            return Err(format!("operand `{name}` is given twice"));
        }
        let value = operand_value(&operands[at], text);
        raw[at] = Some(value.map_err(|fault| format!("operand `{name}`: {fault}"))?);
    }
    Ok(operands
        .iter()
        .zip(raw)
        .map(|(operand, raw)| {
            let (low, high) = operand.domain;
            raw.unwrap_or(if operand.colour { high } else { low.midpoint(high) })
        })
        .collect())
}

fn operand_value(operand: &Operand, text: &str) -> Result<i64, String> {
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
        // It saturates: what is further off than a rounding does not fit.
        let raw = format.quantise(value);
        if (format.to_f64(raw) - value).abs() >= format.to_f64(1) {
            let (least, most) = (format.to_f64(format.min_raw()), format.to_f64(format.max_raw()));
            return Err(format!("{value} is beyond {format}: {least} to {most}"));
        }
        raw
    };
    i64::try_from(raw).map_err(|_| format!("{raw} has more than 63 bits"))
}

/// Writes the operands, starts, and returns all signals in the clock in which `valid` is high.
fn point(model: &mut dyn Model, operands: &[Operand], raw: &[i64]) -> Result<Vec<(String, u64)>> {
    let mut inputs = vec![0; model.inputs().len()];
    let names = model.inputs().to_vec();
    let set = |inputs: &mut Vec<u64>, name: &str, bits: u64| {
        if let Some(at) = names.iter().position(|other| other == name) {
            inputs[at] = bits;
        }
    };
    model.clock(&inputs);
    set(&mut inputs, "rst_n", 1);
    for (operand, &raw) in operands.iter().zip(raw) {
        set(&mut inputs, &operand.name, operand.format.bits(i128::from(raw)));
        set(&mut inputs, &format!("{}_write", operand.name), 1);
    }
    set(&mut inputs, "start", 1);
    model.clock(&inputs);
    inputs.fill(0);
    set(&mut inputs, "rst_n", 1);
    let valid = model
        .signals()
        .iter()
        .position(|name| name == "valid")
        .context("the golden model does not predict `valid`")?;
    for _ in 0..LIMIT {
        if model.values()[valid] == 1 {
            let values = model.values().to_vec();
            return Ok(model.signals().iter().cloned().zip(values).collect());
        }
        model.clock(&inputs);
    }
    bail!("the device does not raise `valid` within {LIMIT} clocks")
}

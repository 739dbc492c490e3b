//! Parses operand values that the user gives for an exhaustive check in place of the contract's own values.
//!
//! For example, `cos_dgamma=908094,950000..960000/1000` names the operand `cos_dgamma`, one raw value, and a range with the step
//! 1000.

use std::str::FromStr;

use anyhow::{Result, ensure};

use glint_base::text::grouped;
use glint_golden::{Contract, Sweep, Values};

/// A longer list is probably a typing error.
const MOST_VALUES: usize = 1 << 20;

/// The raw values of one operand that the user gives for an exhaustive check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AxisValues {
    name: String,
    /// Ascending, without duplicates.
    values: Vec<i64>,
}

impl FromStr for AxisValues {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{text}` is not OPERAND=VALUES: give raw values such as 5,7 and ranges such as 0..1000 or \
                 0..1000/10, with at most {} values in all",
                grouped(MOST_VALUES as u64)
            )
        };
        let (name, list) = text.split_once('=').ok_or_else(wrong)?;
        let mut values = Vec::new();
        for item in list.split(',') {
            let (first, last, step) = range(item).ok_or_else(wrong)?;
            let room = MOST_VALUES - values.len();
            let some = (first..=last).step_by(step);
            values.extend(some.take(room + 1));
            if values.len() > MOST_VALUES || first > last {
                return Err(wrong());
            }
        }
        values.sort_unstable();
        values.dedup();
        Ok(Self { name: name.to_owned(), values })
    }
}

/// Parses first value, last value and step: `0..1000/10` gives (0, 1000, 10), and `5` gives (5, 5, 1).
fn range(item: &str) -> Option<(i64, i64, usize)> {
    let Some((first, rest)) = item.split_once("..") else {
        let value = item.parse().ok()?;
        return Some((value, value, 1));
    };
    let (last, step) = rest.split_once('/').unwrap_or((rest, "1"));
    let step: usize = step.parse().ok()?;
    if step == 0 {
        return None;
    }
    Some((first.parse().ok()?, last.parse().ok()?, step))
}

/// Returns the operand values that an exhaustive check visits. The values in `others` replace the contract's own values of the
/// same operand. In the returned sweep, `omits` names each operand whose range is no longer whole.
///
/// # Errors
/// Fails if an operand is named twice, if the contract's sweep does not have it, or if a value is outside the operand's domain.
pub fn sweep(contract: &dyn Contract, others: &[AxisValues]) -> Result<Sweep> {
    let mut sweep = contract.sweep();
    for (at, AxisValues { name, .. }) in others.iter().enumerate() {
        let is_named_before = others[..at].iter().any(|other| other.name == *name);
        ensure!(!is_named_before, "the operand `{name}` is given twice");
    }
    for AxisValues { name, values } in others {
        let names: Vec<String> = sweep.axes.iter().map(|axis| axis.name.clone()).collect();
        let axis = sweep.axes.iter_mut().find(|axis| axis.name == *name);
        let Some(axis) = axis else {
            anyhow::bail!(
                "the check does not visit an operand `{name}`; its operands are {}",
                names.join(", ")
            );
        };
        let operand = contract.operands().iter().find(|operand| operand.name == *name);
        let domain = match (&axis.values, operand) {
            (_, Some(operand)) => operand.domain,
            (Values::Range(low, high), None) => (*low, *high),
            (Values::List(list), None) => (list[0], list[list.len() - 1]),
        };
        let outside = values.iter().find(|&value| !(domain.0..=domain.1).contains(value));
        if let Some(outside) = outside {
            anyhow::bail!(
                "`{name}` is from {} to {} in this check, and {outside} is outside",
                domain.0,
                domain.1
            );
        }
        if let Values::Range(..) = axis.values {
            if values.len() as u64 == axis.values.count() {
                continue;
            }
            let left_out = format!("values of {name} that are not named");
            sweep.omits = match sweep.omits.as_str() {
                "" => left_out,
                omits => format!("{omits}; {left_out}"),
            };
        }
        axis.values = Values::List(values.clone());
    }
    Ok(sweep)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_single_ones_and_ranges() {
        let parsed: AxisValues = "n=7,0..10/5,7".parse().expect("values");
        assert_eq!(parsed, AxisValues { name: "n".to_owned(), values: vec![0, 5, 7, 10] });
        for wrong in ["n", "n=", "n=1..", "n=3..1", "n=0..9/0", "n=x", "n=0..9999999999"] {
            let message = AxisValues::from_str(wrong).expect_err(wrong);
            assert!(message.contains("0..1000/10"), "{message}");
        }
    }
}

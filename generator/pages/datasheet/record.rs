//! The record of an exhaustive check, as `glint cosim --exhaustive --json` writes it.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use crate::core::Unit;
use crate::golden::Values;

/// How near a recorded bound must come to that of the configuration.
const SAME: f64 = 1e-9;

/// What the check found.
#[derive(Clone, Debug, Deserialize)]
pub struct Proof {
    device: String,
    axes: Vec<Axis>,
    bound: f64,
    /// Evaluations of f.
    pub evaluations: u64,
    /// Words f times colours.
    pub colour_products: u64,
    /// The largest error of f.
    pub f: Peak,
    /// The largest error of an output that the check allows for, in output units.
    pub together: f64,
    /// Whether the bound held everywhere.
    pub holds: bool,
}

/// The largest error of f.
#[derive(Clone, Debug, Deserialize)]
pub struct Peak {
    /// Absolute.
    pub error: f64,
    /// In output units, for the largest colour.
    pub units: f64,
}

#[derive(Clone, Debug, Deserialize)]
struct Axis {
    name: String,
    from: Option<i64>,
    to: Option<i64>,
    #[serde(default)]
    values: Vec<i64>,
}

#[derive(Deserialize)]
struct Record {
    configurations: Vec<Proof>,
}

impl Proof {
    /// Reads a record that is to be of this configuration.
    ///
    /// # Errors
    /// It is no record, or one of another configuration.
    pub fn parse(text: &str, unit: &Unit) -> Result<Self> {
        let record: Record = serde_json::from_str(text)
            .context("it is not what `glint cosim --exhaustive --json` writes")?;
        let [proof] = <[Self; 1]>::try_from(record.configurations)
            .map_err(|all| anyhow::anyhow!("it is about {} configurations", all.len()))?;
        let bound = unit.contract.bound().units;
        let sweep = unit.contract.sweep();
        let same_axes = proof.axes.len() == sweep.axes.len()
            && proof.axes.iter().zip(&sweep.axes).all(|(found, axis)| {
                found.name == axis.name
                    && match &axis.values {
                        Values::Range(low, high) => {
                            (found.from, found.to) == (Some(*low), Some(*high))
                        }
                        Values::List(values) => found.values == *values,
                    }
            });
        ensure!(
            proof.device == unit.device.name && (proof.bound - bound).abs() < SAME && same_axes,
            "it is of another configuration; `glint cosim --exhaustive --json` makes a new one"
        );
        Ok(proof)
    }
}

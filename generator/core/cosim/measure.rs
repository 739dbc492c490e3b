//! Measures how far the results of a device are from its formula, which is evaluated in f64.

use anyhow::{Context, Result, ensure};

use super::outcome::{ROUNDING_OF_F64, StreamRecord, Worst};
use glint_base::fixed::{Format, MAX_WIDTH, exp2};
use glint_golden::{Contract, Output, nearer};
use glint_rtl::netlist::{Design, NetId};

/// Measures the errors of a contract's outputs against the formula in f64, one result at a time, and keeps the largest error.
/// The outputs come from the signals that a run of the co-simulation compares.
pub(super) struct Measure<'a> {
    pub(super) contract: &'a dyn Contract,
    outputs: Vec<OutputQuantity>,
}

struct OutputQuantity {
    /// The index of the output among the compared signals.
    at: usize,
    format: Format,
    /// The weight of the last bit of the output, and the inverse of this weight.
    unit: f64,
    per_unit: f64,
    /// The largest bound of any output, divided by the bound of this output. This factor makes the errors of outputs with
    /// different bounds comparable.
    weight: f64,
}

impl OutputQuantity {
    fn value(&self, bits: u64) -> f64 {
        if self.format.signed {
            let drop = MAX_WIDTH - self.format.width();
            ((bits << drop) as i64 >> drop) as f64 * self.unit
        } else {
            bits as f64 * self.unit
        }
    }
}

impl<'a> Measure<'a> {
    /// Fails if an output is not among `nets`, or has another format in the design.
    pub(super) fn new(design: &Design, contract: &'a dyn Contract, nets: &[NetId]) -> Result<Self> {
        let weights = contract.bounds().weights(ROUNDING_OF_F64);
        let quantity = |(number, Output { name, format }): (usize, &Output)| {
            let at = |net| Some((nets.iter().position(|&it| it == net)?, net));
            let (at, net) = (design.find(name).and_then(at)).with_context(|| {
                format!("the contract has an output `{name}`, and the design has no such net")
            })?;
            let real = design.net(net).format;
            ensure!(
                real == *format,
                "the output `{name}` has the format {format} in the contract and {real} in the design"
            );
            Ok(OutputQuantity {
                at,
                format: real,
                unit: exp2(-real.frac),
                per_unit: exp2(real.frac),
                weight: weights[number],
            })
        };
        let outputs = contract.outputs().iter().enumerate().map(quantity).collect::<Result<_>>()?;
        Ok(Self { contract, outputs })
    }

    /// `operands` are raw, in the order of `Contract::operands`.
    pub(super) fn inside(&self, operands: &[i64]) -> bool {
        let mut pairs = self.contract.operands().iter().zip(operands);
        pairs.all(|(operand, raw)| (operand.domain.0..=operand.domain.1).contains(raw))
    }

    /// Counts the word `f` of one result if the device is a highlight, and updates the largest error in `seen`. `values` has
    /// the compared signals, and `index` is the number of the result in its computation, from 0. The raw `operands` must be
    /// inside the domain.
    #[inline]
    pub(super) fn note(
        &self,
        seen: &mut StreamRecord,
        operands: &[i64],
        index: u64,
        values: &[u64],
    ) {
        seen.exact.clear();
        if let Some(highlight) = self.contract.highlight() {
            let f = highlight.measured(operands, index, &mut seen.point, &mut seen.exact);
            seen.histogram.add(highlight.f_format(), f);
        } else {
            self.contract.exact(operands, index, &mut seen.exact);
        }
        let mut largest = (seen.worst.as_ref().map_or(-1.0, |worst| worst.weighted), None);
        for (number, (output, &exact)) in self.outputs.iter().zip(&seen.exact).enumerate() {
            let units = nearer(output.value(values[output.at]), exact) * output.per_unit;
            let weighted = units * output.weight;
            if weighted > largest.0 {
                largest = (weighted, Some((number, units)));
            }
        }
        let (weighted, Some((number, units))) = largest else {
            return;
        };
        let names = self.contract.operands().iter().map(|it| it.name.clone());
        seen.worst = Some(Worst {
            units,
            weighted,
            output: self.contract.outputs()[number].name.clone(),
            operands: names.zip(operands.iter().copied()).collect(),
        });
    }
}

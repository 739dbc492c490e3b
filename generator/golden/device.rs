//! Makes the golden model and the accuracy contract of a device from one list of its microinstructions.
//!
//! The author of a device declares operands and registers in a [`Frame`] and states each microinstruction's operation. The golden
//! model executes these operations clock by clock. The contract runs the golden model to get the device's results, and compares
//! them with the author's [`Formula`]. For example, this device squares its operand:
//!
//! ```
//! use glint_base::fixed::Format;
//! use glint_golden::device::Formula;
//! use glint_golden::frame::{Frame, idle, step};
//! use glint_golden::{Contract, Term};
//!
//! struct Formulas;
//!
//! impl Formula for Formulas {
//!     fn exact(&self, x: &[f64]) -> Vec<f64> {
//!         vec![x[0] * x[0]]
//!     }
//!
//!     /// Truncation to 4 fraction bits loses at most 15/16 of the last bit.
//!     fn terms(&self, _output: usize) -> Vec<Term> {
//!         vec![Term { key: "width", what: "the square is cut", units: 1.0 - 1.0 / 16.0 }]
//!     }
//! }
//!
//! // The device outputs the square of its operand, truncated to half the fraction bits of the product.
//! let mut frame = Frame::default();
//! let x = frame.operand("x", Format::unsigned(0, 4));
//! let square = frame.register("square", Format::unsigned(0, 4));
//! frame.shows("square_out", square);
//! let squares = step(move |s| s[square] = (s[x] * s[x]) >> 4);
//! let contract = frame.device([idle(), squares, idle().valid().end()]).contract(Formulas);
//! let (mut raw, mut exact) = (Vec::new(), Vec::new());
//! contract.results(&[13], 0, &mut raw);
//! contract.exact(&[13], 0, &mut exact);
//! // 13/16 squared is 10.5625/16.
//! assert_eq!((raw, exact), (vec![10], vec![[0.66015625; 2]]));
//! ```

use super::frame::{ClockedModel, Frame, FrameStep, idle};
use glint_formula::Comparison;

use super::{
    ANY_VALUE, Bound, Bounds, ComputedPart, Contract, Model, Operand, Output, Sweep, Term,
};

/// A computation may take at most this number of clocks. It ends a loop that never ends by mistake.
const LONGEST: u32 = 1 << 20;

/// The smallest bound, in units. A bound below it counts as this one, so errors of outputs with different bounds can be compared.
const LEAST_BOUND: f64 = 1e-6;

/// The result of a computation that never ends: no device outputs it.
const NEVER: i64 = i64::MAX >> 1;

/// A device whose golden model is a list of microinstructions, made by [`Frame::device`].
pub struct Device {
    model: ClockedModel,
    operands: Vec<Operand>,
    outputs: Vec<Output>,
}

impl Frame {
    /// Returns the device that executes the microinstructions `program`, as [`Frame::model`] describes. Panics if `program` is
    /// empty.
    pub fn device(self, program: impl IntoIterator<Item = FrameStep>) -> Device {
        let mut operands = Vec::new();
        for (name, format, domain) in self.operands() {
            let (name, doc) = (name.to_owned(), String::new());
            operands.push(Operand { name, format, domain, clamped: false, colour: false, doc });
        }
        let mut outputs = Vec::new();
        for (name, format) in self.results() {
            outputs.push(Output { name: name.to_owned(), format });
        }
        Device { model: self.model(program), operands, outputs }
    }

    /// Returns the device that runs the parts of the frame one after the other, in the order in which [`Frame::part`] added them.
    /// Each output that is combinational logic gets a register behind it.
    pub fn dataflow(mut self) -> Device {
        let device = match std::mem::take(&mut self.parts) {
            parts if parts.is_empty() => self.device([idle(), idle().valid().end()]),
            parts => self.device(parts.into_iter().chain([idle().valid().end()])),
        };
        let model = device.model.registered().expect("a program that ends with its results");
        Device { model, ..device }
    }
}

impl Device {
    pub fn model(self) -> Box<dyn Model> {
        Box::new(self.model)
    }

    /// Sets the domain of `operand` in the contract to the raw values `low ..= high`. The operand's register may have other
    /// values, for which the contract promises nothing. Panics if the device has no such operand.
    #[must_use]
    pub fn domain(mut self, operand: &str, low: i64, high: i64) -> Self {
        let found = self.operands.iter_mut().find(|it| it.name == operand);
        found.expect("an operand of the device").domain = (low, high);
        self
    }

    /// Declares that the device limits `operand` to its domain before the computation ([`Operand::clamped`]). Panics if the
    /// device has no such operand.
    #[must_use]
    pub fn limits(mut self, operand: &str) -> Self {
        let found = self.operands.iter_mut().find(|it| it.name == operand);
        found.expect("an operand of the device").clamped = true;
        self
    }

    /// Returns the contract. The golden model computes its results, and `formula` gives the exact values.
    pub fn contract(self, formula: impl Formula + 'static) -> Box<dyn Contract> {
        let mut shown = Vec::new();
        for output in &self.outputs {
            shown.extend(self.model.signals().iter().position(|it| *it == output.name));
        }
        let mut contract = OfModel { device: self, shown, weights: Vec::new(), formula };
        contract.weights = contract.bounds().weights(LEAST_BOUND);
        Box::new(contract)
    }
}

/// The exact formula that a device approximates, with the proved bound of the device's error.
pub trait Formula: Send + Sync {
    /// Returns the exact outputs, unrounded, for the values (not raw) of `operands`, in the order in which the frame declares
    /// them.
    fn exact(&self, operands: &[f64]) -> Vec<f64>;

    /// Returns the two values that count as exact for output number `output` if the formula gives `value`. An error is measured
    /// from the nearer one. They differ only if the output wraps. For example, an output in −1 … 1 may be close to −1 or to 1 if
    /// the formula gives 1.
    fn right_values(&self, value: f64, output: usize) -> [f64; 2] {
        let _ = output;
        [value; 2]
    }

    /// Returns whether the contract promises anything about output number `output` for these values of `operands`. A quotient
    /// promises nothing for a divisor of 0.
    fn is_promised(&self, operands: &[f64], output: usize) -> bool {
        let _ = (operands, output);
        true
    }

    /// Appends the raw outputs to `raw` and returns true, if the author can compute them faster than the microprogram. They must
    /// equal the golden model's results.
    fn results(&self, operands: &[i64], raw: &mut Vec<i64>) -> bool {
        let _ = (operands, raw);
        false
    }

    /// Returns the contributions to the error of output number `output`, each a proved upper limit; none if no bound is known.
    fn terms(&self, output: usize) -> Vec<Term> {
        let _ = output;
        Vec::new()
    }

    /// Returns the operations for [`Contract::parts`], by default none.
    fn parts(&self) -> Vec<ComputedPart> {
        Vec::new()
    }

    /// Returns the largest error that the contract allows for output number `output`, in units ([`Bound::limit`]).
    fn limit(&self, output: usize) -> f64 {
        let _ = output;
        1.0
    }

    /// Returns the Python expressions for [`Contract::expressions`], by default none.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns whether an output loses the high bits of a value beyond its format ([`Contract::wraps`]).
    fn wraps(&self) -> bool {
        false
    }

    /// Returns the comparisons for [`Contract::conditions`], by default none.
    fn conditions(&self) -> Option<Vec<Option<Comparison>>> {
        None
    }

    /// Returns raw operands for [`Contract::hint`], by default none.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let _ = unit;
        None
    }

    /// Returns the cases for [`Contract::sweep`], or `None` for all combinations of the operands.
    fn sweep(&self) -> Option<Sweep> {
        None
    }

    /// Returns the error for [`Contract::sweep_error`], or `None` if a case is a set of operands.
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let _ = place;
        None
    }

    /// Returns the remarks for [`Contract::remarks`], by default none.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

struct OfModel<F> {
    device: Device,
    /// The positions of the outputs in the list of the golden model's signals.
    shown: Vec<usize>,
    /// The factors of [`Bounds::weights`], which make the errors of all outputs comparable.
    weights: Vec<f64>,
    formula: F,
}

impl<F> OfModel<F> {
    /// Runs the golden model from power-up with `operands`, and returns the raw outputs of result number `index`. Returns `None`
    /// if the model does not raise `valid` for this result within `LONGEST` clocks.
    fn shown(&self, operands: &[i64], index: u64) -> Option<Vec<i64>> {
        let mut model = self.device.model.clone();
        model.clock(&self.inputs(operands, 1));
        let rest = self.inputs(operands, 0);
        let mut left = index;
        for _ in 0..LONGEST {
            if model.is_valid() {
                if left == 0 {
                    return Some(self.raw_outputs(&model));
                }
                left -= 1;
            }
            model.clock(&rest);
        }
        None
    }

    fn operand_values(&self, raw: &[i64]) -> Vec<f64> {
        let pairs = self.device.operands.iter().zip(raw);
        pairs.map(|(it, &raw)| it.format.to_f64(raw.into())).collect()
    }

    /// Returns all inputs of the model in a clock without reset. `start` and the write strobes have the value `strobe`.
    fn inputs(&self, operands: &[i64], strobe: u64) -> Vec<u64> {
        let mut inputs = vec![1, strobe];
        for (operand, &raw) in self.device.operands.iter().zip(operands) {
            inputs.push(operand.format.bits(raw.into()));
            inputs.push(strobe);
        }
        inputs
    }

    fn raw_outputs(&self, model: &ClockedModel) -> Vec<i64> {
        let mut outputs = Vec::with_capacity(self.shown.len());
        for (&at, output) in self.shown.iter().zip(&self.device.outputs) {
            outputs.push(output.format.raw(model.values()[at]) as i64);
        }
        outputs
    }
}

impl<F: Formula> Contract for OfModel<F> {
    fn operands(&self) -> &[Operand] {
        &self.device.operands
    }

    fn outputs(&self) -> &[Output] {
        &self.device.outputs
    }

    /// Appends the outputs of result number `index`. [`Formula::results`] can compute only result number 0. If the model never
    /// shows the result, each output gets a number whose error exceeds every bound.
    fn results(&self, operands: &[i64], index: u64, raw: &mut Vec<i64>) {
        if index == 0 && self.formula.results(operands, raw) {
            return;
        }
        match self.shown(operands, index) {
            Some(shown) => raw.extend(shown),
            None => raw.extend(self.shown.iter().map(|_| NEVER)),
        }
    }

    fn check(&self) -> Result<(), String> {
        let ends: [fn(&Operand) -> i64; 2] = [|it| it.domain.0, |it| it.domain.1];
        for end in ends {
            let operands: Vec<i64> = self.device.operands.iter().map(end).collect();
            let mut exact = Vec::new();
            self.exact(&operands, 0, &mut exact);
            let (stated, outputs) = (exact.len(), self.device.outputs.len());
            if stated != outputs {
                return Err(format!(
                    "the formula gives {stated} values for {outputs} outputs: give one value for each \
                     output, in the order of `shows`"
                ));
            }
            if self.shown(&operands, 0).is_none() {
                return Err(format!(
                    "the golden model shows no result within {LONGEST} clocks for the operands {operands:?}: one of its \
                     microinstructions must be `valid()`, and each `repeat_while` must end"
                ));
            }
        }
        Ok(())
    }

    fn exact(&self, operands: &[i64], _: u64, values: &mut Vec<[f64; 2]>) {
        let operands = self.operand_values(operands);
        for (output, value) in self.formula.exact(&operands).into_iter().enumerate() {
            let is_promised = self.formula.is_promised(&operands, output);
            values.push(match is_promised {
                true => self.formula.right_values(value, output),
                false => ANY_VALUE,
            });
        }
    }

    fn formula_values(&self, operands: &[i64], _: u64, values: &mut Vec<f64>) {
        values.extend(self.formula.exact(&self.operand_values(operands)));
    }

    fn bounds(&self) -> Bounds {
        let mut outputs = Vec::new();
        for (number, output) in self.device.outputs.iter().enumerate() {
            let limit = self.formula.limit(number);
            let bound = Bound::of(self.formula.terms(number));
            outputs.push(Bound { output: output.name.clone(), limit, ..bound });
        }
        let f = outputs.iter().map(|bound| bound.units).fold(0.0, f64::max);
        Bounds { f, outputs }
    }

    fn expressions(&self) -> Vec<String> {
        self.formula.expressions()
    }

    fn wraps(&self) -> bool {
        self.formula.wraps()
    }

    fn conditions(&self) -> Option<Vec<Option<Comparison>>> {
        self.formula.conditions()
    }

    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        self.formula.hint(unit)
    }

    fn sweep(&self) -> Sweep {
        self.formula.sweep().unwrap_or_else(|| Sweep::all(self.device.operands.iter()))
    }

    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.formula.sweep_error(place).unwrap_or_else(|| {
            let mut largest: f64 = 0.0;
            for (error, weight) in self.errors(place).into_iter().zip(&self.weights) {
                largest = largest.max(error * weight);
            }
            largest
        })
    }

    fn parts(&self) -> Vec<ComputedPart> {
        self.formula.parts()
    }

    fn remarks(&self) -> Vec<String> {
        self.formula.remarks()
    }
}

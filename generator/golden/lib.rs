//! The golden models and the accuracy contracts of the devices.
//!
//! A golden model is a second implementation of a device, written from the formula and the text of its source; it predicts the
//! architectural registers and the outputs on every clock. An accuracy contract states the exact formula of the device, and a
//! bound on its error if the author of the device has proved one.
//!
//! A golden model never sees the hardware description, the netlist or the microcode, so that an error in one of them shows as a
//! difference in simulation. The golden model also computes its own tables, except in four devices. In `blinn` and `gauss` the
//! description and the golden model read the same polynomials ([`glint_keys::decay`]), and in `function` and `expression` the
//! same plan ([`glint_plan`]). Polynomials and plan are compared with the formulas instead, by exhaustive checks or by proofs.

pub mod blinn;
pub mod contract;
pub mod cosine_power;
pub mod cosine_squared;
pub mod curve;
pub mod decay;
pub mod device;
pub mod dot_product;
pub mod expression;
pub mod formulas;
pub mod frame;
pub mod function;
pub mod gauss;
pub mod highlight;
mod inverse_root;
pub mod line;
pub mod lyon;
pub mod narrow;
pub mod normaliser;
pub mod pipeline;
mod plan;
mod polynomial;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
pub mod schlick;
pub mod shading;
pub mod sine;
pub mod threshold;

use std::fmt;

pub use highlight::Highlight;

use glint_base::fixed::{Format, exp2};
use glint_base::text;
use glint_formula::Comparison;

/// A golden model of a device, which predicts every register and output clock by clock.
///
/// The values are bit patterns. All state is zero before the first clock, as in the built-in simulator. A simulation runs many
/// copies of a model, so the copies should share large tables in an `Arc`.
pub trait Model: CloneModel + Send + Sync {
    /// Returns the names of the inputs, in the order in which [`Model::clock`] takes them: `rst_n`, `start`,
    /// and `<operand>` and `<operand>_write` for each operand. The order is the model's own.
    fn inputs(&self) -> &[String];

    /// Returns the names of all signals that the model predicts, in the order of [`Model::values`]; the model chooses this
    /// order.
    ///
    /// A model must predict everything that a device shows: the outputs (`valid`, `busy`, `done`, results and flags); the
    /// sequencer's registers `run` and `word_address`; the register `<operand>_reg` of each operand; and the registers and
    /// counters that the description names. A model may leave out registers inside a block, such as pipeline stages and
    /// synchronous ROMs.
    fn signals(&self) -> &[String];

    /// Performs one rising edge. `inputs` are the bit patterns of the inputs just before the edge, in the order of
    /// [`Model::inputs`].
    fn clock(&mut self, inputs: &[u64]);

    /// Returns the model, in the state after power-up, of a variant of the device: each result that is combinational logic has
    /// a register `<output>_reg` behind it. The microinstruction that raised `valid` loads these registers, and one more after
    /// it raises `valid`. If the device delays `valid`, every microinstruction loads the registers, and the delay becomes one
    /// clock longer. Other outputs do not change. A copy of the model is returned if no result is combinational logic.
    ///
    /// A model made from a [`frame::Frame`] has this variant, unless it does not delay `valid` and a condition decides what
    /// follows a microinstruction with `valid`. Any other model has the variant only if its author wrote it; otherwise the
    /// result is `None`.
    fn with_output_registers(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the model, in the state after power-up, of a variant of the device: each operand register has a register
    /// `<operand>_buffer` in front. The environment may write the buffers at any time. `start` loads the operand registers from
    /// the buffers; an operand that is written in the same clock gets the new value. The last clock of a computation also accepts
    /// `start`, so that the next computation follows at once.
    ///
    /// A model made from a [`frame::Frame`] has this variant; without operands the variant behaves as the model itself. Any
    /// other model has the variant only if its author wrote it; otherwise the result is `None`.
    fn with_operand_buffers(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the model if it was made from a [`frame::Frame`], and `None` otherwise. Only such a model can be a part of
    /// another model.
    fn clocked(&self) -> Option<&frame::ClockedModel> {
        None
    }

    /// Returns the values after the latest edge, in the order of [`Model::signals`].
    fn values(&self) -> &[u64];

    /// Returns the value of the signal `name` after the latest edge, as a bit pattern, or `None` if the model has no such signal.
    fn value(&self, name: &str) -> Option<u64> {
        let at = self.signals().iter().position(|signal| signal == name)?;
        Some(self.values()[at])
    }
}

/// Clones a boxed [`Model`]. Every model that implements [`Clone`] has it.
pub trait CloneModel {
    /// Returns a copy of the model, with its present state.
    fn boxed_clone(&self) -> Box<dyn Model>;
}

impl<M: Model + Clone + 'static> CloneModel for M {
    fn boxed_clone(&self) -> Box<dyn Model> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Model> {
    fn clone(&self) -> Self {
        self.as_ref().boxed_clone()
    }
}

/// An operand of a device as its accuracy contract sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Operand {
    /// The name of the input port.
    pub name: String,
    /// The fixed-point format of the operand's port.
    pub format: Format,
    /// The smallest and largest raw value for which the contract is stated; both are included.
    pub domain: (i64, i64),
    /// Whether the device limits the operand to the domain before it computes, so that the contract also holds for operands outside
    /// the domain, with the nearer end of the domain in their place.
    pub clamped: bool,
    /// Whether this is a colour operand of a highlight device, which multiplies the reflectance `f`. The other operands determine
    /// `f`.
    pub colour: bool,
    /// The meaning of the operand, in one line.
    pub doc: String,
}

/// An output of a device as its accuracy contract sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The name of the output port.
    pub name: String,
    /// The format of the port. The weight of its last bit is the unit in which errors are stated.
    pub format: Format,
}

/// The accuracy contract of a device: the exact formula of each output, and a proven bound on the difference of the output from
/// the formula.
///
/// A device may have any number of outputs, signed or unsigned. A device that multiplies colours by a reflectance f uses a
/// [`Highlight`] as its contract.
pub trait Contract: Send + Sync {
    /// Returns the operands, in the order in which values are passed.
    fn operands(&self) -> &[Operand];

    /// Returns the outputs, in the order in which results are given.
    fn outputs(&self) -> &[Output];

    /// Appends the raw outputs that the device computes from raw operands, which must be in the order of [`Contract::operands`].
    /// If a computation has several results, such as the points of a scan line, `index` is the number of the result, from 0.
    fn results(&self, operands: &[i64], index: u64, raw: &mut Vec<i64>);

    /// Checks that the device shows its results at all. The default implementation always succeeds.
    ///
    /// # Errors
    /// Fails if the device never shows its results. The error says why, with a remedy.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Appends the exact values of each output: the formula in f64, unrounded, at the values that the raw operands represent.
    ///
    /// There are two values for each output, normally equal. If the formula jumps and rounding may lead to either side of the
    /// jump, they are the values on both sides, and an error is measured from the nearer one. [`ANY_VALUE`] means that the
    /// contract promises nothing.
    fn exact(&self, operands: &[i64], index: u64, values: &mut Vec<[f64; 2]>);

    /// Appends the value of the formula of each output, also for operands for which the contract promises nothing. NaN denotes an
    /// output whose formula has no value. For example, the formula x / y has the value 9 for x = 0.9 and y = 0.1, even if the
    /// contract promises results only where x < y.
    fn formula_values(&self, operands: &[i64], index: u64, values: &mut Vec<f64>) {
        let mut exact = Vec::new();
        self.exact(operands, index, &mut exact);
        for sides in exact {
            values.push(if sides == ANY_VALUE { f64::NAN } else { sides[0] });
        }
    }

    /// Returns the proven bounds of the errors of all outputs, which are known before any simulation. A bound without terms is not
    /// stated; `glint certify` may then find one.
    fn bounds(&self) -> Bounds;

    /// Returns the formula of each output as a Python expression ([`highlight::Reflectance::expressions`] has the rules), or an
    /// empty list if nobody has written them. For a highlight the list is empty; [`Highlight::expressions`] has the expressions
    /// of f.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns for each output the comparison under which the error is promised, or `None` for an output whose error is promised
    /// for the whole domain. Returns `None` if the device does not state its promises as comparisons.
    fn conditions(&self) -> Option<Vec<Option<Comparison>>> {
        None
    }

    /// Returns whether an output wraps: a value beyond its format loses its high bits, so that the formula alone does not say
    /// which value is right.
    fn wraps(&self) -> bool {
        false
    }

    /// Returns the contract as a [`Highlight`] if the device multiplies colours by a reflectance f, and `None` for any other
    /// device.
    fn highlight(&self) -> Option<&Highlight> {
        None
    }

    /// Returns raw operands at which an error is likely to show: where the formula is steep, bends or ends. Half of the points
    /// of a test are such points. `unit` returns random numbers from 0 to below 1. A value outside the domain is moved to the
    /// nearest end of the domain.
    ///
    /// With `None`, tests draw points from the whole domain, its ends more often than other values. For a [`Highlight`] they
    /// draw points by the value of its formula.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let _ = unit;
        None
    }

    /// Returns the name of the operand that states how many results a computation has; `None` if a computation has one result.
    /// For example, it is `length` in `quad-cosine`.
    fn length(&self) -> Option<&str> {
        None
    }

    /// Returns the cases of an exhaustive check. By default these are all combinations of the operands.
    fn sweep(&self) -> Sweep {
        Sweep::all(self.operands().iter())
    }

    /// Returns the error in one case of [`Contract::sweep`]. `place` has the value on each axis. By default a case is a set of
    /// operands, and the error is the largest error of any output, in units. Errors of outputs with different bounds are
    /// multiplied by [`Bounds::weights`] first.
    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.largest_error(place)
    }

    /// Returns the error of each output at raw operands, in units, in the first result of the computation.
    fn errors(&self, operands: &[i64]) -> Vec<f64> {
        let (mut raw, mut exact) = (Vec::new(), Vec::new());
        self.results(operands, 0, &mut raw);
        self.exact(operands, 0, &mut exact);
        let mut errors = Vec::with_capacity(raw.len());
        for ((output, raw), exact) in self.outputs().iter().zip(raw).zip(exact) {
            let unit = exp2(-output.format.frac);
            errors.push(nearer(raw as f64, exact.map(|value| value / unit)));
        }
        errors
    }

    /// Returns the largest error of an output at raw operands, in units, in the first result of the computation.
    fn largest_error(&self, operands: &[i64]) -> f64 {
        self.errors(operands).into_iter().fold(0.0, f64::max)
    }

    /// Returns the parts of the computation, in the order in which they are computed; an empty list if the contract does not
    /// know them.
    fn parts(&self) -> Vec<ComputedPart> {
        Vec::new()
    }

    /// Returns remarks about the formula of this configuration for a user, with numbers. For example, a remark may say that
    /// another configuration of the device comes closer to the function that it approximates.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Returns the distance of `value` from the nearer one of the two values in `right`; both are correct results. The distance is
/// infinite if a value in `right` is not finite, since a formula without a value cannot confirm a result. The distance is 0 if
/// `right` is [`ANY_VALUE`]. For example, 2.5 is 0.5 away from the nearer of 2.0 and 4.0.
#[inline]
pub fn nearer(value: f64, right: [f64; 2]) -> f64 {
    let [a, b] = right.map(|right| (value - right).abs());
    // A difference from a number that is not finite is not finite either.
    if a.is_finite() && b.is_finite() {
        a.min(b)
    } else if right == ANY_VALUE {
        0.0
    } else {
        f64::INFINITY
    }
}

/// The exact values of an output for operands for which the contract promises nothing: every value counts as correct.
pub const ANY_VALUE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The cases that an exhaustive check of a contract visits: every combination of the values on its axes.
///
/// An axis is usually an operand. A device with too many combinations of operands may use intermediate values that determine the
/// result as axes instead; [`Contract::sweep_error`] then returns the largest error over all operands that lead to them. An axis
/// may also be a list of settings. `omits` says which operands the check leaves to random tests.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The axes, the outermost loop first.
    pub axes: Vec<Axis>,
    /// The operands that the sweep leaves out, in a sentence; empty when every combination is covered.
    pub omits: String,
}

/// One axis of a [`Sweep`]: an operand or an intermediate value, with the values that the check visits.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The name of the operand, or of the intermediate value that replaces operands.
    pub name: String,
    /// The values that the check visits.
    pub values: Values,
}

/// The values on an [`Axis`] that an exhaustive check visits.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// All integers from the first to the last, both included. For example, `Range(1, 1000)` has 1000 values.
    Range(i64, i64),
    /// The values of this list.
    List(Vec<i64>),
}

impl Sweep {
    /// Returns the sweep of every combination of values of these operands.
    pub fn all<'a>(operands: impl Iterator<Item = &'a Operand>) -> Self {
        Self::ranges(operands.map(|operand| (operand.name.as_str(), operand.domain)))
    }

    /// Returns the sweep of every combination of named values; each value runs from the first to the last number of its range.
    pub fn ranges<'a>(ranges: impl IntoIterator<Item = (&'a str, (i64, i64))>) -> Self {
        let axes = ranges.into_iter().map(|(name, (low, high))| Axis {
            name: name.to_owned(),
            values: Values::Range(low, high),
        });
        Self { axes: axes.collect(), omits: String::new() }
    }

    /// Returns a sentence with the axes and their values. For example, two axes give `cos_gamma = 0 to 1048576 x exponent = 1 to
    /// 1000`.
    pub fn words(&self) -> String {
        let axes: Vec<String> = self.axes.iter().map(Axis::to_string).collect();
        axes.join(" x ")
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.values {
            Values::Range(low, high) => write!(f, "{} = {low} to {high}", self.name),
            Values::List(values) => {
                write!(f, "{} of {}", text::counted(values.len(), "value"), self.name)
            }
        }
    }
}

impl Values {
    /// Returns the number of values on the axis. For example, `Range(1, 1000)` has 1000 values.
    pub fn count(&self) -> u64 {
        match self {
            Self::Range(low, high) => low.abs_diff(*high) + 1,
            Self::List(values) => values.len() as u64,
        }
    }

    /// Returns value number `at`, counted from 0. For example, value 2 of `Range(5, 9)` is 7.
    ///
    /// # Panics
    /// Panics if a list has no value with this number.
    #[inline]
    pub fn value(&self, at: u64) -> i64 {
        match self {
            Self::Range(low, _) => low + at as i64,
            Self::List(values) => values[at as usize],
        }
    }
}

/// The proven bounds on the errors of a contract's outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// The bound on the quantity that a sweep measures: the error of `f` of a highlight, otherwise the largest bound of an output,
    /// in units.
    pub f: f64,
    /// The bound of each output, in the order of the outputs. A contract has at least one output.
    pub outputs: Vec<Bound>,
}

/// A proven bound on the error of an output for all operands of the domain, with the contributions that add up to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// The name of the output.
    pub output: String,
    /// The bound on the error of the output, in units of its last bit. A highlight states it for the largest colour operand.
    pub units: f64,
    /// The bound that the contract demands, in units: the contract is kept if `units` is below it. The bound is 1, or the error
    /// that the configuration allows.
    pub limit: f64,
    /// The contributions, in units of the output, each with the configuration key that governs it. Their sum is `units`.
    pub terms: Vec<Term>,
}

/// A part of a core that computes an expression, for pages that people read.
#[derive(Clone, Debug, PartialEq)]
pub struct ComputedPart {
    /// The name of the net that carries the part's value. The part is one operation of the core's computation, such as `x · y`.
    pub name: String,
    /// The operation that the part computes, as text. For example, `x · y`.
    pub words: String,
    /// The format of the part's value.
    pub format: Format,
    /// The part's share in the error of each output, in units of the output's last bit; 0 for a part that is exact.
    pub shares: Vec<f64>,
    /// An estimate of the look-up tables of four inputs that the part takes. The estimate is 0 for a part that only selects
    /// bits.
    pub cells: f64,
    /// The number of products that the part computes: in a pipeline each takes a multiplier of its own.
    pub products: usize,
}

/// One contribution to a [`Bound`]. For example, `output.rounding` contributes 0.5 units to the bound of `rough`, for the
/// rounding of the colour outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The configuration key that governs the contribution.
    pub key: &'static str,
    /// The operation that rounds or approximates.
    pub what: &'static str,
    /// The size of the contribution, in units of the last bit of an output.
    pub units: f64,
}

impl Bounds {
    /// Makes the bounds of outputs that all have the bound `bound`. `f` is [`Bounds::f`].
    pub fn alike(f: f64, bound: &Bound, outputs: &[Output]) -> Self {
        let named = |output: &Output| Bound { output: output.name.clone(), ..bound.clone() };
        Self { f, outputs: outputs.iter().map(named).collect() }
    }

    /// Returns the bound that is nearest to its limit, or furthest beyond it. Among equal ones, returns the first.
    ///
    /// # Panics
    /// Panics if there are no outputs.
    pub fn governing(&self) -> &Bound {
        let ratio = |bound: &Bound| bound.units / bound.limit;
        let largest = self.outputs.iter().rev().max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        largest.expect("a contract has an output")
    }

    /// Returns the largest bound of an output, in units.
    pub fn governing_units(&self) -> f64 {
        self.outputs.iter().map(|bound| bound.units).fold(0.0, f64::max)
    }

    /// Returns for each output the factor by which its error is multiplied before it is compared with the errors of other outputs:
    /// the largest bound divided by the bound of the output. A bound below `least` counts as `least`, so that no factor is
    /// infinite.
    pub fn weights(&self, least: f64) -> Vec<f64> {
        let largest = self.governing_units();
        let weight = |own: f64| if own == largest { 1.0 } else { largest / own.max(least) };
        self.outputs.iter().map(|bound| weight(bound.units)).collect()
    }

    /// Returns the bound of the output with this name; `None` without such an output.
    pub fn of(&self, output: &str) -> Option<&Bound> {
        self.outputs.iter().find(|bound| bound.output == output)
    }

    /// Returns whether all outputs have the same bound and the same limit.
    pub fn are_alike(&self) -> bool {
        let [first, rest @ ..] = &self.outputs[..] else { return true };
        rest.iter().all(|other| (other.units, other.limit) == (first.units, first.limit))
    }

    /// Returns whether every bound is below its limit.
    pub fn keep(&self) -> bool {
        self.outputs.iter().all(Bound::keeps)
    }

    /// Returns whether the author of the device has stated a bound for every output.
    pub fn are_stated(&self) -> bool {
        self.outputs.iter().all(Bound::is_stated)
    }

    /// Returns the bounds in units as text. For example, `0.969` if all outputs have this bound, and otherwise `0.583 for p_out,
    /// 6.381 for q_out`.
    pub fn words(&self) -> String {
        if self.are_alike() {
            return self.governing().words();
        }
        let each = |bound: &Bound| format!("{} for {}", bound.words(), bound.output);
        let all: Vec<String> = self.outputs.iter().map(each).collect();
        all.join(", ")
    }
}

impl Bound {
    /// Makes the bound of an output without a name, with the limit 1. The bound is the sum of the terms, or infinite if there are
    /// no terms or the sum is NaN.
    pub fn of(terms: Vec<Term>) -> Self {
        let sum: f64 = terms.iter().map(|term| term.units).sum();
        // A sum that is NaN limits nothing.
        let units = if terms.is_empty() || sum.is_nan() { f64::INFINITY } else { sum };
        Self { output: String::new(), units, limit: 1.0, terms }
    }

    /// Returns the bound in units as text, or says that no bound is stated. For example, `rough` has `0.969`.
    pub fn words(&self) -> String {
        if self.is_stated() { text::rounded_up(self.units, 3) } else { "not stated".to_owned() }
    }

    /// Returns whether the bound is small enough: whether `units` is below `limit`. A bound of half a unit also keeps a limit of
    /// half a unit, because rounding to the nearest value has this error.
    pub fn keeps(&self) -> bool {
        self.units < self.limit || self.units == 0.5 && self.limit == 0.5
    }

    /// Returns whether the author of the device has stated a bound.
    pub fn is_stated(&self) -> bool {
        self.units.is_finite()
    }

    /// Returns the largest contribution, whose key a user should change first to reduce the error, or `None` for a bound
    /// without terms. For example, it is `output.rounding` for `rough`, with 0.5 of 0.969 units.
    pub fn limiting(&self) -> Option<&Term> {
        self.terms.iter().max_by(|a, b| a.units.total_cmp(&b.units))
    }
}

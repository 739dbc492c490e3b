//! The golden models and the accuracy contracts of the devices.
//!
//! A golden model is a second implementation of a device, written from the formula and the text of its source. It predicts the
//! architectural registers and the outputs on every clock. An accuracy contract states the exact formula of the device, and a
//! bound on its error if the device's author has proved one.
//!
//! A golden model never sees the hardware description, the netlist or the microcode. An error in one of them therefore shows as a
//! difference in simulation. It also computes its own tables, except in five devices. In `blinn` and `gauss` the description and
//! the golden model read the same polynomials ([`glint_keys::decay`]). In `function`, `expression` and `unit` they read the same
//! plan ([`glint_plan`]).
//!
//! # Symbols
//! c = cos γ, where γ is the angle between the surface normal and the half vector. n is the specular exponent. f is the
//! reflectance, the factor from 0 to 1 by which a highlight multiplies colours or an amplitude. An ulp is one unit in the last
//! place.
//!
//! Seeds 000 to 002 are the documents from which the devices come. Seed 000 is the patent of `quad-cosine`, and seed 001 the
//! patent UA 60139 of `rough`. Seed 002 is the paper "A model for reproducing the specular component of colour in computer
//! graphics" (in Ukrainian).

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
pub mod unit;

use std::fmt;

pub use highlight::Highlight;

use glint_base::fixed::{Format, exp2};
use glint_base::text;
use glint_formula::Comparison;

/// Predicts every register and output of a device clock by clock, as bit patterns.
///
/// All state is zero before the first clock, as in the built-in simulator. A simulation runs many copies of a model, so the
/// copies should share large tables in an `Arc`.
pub trait Model: CloneModel + Send + Sync {
    /// Returns the names of the inputs, in the order in which [`Model::clock`] takes them: `rst_n`, `start`, and `<operand>` and
    /// `<operand>_write` for each operand.
    fn inputs(&self) -> &[String];

    /// Returns the names of all signals that the model predicts, in the order of [`Model::values`].
    ///
    /// A model must predict everything that a device shows. This includes the outputs (`valid`, `busy`, `done`, results and
    /// flags), and the sequencer's registers `run` and `word_address`. It also includes the register `<operand>_reg` of each
    /// operand, and the registers and counters that the description names. It may leave out registers inside a block, such as
    /// pipeline stages and synchronous ROMs.
    fn signals(&self) -> &[String];

    /// Performs one rising edge. `inputs` are the bit patterns of the inputs just before it, in the order of `Model::inputs`.
    fn clock(&mut self, inputs: &[u64]);

    /// Returns the model, after power-up, of a variant of the device: each result that is combinational logic has a register
    /// `<output>_reg` behind it. The microinstruction that raised `valid` loads these registers, and an added microinstruction
    /// after it raises `valid`. If the device delays `valid`, every microinstruction loads the registers, and the delay becomes
    /// one clock longer. Without combinational results the variant is a copy.
    ///
    /// A model made from a [`frame::Frame`] has this variant, with one exception: without a delay of `valid`, a microinstruction
    /// with `valid` must have an unconditional successor.
    fn with_output_registers(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the model, after power-up, of a variant of the device: each operand register has a register `<operand>_buffer` in
    /// front of it. The environment may write the buffers at any time. `start` loads the operand registers from the buffers; an
    /// operand that is written in the same clock gets the new value. The last clock of a computation also accepts `start`, so the
    /// next computation follows at once.
    ///
    /// A model made from a [`frame::Frame`] has this variant.
    fn with_operand_buffers(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the model if it was made from a [`frame::Frame`], otherwise `None`. Only such a model can be a part of a larger
    /// one.
    fn clocked(&self) -> Option<&frame::ClockedModel> {
        None
    }

    /// Returns the values after the latest edge, in the order of [`Model::signals`].
    fn values(&self) -> &[u64];

    /// Returns the bit pattern of the signal `name` after the latest edge, or `None` if the model has no such signal.
    fn value(&self, name: &str) -> Option<u64> {
        let at = self.signals().iter().position(|signal| signal == name)?;
        Some(self.values()[at])
    }
}

/// Clones a boxed [`Model`]. Every `Model` that is [`Clone`] gets it automatically.
pub trait CloneModel {
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

/// An operand of an accuracy contract.
#[derive(Clone, Debug, PartialEq)]
pub struct Operand {
    pub name: String,
    pub format: Format,
    /// The smallest and largest raw value of the domain, for which the contract is stated.
    pub domain: (i64, i64),
    /// Whether the device limits the operand to the domain before it computes. The contract then also holds for operands outside
    /// the domain: they count as the nearest end.
    pub clamped: bool,
    /// Whether a highlight multiplies the reflectance `f` by this operand. The other operands determine `f`.
    pub colour: bool,
    /// A description of one line.
    pub doc: String,
}

/// An output of an accuracy contract.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    pub name: String,
    /// The weight of its last bit is the unit in which errors are stated.
    pub format: Format,
}

/// The exact formula of each output of a device, and a proven bound on the output's difference from it.
pub trait Contract: Send + Sync {
    /// Returns the operands, in the order in which other methods take their values.
    fn operands(&self) -> &[Operand];

    /// Returns the outputs, in the order in which other methods return their values.
    fn outputs(&self) -> &[Output];

    /// Appends the raw outputs for raw `operands` to `raw`. If a computation has several results, such as a scan line's points,
    /// `index` is the number of the result, from 0.
    fn results(&self, operands: &[i64], index: u64, raw: &mut Vec<i64>);

    /// Checks that the device shows its results.
    ///
    /// # Errors
    ///
    /// Fails if it does not. The message has the reason and a remedy.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Appends the exact values of each output: the formula in f64, unrounded.
    ///
    /// There are two values for each output, normally equal. If the formula jumps and rounding may lead to either side of the
    /// jump, they are the values on both sides. An error is then measured from the nearer one. [`ANY_VALUE`] means that the
    /// contract promises nothing.
    fn exact(&self, operands: &[i64], index: u64, values: &mut Vec<[f64; 2]>);

    /// Appends the value of each output's formula, also where the contract promises nothing, or NaN if the formula has none. For
    /// example, x / y is 9 for x = 0.9 and y = 0.1, even if the contract promises results only where x < y.
    fn formula_values(&self, operands: &[i64], index: u64, values: &mut Vec<f64>) {
        let mut exact = Vec::new();
        self.exact(operands, index, &mut exact);
        for sides in exact {
            values.push(if sides == ANY_VALUE { f64::NAN } else { sides[0] });
        }
    }

    /// Returns the proved bounds of the errors of all outputs. A bound without terms is not stated; `glint certify` may then find
    /// one.
    fn bounds(&self) -> Bounds;

    /// Returns each output's formula as a Python expression, by the rules of [`highlight::Reflectance::expressions`], or an empty
    /// list. For a highlight it is empty; [`Highlight::expressions`] has f.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns for each output the comparison under which its error is promised, or `None` if it is promised for the whole
    /// domain. Returns `None` if the device does not state its promises as comparisons.
    fn conditions(&self) -> Option<Vec<Option<Comparison>>> {
        None
    }

    /// Returns whether an output wraps: a value beyond its format loses its high bits, so two values may count as right.
    fn wraps(&self) -> bool {
        false
    }

    /// Returns the contract as a [`Highlight`] if the device multiplies colours by a reflectance f.
    fn highlight(&self) -> Option<&Highlight> {
        None
    }

    /// Returns raw operands at which an error is likely to show: where the formula is steep, bends or ends. Tests draw half of
    /// their points this way. `unit` returns random numbers from 0 to below 1. Values outside the domain are moved to its nearest
    /// end.
    ///
    /// With `None`, tests draw points from the whole domain, its ends more often.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let _ = unit;
        None
    }

    /// Returns the name of the operand that states how many results a computation has, such as `length` in `quad-cosine`; `None`
    /// if it has one result.
    fn length(&self) -> Option<&str> {
        None
    }

    /// Returns the cases of an exhaustive check, by default all combinations of the operands.
    fn sweep(&self) -> Sweep {
        Sweep::all(self.operands().iter())
    }

    /// Returns the error in one case of [`Contract::sweep`]. `place` has the value on each axis. By default a case is a set of
    /// operands, and the error is the largest error of any output, in units. Errors of outputs with different bounds are
    /// multiplied by [`Bounds::weights`] first.
    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.largest_error(place)
    }

    /// Returns the error of each output for raw `operands`, in units of the output's last bit. For a computation with several
    /// results, such as a line's points, these are the first's errors.
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

    /// Returns the largest error of an output in the first result, in units.
    fn largest_error(&self, operands: &[i64]) -> f64 {
        self.errors(operands).into_iter().fold(0.0, f64::max)
    }

    /// Returns the operations of the computation in order; none if the contract does not know them.
    fn parts(&self) -> Vec<ComputedPart> {
        Vec::new()
    }

    /// Returns remarks for a user, with numbers. For example, they say that another configuration comes closer to the function
    /// that the device approximates.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Returns the distance of `value` from the nearer one of the two values `right`: 2.5 is 0.5 away from 2.0 and 4.0. A right value
/// that is not finite gives infinity, because a formula without a value cannot confirm a result. [`ANY_VALUE`] gives 0.
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

/// Takes the place of the exact values if the contract promises nothing: every result counts as right.
pub const ANY_VALUE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The cases of an exhaustive check: every combination of the values on its axes.
///
/// An axis is usually an operand. A device with too many combinations may use intermediate values that determine the result as
/// axes. [`Contract::sweep_error`] then returns the largest error over all operands that give these values.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The axes, the outermost loop first.
    pub axes: Vec<Axis>,
    /// The operands that the sweep leaves to random tests, in a sentence; empty if it covers every combination.
    pub omits: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The name of an operand, or of an intermediate value that replaces operands.
    pub name: String,
    pub values: Values,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// All integers from the first to the last, both included.
    Range(i64, i64),
    List(Vec<i64>),
}

impl Sweep {
    /// Makes the sweep of all values in the domains of `operands`.
    pub fn all<'a>(operands: impl Iterator<Item = &'a Operand>) -> Self {
        Self::ranges(operands.map(|operand| (operand.name.as_str(), operand.domain)))
    }

    /// Makes a sweep from the name, the first and the last value of each axis.
    pub fn ranges<'a>(ranges: impl IntoIterator<Item = (&'a str, (i64, i64))>) -> Self {
        let axes = ranges.into_iter().map(|(name, (low, high))| Axis {
            name: name.to_owned(),
            values: Values::Range(low, high),
        });
        Self { axes: axes.collect(), omits: String::new() }
    }

    /// Returns the axes and their values in words: `cos_gamma = 0 to 1048576 x exponent = 1 to 1000`.
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
    pub fn count(&self) -> u64 {
        match self {
            Self::Range(low, high) => low.abs_diff(*high) + 1,
            Self::List(values) => values.len() as u64,
        }
    }

    /// Returns value number `at`, counted from 0: value 2 of `Range(5, 9)` is 7. Panics if a list has no such value.
    #[inline]
    pub fn value(&self, at: u64) -> i64 {
        match self {
            Self::Range(low, _) => low + at as i64,
            Self::List(values) => values[at as usize],
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// The bound on the quantity that a sweep measures: the error of `f` of a highlight, otherwise the largest bound of an
    /// output, in units.
    pub f: f64,
    /// The bounds in the order of the outputs. There is at least one output.
    pub outputs: Vec<Bound>,
}

/// A proven bound on the error of an output for all operands of the domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    pub output: String,
    /// The bound in units of the last bit of the output. For a highlight, it assumes the largest colour operand.
    pub units: f64,
    /// The contract is kept if `units` is below this limit: 1, or the error that the configuration allows.
    pub limit: f64,
    /// The contributions to `units`, each with the configuration key that governs it.
    pub terms: Vec<Term>,
}

/// An operation of a core that computes an expression. Pages such as the datasheet list it.
#[derive(Clone, Debug, PartialEq)]
pub struct ComputedPart {
    /// The net that carries the value.
    pub name: String,
    /// The operation as text, such as `x · y`.
    pub words: String,
    pub format: Format,
    /// The operation's share in each output's error, in units of the output's last bit; 0 if the operation is exact.
    pub shares: Vec<f64>,
    /// An estimate of the number of look-up tables with four inputs that the operation takes; 0 if it only selects bits.
    pub cells: f64,
    /// The number of products. In a pipeline, each takes a multiplier of its own.
    pub products: usize,
}

/// A contribution to a [`Bound`]. For example, the rounding of the colour outputs of `rough` contributes 0.5 units, and the key
/// `output.rounding` governs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The configuration key that governs the contribution.
    pub key: &'static str,
    /// A description of the operation that rounds or approximates.
    pub what: &'static str,
    /// The contribution, in units of the last bit of an output.
    pub units: f64,
}

impl Bounds {
    /// Gives every output the bound `bound`. `f` is the bound on the quantity that a sweep measures.
    pub fn alike(f: f64, bound: &Bound, outputs: &[Output]) -> Self {
        let named = |output: &Output| Bound { output: output.name.clone(), ..bound.clone() };
        Self { f, outputs: outputs.iter().map(named).collect() }
    }

    /// Returns the bound that is nearest to its limit, or furthest beyond it; the first of several. Panics if there are no
    /// outputs.
    pub fn governing(&self) -> &Bound {
        let ratio = |bound: &Bound| bound.units / bound.limit;
        let largest = self.outputs.iter().rev().max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        largest.expect("a contract has an output")
    }

    pub fn governing_units(&self) -> f64 {
        self.outputs.iter().map(|bound| bound.units).fold(0.0, f64::max)
    }

    /// Returns a factor for each output that makes the errors of all outputs comparable: the largest bound divided by the
    /// output's own bound. A bound below `least` counts as `least`, so no factor is infinite.
    pub fn weights(&self, least: f64) -> Vec<f64> {
        let largest = self.governing_units();
        let weight = |own: f64| if own == largest { 1.0 } else { largest / own.max(least) };
        self.outputs.iter().map(|bound| weight(bound.units)).collect()
    }

    pub fn of(&self, output: &str) -> Option<&Bound> {
        self.outputs.iter().find(|bound| bound.output == output)
    }

    /// Returns whether all outputs have the same bound and the same limit.
    pub fn are_alike(&self) -> bool {
        let [first, rest @ ..] = &self.outputs[..] else { return true };
        rest.iter().all(|other| (other.units, other.limit) == (first.units, first.limit))
    }

    pub fn keep(&self) -> bool {
        self.outputs.iter().all(Bound::keeps)
    }

    /// Returns whether every output has a stated bound.
    pub fn are_stated(&self) -> bool {
        self.outputs.iter().all(Bound::is_stated)
    }

    /// Returns the bounds in units as text: `0.969` for all outputs, or `0.583 for p_out, 6.381 for q_out`.
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
    /// Makes a bound with the limit 1 and no output name. The bound is the sum of the terms; it is infinite if there are no terms
    /// or the sum is NaN.
    pub fn of(terms: Vec<Term>) -> Self {
        let sum: f64 = terms.iter().map(|term| term.units).sum();
        let units = if terms.is_empty() || sum.is_nan() { f64::INFINITY } else { sum };
        Self { output: String::new(), units, limit: 1.0, terms }
    }

    /// Returns the bound in units as text, such as `0.969`, or says that none is stated.
    pub fn words(&self) -> String {
        if self.is_stated() { text::rounded_up(self.units, 3) } else { "not stated".to_owned() }
    }

    /// Returns whether `units` is below `limit`. A bound of half a unit also keeps a limit of half a unit, because rounding to
    /// the nearest value has this error.
    pub fn keeps(&self) -> bool {
        self.units < self.limit || self.units == 0.5 && self.limit == 0.5
    }

    pub fn is_stated(&self) -> bool {
        self.units.is_finite()
    }

    /// Returns the term with the largest contribution. A user should change its key first to reduce the error. For `rough`, this
    /// is `output.rounding` with 0.5 of 0.969 units.
    pub fn limiting(&self) -> Option<&Term> {
        self.terms.iter().max_by(|a, b| a.units.total_cmp(&b.units))
    }
}

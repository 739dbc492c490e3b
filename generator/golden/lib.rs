//! The golden models and the accuracy contracts of the devices. A golden model is a second implementation of a device, from
//! its formula and the source's narrative.
//!
//! A golden model uses only [`glint_base::fixed`] and [`glint_config`]. It never sees the description, the netlist or the
//! microcode, and it computes its own tables. This independence makes the comparison with the simulated hardware meaningful.
//! Four devices are exceptions. Description and golden model of `function`, `blinn` and `gauss` read the same polynomials
//! ([`glint_keys::function`], [`glint_keys::decay`]). The comparison of every control operand with the formula checks these
//! polynomials. Description and golden model of `expression` read the same plan ([`glint_plan`]), whose error against the
//! formulas is proved.

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

/// A clock-by-clock model of a device.
///
/// Values are bit patterns. All state is zero before the first clock, as the built-in simulator's is.
/// A run has many instances; tables are best shared among them (`Arc`).
pub trait Model: CloneModel + Send + Sync {
    /// Returns the names of the inputs, in the order in which [`Model::clock`] takes them: `rst_n`, `start`,
    /// and `<operand>` and `<operand>_write` for each operand. The order is the model's own.
    fn inputs(&self) -> &[String];

    /// Returns the names of everything predicted, in any order.
    ///
    /// Nothing that a device shows may be missing: the outputs (`valid`, `busy`, `done`, results and
    /// flags); the sequencer's registers `run` and `word_address`; the register `<operand>_reg` of each
    /// operand; and the registers and counters of the description by their names. Registers inside a
    /// block (pipeline stages, synchronous ROMs) need not be there.
    fn signals(&self) -> &[String];

    /// Takes one rising edge. `inputs` are the values just before the edge. They must be in the order of [`Model::inputs`].
    fn clock(&mut self, inputs: &[u64]);

    /// Returns the device at power-up with a register `<output>_reg` behind each result that is logic, loaded in the
    /// microinstruction that was to set `valid`; one after it sets `valid`. Other outputs stay as they are.
    ///
    /// A device of a [`frame::Frame`] has it, unless it goes on by a condition from such a microinstruction; for any other
    /// its author writes it, or there is none.
    fn with_output_registers(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the device at power-up with a register `<operand>_buffer` in front of each operand register. The environment
    /// may write the buffers at any time. `start` loads the operand registers from the buffers; an operand that is written in
    /// the same clock gets the new value. The last clock of a computation also accepts `start`, so that the next computation
    /// follows at once.
    ///
    /// A device of a [`frame::Frame`] has this model. For any other device its author must write it, or there is none.
    fn with_operand_buffers(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Returns the model of a [`frame::Frame`], which alone can be a part of another.
    fn clocked(&self) -> Option<&frame::ClockedModel> {
        None
    }

    /// Returns the values after the latest edge, in the order of [`Model::signals`].
    fn values(&self) -> &[u64];

    /// Returns the value of one signal.
    fn value(&self, name: &str) -> Option<u64> {
        let at = self.signals().iter().position(|signal| signal == name)?;
        Some(self.values()[at])
    }
}

/// The clone of a [`Model`], which it has by being [`Clone`].
pub trait CloneModel {
    /// Returns a copy, with the state that it has now.
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
    /// The input port.
    pub name: String,
    /// Its format.
    pub format: Format,
    /// The smallest and largest raw value for which the contract is stated.
    pub domain: (i64, i64),
    /// A colour operand of a highlight multiplies `f`; the others determine it.
    pub colour: bool,
    /// The meaning of the operand, in one line.
    pub doc: String,
}

/// An output of a device as its accuracy contract sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The output port.
    pub name: String,
    /// Its format. Its unit, in which errors are stated, is the last place.
    pub format: Format,
}

/// The accuracy contract of a device: each output is within a proven bound of a formula.
///
/// It may have any number of outputs, with or without a sign. A device that multiplies by a reflectance has
/// a [`Highlight`] for its contract.
pub trait Contract: Send + Sync {
    /// Returns the operands, in the order in which values are passed.
    fn operands(&self) -> &[Operand];

    /// Returns the outputs, in the order in which results are given.
    fn outputs(&self) -> &[Output];

    /// Appends the raw outputs that the device computes from raw operands: of result number `index` (from 0), where a
    /// computation has several. The operands must be in the order of [`Contract::operands`].
    fn results(&self, operands: &[i64], index: u64, raw: &mut Vec<i64>);

    /// Refuses a contract whose results are never shown.
    ///
    /// # Errors
    /// Fails if the results are never shown. The error says why, with a remedy.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Appends a pair of values for each output: the formula in f64, unrounded, at the raw (that is, quantised) operands.
    /// Both values are normally the same. If the formula jumps and fixed point may come out on its other side, they are the
    /// values on both sides. An error is measured from the nearer value. [`ANY_VALUE`] says that nothing is promised.
    fn exact(&self, operands: &[i64], index: u64, values: &mut Vec<[f64; 2]>);

    /// Returns a proven bound on the error, stated before anything is simulated. One without terms is not stated:
    /// `glint certify` may find one.
    fn bound(&self) -> Bound;

    /// Returns the formula of each output, as an expression of Python, as in
    /// [`highlight::Reflectance::expressions`]; none where nobody wrote them. A [`Highlight`] has its own.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns the contract of a device that multiplies by a reflectance.
    fn highlight(&self) -> Option<&Highlight> {
        None
    }

    /// Returns operands at which results say much: where the formula is steep, bends or ends. Half of the points of a test
    /// are such points. `unit` gives numbers from 0 to below 1, drawn evenly. A value outside the domain is moved to its end.
    ///
    /// `None`: points are drawn over the whole domain, its ends more often than the rest. The points of a [`Highlight`] are
    /// drawn by the value of its formula.
    fn hint(&self, unit: &mut dyn FnMut() -> f64) -> Option<Vec<i64>> {
        let _ = unit;
        None
    }

    /// Returns the operand that says how many results a computation has, when one does.
    fn length(&self) -> Option<&str> {
        None
    }

    /// Returns the places of an exhaustive check: by default every combination of the operands.
    fn sweep(&self) -> Sweep {
        Sweep::all(self.operands().iter())
    }

    /// Returns the error at a place of the sweep: by default a place has the operands, and the error is the largest of an
    /// output, in units.
    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.largest_error(place)
    }

    /// Returns the bound of the error of one output, by its number, in units of its last place. It is never above
    /// [`Contract::bound`].
    fn output_bound(&self, output: usize) -> f64 {
        let _ = output;
        self.bound().units
    }

    /// Returns the largest error of an output at raw operands, in units.
    fn largest_error(&self, operands: &[i64]) -> f64 {
        let (mut raw, mut exact) = (Vec::new(), Vec::new());
        self.results(operands, 0, &mut raw);
        self.exact(operands, 0, &mut exact);
        let outputs = self.outputs().iter().zip(&raw).zip(exact);
        let errors = outputs.map(|((output, &raw), exact)| {
            let unit = exp2(-output.format.frac);
            nearer(raw as f64, exact.map(|value| value / unit))
        });
        errors.fold(0.0, f64::max)
    }

    /// Returns facts about the formula itself that a user of this configuration should know, with figures. For example,
    /// another choice of the same device may come closer to the function that it approximates in some part of the domain.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Returns the distance of `value` from the nearer of two right values. It is infinite if either is no finite number, since a
/// formula without a value cannot confirm a result. Every value is right where the contract promises none, as [`ANY_VALUE`]
/// says. For example, 2.5 is 0.5 away from the nearer of 2.0 and 4.0.
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

/// In the place of the right values of an output for operands for which the contract promises nothing.
pub const ANY_VALUE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The places that an exhaustive check visits: the product of its axes.
///
/// A device with too many operands for all combinations may name the values that determine the result (in a highlight, `f`).
/// For example, an axis may be an intermediate word, if [`Contract::sweep_error`] takes the worst error over everything that
/// rounds to it. An axis may also be a list of settings. `omits` must say which operands are left to random points.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The outermost first.
    pub axes: Vec<Axis>,
    /// The operands that the sweep leaves out, in a sentence; empty when every combination is covered.
    pub omits: String,
}

/// One axis of a [`Sweep`].
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The operand, or the value that replaces it.
    pub name: String,
    /// Its values.
    pub values: Values,
}

/// The values of an [`Axis`].
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// All integers from the first to the last. For example, `Range(1, 1000)` has 1000 values.
    Range(i64, i64),
    /// The values of this list.
    List(Vec<i64>),
}

impl Sweep {
    /// Makes the sweep of every combination of some operands.
    pub fn all<'a>(operands: impl Iterator<Item = &'a Operand>) -> Self {
        Self::ranges(operands.map(|operand| (operand.name.as_str(), operand.domain)))
    }

    /// Makes the sweep of every combination of values by name, each from the first to the last.
    pub fn ranges<'a>(ranges: impl IntoIterator<Item = (&'a str, (i64, i64))>) -> Self {
        let axes = ranges.into_iter().map(|(name, (low, high))| Axis {
            name: name.to_owned(),
            values: Values::Range(low, high),
        });
        Self { axes: axes.collect(), omits: String::new() }
    }

    /// Returns its axes in a sentence. For example, two axes give `cos_gamma = 0 to 1048576 x exponent = 1 to 1000`.
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
    /// Returns how many.
    pub fn count(&self) -> u64 {
        match self {
            Self::Range(low, high) => low.abs_diff(*high) + 1,
            Self::List(values) => values.len() as u64,
        }
    }

    /// Returns value number `at`.
    #[inline]
    pub fn value(&self, at: u64) -> i64 {
        match self {
            Self::Range(low, _) => low + at as i64,
            Self::List(values) => values[at as usize],
        }
    }
}

/// A bound on the error of an output over the domain, and its contributions.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// The bound on the quantity that a sweep measures: the error of `f` of a highlight, otherwise the error of an output, in
    /// units.
    pub f: f64,
    /// The bound on the error of an output, in its units. A highlight states it for the largest colour operand.
    pub units: f64,
    /// The accuracy contract is kept if `units` is below this limit, in units. It is 1, or the error that a configuration
    /// allows.
    pub limit: f64,
    /// The contributions, in output units, each with the configuration key that governs it. They
    /// add up to `units`.
    pub terms: Vec<Term>,
}

/// One contribution to a [`Bound`]. For example, `output.rounding` contributes 0.5 units to the bound of `rough`, for the
/// rounding of the colour outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The configuration key that governs it.
    pub key: &'static str,
    /// The operation that rounds or approximates.
    pub what: &'static str,
    /// Its share, in output units.
    pub units: f64,
}

impl Bound {
    /// Makes the bound of a device that is no highlight: the sum of its terms; infinite without any.
    pub fn of(terms: Vec<Term>) -> Self {
        let sum: f64 = terms.iter().map(|term| term.units).sum();
        // A sum that is NaN limits nothing.
        let units = if terms.is_empty() || sum.is_nan() { f64::INFINITY } else { sum };
        Self { f: units, units, limit: 1.0, terms }
    }

    /// Returns the bound in units, or says that there is none. For example, `rough` has `0.969`.
    pub fn words(&self) -> String {
        if self.is_stated() { text::rounded_up(self.units, 3) } else { "not stated".to_owned() }
    }

    /// Returns whether the accuracy contract is kept.
    pub fn keeps(&self) -> bool {
        self.units < self.limit
    }

    /// Returns whether its author has stated one.
    pub fn is_stated(&self) -> bool {
        self.units.is_finite()
    }

    /// Returns the largest contribution: the key to change first. For example, it is `output.rounding` for `rough`, with 0.5 of
    /// 0.969 units.
    pub fn limiting(&self) -> Option<&Term> {
        self.terms.iter().max_by(|a, b| a.units.total_cmp(&b.units))
    }
}

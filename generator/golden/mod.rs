//! Golden models: each device a second time, by its formula and the source's narrative.
//!
//! A golden model uses [`crate::base::fixed`] and [`crate::config`] alone. It never sees the description,
//! the netlist or the microcode, and it computes its own tables; that is what makes the comparison
//! with the simulated hardware worth something.

pub mod blinn;
pub mod contract;
pub mod cosine_power;
pub mod cosine_squared;
pub mod curve;
pub mod decay;
pub mod formulas;
pub mod frame;
pub mod gauss;
pub mod halving;
mod handshake;
pub mod highlight;
pub mod keys;
pub mod line;
pub mod lyon;
pub mod narrow;
pub mod pipeline;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
pub mod schlick;
pub mod sine;
pub mod threshold;

use std::fmt;

use crate::base::fixed::Format;

/// A clock-by-clock model of a device.
///
/// Values are bit patterns. All state is zero before the first clock, as the built-in simulator's is.
/// A run has many instances; tables are best shared among them (`Arc`).
pub trait Model: CloneModel + Send + Sync {
    /// The names of the inputs, in the order in which [`Model::clock`] takes them: `rst_n`, `start`,
    /// and `<operand>` and `<operand>_write` for each operand. The order is the model's own.
    fn inputs(&self) -> &[String];

    /// The names of everything predicted, in any order.
    ///
    /// Nothing that a device shows may be missing: the outputs (`valid`, `busy`, `done`, results and
    /// flags); the sequencer's registers `run` and `word_address`; the register `<operand>_reg` of each
    /// operand; and the registers and counters of the description by their names. Registers inside a
    /// block (pipeline stages, synchronous ROMs) need not be there.
    fn signals(&self) -> &[String];

    /// One rising edge, with the inputs as they stand just before it.
    fn clock(&mut self, inputs: &[u64]);

    /// The values after the latest edge, in the order of [`Model::signals`].
    fn values(&self) -> &[u64];

    /// The value of one signal.
    fn value(&self, name: &str) -> Option<u64> {
        let at = self.signals().iter().position(|signal| signal == name)?;
        Some(self.values()[at])
    }
}

/// What a [`Model`] has by being [`Clone`].
pub trait CloneModel {
    /// A copy, with the state that it has now.
    fn boxed_clone(&self) -> Box<dyn Model>;
}

impl<M: Model + Clone + 'static> CloneModel for M {
    fn boxed_clone(&self) -> Box<dyn Model> {
        Box::new(self.clone())
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
    /// A colour operand multiplies `f`; the others determine it.
    pub colour: bool,
    /// One line: what it is.
    pub doc: String,
}

/// The accuracy contract of a device: `|out − K·f| < 1` unit for each colour output.
///
/// It is factored as the hardware is: control operands determine the word `f`, and each colour
/// output is `f` times one colour operand.
pub trait Contract: Send + Sync {
    /// Control operands, then colour operands, in the order in which values are passed.
    fn operands(&self) -> &[Operand];

    /// The colour outputs, each from the colour operand of the same position.
    fn outputs(&self) -> &[String];

    /// The format of the word `f`.
    fn f_format(&self) -> Format;

    /// The word `f` that the device computes from the raw control operands.
    fn f(&self, control: &[i64]) -> i64;

    /// The raw output for a word `f` and a raw colour operand.
    fn colour(&self, f: i64, colour: i64) -> i64;

    /// The source's formula in f64, unrounded, at the raw (that is, quantised) control operands.
    fn reference(&self, control: &[i64]) -> f64;

    /// The values that are right for `f` at the raw control operands: the formula's, twice. Where the formula
    /// jumps and fixed point may come out on its other side, the values on both sides. An error is
    /// taken from the nearer.
    fn references(&self, control: &[i64]) -> [f64; 2] {
        [self.reference(control); 2]
    }

    /// The values of [`Contract::references`] as expressions of Python, for benches that have no other second
    /// opinion; none where nobody wrote them.
    ///
    /// They speak of the control operands by name, as values and not raw, of the result's number (from 0) as
    /// `index`, of the words of a ROM as values by its name, and of `math`'s functions.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// The control operands of the one point that result number `index` (from 0) of a computation shows.
    ///
    /// A device with one result per `start` shows the point of its operands. One that walks a line of
    /// points from one `start` says here where the walk has come to.
    fn point(&self, control: &[i64], index: u64) -> Vec<i64> {
        let _ = index;
        control.to_vec()
    }

    /// Where the formula is largest: these control operands with those changed that lead there (a cosine to 1, an
    /// angle or a vector to 0). Points for tests are drawn between there and anywhere, by the value of the formula;
    /// it should not rise on the straight way from there to `control`.
    ///
    /// `None`: the operands with a fraction are each taken to an end of their domain or to 0, to those where the
    /// formula turns out to be largest. A device whose peak lies elsewhere says so here.
    fn peak(&self, control: &[i64]) -> Option<Vec<i64>> {
        let _ = control;
        None
    }

    /// The control operands of a computation of several results that goes from the point `first` to the point
    /// `last`, as far as `first` says how many there are: the inverse of [`Contract::point`].
    ///
    /// A device with one result per `start` shows `first`.
    fn line(&self, first: &[i64], last: &[i64]) -> Vec<i64> {
        let _ = last;
        first.to_vec()
    }

    /// The operand that says how many results a computation has, when one does.
    fn length(&self) -> Option<&str> {
        None
    }

    /// The control operands, as [`Contract::f`] takes them, that come nearest to the angle `gamma`, in radians
    /// from 0 to π/2, and the exponent `n`; `None` where no operands of the domain stand for that exponent.
    ///
    /// By default these are the operands `cos_gamma` and `exponent`, if the device has them; any other is
    /// as near to 0 as its domain allows. A device with other operands, or for whose operands 0 means
    /// something, says so here.
    fn at(&self, gamma: f64, n: f64) -> Option<Vec<i64>> {
        contract::operands_at(self.operands(), gamma, n, &[])
    }

    /// The cosine of the angle γ that control operands denote once they are quantised: by default the operand
    /// `cos_gamma`, if the device has one.
    fn cosine(&self, control: &[i64]) -> Option<f64> {
        let operands = self.operands().iter().zip(control);
        let (operand, raw) =
            operands.into_iter().find(|(operand, _)| operand.name == contract::COSINE)?;
        Some(operand.format.to_f64(i128::from(*raw)).clamp(0.0, 1.0))
    }

    /// What an exhaustive check of `f` goes through: by default every combination of the control operands.
    fn sweep(&self) -> Sweep {
        let control = self.operands().iter().filter(|operand| !operand.colour);
        Sweep {
            axes: control
                .map(|operand| Axis {
                    name: operand.name.clone(),
                    values: Values::Range(operand.domain.0, operand.domain.1),
                })
                .collect(),
            omits: String::new(),
        }
    }

    /// The error of `f` at a place of the sweep, absolute: by default a place is a point.
    fn sweep_error(&self, place: &[i64]) -> f64 {
        let f = self.f_format().to_f64(i128::from(self.f(place)));
        nearer(f, self.references(place))
    }

    /// A proven bound on the error, stated before anything is simulated.
    fn bound(&self) -> Bound;

    /// What a user of this configuration should know of the formula itself, with figures: where in the
    /// domain another choice of the same device would come closer to `cosⁿγ`.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// The distance of `value` from the nearer of two values that are right.
#[inline]
pub fn nearer(value: f64, right: [f64; 2]) -> f64 {
    (value - right[0]).abs().min((value - right[1]).abs())
}

/// The places that an exhaustive check of `f` visits: the product of its axes.
///
/// A device with too many control operands for all combinations names what determines `f` (a word in
/// between, say, with [`Contract::sweep_error`] taking the worst over what rounds to it), or a list of
/// settings, and says in `omits` what is left to random points.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The outermost first.
    pub axes: Vec<Axis>,
    /// What is not covered, in a sentence; empty when every combination of control operands is.
    pub omits: String,
}

/// One axis of a [`Sweep`].
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The operand, or what stands for it.
    pub name: String,
    /// Its values.
    pub values: Values,
}

/// The values of an [`Axis`].
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// From the first to the last.
    Range(i64, i64),
    /// These.
    List(Vec<i64>),
}

impl Sweep {
    /// Its axes in a sentence.
    pub fn words(&self) -> String {
        let axes: Vec<String> = self.axes.iter().map(Axis::to_string).collect();
        axes.join(" x ")
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.values {
            Values::Range(low, high) => write!(f, "{} = {low} to {high}", self.name),
            Values::List(values) => write!(f, "{} settings of {}", values.len(), self.name),
        }
    }
}

impl Values {
    /// How many.
    pub fn count(&self) -> u64 {
        match self {
            Self::Range(low, high) => low.abs_diff(*high) + 1,
            Self::List(values) => values.len() as u64,
        }
    }

    /// Value number `at`.
    #[inline]
    pub fn value(&self, at: u64) -> i64 {
        match self {
            Self::Range(low, _) => low + at as i64,
            Self::List(values) => values[at as usize],
        }
    }
}

/// A bound on `|out − K·f|` over the domain, and what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// On the error of `f`.
    pub f: f64,
    /// On the error of an output, in output units, for the largest colour operand.
    pub units: f64,
    /// The contributions, in output units, each with the configuration key that governs it. They
    /// add up to `units`.
    pub terms: Vec<Term>,
}

/// One contribution to a [`Bound`].
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The configuration key that governs it.
    pub key: &'static str,
    /// What rounds or approximates.
    pub what: &'static str,
    /// Its share, in output units.
    pub units: f64,
}

impl Bound {
    /// The largest contribution: the key to change first.
    pub fn limiting(&self) -> Option<&Term> {
        self.terms.iter().max_by(|a, b| a.units.total_cmp(&b.units))
    }
}

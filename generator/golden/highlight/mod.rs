//! The accuracy contract of highlights, which are devices that multiply colours by a reflectance `f`.

mod keys;
mod multiplied;

pub use keys::{operands, products, slots};
pub use multiplied::Products;

use std::borrow::Cow;
use std::ops::Deref;
use std::sync::OnceLock;

use super::contract::{self, COSINE, ErrorShare};
use super::{Bound, Contract, Operand, Output, Sweep, nearer};
use glint_base::fixed::{Format, exp2};

/// The reflectance by a highlight's control operands: a number f in 0 … 1.
pub trait Reflectance: Send + Sync {
    /// Returns the raw f that the device computes from the raw control operands.
    fn f(&self, control: &[i64]) -> i64;

    /// Returns the source's formula in f64, unrounded, at the raw (that is, quantised) control operands.
    fn reference(&self, control: &[i64]) -> f64;

    /// Returns the values that are right for `f` at the raw control operands: the formula's, twice. Where the formula
    /// jumps and fixed point may come out on its other side, the values on both sides. An error is
    /// taken from the nearer.
    fn references(&self, control: &[i64]) -> [f64; 2] {
        [self.reference(control); 2]
    }

    /// Returns the values of [`Reflectance::references`] as expressions of Python, for benches that have no other second
    /// opinion; none where nobody wrote them.
    ///
    /// The expressions may use the control operands by name, as values and not raw, the result's number (from 0) as `index`,
    /// the words of a ROM as values by its name, and the functions of `math`.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Moves the control operands to the point that result number `index` (from 0) of a computation shows.
    ///
    /// A device with one result per `start` shows the point of its operands. A device that walks a line of points from one
    /// `start` must say here where the walk is at that result.
    fn point(&self, control: &mut [i64], index: u64) {
        let _ = (control, index);
    }

    /// Returns where the formula is largest: these control operands with those changed that lead there (a cosine to 1, an
    /// angle or a vector to 0). Points for tests are drawn between there and anywhere, by the value of the formula;
    /// it should not rise on the straight way from there to `control`.
    ///
    /// `None`: the operands with a fraction are each taken to an end of their domain or to 0, to those where the
    /// formula turns out to be largest. A device whose peak lies elsewhere says so here.
    fn peak(&self, control: &[i64]) -> Option<Vec<i64>> {
        let _ = control;
        None
    }

    /// Returns the control operands of a computation of several results that goes from the point `first` to the point
    /// `last`, as far as `first` says how many there are: the inverse of [`Reflectance::point`].
    ///
    /// A device with one result per `start` shows `first`.
    fn line(&self, first: &[i64], last: &[i64]) -> Vec<i64> {
        let _ = last;
        first.to_vec()
    }

    /// Returns the formula at a cosine that is not quantised, and a raw exponent. Returns `None` if the device has other
    /// control operands.
    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        let _ = (cosine, exponent);
        None
    }

    /// Returns how far the formula follows the cosine over the domain; none where nobody stated it.
    fn variation(&self) -> Option<Variation> {
        None
    }

    /// Returns the operand that says how many results a computation has, as [`Contract::length`].
    fn length(&self) -> Option<&str> {
        None
    }

    /// Returns the control operands, as [`Reflectance::f`] takes them, that come nearest to the angle `gamma`, in radians
    /// from 0 to π/2, and the exponent `n`. Returns `None` if no operands of the domain denote that exponent. `operands` are
    /// the operands of the contract.
    ///
    /// By default these are the operands `cos_gamma` and `exponent`, if the device has them. Any other operand is as near to
    /// 0 as its domain allows. A device with other operands, or for whose operands 0 means something, must say so here.
    fn at(&self, operands: &[Operand], gamma: f64, n: f64) -> Option<Vec<i64>> {
        contract::operands_at(operands, gamma, n, &[])
    }

    /// Returns the cosine of the angle γ that the control operands denote once they are quantised. By default this is the
    /// operand `cos_gamma`, if the device has one. `operands` are the operands of the contract.
    fn cosine(&self, operands: &[Operand], control: &[i64]) -> Option<f64> {
        let (operand, raw) =
            operands.iter().zip(control).find(|(operand, _)| operand.name == COSINE)?;
        Some(operand.format.to_f64(i128::from(*raw)).clamp(0.0, 1.0))
    }

    /// Returns the places of an exhaustive check of `f`; none for every combination of the control operands.
    fn sweep(&self) -> Option<Sweep> {
        None
    }

    /// Returns the error of `f` at a place of the sweep, absolute; none where a place is a point.
    #[inline]
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let _ = place;
        None
    }

    /// Returns the terms of f's error, each a proven upper limit; none where the bound is not known yet.
    fn shares(&self) -> Vec<ErrorShare> {
        Vec::new()
    }

    /// Returns facts about the formula that a user should know, as [`Contract::remarks`].
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Proven limits of how far values of a formula are apart: the slope times the distance of two cosines from −1 to 1, and a jump
/// that may lie between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// The largest slope beside the jump.
    pub slope: f64,
    /// The largest jump. Most formulas jump at a right angle, from their value there to 0 beyond it.
    pub jump: f64,
}

/// The accuracy contract of a device that multiplies by a reflectance.
pub struct Highlight {
    reflectance: Box<dyn Reflectance>,
    /// A computation has one result, at the point of its operands.
    single: bool,
    products: Products,
    operands: Vec<Operand>,
    /// Once it was asked for: it may take a search.
    bound: OnceLock<Bound>,
}

/// The contract answers for its reflectance wherever only control operands matter.
impl Deref for Highlight {
    type Target = dyn Reflectance;

    fn deref(&self) -> &Self::Target {
        &*self.reflectance
    }
}

impl Highlight {
    /// Makes the contract of a reflectance with these control operands, in the order in which it takes them.
    pub fn new(
        reflectance: impl Reflectance + 'static,
        control: Vec<Operand>,
        products: Products,
    ) -> Self {
        let mut operands = control;
        operands.extend(products.operands.iter().cloned());
        let single = reflectance.length().is_none();
        let bound = OnceLock::new();
        Self { reflectance: Box::new(reflectance), single, products, operands, bound }
    }

    /// Returns the number of control operands, which come first.
    pub fn control(&self) -> usize {
        self.operands.len() - self.products.operands.len()
    }

    /// Returns the format of f.
    pub fn f_format(&self) -> Format {
        self.products.f
    }

    /// Returns the raw output for a raw f and a raw colour operand.
    #[inline]
    pub fn colour(&self, f: i64, colour: i64) -> i64 {
        self.products.narrow.apply(f * colour)
    }

    /// Returns [`Reflectance::expressions`] of the reflectance.
    pub fn expressions(&self) -> Vec<String> {
        self.reflectance.expressions()
    }

    /// Returns the control operands of a point, as [`Reflectance::point`]: those given where a computation has one result.
    #[inline]
    pub fn point<'c>(&self, control: &'c [i64], index: u64) -> Cow<'c, [i64]> {
        let mut point = Cow::Borrowed(control);
        if !self.single {
            self.reflectance.point(point.to_mut(), index);
        }
        point
    }

    /// Returns the f of result number `index` (from 0) of raw operands. It writes the values of [`Contract::exact`] into
    /// `exact`, and the control operands of the point into `point`.
    #[inline]
    pub fn measured(
        &self,
        operands: &[i64],
        index: u64,
        point: &mut Vec<i64>,
        exact: &mut Vec<[f64; 2]>,
    ) -> i64 {
        let (control, colours) = operands.split_at(self.control());
        point.clear();
        point.extend(control);
        self.reflectance.point(point, index);
        self.exact_at(point, colours, exact);
        self.f(point)
    }

    /// Appends [`Contract::exact`] at the control operands of one point.
    fn exact_at(&self, point: &[i64], colours: &[i64], exact: &mut Vec<[f64; 2]>) {
        let f = self.references(point);
        let pairs = self.products.operands.iter().zip(colours);
        exact.extend(pairs.map(|(operand, &colour)| {
            let colour = colour as f64 * exp2(-operand.format.frac);
            f.map(|f| f * colour)
        }));
    }

    /// Returns [`Reflectance::at`] with the operands of the contract.
    pub fn at(&self, gamma: f64, n: f64) -> Option<Vec<i64>> {
        self.reflectance.at(&self.operands, gamma, n)
    }

    /// Returns [`Reflectance::cosine`] with the operands of the contract.
    pub fn cosine(&self, control: &[i64]) -> Option<f64> {
        self.reflectance.cosine(&self.operands, control)
    }
}

impl Contract for Highlight {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[Output] {
        &self.products.outputs
    }

    fn results(&self, operands: &[i64], index: u64, raw: &mut Vec<i64>) {
        let (control, colours) = operands.split_at(self.control());
        let f = self.f(&self.point(control, index));
        raw.extend(colours.iter().map(|&colour| self.colour(f, colour)));
    }

    fn exact(&self, operands: &[i64], index: u64, values: &mut Vec<[f64; 2]>) {
        let (control, colours) = operands.split_at(self.control());
        self.exact_at(&self.point(control, index), colours, values);
    }

    fn highlight(&self) -> Option<&Highlight> {
        Some(self)
    }

    fn length(&self) -> Option<&str> {
        self.reflectance.length()
    }

    /// Returns the sweep of f alone; every product is checked beside it.
    fn sweep(&self) -> Sweep {
        let control = &self.operands[..self.control()];
        self.reflectance.sweep().unwrap_or_else(|| Sweep::all(control.iter()))
    }

    /// Returns the error of f, absolute.
    #[inline]
    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.reflectance.sweep_error(place).unwrap_or_else(|| {
            let f = self.products.f.to_f64(i128::from(self.reflectance.f(place)));
            nearer(f, self.reflectance.references(place))
        })
    }

    fn bound(&self) -> Bound {
        let bound = self.bound.get_or_init(|| {
            let products = &self.products;
            let shares = self.reflectance.shares();
            contract::bound(&shares, products.f.frac as u32, products.bits, products.rounding)
        });
        bound.clone()
    }

    fn remarks(&self) -> Vec<String> {
        self.reflectance.remarks()
    }
}

//! The accuracy contract of highlight devices, which multiply colours by a reflectance `f` from 0 to 1.
//!
//! Such a device computes f from its control operands, for example f = cⁿ from `cos_gamma` and `exponent`. Each colour output is
//! K·f, rounded, where K is a colour operand. A device implements [`Reflectance`]; [`Highlight`] makes the whole contract from
//! it.

mod keys;
mod multiplied;

pub use keys::{operands, products, slots};
pub use multiplied::Products;

use std::borrow::Cow;
use std::ops::Deref;
use std::sync::OnceLock;

use super::contract::{self, COSINE, ErrorShare};
use super::{Bounds, Contract, Operand, Output, Sweep, nearer};
use glint_base::fixed::{Format, exp2};

/// The reflectance f of one highlight device, from 0 to 1, as a function of its control operands.
pub trait Reflectance: Send + Sync {
    /// Returns the raw f that the device computes from the raw control operands.
    fn f(&self, control: &[i64]) -> i64;

    /// Returns the exact f: the formula of the source in f64, unrounded.
    fn reference(&self, control: &[i64]) -> f64;

    /// Returns the two values that count as correct for `f`, normally both the exact f. If the formula jumps and rounding may
    /// lead to either side of the jump, they are the values on both sides. An error is measured from the nearer value.
    fn references(&self, control: &[i64]) -> [f64; 2] {
        [self.reference(control); 2]
    }

    /// Returns the values of [`Reflectance::references`] as Python expressions, or nothing if the author has not written any.
    /// Test benches use them as an independent second opinion.
    ///
    /// The expressions may use the names of control operands (as values, not raw), and `index` (the number of the result, from
    /// 0). They may also use the words of a ROM (as values, by the ROM's name), and the functions of `math`.
    fn expressions(&self) -> Vec<String> {
        Vec::new()
    }

    /// Replaces the raw control operands of a computation by the operands of its result number `index`, counted from 0. A device
    /// that computes a line of points, such as `quad-cosine`, must set the angle of point number `index`.
    fn point(&self, control: &mut [i64], index: u64) {
        let _ = (control, index);
    }

    /// Returns raw control operands at which the formula is largest, near `control`: a cosine becomes 1, and an angle or a
    /// vector becomes 0. Tests draw points between the peak and other operands, so the formula should not rise on the straight
    /// line from the peak to `control`.
    ///
    /// With `None`, each operand with fraction bits is set to an end of its domain or to 0, whichever gives the largest value.
    fn peak(&self, control: &[i64]) -> Option<Vec<i64>> {
        let _ = control;
        None
    }

    /// Returns the control operands of a line from the point `first` to the point `last`. Each point has its control operands,
    /// and `first` also has the line's length. For example, a line from the angle 0 to the angle 300 in 3 steps gets the step
    /// 100. A step that is no integer is rounded toward 0, so the line may end before `last`. A device with one result for each
    /// `start` returns `first`.
    fn line(&self, first: &[i64], last: &[i64]) -> Vec<i64> {
        let _ = last;
        first.to_vec()
    }

    /// Returns the exact f at `cosine`, which need not fit the operand's format, and at the raw `exponent`. Returns `None` if the
    /// device has no such operands or does not override this method.
    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        let _ = (cosine, exponent);
        None
    }

    /// Returns proved limits on how much the formula changes with the cosine; `None` if the author has not stated them.
    fn variation(&self) -> Option<Variation> {
        None
    }

    /// Returns the operand for [`Contract::length`], by default none.
    fn length(&self) -> Option<&str> {
        None
    }

    /// Returns the control operands that come nearest to the angle `gamma`, in radians from 0 to π/2, and to the specular
    /// exponent `n`. The domain must represent this exponent.
    ///
    /// By default the device must have the operands `cos_gamma` and `exponent`; any other operand gets the value of its domain
    /// that is nearest to 0. A device with other operands must override this.
    fn at(&self, operands: &[Operand], gamma: f64, n: f64) -> Option<Vec<i64>> {
        contract::operands_at(operands, gamma, n, &[])
    }

    /// Returns cos γ for the raw operands `control`, limited to 0 … 1. By default it is the value of the operand `cos_gamma`;
    /// `None` without this operand.
    fn cosine(&self, operands: &[Operand], control: &[i64]) -> Option<f64> {
        let (operand, raw) =
            operands.iter().zip(control).find(|(operand, _)| operand.name == COSINE)?;
        Some(operand.format.to_f64(i128::from(*raw)).clamp(0.0, 1.0))
    }

    /// Returns the cases of an exhaustive check of `f`, or `None` for all combinations of the control operands.
    fn sweep(&self) -> Option<Sweep> {
        None
    }

    /// Returns the absolute error of `f`, as a value, in one case of the sweep. `place` has the value on each axis. Returns
    /// `None` if a case is a set of control operands; the caller then computes the error.
    #[inline]
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let _ = place;
        None
    }

    /// Returns the contributions to the error of f, each a proved upper limit; none if no bound is known.
    fn shares(&self) -> Vec<ErrorShare> {
        Vec::new()
    }

    /// Returns the remarks for [`Contract::remarks`], by default none.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }
}

/// An upper limit of the difference of two values of a formula, at two cosines from −1 to 1: `slope` times the distance of the
/// cosines, plus `jump`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// The largest slope, apart from the jump.
    pub slope: f64,
    /// The largest jump, mostly at a right angle, where the formula falls from some value to 0.
    pub jump: f64,
}

pub struct Highlight {
    reflectance: Box<dyn Reflectance>,
    /// Whether a computation has a single result, not a line of points.
    single: bool,
    products: Products,
    operands: Vec<Operand>,
    /// Stored at the first request, because a search may be needed to compute it.
    bounds: OnceLock<Bounds>,
}

/// Makes the methods of [`Reflectance`] available, which take only the control operands.
impl Deref for Highlight {
    type Target = dyn Reflectance;

    fn deref(&self) -> &Self::Target {
        &*self.reflectance
    }
}

impl Highlight {
    /// Makes the contract. `control` are the control operands in the order in which `reflectance` takes them; the colour operands
    /// of `products` follow.
    pub fn new(
        reflectance: impl Reflectance + 'static,
        control: Vec<Operand>,
        products: Products,
    ) -> Self {
        let mut operands = control;
        operands.extend(products.operands.iter().cloned());
        let single = reflectance.length().is_none();
        let bounds = OnceLock::new();
        Self { reflectance: Box::new(reflectance), single, products, operands, bounds }
    }

    /// Returns the number of control operands, which come before the colour operands.
    pub fn control(&self) -> usize {
        self.operands.len() - self.products.operands.len()
    }

    pub fn f_format(&self) -> Format {
        self.products.f
    }

    /// Returns the raw colour output: the product of the raw `f` and `colour`, rounded to the output's format.
    #[inline]
    pub fn colour(&self, f: i64, colour: i64) -> i64 {
        self.products.narrow.apply(f * colour)
    }

    pub fn expressions(&self) -> Vec<String> {
        self.reflectance.expressions()
    }

    /// Returns the control operands of result number `index`, as [`Reflectance::point`] gives them.
    #[inline]
    pub fn point<'c>(&self, control: &'c [i64], index: u64) -> Cow<'c, [i64]> {
        let mut point = Cow::Borrowed(control);
        if !self.single {
            self.reflectance.point(point.to_mut(), index);
        }
        point
    }

    /// Returns the raw f of result number `index` (from 0). Replaces `point` by the control operands of this result, and appends
    /// its exact values ([`Contract::exact`]) to `exact`.
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

    /// Appends the values of [`Contract::exact`] for the control operands `point`.
    fn exact_at(&self, point: &[i64], colours: &[i64], exact: &mut Vec<[f64; 2]>) {
        let f = self.references(point);
        let pairs = self.products.operands.iter().zip(colours);
        exact.extend(pairs.map(|(operand, &colour)| {
            let colour = colour as f64 * exp2(-operand.format.frac);
            f.map(|f| f * colour)
        }));
    }

    /// Returns the control operands for the angle `gamma` and the exponent `n` ([`Reflectance::at`]).
    pub fn at(&self, gamma: f64, n: f64) -> Option<Vec<i64>> {
        self.reflectance.at(&self.operands, gamma, n)
    }

    /// Returns cos γ, limited to 0 … 1, for the raw operands `control`; `None` if they determine no cosine
    /// ([`Reflectance::cosine`]).
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

    fn sweep(&self) -> Sweep {
        let control = &self.operands[..self.control()];
        self.reflectance.sweep().unwrap_or_else(|| Sweep::all(control.iter()))
    }

    /// Returns the absolute error of f, as a value.
    #[inline]
    fn sweep_error(&self, place: &[i64]) -> f64 {
        self.reflectance.sweep_error(place).unwrap_or_else(|| {
            let f = self.products.f.to_f64(i128::from(self.reflectance.f(place)));
            nearer(f, self.reflectance.references(place))
        })
    }

    fn bounds(&self) -> Bounds {
        let bounds = self.bounds.get_or_init(|| {
            let products = &self.products;
            let shares = self.reflectance.shares();
            let frac = products.f.frac as u32;
            let (f, bound) = contract::bound(&shares, frac, products.bits, products.rounding);
            Bounds::alike(f, &bound, &products.outputs)
        });
        bounds.clone()
    }

    fn remarks(&self) -> Vec<String> {
        self.reflectance.remarks()
    }
}

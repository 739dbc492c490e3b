//! Evaluates a piecewise polynomial in a golden model by Horner's rule in integers, for `blinn`, `gauss`, `function` and
//! `expression`. Each partial sum has a register. The models read the same table of coefficients as the hardware; another check
//! compares this table with the formula.

use std::sync::Arc;

use super::frame::{Frame, Slot, State};
use glint_approximate::Piecewise;

/// A piecewise polynomial with the registers of its partial sums.
pub struct Polynomial {
    it: Arc<Piecewise>,
    /// Sum number k contains the coefficients from number k on, so sum 0 is the whole polynomial.
    sums: Vec<Slot>,
    /// The highest coefficient's register, if it has one.
    highest: Option<Slot>,
}

impl Polynomial {
    /// Adds the registers of the partial sums of `it` to `frame`. `names` begins with the whole polynomial's register; names
    /// beyond the degree are not used.
    pub fn new(frame: &mut Frame, names: &[&str], it: &Arc<Piecewise>) -> Self {
        let registers = names.iter().zip(&it.sums).take(it.degree().max(1));
        let sums = registers.map(|(name, format)| frame.register(name, *format)).collect();
        Self { it: it.clone(), sums, highest: None }
    }

    /// Returns the polynomial of another operand. It shares the table and the registers of partial sums, but has a register
    /// `name` for its own value. The two polynomials are computed one after the other.
    pub fn sharing(&self, frame: &mut Frame, name: &str) -> Self {
        let mut sums = self.sums.clone();
        sums[0] = frame.register(name, self.it.sums[0]);
        Self { it: self.it.clone(), sums, highest: self.highest }
    }

    /// Adds a register `name` for the highest coefficient, which [`Polynomial::load_highest`] loads before the first sum.
    pub fn with_highest(self, frame: &mut Frame, name: &str) -> Self {
        let format = self.it.coefficients[self.it.degree()];
        Self { highest: Some(frame.register(name, format)), ..self }
    }

    /// Returns the operation that loads the register of the highest coefficient from the table.
    ///
    /// # Panics
    /// The operation panics if there is no such register.
    pub fn load_highest<R>(&self, raw: R) -> impl Fn(&mut State) + use<R>
    where
        R: Fn(&State) -> i64 + Send + Sync + 'static,
    {
        let (it, highest) = (self.it.clone(), self.highest.expect("a register"));
        move |s: &mut State| s[highest] = it.words[it.place(raw(s)).word][it.degree()]
    }

    /// Returns the slot of the register that has the polynomial's value.
    pub fn q(&self) -> Slot {
        self.sums[0]
    }

    /// Returns the operation of Horner's rule that adds coefficient number `coefficient`. `raw` computes the polynomial's operand
    /// from the state.
    pub fn step<R>(&self, coefficient: usize, raw: R) -> impl Fn(&mut State) + use<R>
    where
        R: Fn(&State) -> i64 + Send + Sync + 'static,
    {
        let it = self.it.clone();
        let own = self.sums[coefficient];
        let above = self.sums.get(coefficient + 1).copied().or(self.highest);
        move |s: &mut State| {
            let place = it.place(raw(s));
            // Without a register, the highest coefficient is read from the table.
            let sum_above = above.map_or(it.words[place.word][it.degree()], |above| s[above]);
            let sum = it.sum(coefficient, place, sum_above);
            let shortened = sum >> if coefficient == 0 { it.guard() } else { 0 };
            let format = it.sums[coefficient];
            s[own] = format.raw(format.bits(shortened.into())) as i64;
        }
    }

    /// Returns the operations of Horner's rule in their order, one for each register.
    pub fn steps<R>(
        &self,
        raw: R,
    ) -> impl Iterator<Item = impl Fn(&mut State) + use<R>> + use<'_, R>
    where
        R: Fn(&State) -> i64 + Clone + Send + Sync + 'static,
    {
        (0..self.sums.len()).rev().map(move |coefficient| self.step(coefficient, raw.clone()))
    }
}

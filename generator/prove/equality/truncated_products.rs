//! Finds products of the core that the pipeline has of the lowest bits of their factors alone.
//!
//! A pipeline leaves the highest bit of a factor to itself: where it is a sign, or set where all other bits are 0. The lowest bits
//! may be a value that the core has in other terms, which the solver is asked about.

use anyhow::Result;

use super::Comparison;
use super::facts::{extended, shifted};
use super::solver::Outcome;
use super::split_products::agree;
use super::term::{Id, Term};
use glint_base::fixed::MAX_WIDTH;

/// How a factor is made of one of the pipeline's: the same, or its lowest bits, so many.
#[derive(Clone, Copy)]
enum Factor {
    Same,
    Lowest(u32),
}

impl Comparison<'_> {
    /// Notes what the products of a cone are by those of the pipeline.
    pub(super) fn divide_by_lowest(&mut self, wanted: &[Id]) -> Result<()> {
        for id in self.terms.cone(wanted.iter().copied()) {
            let Term::Product(a, b) = *self.terms.term(id) else { continue };
            if self.divided.contains_key(&id) || self.parts.binary_search(&id).is_ok() {
                continue;
            }
            for part in self.parts.clone() {
                let Term::Product(c, d) = *self.terms.term(part) else { continue };
                if self.by_parts([a, b], [c, d])? || self.by_parts([a, b], [d, c])? {
                    break;
                }
            }
        }
        Ok(())
    }

    /// Notes what a product is if its factors are made of those of a product of the pipeline; whether they are.
    fn by_parts(&mut self, [a, b]: [Id; 2], [c, d]: [Id; 2]) -> Result<bool> {
        let (Some(first), Some(second)) = (self.made(a, c)?, self.made(b, d)?) else {
            return Ok(false);
        };
        self.note(b, d, second, c);
        self.note(a, c, first, b);
        Ok(true)
    }

    fn made(&mut self, factor: Id, of: Id) -> Result<Option<Factor>> {
        if self.same(factor, of)? {
            return Ok(Some(Factor::Same));
        }
        let Some((bits, false)) = extended(&self.terms, of) else { return Ok(None) };
        let width = self.terms.width(bits);
        let low = self.terms.slice(factor, 0, width);
        Ok(self.same(low, bits)?.then_some(Factor::Lowest(width)))
    }

    /// Returns whether two terms of one width are equal for all operands.
    fn same(&mut self, one: Id, other: Id) -> Result<bool> {
        if one == other || !agree(&self.terms, one, other) {
            return Ok(one == other);
        }
        let equal = self.terms.equal(one, other);
        let mut differ = [self.terms.not(equal)];
        self.terms.replace(&self.divided, &mut differ);
        let said = self.solver.ask(&mut self.terms, &differ, &self.products, false)?;
        Ok(matches!(said, Outcome::Unsatisfiable))
    }

    /// Notes what the product of `factor` and `other` is by that of `part` and `other`: the same, or that and the product of the
    /// bits above, which is one by 0, 1 or -1.
    fn note(&mut self, factor: Id, part: Id, made: Factor, other: Id) {
        let terms = &mut self.terms;
        let product = terms.make(Term::Product(factor, other), MAX_WIDTH);
        let lower = terms.make(Term::Product(part, other), MAX_WIDTH);
        if lower == product {
            return;
        }
        let mut sum = [match made {
            Factor::Same => lower,
            Factor::Lowest(places) => {
                let upper = terms.slice(factor, places, MAX_WIDTH - places);
                let upper = terms.sign_extended(upper, MAX_WIDTH);
                let upper = terms.make(Term::Product(upper, other), MAX_WIDTH);
                let upper = shifted(terms, upper, places);
                terms.make(Term::Add(lower, upper), MAX_WIDTH)
            }
        }];
        terms.replace(&self.divided, &mut sum);
        self.divided.insert(product, sum[0]);
    }
}

//! Expresses a product of the sequential core by a product of the pipeline, if the pipeline's factors have only the low bits of
//! the core's factors.
//!
//! A pipeline treats the highest bit of a factor separately if it is a sign, or if it can be set only when all other bits are 0.
//! The core's product is then the pipeline's product plus the second factor times the highest bits.

use anyhow::Result;

use super::PipelineComparison;
use super::facts::{extended, shifted};
use super::solver::SolverAnswer;
use super::split_products::agree;
use super::term::{VectorTerm, VectorTermId};
use glint_base::fixed::MAX_WIDTH;

/// How a factor of the core follows from a factor of the pipeline: they are the same, or the pipeline's factor is this number of
/// lowest bits of the core's factor.
#[derive(Clone, Copy)]
enum Factor {
    Same,
    Lowest(u32),
}

impl PipelineComparison<'_> {
    /// Stores in `divided` how each product on which `wanted` depends follows from a product of the pipeline, if the search finds
    /// one.
    pub(super) fn divide_by_lowest(&mut self, wanted: &[VectorTermId]) -> Result<()> {
        for id in self.terms.cone(wanted.iter().copied()) {
            let VectorTerm::Product(a, b) = *self.terms.term(id) else { continue };
            if self.divided.contains_key(&id) || self.parts.binary_search(&id).is_ok() {
                continue;
            }
            for part in self.parts.clone() {
                let VectorTerm::Product(c, d) = *self.terms.term(part) else { continue };
                if self.by_parts([a, b], [c, d])? || self.by_parts([a, b], [d, c])? {
                    break;
                }
            }
        }
        Ok(())
    }

    /// Stores in `divided` how the product a·b follows from the pipeline's product c·d, if a follows from c and b from d.
    /// Otherwise returns false.
    fn by_parts(&mut self, [a, b]: [VectorTermId; 2], [c, d]: [VectorTermId; 2]) -> Result<bool> {
        let (Some(first), Some(second)) = (self.made(a, c)?, self.made(b, d)?) else {
            return Ok(false);
        };
        self.note(b, d, second, c);
        self.note(a, c, first, b);
        Ok(true)
    }

    /// Returns how `factor`, a factor of the core's product, follows from `of`, a factor of the pipeline's product. Returns
    /// `None` if the solver proves neither.
    fn made(&mut self, factor: VectorTermId, of: VectorTermId) -> Result<Option<Factor>> {
        if self.same(factor, of)? {
            return Ok(Some(Factor::Same));
        }
        let Some((bits, false)) = extended(&self.terms, of) else { return Ok(None) };
        let width = self.terms.width(bits);
        let low = self.terms.slice(factor, 0, width);
        Ok(self.same(low, bits)?.then_some(Factor::Lowest(width)))
    }

    /// Returns whether the solver proves that two terms are equal. Terms that differ at random values need no question.
    fn same(&mut self, one: VectorTermId, other: VectorTermId) -> Result<bool> {
        if one == other || !agree(&self.terms, one, other) {
            return Ok(one == other);
        }
        let equal = self.terms.equal(one, other);
        let mut differ = [self.terms.not(equal)];
        self.terms.replace(&self.divided, &mut differ);
        let said = self.solver.ask(&mut self.terms, &differ, &self.products, false)?;
        Ok(matches!(said, SolverAnswer::Unsatisfiable))
    }

    /// Stores how the product of `factor` and `other` follows from the product of `part` and `other`. Either the products are
    /// equal, or they differ by the product of `other` and the bits of `factor` above `part`. If only the highest bit is above,
    /// this difference is a product by 0, 1 or −1.
    fn note(
        &mut self,
        factor: VectorTermId,
        part: VectorTermId,
        made: Factor,
        other: VectorTermId,
    ) {
        let terms = &mut self.terms;
        let product = terms.make(VectorTerm::Product(factor, other), MAX_WIDTH);
        let lower = terms.make(VectorTerm::Product(part, other), MAX_WIDTH);
        if lower == product {
            return;
        }
        let mut sum = [match made {
            Factor::Same => lower,
            Factor::Lowest(places) => {
                let upper = terms.slice(factor, places, MAX_WIDTH - places);
                let upper = terms.sign_extended(upper, MAX_WIDTH);
                let upper = terms.make(VectorTerm::Product(upper, other), MAX_WIDTH);
                let upper = shifted(terms, upper, places);
                terms.make(VectorTerm::Add(lower, upper), MAX_WIDTH)
            }
        }];
        terms.replace(&self.divided, &mut sum);
        self.divided.insert(product, sum[0]);
    }
}

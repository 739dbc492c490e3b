//! Finds nets that probably carry a product that a pipeline computes as a sum of partial products.
//!
//! The module evaluates all terms with 24 sets of random values of the unknowns. A net is a candidate if, extended to 64 bits, it
//! has the same values as the product. The caller must prove with the solver that net and product are equal.

use std::collections::HashMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::term::{VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;

/// The number of sets of random values for which terms are compared.
const SAMPLES: usize = 24;

/// The values of all terms for 24 sets of random values of the unknowns. Terms with the same values may be equal.
pub struct Candidates {
    values: Vec<HashMap<VectorTermId, u64>>,
    /// For each list of values, the first net that has them, after its extension to 64 bits by zeros or by its sign bit.
    nets: HashMap<Vec<u64>, VectorTermId>,
}

impl Candidates {
    /// Evaluates the terms `nets` and `others`, and all terms on which they depend. Only `nets` can be candidates.
    pub fn new<'i>(
        terms: &VectorTerms,
        nets: &'i [VectorTermId],
        others: impl Iterator<Item = &'i VectorTermId>,
    ) -> Self {
        let cone = terms.cone(nets.iter().chain(others).copied());
        let values: Vec<HashMap<VectorTermId, u64>> = samples(terms, &cone).collect();
        let mut known = HashMap::new();
        for signed in [false, true] {
            for &net in nets {
                let drop = MAX_WIDTH - terms.width(net);
                let number =
                    |bits: u64| if signed { ((bits << drop) as i64 >> drop) as u64 } else { bits };
                let key = values.iter().map(|values| number(values[&net])).collect();
                known.entry(key).or_insert(net);
            }
        }
        Self { values, nets: known }
    }

    /// Returns a net that, extended to 64 bits, has the same values as the 64-bit term `id`.
    pub fn of(&self, id: VectorTermId) -> Option<VectorTermId> {
        let key: Vec<u64> = self.values.iter().map(|values| values[&id]).collect();
        self.nets.get(&key).copied()
    }
}

/// Returns whether two terms have the same width, and the same values for 24 sets of random values of the unknowns.
pub fn agree(terms: &VectorTerms, one: VectorTermId, other: VectorTermId) -> bool {
    let cone = terms.cone([one, other]);
    terms.width(one) == terms.width(other)
        && samples(terms, &cone).all(|values| values[&one] == values[&other])
}

/// Evaluates the terms `cone` `SAMPLES` times, with new random values of the unknowns each time. The seed is always the same.
pub fn samples(
    terms: &VectorTerms,
    cone: &[VectorTermId],
) -> impl Iterator<Item = HashMap<VectorTermId, u64>> {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    (0..SAMPLES).map(move |_| {
        let key = random.next_u64();
        terms.values(cone, |number| {
            let mut one = ChaCha8Rng::seed_from_u64(key ^ u64::from(number));
            match one.next_u32() % 8 {
                0 => 0,
                1 => u64::MAX,
                _ => one.next_u64(),
            }
        })
    })
}

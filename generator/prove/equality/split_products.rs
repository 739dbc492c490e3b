//! Finds the nets that may carry a product that was put together from parts.

use std::collections::HashMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::term::{VectorTermId, VectorTerms};
use glint_base::fixed::MAX_WIDTH;

/// Numbers at random by which terms that may be equal are found.
const SAMPLES: usize = 4;

/// Values of terms for numbers at random in place of the unknowns: terms that may be equal.
pub struct Candidates {
    values: Vec<HashMap<VectorTermId, u64>>,
    /// The first net of these values, extended by zeros or by its sign bit.
    nets: HashMap<Vec<u64>, VectorTermId>,
}

impl Candidates {
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

    /// Returns a net that has the values of a term of 64 bits, extended to as many. For example, a net of 20 bits may
    /// have them with its sign extended.
    pub fn of(&self, id: VectorTermId) -> Option<VectorTermId> {
        let key: Vec<u64> = self.values.iter().map(|values| values[&id]).collect();
        self.nets.get(&key).copied()
    }
}

/// Returns whether two terms of one width have the same values for numbers at random.
pub fn agree(terms: &VectorTerms, one: VectorTermId, other: VectorTermId) -> bool {
    let cone = terms.cone([one, other]);
    terms.width(one) == terms.width(other)
        && samples(terms, &cone).all(|values| values[&one] == values[&other])
}

/// Evaluates the terms of a cone `SAMPLES` times, with new random values of the unknowns each time. The seed is fixed.
pub fn samples(
    terms: &VectorTerms,
    cone: &[VectorTermId],
) -> impl Iterator<Item = HashMap<VectorTermId, u64>> {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    (0..SAMPLES).map(move |_| {
        let key = random.next_u64();
        terms.values(cone, |number| {
            let mut one = ChaCha8Rng::seed_from_u64(key ^ u64::from(number));
            one.next_u64()
        })
    })
}

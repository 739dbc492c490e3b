//! Tests, for random terms and values, that simplified terms keep their values, and that the facts for the solver are true.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::facts;
use super::symbolic::Product;
use super::term::{ADDRESS, VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::mask;

/// Half of the values are random, and the rest are 0 or all ones.
fn unknowns(random: &mut ChaCha8Rng) -> Vec<u64> {
    let of = |random: &mut ChaCha8Rng| match random.next_u32() % 4 {
        0 => 0,
        1 => u64::MAX,
        _ => random.next_u64(),
    };
    (0..64).map(|_| of(random)).collect()
}

fn signed(bits: u64, width: u32) -> i64 {
    (bits << (64 - width)) as i64 >> (64 - width)
}

#[test]
fn simpler_terms_have_the_values_of_those_that_were_asked_for() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..60 {
        let values = unknowns(&mut random);
        let mut terms = VectorTerms::default();
        // The terms that are made, each with its expected value.
        let mut made: Vec<(VectorTermId, u64)> = Vec::new();
        for value in &values[..6] {
            let width = 1 + random.next_u32() % 12;
            made.push((terms.unknown(width), value & mask(width)));
            let bits = random.next_u64() & mask(width);
            made.push((terms.constant(bits, width), bits));
        }
        for _ in 0..300 {
            let mut pick = || made[random.next_u32() as usize % made.len()];
            let ((a, x), (b, y), (c, z)) = (pick(), pick(), pick());
            let width = terms.width(a);
            let (b, y) = (terms.resized(b, width), y & mask(width));
            let (bit, z) = (terms.slice(c, 0, 1), z & 1);
            let (term, width, value) = match random.next_u32() % 13 {
                0 => (VectorTerm::Not(a), width, !x),
                1 => (VectorTerm::And(a, b), width, x & y),
                2 => (VectorTerm::Or(a, b), width, x | y),
                3 => (VectorTerm::Xor(a, b), width, x ^ y),
                4 => (VectorTerm::Add(a, b), width, x.wrapping_add(y)),
                5 => (VectorTerm::Sub(a, b), width, x.wrapping_sub(y)),
                6 => (VectorTerm::Equal(a, b), 1, u64::from(x == y)),
                7 => (VectorTerm::Less(a, b), 1, u64::from(x < y)),
                8 => {
                    let less = signed(x, width) < signed(y, width);
                    (VectorTerm::SignedLess(a, b), 1, u64::from(less))
                }
                9 => (VectorTerm::Choice(bit, a, b), width, if z == 1 { x } else { y }),
                10 => {
                    let low = random.next_u32() % width;
                    let bits = 1 + random.next_u32() % (width - low);
                    (VectorTerm::Slice { of: a, low }, bits, x >> low)
                }
                11 if width <= 32 => (VectorTerm::Join(a, b), 2 * width, x << width | y),
                _ => (VectorTerm::SignExtend(a), (width + 3).min(64), signed(x, width) as u64),
            };
            if matches!(term, VectorTerm::SignExtend(_)) && width == terms.width(a) {
                continue;
            }
            made.push((terms.make(term, width), value & mask(width)));
        }
        let cone = terms.cone(made.iter().map(|&(id, _)| id));
        let found = terms.values(&cone, |number| values[number as usize]);
        for (id, value) in made {
            assert_eq!(found[&id], value, "{:?}", terms.term(id));
        }
    }
}

/// Checks the facts about products of factors that are sliced, extended, or both, and about reads from memories.
#[test]
fn facts_hold_whatever_the_operands_are() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut seen = [0; 2];
    for round in 0..200 {
        let mut terms = VectorTerms::default();
        let mut products = Vec::new();
        let mut roots: Vec<VectorTermId> = Vec::new();
        let factors: Vec<VectorTermId> = (0..3)
            .map(|_| {
                let width = 4 + random.next_u32() % 28;
                let low = random.next_u32() % 12 % width;
                let whole = terms.unknown(width);
                let bits = terms.slice(whole, low, width - low);
                if low > 0 && width < 31 {
                    // The first row of the rest of a square.
                    let (rest, zero) = (terms.slice(whole, 0, low), terms.constant(0, 1));
                    let below = terms.make(VectorTerm::Join(zero, rest), low + 1);
                    let between = terms.make(VectorTerm::Join(bits, below), width + 1);
                    let (bit, none) = (terms.slice(rest, 0, 1), terms.constant(0, width + 1));
                    roots.push(terms.choice(bit, between, none));
                }
                match random.next_u32() % 2 {
                    0 => terms.resized(bits, 64),
                    _ => terms.sign_extended(bits, 64),
                }
            })
            .collect();
        for pair in [[0, 1], [1, 2], [2, 2]] {
            let factors = pair.map(|at| factors[at]);
            let ranges = [random.next_u32() % 5000, random.next_u32() % 5000];
            let ranges = ranges.map(|most| (-i128::from(most % 7), i128::from(most)));
            products.push(Product { factors, ranges });
            roots.push(terms.make(VectorTerm::Product(factors[0], factors[1]), 64));
        }
        for words in [3, 40] {
            let words: Vec<u64> = (0..words).map(|_| random.next_u64() & mask(9) & !6).collect();
            let memory = terms.memory(&words);
            let address = terms.unknown(6);
            let address = terms.resized(address, ADDRESS);
            roots.push(terms.make(VectorTerm::Word { memory, address }, 9));
        }
        for parts in [false, true] {
            let facts = facts::about(&mut terms, &roots, &products, parts);
            seen[usize::from(parts)] += facts.len();
            let cone = terms.cone(facts.iter().copied());
            for _ in 0..20 {
                let values = unknowns(&mut random);
                let found = terms.values(&cone, |number| values[number as usize]);
                for fact in &facts {
                    assert_eq!(found[fact], 1, "round {round}: {:?}", terms.term(*fact));
                }
            }
        }
        let divided = facts::divided(&mut terms, roots);
        let cone = terms.cone(divided.iter().flat_map(|(&product, &sum)| [product, sum]));
        let values = unknowns(&mut random);
        let found = terms.values(&cone, |number| values[number as usize]);
        for (product, sum) in divided {
            assert_eq!(found[&product], found[&sum], "round {round}");
        }
    }
    assert!(seen[0] > 1000 && seen[1] > seen[0] + 200, "{seen:?}");
}

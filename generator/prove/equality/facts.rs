//! Gives the SMT solver arithmetic facts about the products and memory words in its question.
//!
//! The solver treats a product and a memory's read as uninterpreted functions and knows nothing about them. One fact says that a
//! product with a factor 0 is 0. Another says that a memory word lies within the bounds of all words. Every fact is true for all
//! values, so an unnecessary fact cannot make a proof wrong.

use std::collections::{HashMap, HashSet};

use super::symbolic::Product;
use super::term::{VectorTerm, VectorTermId, VectorTerms};
use glint_base::fixed::{MAX_WIDTH, mask};
use glint_base::interval::{self, Interval};

/// A product with a factor of at most this number of bits is written out as a sum of rows, one for each bit.
const ROWS: u32 = 8;

/// The contents of a memory of at most this number of words are written out word by word.
const WORDS: usize = 16;

/// Returns facts about the products and memory words on which the terms `roots` depend. Each fact is a term of one bit that is
/// always 1. If `parts` is set, further facts divide a product: it is the sum of the products of a factor's parts, which are new
/// products.
pub fn about(
    terms: &mut VectorTerms,
    roots: &[VectorTermId],
    products: &[Product],
    parts: bool,
) -> Vec<VectorTermId> {
    let mut facts = Vec::new();
    let mut seen = HashSet::new();
    loop {
        let cone = terms.cone(roots.iter().chain(&facts).copied());
        let new: Vec<VectorTermId> = cone.into_iter().filter(|&id| seen.insert(id)).collect();
        if new.is_empty() {
            break;
        }
        for id in new {
            match *terms.term(id) {
                VectorTerm::Product(a, b) => {
                    if parts {
                        let of_both = [in_parts(terms, a, b), in_parts(terms, b, a)];
                        for ProductSum { product, sum, .. } in of_both.into_iter().flatten() {
                            facts.push(terms.equal(product, sum));
                        }
                    }
                    for (factor, other) in [(a, b), (b, a)] {
                        facts.extend(by_one_or_none(terms, id, factor, other));
                    }
                    let by_width = [a, b].map(|factor| range_by_width(terms, factor));
                    facts.extend(within(terms, &Product { factors: [a, b], ranges: by_width }));
                    for product in products {
                        if product.factors == [a, b] || product.factors == [b, a] {
                            facts.extend(within(terms, product));
                        }
                    }
                }
                VectorTerm::Word { memory, address } => {
                    facts.extend(contents(terms, id, memory, address));
                }
                _ => {}
            }
        }
    }
    facts.retain(|&fact| terms.constant_of(fact).is_none());
    facts
}

/// Returns the facts about a product with a factor 0, 1 or −1. For example, one fact says: `factor` is not 1, or `product` equals
/// `other`.
fn by_one_or_none(
    terms: &mut VectorTerms,
    product: VectorTermId,
    factor: VectorTermId,
    other: VectorTermId,
) -> [VectorTermId; 3] {
    let zero = terms.constant(0, MAX_WIDTH);
    let negative = terms.make(VectorTerm::Sub(zero, other), MAX_WIDTH);
    [(0, zero), (1, other), (u64::MAX, negative)].map(|(value, result)| {
        let value = terms.constant(value, MAX_WIDTH);
        let (is, equal) = (terms.equal(factor, value), terms.equal(product, result));
        let not = terms.not(is);
        terms.make(VectorTerm::Or(not, equal), 1)
    })
}

/// Finds products that a design computes as a sum of partial products, among the terms on which `roots` depend. Returns the term
/// of the sum for each product.
pub fn divided(
    terms: &mut VectorTerms,
    roots: impl IntoIterator<Item = VectorTermId>,
) -> HashMap<VectorTermId, VectorTermId> {
    let mut pending = terms.cone(roots);
    pending.retain(|&id| matches!(terms.term(id), VectorTerm::Product(..)));
    let mut divided = HashMap::new();
    while let Some(part) = pending.pop() {
        let VectorTerm::Product(a, b) = *terms.term(part) else { continue };
        for (factor, other) in [(a, b), (b, a)] {
            if let Some(parts) = in_parts(terms, factor, other)
                && parts.there
                && divided.insert(parts.product, parts.sum).is_none()
            {
                pending.push(parts.product);
            }
        }
    }
    divided
}

/// Returns the narrower term that `factor` extends, and whether the extension copies the sign bit (`true`) or adds zeros
/// (`false`). Returns `None` if `factor` is no extension.
pub fn extended(terms: &VectorTerms, factor: VectorTermId) -> Option<(VectorTermId, bool)> {
    match *terms.term(factor) {
        VectorTerm::SignExtend(bits) => Some((bits, true)),
        VectorTerm::Join(top, bits) if terms.constant_of(top) == Some(0) => Some((bits, false)),
        _ => None,
    }
}

struct ProductSum {
    product: VectorTermId,
    sum: VectorTermId,
    /// Whether the design computes the product as this sum: the terms already contain the lower part's product.
    there: bool,
}

/// Returns the product of a larger term and `other` as a sum of partial products, if `factor` is the upper bits of the larger
/// term. The sum is the product of `factor` and `other`, shifted, plus the product of the lower bits and `other`. For example, if
/// u is the bits from 4 up of w, then w·x is 16·(u·x) plus the lowest 4 bits of w times x.
fn in_parts(
    terms: &mut VectorTerms,
    factor: VectorTermId,
    other: VectorTermId,
) -> Option<ProductSum> {
    let (bits, signed) = extended(terms, factor)?;
    let (whole, low) = whole(terms, bits)?;
    let rest = terms.slice(whole, 0, low);
    if factor == other
        && let Some(parts) = square_in_parts(terms, factor, whole, rest)
    {
        return Some(parts);
    }
    let whole = if signed {
        terms.sign_extended(whole, MAX_WIDTH)
    } else {
        terms.resized(whole, MAX_WIDTH)
    };
    let product = terms.make(VectorTerm::Product(whole, other), MAX_WIDTH);
    let upper = terms.make(VectorTerm::Product(factor, other), MAX_WIDTH);
    let upper = shifted(terms, upper, low);
    let lower = terms.resized(rest, MAX_WIDTH);
    let lower = VectorTerm::Product(lower, other);
    let is_product = terms.has(&lower, MAX_WIDTH);
    let there = is_product || has_row(terms, rest, other);
    let lower = if is_product || low > ROWS {
        terms.make(lower, MAX_WIDTH)
    } else {
        rows(terms, rest, other)
    };
    let sum = terms.make(VectorTerm::Add(upper, lower), MAX_WIDTH);
    Some(ProductSum { product, sum, there })
}

/// Returns the square of `u·2^r + l` as a sum, if the terms contain the product of `l` and `u·2^(r+1) + l`. The sum is this
/// product plus the square of u, shifted by 2r. For example, 13² with u = 3, l = 1 and r = 2 is 1·25 plus 9·16.
fn square_in_parts(
    terms: &mut VectorTerms,
    factor: VectorTermId,
    whole: VectorTermId,
    rest: VectorTermId,
) -> Option<ProductSum> {
    let (bits, signed) = extended(terms, factor)?;
    let low = terms.width(rest);
    if terms.width(whole) >= MAX_WIDTH || 2 * low >= MAX_WIDTH {
        return None;
    }
    let zero = terms.constant(0, 1);
    let below = terms.make(VectorTerm::Join(zero, rest), low + 1);
    let between = terms.make(VectorTerm::Join(bits, below), terms.width(bits) + low + 1);
    let [whole, between] = [whole, between].map(|it| {
        if signed { terms.sign_extended(it, MAX_WIDTH) } else { terms.resized(it, MAX_WIDTH) }
    });
    let lower = terms.resized(rest, MAX_WIDTH);
    let lower = VectorTerm::Product(lower, between);
    let lower = if terms.has(&lower, MAX_WIDTH) {
        terms.make(lower, MAX_WIDTH)
    } else if has_row(terms, rest, between) {
        rows(terms, rest, between)
    } else {
        return None;
    };
    let product = terms.make(VectorTerm::Product(whole, whole), MAX_WIDTH);
    let upper = terms.make(VectorTerm::Product(factor, factor), MAX_WIDTH);
    let upper = shifted(terms, upper, 2 * low);
    let sum = terms.make(VectorTerm::Add(upper, lower), MAX_WIDTH);
    Some(ProductSum { product, sum, there: true })
}

/// Returns the larger term that has the upper bits `bits`, and the number of its bits below `bits`. For example, if `bits` is
/// bits 4 to 7 of a term, the result is the term's bits 0 to 7, and 4.
fn whole(terms: &mut VectorTerms, bits: VectorTermId) -> Option<(VectorTermId, u32)> {
    match *terms.term(bits) {
        VectorTerm::Slice { of, low } if low > 0 => {
            Some((terms.slice(of, 0, low + terms.width(bits)), low))
        }
        VectorTerm::Join(upper, lower) => {
            let (below, low) = whole(terms, lower)?;
            let width = terms.width(bits) + low;
            Some((terms.make(VectorTerm::Join(upper, below), width), low))
        }
        _ => None,
    }
}

/// Returns whether the terms contain the first partial product of `bits` and `other`: `other` if the lowest bit of `bits` is 1,
/// and otherwise 0.
fn has_row(terms: &mut VectorTerms, bits: VectorTermId, other: VectorTermId) -> bool {
    let narrow = match *terms.term(other) {
        VectorTerm::SignExtend(narrow) => narrow,
        VectorTerm::Join(top, narrow) if terms.constant_of(top) == Some(0) => narrow,
        _ => other,
    };
    let (bit, width) = (terms.slice(bits, 0, 1), terms.width(narrow));
    let (zero, all) = (terms.constant(0, width), terms.sign_extended(bit, width));
    terms.has(&VectorTerm::Choice(bit, narrow, zero), width)
        || terms.has(&VectorTerm::And(narrow, all), width)
}

/// Returns the product of `bits` and the 64-bit term `other` as a sum of rows, one for each bit.
fn rows(terms: &mut VectorTerms, bits: VectorTermId, other: VectorTermId) -> VectorTermId {
    let zero = terms.constant(0, MAX_WIDTH);
    let mut sum = zero;
    for row in 0..terms.width(bits) {
        let bit = terms.slice(bits, row, 1);
        let addend = shifted(terms, other, row);
        let taken = terms.choice(bit, addend, zero);
        sum = terms.make(VectorTerm::Add(sum, taken), MAX_WIDTH);
    }
    sum
}

/// Returns term `id`, shifted left by `by` places, as a term of 64 bits.
pub fn shifted(terms: &mut VectorTerms, id: VectorTermId, by: u32) -> VectorTermId {
    if by == 0 {
        return id;
    }
    let (kept, zeros) = (terms.slice(id, 0, MAX_WIDTH - by), terms.constant(0, by));
    terms.make(VectorTerm::Join(kept, zeros), MAX_WIDTH)
}

/// Returns the interval of a 64-bit factor that follows from the width of the term that it extends. For example, a term of 8 bits
/// with zeros above it is at most 255. The intervals in the design can be wider: a multiplier that several products share has the
/// intervals of all its factors.
fn range_by_width(terms: &VectorTerms, factor: VectorTermId) -> Interval {
    match extended(terms, factor) {
        Some((bits, true)) => {
            let half = 1 << (terms.width(bits) - 1);
            (-half, half - 1)
        }
        Some((bits, false)) => (0, (1 << terms.width(bits)) - 1),
        None => match terms.constant_of(factor) {
            Some(bits) => (i128::from(bits as i64), i128::from(bits as i64)),
            None => (i128::from(i64::MIN), i128::from(i64::MAX)),
        },
    }
}

/// Returns the fact that a product lies in the product of its factors' intervals, if both factors lie in their intervals. Returns
/// `None` if an end does not fit into 64 bits.
fn within(terms: &mut VectorTerms, product: &Product) -> Option<VectorTermId> {
    let [a, b] = product.factors;
    let [x, y] = product.ranges;
    let (least, most) = interval::product(x, y);
    let range = (if a == b { least.max(0) } else { least }, most);
    let premises = [between(terms, a, x)?, between(terms, b, y)?];
    let value = terms.make(VectorTerm::Product(a, b), MAX_WIDTH);
    let conclusion = between(terms, value, range)?;
    let both = terms.make(VectorTerm::And(premises[0], premises[1]), 1);
    let not = terms.not(both);
    Some(terms.make(VectorTerm::Or(not, conclusion), 1))
}

/// Returns a one-bit term that is 1 if `value`, a two's complement number of 64 bits, lies in `range`. Returns `None` if an end
/// does not fit into 64 bits.
fn between(terms: &mut VectorTerms, value: VectorTermId, range: Interval) -> Option<VectorTermId> {
    let low = i64::try_from(range.0).ok()?;
    let high = i64::try_from(range.1).ok()?;
    let (low, high) =
        (terms.constant(low as u64, MAX_WIDTH), terms.constant(high as u64, MAX_WIDTH));
    let below = terms.make(VectorTerm::SignedLess(value, low), 1);
    let above = terms.make(VectorTerm::SignedLess(high, value), 1);
    let outside = terms.make(VectorTerm::Or(below, above), 1);
    Some(terms.not(outside))
}

/// Returns facts about `word`, which `memory` has at `address`. For a small memory, they give the word at each address. For a
/// large memory, they give the bits that are 0 in all words, and the interval that contains all words.
fn contents(
    terms: &mut VectorTerms,
    word: VectorTermId,
    memory: usize,
    address: VectorTermId,
) -> Vec<VectorTermId> {
    let words = terms.memories[memory].clone();
    let width = terms.width(word);
    if words.len() <= WORDS {
        let mut exact = Vec::new();
        for (at, &bits) in words.iter().enumerate() {
            let at = terms.constant(at as u64, terms.width(address));
            let (here, bits) = (terms.equal(address, at), terms.constant(bits, width));
            let (elsewhere, right) = (terms.not(here), terms.equal(word, bits));
            exact.push(terms.make(VectorTerm::Or(elsewhere, right), 1));
        }
        return exact;
    }
    let mut used = 0;
    // A word beyond the contents is 0.
    let (mut largest, mut least, mut greatest) = (0, 0, 0);
    let signed = |word: u64| (word << (MAX_WIDTH - width)) as i64;
    for &word in &words {
        used |= word;
        largest = largest.max(word);
        if signed(word) < signed(least) {
            least = word;
        }
        if signed(word) > signed(greatest) {
            greatest = word;
        }
    }
    let unused = terms.constant(!used & mask(width), width);
    let masked = terms.make(VectorTerm::And(word, unused), width);
    let zero = terms.constant(0, width);
    let lacks_unused = terms.equal(masked, zero);
    let most = terms.constant(largest, width);
    let above = terms.make(VectorTerm::Less(most, word), 1);
    let (lowest, highest) = (terms.constant(least, width), terms.constant(greatest, width));
    let outside = [
        above,
        terms.make(VectorTerm::SignedLess(word, lowest), 1),
        terms.make(VectorTerm::SignedLess(highest, word), 1),
    ];
    let mut facts = outside.map(|outside| terms.not(outside)).to_vec();
    facts.push(lacks_unused);
    facts
}

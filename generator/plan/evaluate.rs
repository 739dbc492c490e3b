//! Computes the values of all nodes of a plan in integers, from the definitions of their operations. The golden model of the
//! device `expression` uses it.

use super::node::{NodeId, Operation, PlanNode, middle, normalising_shifts};
use super::plan::ExpressionPlan;

impl ExpressionPlan {
    /// Returns the raw value of each node, from the raw values of the operands in their order. For example, the plan of `x * y`
    /// has a node with the value 6 for x = 2 and y = 3.
    ///
    /// # Panics
    /// Panics if there are fewer values than operands, or if the plan has a function whose polynomials are not known yet.
    pub fn values(&self, operands: &[i64]) -> Vec<i128> {
        let mut values: Vec<i128> = Vec::with_capacity(self.nodes().len());
        for at in 0..self.nodes().len() {
            let value = self.value(NodeId(at), operands, &|id: NodeId| values[id.0]);
            values.push(value);
        }
        values
    }

    /// Returns the raw value of one node, from the raw values of the operands. `known` returns the raw value of a node that
    /// this node reads.
    ///
    /// # Panics
    /// Panics if there are fewer values than operands, or if the node is a function whose polynomials are not known yet.
    pub fn value<F>(&self, id: NodeId, operands: &[i64], known: &F) -> i128
    where
        F: Fn(NodeId) -> i128 + ?Sized,
    {
        // Operands outside their domains can give values beyond the format, as in the hardware.
        wrapped(self.node(id), self.whole_value(id, operands, known))
    }

    /// Returns the raw value of a node before the bits beyond its format are dropped.
    pub(super) fn whole_value<F>(&self, id: NodeId, operands: &[i64], known: &F) -> i128
    where
        F: Fn(NodeId) -> i128 + ?Sized,
    {
        let node = self.node(id);
        // Returns the raw value of `input` with `frac` fraction bits, if it has fewer.
        let aligned = |input: NodeId, frac: i32| {
            left_by(known(input), (frac - self.node(input).format.frac).max(0).into())
        };
        let finest = |a: NodeId, b: NodeId| self.node(a).format.frac.max(self.node(b).format.frac);
        match &node.operation {
            Operation::Operand(number) => operands[*number].into(),
            Operation::Constant { raw, .. } => *raw,
            Operation::Add(a, b) => aligned(*a, node.format.frac) + aligned(*b, node.format.frac),
            Operation::Subtract(a, b) => {
                aligned(*a, node.format.frac) - aligned(*b, node.format.frac)
            }
            Operation::Multiply(a, b) => known(*a) * known(*b),
            Operation::Absolute(a) => known(*a).abs(),
            Operation::Minimum(a, b) => {
                aligned(*a, node.format.frac).min(aligned(*b, node.format.frac))
            }
            Operation::Maximum(a, b) => {
                aligned(*a, node.format.frac).max(aligned(*b, node.format.frac))
            }
            Operation::Less(a, b) => {
                let frac = finest(*a, *b);
                i128::from(aligned(*a, frac) < aligned(*b, frac))
            }
            Operation::NonZero(a) => i128::from(known(*a) != 0),
            Operation::Choose { condition, cases } => {
                let chosen = cases[known(*condition) as usize];
                aligned(chosen, node.format.frac)
            }
            Operation::Scale(a) => known(*a),
            Operation::Narrow(a, rounding) => {
                let places = self.node(*a).format.frac - node.format.frac;
                if places > 0 {
                    rounding.shift(known(*a), places)
                } else {
                    left_by(known(*a), i128::from(-places))
                }
            }
            Operation::Middle(a) => middle(known(*a), self.node(*a).format.frac - node.format.frac),
            Operation::Bit(a, number) => known(*a) >> number & 1,
            Operation::IntegerPart(a) => known(*a) >> self.node(*a).format.frac,
            Operation::FractionPart(a, _) => known(*a),
            Operation::Normalise { word, by_pairs } => {
                normalised(known(*word), self.node(*word).format.width(), *by_pairs).0
            }
            Operation::Places(normalised_word) => {
                let Operation::Normalise { word, by_pairs } = self.node(*normalised_word).operation
                else {
                    unreachable!("places are those of a normalised word")
                };
                normalised(known(word), self.node(word).format.width(), by_pairs).1
            }
            Operation::ShiftLeft(a, places) => left_by(known(*a), known(*places)),
            Operation::ShiftRight(a, places) => known(*a) >> known(*places).min(127),
            Operation::Reverse(a) => {
                let unused = u128::BITS - node.format.width();
                (known(*a).cast_unsigned().reverse_bits() >> unused).cast_signed()
            }
            Operation::Lookup { address, words } => {
                let place = usize::try_from(known(*address)).expect("an address has no sign");
                words.get(place).copied().unwrap_or(0)
            }
            Operation::Polynomial(a, approximation) => {
                let polynomials = approximation.polynomials.as_ref();
                let polynomials = polynomials.expect("a plan whose polynomials are known");
                polynomials.result(known(*a) as i64).into()
            }
        }
    }
}

/// Returns the low 128 bits of `raw` · 2^`places`.
fn left_by(raw: i128, places: i128) -> i128 {
    u32::try_from(places).ok().and_then(|places| raw.checked_shl(places)).unwrap_or(0)
}

/// Returns the raw value after the bits beyond the format of the node are dropped.
fn wrapped(node: &PlanNode, raw: i128) -> i128 {
    match node.format.holds(raw) {
        true => raw,
        false => node.format.raw(node.format.bits(raw)),
    }
}

/// Returns the bits of a word after it is shifted left until its top bit is 1, and the number of bits of the shift. By pairs,
/// the shift is even, and the number counts pairs. For example, 22 in 8 bits gives 176 and 3, or by pairs 88 and 1.
fn normalised(word: i128, width: u32, by_pairs: bool) -> (i128, i128) {
    let mut bits = word;
    let mut places = 0;
    for shift in normalising_shifts(width, by_pairs) {
        if bits >> (width - shift) == 0 {
            bits <<= shift;
            places += i128::from(shift);
        }
    }
    (bits, if by_pairs { places / 2 } else { places })
}

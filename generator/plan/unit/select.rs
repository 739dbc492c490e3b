//! Builds choices by the opcode, such as the choice of the word that the shared normaliser gets.
//!
//! A choice between n different values takes n − 1 two-way choices. A tree over the bits of the opcode often has more, because the
//! functions with the same value are seldom neighbours. Such a choice reads its conditions from a table, the *selections*, with a word for
//! each opcode.

use glint_base::fixed::Rounding;

use super::opcode_bits;
use super::tables::wide_enough;
use crate::node::{NodeId, Operation};
use crate::plan::PlanBuilder;
use crate::refusal::PlanRefusal;

/// The choices by the opcode in a merged plan.
pub(super) struct OpcodeChoices {
    opcode: NodeId,
    functions: usize,
    /// The table of conditions. It gets its words when all choices are known.
    selections: NodeId,
    /// The columns of the table. Each has a bit for each function, or `None` where the bit does not matter.
    columns: Vec<Vec<Option<bool>>>,
    /// Nodes that are low bits of a shared word, with this word. For their functions, the word has the same value.
    low_bits: Vec<(NodeId, NodeId)>,
}

/// The bits of a word without its lowest `dropped` bits. For example, −2 appends two zeros below the word.
#[derive(Clone, Copy, Debug, PartialEq)]
struct WordBits {
    word: NodeId,
    dropped: i32,
}

impl OpcodeChoices {
    /// Adds the table of conditions to `plan`.
    ///
    /// # Errors
    /// Fails if the plan has no room for it.
    pub(super) fn new(
        plan: &mut PlanBuilder,
        opcode: NodeId,
        functions: usize,
    ) -> Result<Self, PlanRefusal> {
        let selections = plan.lookup("selections", opcode, Vec::new(), 0)?;
        Ok(Self { opcode, functions, selections, columns: Vec::new(), low_bits: Vec::new() })
    }

    /// Remembers that `low_bits` are the low bits of `word`, and that both have the same value for the function that reads them.
    pub(super) fn add_low_bits(&mut self, low_bits: NodeId, word: NodeId) {
        if low_bits != word && !self.low_bits.contains(&(low_bits, word)) {
            self.low_bits.push((low_bits, word));
        }
    }

    /// Returns a node with the value of `cases[opcode]`. A missing case may have any value. The list has a case for each function.
    ///
    /// # Errors
    /// Fails if the value has too many bits.
    ///
    /// # Panics
    /// Panics if no case is given.
    pub(super) fn selected(
        &mut self,
        plan: &mut PlanBuilder,
        name: &str,
        cases: &[Option<NodeId>],
    ) -> Result<NodeId, PlanRefusal> {
        let mut cases = self.with_common_words(plan, name, cases)?;
        let mut distinct: Vec<NodeId> = Vec::new();
        for case in cases.iter().flatten() {
            if !distinct.contains(case) {
                distinct.push(*case);
            }
        }
        let bits = opcode_bits(self.functions);
        cases.resize(1 << bits, None);
        if choices_in_tree(&cases).0 < distinct.len() {
            let mut conditions = Vec::new();
            for bit in 0..bits {
                conditions.push(plan.bit(&format!("opcode_bit{bit}"), self.opcode, bit)?);
            }
            let selected = tree(plan, name, &cases, &conditions)?;
            return Ok(selected.expect("a case"));
        }
        let mut conditions = Vec::new();
        let mut leaves: Vec<Option<NodeId>> = distinct.iter().copied().map(Some).collect();
        leaves.resize(distinct.len().next_power_of_two(), None);
        for bit in 0..leaves.len().trailing_zeros() {
            let mut column = Vec::new();
            for case in &cases {
                let place = distinct.iter().position(|other| Some(*other) == *case);
                column.push(place.map(|place| place >> bit & 1 != 0));
            }
            conditions.push(self.condition(plan, column)?);
        }
        let selected = tree(plan, name, &leaves, &conditions)?;
        Ok(selected.expect("a case"))
    }

    /// Replaces cases that are bits of the same word, from the same lowest bit on, by the bits of the widest of them, so that
    /// they need no choice.
    fn with_common_words(
        &self,
        plan: &mut PlanBuilder,
        name: &str,
        cases: &[Option<NodeId>],
    ) -> Result<Vec<Option<NodeId>>, PlanRefusal> {
        let mut common = cases.to_vec();
        for at in 0..common.len() {
            let Some(case) = common[at] else { continue };
            let WordBits { word, dropped } = self.source_of(plan, case);
            let mut format = plan.node(case).format;
            let mut alike = Vec::new();
            for (place, other) in common.iter().enumerate() {
                let Some(other) = *other else { continue };
                let own = plan.node(other).format;
                let has_same_bits = self.source_of(plan, other) == WordBits { word, dropped };
                if has_same_bits && own.frac == format.frac {
                    format = wide_enough(format, own);
                    alike.push(place);
                }
            }
            if alike.iter().all(|place| common[*place] == Some(case)) {
                continue;
            }
            let exponent = plan.node(word).format.frac - dropped - format.frac;
            let bits = plan.scale(name, word, exponent)?;
            let bits = plan.low_bits(name, bits, format)?;
            for place in alike {
                common[place] = Some(bits);
            }
        }
        Ok(common)
    }

    /// Returns the word whose bits a node has, and the number of dropped low bits.
    fn source_of(&self, plan: &PlanBuilder, node: NodeId) -> WordBits {
        let mut source = WordBits { word: node, dropped: 0 };
        loop {
            let at = plan.node(source.word);
            source = match at.operation {
                Operation::Scale(before) => WordBits { word: before, ..source },
                Operation::Narrow(before, Rounding::Truncate) => {
                    let wide = plan.node(before).format;
                    let keeps_top = at.format.int >= wide.int && at.format.signed == wide.signed;
                    let is_low_bits = self.low_bits.contains(&(source.word, before));
                    let dropped = wide.frac - at.format.frac;
                    // Zeros that are appended below may be dropped afterwards, but dropped bits do not come back.
                    let drops_below_zeros = source.dropped < 0 && dropped > 0;
                    if drops_below_zeros || !keeps_top && !is_low_bits {
                        return source;
                    }
                    WordBits { word: before, dropped: source.dropped + dropped }
                }
                _ => return source,
            };
        }
    }

    /// Returns the node of a condition that is `column[opcode]`, from a new column of the table, or from a column that agrees
    /// with it.
    fn condition(
        &mut self,
        plan: &mut PlanBuilder,
        column: Vec<Option<bool>>,
    ) -> Result<NodeId, PlanRefusal> {
        let agree = |other: &Vec<Option<bool>>| {
            let mut pairs = other.iter().zip(&column);
            pairs.all(|(a, b)| a.is_none() || b.is_none() || a == b)
        };
        let number = match self.columns.iter().position(agree) {
            Some(number) => {
                for (bit, own) in self.columns[number].iter_mut().zip(&column) {
                    *bit = bit.or(*own);
                }
                number
            }
            None => {
                self.columns.push(column);
                self.columns.len() - 1
            }
        };
        plan.bit(&format!("selection{number}"), self.selections, number as u32)
    }

    /// Gives the table of conditions its words.
    pub(super) fn finish(self, plan: &mut PlanBuilder) {
        let mut words = vec![0i128; 1 << opcode_bits(self.functions)];
        for (number, column) in self.columns.iter().enumerate() {
            for (word, bit) in words.iter_mut().zip(column) {
                *word |= i128::from(*bit == Some(true)) << number;
            }
        }
        let bits = self.columns.len().max(1) as i32;
        plan.complete_lookup(self.selections, words, bits);
    }
}

/// Returns the number of two-way choices of a tree over the cases, and its case if it has only one.
fn choices_in_tree(cases: &[Option<NodeId>]) -> (usize, Option<NodeId>) {
    let mut given = cases.iter().flatten();
    let Some(first) = given.next() else { return (0, None) };
    if given.all(|case| case == first) {
        return (0, Some(*first));
    }
    let (lower, upper) = cases.split_at(cases.len() / 2);
    let is_choice = [lower, upper].iter().all(|half| half.iter().any(Option::is_some));
    let [lower, upper] = [lower, upper].map(|half| choices_in_tree(half).0);
    (lower + upper + usize::from(is_choice), None)
}

/// Returns a node with the value of the case whose index has the conditions as its bits; `None` without cases.
fn tree(
    plan: &mut PlanBuilder,
    name: &str,
    cases: &[Option<NodeId>],
    conditions: &[NodeId],
) -> Result<Option<NodeId>, PlanRefusal> {
    let mut given = cases.iter().flatten();
    let Some(first) = given.next() else { return Ok(None) };
    if given.all(|case| case == first) {
        return Ok(Some(*first));
    }
    let (last, others) = conditions.split_last().expect("a condition for each halving");
    let (lower, upper) = cases.split_at(cases.len() / 2);
    let lower = tree(plan, name, lower, others)?;
    let upper = tree(plan, name, upper, others)?;
    let (Some(lower), Some(upper)) = (lower, upper) else { return Ok(lower.or(upper)) };
    plan.choose(name, *last, [lower, upper]).map(Some)
}

//! Builds a plan node after node. [`PlanBuilder::finish`] checks the plan, which nothing changes afterwards.

use glint_base::fixed::{Format, MAX_WIDTH, Rounding, exp2, shifted_left};
use glint_base::interval::{self, Interval};
use glint_formula::Enclosure;

use super::{ANYTHING, ExpressionPlan};
use crate::memory::TableMemory;
use crate::node::{
    Approximation, CaseAgreement, NodeId, Operation, PlanNode, StatedValue, middle,
    normalising_shifts,
};
use crate::refusal::PlanRefusal;

/// A plan to which nodes are added.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlanBuilder {
    plan: ExpressionPlan,
}

impl PlanBuilder {
    /// Starts a plan with tables in `memory`.
    pub(crate) fn new(memory: TableMemory) -> Self {
        Self { plan: ExpressionPlan { memory, ..ExpressionPlan::default() } }
    }

    /// Starts a plan whose operations several functions share, with the opcode as the first operand.
    pub(crate) fn shared() -> Self {
        Self { plan: ExpressionPlan { is_shared: true, ..ExpressionPlan::default() } }
    }

    /// Starts a plan without nodes that is shared if `other` is, and has its tables in the same memory.
    pub(crate) fn like(other: &ExpressionPlan) -> Self {
        let ExpressionPlan { is_shared, memory, .. } = *other;
        Self { plan: ExpressionPlan { is_shared, memory, ..ExpressionPlan::default() } }
    }

    /// Starts with the nodes and the results of a finished plan, to change it.
    pub(crate) fn of_plan(plan: ExpressionPlan) -> Self {
        Self { plan }
    }

    /// Checks the plan, and returns it.
    ///
    /// # Errors
    /// Fails if the plan contradicts itself, which is a fault of Glint ([`ExpressionPlan::check`]).
    pub(crate) fn finish(self) -> Result<ExpressionPlan, PlanRefusal> {
        self.plan.check()?;
        Ok(self.plan)
    }

    /// Returns the plan with the nodes and the results so far.
    pub(crate) fn so_far(&self) -> &ExpressionPlan {
        &self.plan
    }

    pub(crate) fn node(&self, id: NodeId) -> &PlanNode {
        self.plan.node(id)
    }

    /// Makes a node the only result, so that the analysis gives its error.
    pub(crate) fn end_at(&mut self, node: NodeId) {
        self.plan.results = vec![node];
        self.plan.proved = vec![node];
    }

    /// Adds a result: the node `result`, and the node `proved` whose error is proved. They differ for a result that wraps.
    pub(crate) fn add_result(&mut self, result: NodeId, proved: NodeId) {
        self.plan.results.push(result);
        self.plan.proved.push(proved);
    }
}

/// Methods that state a fact about a node, which the analysis of errors then relies on.
impl PlanBuilder {
    /// States the value of a node by a formula of the operands.
    pub(crate) fn state_value(&mut self, id: NodeId, stated: StatedValue) {
        self.plan.nodes[id.0].stated = Some(stated);
    }

    /// States an interval that contains the node's value in real-number arithmetic wherever the value matters.
    pub(crate) fn state_limits(&mut self, id: NodeId, limits: Enclosure) {
        self.plan.nodes[id.0].limits = limits;
    }

    /// States an interval that contains the value of the hardware wherever the value matters.
    pub(crate) fn state_actual_limits(&mut self, id: NodeId, limits: Enclosure) {
        self.plan.nodes[id.0].actual_limits = limits;
    }

    /// States how far the node's value may be from the operation on the values of the inputs, both in real-number arithmetic.
    pub(crate) fn state_deviation(&mut self, id: NodeId, deviation: f64) {
        self.plan.nodes[id.0].deviation = deviation;
    }

    /// States how near the cases of a choice are to each other. `None` states nothing.
    pub(crate) fn state_agreement(&mut self, id: NodeId, agreement: Option<CaseAgreement>) {
        self.plan.nodes[id.0].agreement = agreement;
    }

    /// States which rounding operation gives the node its fraction bits; `None` for an exact node.
    pub(crate) fn state_source(&mut self, id: NodeId, source: Option<usize>) {
        self.plan.nodes[id.0].source = source;
    }

    /// Replaces the operation of a node by operand number `number`. The node keeps its format and its range.
    pub(crate) fn make_operand(&mut self, id: NodeId, number: usize) {
        let node = &mut self.plan.nodes[id.0];
        node.operation = Operation::Operand(number);
        node.stated = None;
    }

    /// Adds the words, of `bits` bits each, to a table of constants that [`Self::lookup`] added without words.
    pub(crate) fn complete_lookup(&mut self, id: NodeId, words: Vec<i128>, bits: i32) {
        let node = &mut self.plan.nodes[id.0];
        if let Operation::Lookup { words: own, .. } = &mut node.operation {
            *own = words;
        }
        node.format = Format::unsigned(bits, 0);
        node.range = node.format.range();
    }
}

/// Methods that add nodes to a plan. Each returns the node of its result, whose format can represent every value that the
/// ranges of the inputs allow. If the plan already has the same exact operation, they return its node instead. The methods fail
/// if the result needs more bits than a net can have.
impl PlanBuilder {
    fn insert(
        &mut self,
        name: &str,
        operation: Operation,
        format: Format,
        range: Interval,
    ) -> Result<NodeId, PlanRefusal> {
        let width = format.int + format.frac + i32::from(format.signed);
        if width > MAX_WIDTH as i32 {
            return Err(PlanRefusal::too_wide(width));
        }
        if let Some(same) = self.same_node(&operation, format) {
            return Ok(same);
        }
        let name = match operation {
            Operation::Operand(_) => name.to_owned(),
            _ => self.unused_name(name),
        };
        self.plan.nodes.push(PlanNode {
            name,
            operation,
            format,
            range,
            limits: ANYTHING,
            actual_limits: ANYTHING,
            stated: None,
            deviation: 0.0,
            agreement: None,
            source: None,
        });
        Ok(NodeId(self.plan.nodes.len() - 1))
    }

    /// Adds a copy of a node of another plan, with the operation replaced by `operation`, which must read nodes of this plan.
    pub(crate) fn push_copy(&mut self, node: &PlanNode, operation: Operation) -> NodeId {
        let name = match operation {
            Operation::Operand(_) => node.name.clone(),
            _ => self.unused_name(&node.name),
        };
        self.plan.nodes.push(PlanNode { name, operation, ..node.clone() });
        NodeId(self.plan.nodes.len() - 1)
    }

    /// Returns the node that already computes `operation` in this format. Returns `None` without one, or if the operation may
    /// round.
    fn same_node(&self, operation: &Operation, format: Format) -> Option<NodeId> {
        let wanted = operation.identity()?;
        let is_same = |node: &PlanNode| {
            node.source.is_none()
                && node.limits == ANYTHING
                && node.stated.is_none()
                && node.deviation == 0.0
                && node.format == format
                && node.operation.identity().as_ref() == Some(&wanted)
        };
        self.plan.nodes.iter().position(is_same).map(NodeId)
    }

    /// Returns `name`, or `name` followed by a number if a node already has this name. For example, a second `product` is
    /// `product2`.
    ///
    /// The name also gives way to operands. Nets of the hardware have the name of a node with an ending, such as `sum_next`, so
    /// that beside an operand `sum_next` a node `sum` becomes `sum2`.
    fn unused_name(&self, name: &str) -> String {
        let is_used = |name: &str| {
            let owns = |end: &str| end.is_empty() || end.starts_with('_');
            self.plan.nodes.iter().any(|node| match node.operation {
                Operation::Operand(_) => node.name.strip_prefix(name).is_some_and(owns),
                _ => node.name == name,
            })
        };
        let mut unused = name.to_owned();
        let mut number = 2;
        while is_used(&unused) {
            unused = format!("{name}{number}");
            number += 1;
        }
        unused
    }

    /// Gives a node the name `name`, followed by a number if another node already has this name.
    pub(crate) fn rename(&mut self, id: NodeId, name: &str) {
        if self.node(id).name != name {
            self.plan.nodes[id.0].name = self.unused_name(name);
        }
    }

    /// Adds an exact operation whose raw results lie in `range`, with `frac` fraction bits, and returns its node. Fails if the
    /// node has more than 64 bits.
    fn exact(
        &mut self,
        name: &str,
        operation: Operation,
        range: Interval,
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        self.insert(name, operation, Format::holding(range.0, range.1, frac), range)
    }

    pub(crate) fn operand(
        &mut self,
        number: usize,
        name: &str,
        format: Format,
        domain: (i64, i64),
    ) -> Result<NodeId, PlanRefusal> {
        let range = (domain.0.into(), domain.1.into());
        self.insert(name, Operation::Operand(number), format, range)
    }

    /// Adds the exact constant with the raw value `raw` and `frac` fraction bits, and returns its node. For example, 3 and 1
    /// give the constant 1.5. Fails if the node has more than 64 bits.
    pub(crate) fn constant(
        &mut self,
        name: &str,
        raw: i128,
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let value = Enclosure::exactly(Format::holding(raw, raw, frac).to_f64(raw));
        self.rounded_constant(name, raw, frac, value)
    }

    /// Adds the raw constant `raw` with `frac` fraction bits for a real number that lies in the interval `value`, and returns
    /// its node. Fails if the node has more than 64 bits.
    pub(crate) fn rounded_constant(
        &mut self,
        name: &str,
        raw: i128,
        frac: i32,
        value: Enclosure,
    ) -> Result<NodeId, PlanRefusal> {
        let is_same = |node: &PlanNode| match &node.operation {
            Operation::Constant { raw: other_raw, value: other } => {
                node.format.frac == frac && *other_raw == raw && *other == value
            }
            _ => false,
        };
        if let Some(at) = self.plan.nodes.iter().position(is_same) {
            return Ok(NodeId(at));
        }
        self.exact(name, Operation::Constant { raw, value }, (raw, raw), frac)
    }

    /// Returns the raw ranges of two nodes, converted to the same number of fraction bits, and this number, which is the larger
    /// one of the two nodes. For example, the raw range 0 to 3 with one fraction bit becomes 0 to 6 if the other node has two.
    /// Fails if a converted value has more than 64 bits.
    fn aligned(&self, a: NodeId, b: NodeId) -> Result<(Interval, Interval, i32), PlanRefusal> {
        let (a, b) = (self.node(a), self.node(b));
        let frac = a.format.frac.max(b.format.frac);
        Ok((with_fraction(a, frac)?, with_fraction(b, frac)?, frac))
    }

    /// Adds a + b, and returns its node. Returns one of the two nodes itself if the other is the constant 0. Fails if the node
    /// has more than 64 bits.
    pub(crate) fn add(&mut self, name: &str, a: NodeId, b: NodeId) -> Result<NodeId, PlanRefusal> {
        if self.is_exactly_zero(a) {
            return Ok(b);
        }
        if self.is_exactly_zero(b) {
            return Ok(a);
        }
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0 + second.0, first.1 + second.1);
        self.exact(name, Operation::Add(a, b), range, frac)
    }

    pub(crate) fn subtract(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0 - second.1, first.1 - second.0);
        self.exact(name, Operation::Subtract(a, b), range, frac)
    }

    fn is_exactly_zero(&self, id: NodeId) -> bool {
        let zero = Enclosure::exactly(0.0);
        matches!(&self.node(id).operation, Operation::Constant { value, .. } if *value == zero)
    }

    pub(crate) fn negate(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let frac = self.node(a).format.frac;
        let zero = self.constant("zero", 0, frac)?;
        self.subtract(name, zero, a)
    }

    /// Adds the product of two nodes, and returns its node. The wider factor comes first, so that one multiplier for all products
    /// of a sequential core has as few bits as possible. Fails if the node has more than 64 bits.
    pub(crate) fn multiply(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let width = |id: NodeId| self.node(id).format.width();
        let [a, b] = if width(b) > width(a) { [b, a] } else { [a, b] };
        let (first, second) = (self.node(a), self.node(b));
        let range = if a == b {
            let [low, high] =
                [first.range.0, first.range.1].map(|raw: i128| raw.saturating_mul(raw));
            let least = if first.range.0 <= 0 && first.range.1 >= 0 { 0 } else { low.min(high) };
            (least, low.max(high))
        } else {
            interval::product(first.range, second.range)
        };
        let frac = first.format.frac + second.format.frac;
        self.exact(name, Operation::Multiply(a, b), range, frac)
    }

    pub(crate) fn absolute(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let (low, high) = node.range;
        if low >= 0 {
            return Ok(a);
        }
        let least = if high >= 0 { 0 } else { -high };
        self.exact(name, Operation::Absolute(a), (least, high.max(-low)), node.format.frac)
    }

    pub(crate) fn minimum(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0.min(second.0), first.1.min(second.1));
        self.exact(name, Operation::Minimum(a, b), range, frac)
    }

    pub(crate) fn maximum(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0.max(second.0), first.1.max(second.1));
        self.exact(name, Operation::Maximum(a, b), range, frac)
    }

    pub(crate) fn less(&mut self, name: &str, a: NodeId, b: NodeId) -> Result<NodeId, PlanRefusal> {
        self.aligned(a, b)?;
        self.insert(name, Operation::Less(a, b), Format::BIT, (0, 1))
    }

    pub(crate) fn nonzero(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        self.insert(name, Operation::NonZero(a), Format::BIT, (0, 1))
    }

    pub(crate) fn choose(
        &mut self,
        name: &str,
        condition: NodeId,
        cases: [NodeId; 2],
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(cases[0], cases[1])?;
        let range = (first.0.min(second.0), first.1.max(second.1));
        self.exact(name, Operation::Choose { condition, cases }, range, frac)
    }

    /// Adds a · 2^`exponent`, and returns its node. The node has the same bits as `a`, with another binary point. Returns `a`
    /// itself if `exponent` is 0. Fails if the node has more than 64 bits.
    pub(crate) fn scale(
        &mut self,
        name: &str,
        a: NodeId,
        exponent: i32,
    ) -> Result<NodeId, PlanRefusal> {
        if exponent == 0 {
            return Ok(a);
        }
        let node = self.node(a);
        let Format { signed, int, frac } = node.format;
        let format = Format { signed, int: int + exponent, frac: frac - exponent };
        let range = node.range;
        self.insert(name, Operation::Scale(a), format, range)
    }

    /// Adds a node with the value of the node `a`, and returns the new node. A result that is an operand itself needs a copy,
    /// because its register has its own name. Fails if the node has more than 64 bits.
    pub(crate) fn copy(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let PlanNode { format, range, .. } = *self.node(a);
        self.insert(name, Operation::Scale(a), format, range)
    }

    /// Returns the format of the values of the exact node `a` within limits.
    fn format_within(&self, a: NodeId, limits: Enclosure) -> Format {
        let PlanNode { format, range, .. } = *self.node(a);
        let unit = exp2(format.frac);
        let low = range.0.max((limits.low * unit).ceil() as i128);
        let high = range.1.min((limits.high * unit).floor() as i128);
        Format::holding(low.min(high), high.max(low), format.frac)
    }

    /// Returns whether the values of the exact node `a` within limits need fewer bits than the node has.
    pub(crate) fn is_narrower(&self, a: NodeId, limits: Enclosure) -> bool {
        self.format_within(a, limits).width() < self.node(a).format.width()
    }

    /// Adds a node for the values of the exact node `a` within limits, and returns it. The caller must know that the limits
    /// contain the value wherever the new node's value matters. For other values, high bits are dropped. Fails if the node has
    /// more than 64 bits.
    pub(crate) fn limited(
        &mut self,
        name: &str,
        a: NodeId,
        limits: Enclosure,
    ) -> Result<NodeId, PlanRefusal> {
        let node = if self.is_narrower(a, limits) {
            self.narrow(name, a, self.format_within(a, limits), Rounding::Truncate)?
        } else {
            let copy = PlanNode { name: name.to_owned(), ..self.node(a).clone() };
            self.push_copy(&copy, Operation::Scale(a))
        };
        self.plan.nodes[node.0].limits = limits;
        Ok(node)
    }

    /// Adds the node `a` converted to `format` with the given rounding, and returns the new node. Returns `a` itself if it
    /// already has this format. The caller must prove that no value exceeds the format. Fails if the node has more than 64
    /// bits.
    pub(crate) fn narrow(
        &mut self,
        name: &str,
        a: NodeId,
        format: Format,
        rounding: Rounding,
    ) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        if node.format == format {
            return Ok(a);
        }
        let places = node.format.frac - format.frac;
        let whole = if places > 0 {
            (rounding.shift(node.range.0, places), rounding.shift(node.range.1, places))
        } else {
            with_fraction(node, format.frac)?
        };
        let range = if interval::fits(whole, format) { whole } else { format.range() };
        self.insert(name, Operation::Narrow(a, rounding), format, range)
    }

    /// Returns the node of `a` in `format`, without the bits below the last place of this format. Adds a node unless the plan has
    /// one with these bits. The caller must prove that no value exceeds the format. Fails if the node has more than 64 bits.
    pub(crate) fn low_bits(
        &mut self,
        name: &str,
        a: NodeId,
        format: Format,
    ) -> Result<NodeId, PlanRefusal> {
        let is_same = |node: &PlanNode| {
            let is_of_a =
                matches!(node.operation, Operation::Narrow(of, Rounding::Truncate) if of == a);
            is_of_a && node.format == format && node.source.is_none() && node.limits == ANYTHING
        };
        match self.plan.nodes.iter().position(is_same) {
            Some(same) => Ok(NodeId(same)),
            None => self.narrow(name, a, format, Rounding::Truncate),
        }
    }

    /// Adds the node `a` rounded to `frac` fraction bits, with as many integer bits as its values need, and returns the new
    /// node. Returns `a` itself if it does not have more fraction bits. Fails if the node has more than 64 bits.
    pub(crate) fn shorten(
        &mut self,
        name: &str,
        a: NodeId,
        frac: i32,
        rounding: Rounding,
    ) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let places = node.format.frac - frac;
        if places <= 0 {
            return Ok(a);
        }
        let range = (rounding.shift(node.range.0, places), rounding.shift(node.range.1, places));
        self.narrow(name, a, Format::holding(range.0, range.1, frac), rounding)
    }

    /// Adds the node `a` with its low bits replaced by a single 1, and returns the new node. `format` must have fewer fraction
    /// bits than `a`, and its last bit is this 1. For example, 0.1011 with a format of two fraction bits becomes 0.11. The
    /// caller must prove that no value exceeds the format. Fails if the node has more than 64 bits.
    pub(crate) fn middle(
        &mut self,
        name: &str,
        a: NodeId,
        format: Format,
    ) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let places = node.format.frac - format.frac;
        let whole = (middle(node.range.0, places), middle(node.range.1, places));
        let range = if interval::fits(whole, format) { whole } else { format.range() };
        self.insert(name, Operation::Middle(a), format, range)
    }

    /// Adds the node `a` as the operand of a table, and returns the new node. If `a` has more than `frac` fraction bits, all
    /// bits beyond `frac` are replaced by a single 1; otherwise returns `a` itself. The table absorbs this bit, so that it
    /// costs no logic, and the error is as small as with rounding.
    pub(crate) fn shorten_for_table(
        &mut self,
        name: &str,
        a: NodeId,
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let places = node.format.frac - (frac + 1);
        if places < 0 {
            return Ok(a);
        }
        let range = (middle(node.range.0, places), middle(node.range.1, places));
        self.middle(name, a, Format::holding(range.0, range.1, frac + 1))
    }

    /// Adds the bit `number` of the integer `a`, and returns its node. Bit 0 is the lowest.
    pub(crate) fn bit(
        &mut self,
        name: &str,
        a: NodeId,
        number: u32,
    ) -> Result<NodeId, PlanRefusal> {
        self.insert(name, Operation::Bit(a, number), Format::BIT, (0, 1))
    }

    /// Adds the greatest integer that is not above `a`, and returns its node. `a` must have fraction bits. For example, −1.5
    /// gives −2. Fails if the node has more than 64 bits.
    pub(crate) fn integer_part(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let (frac, range) = (node.format.frac, node.range);
        self.exact(name, Operation::IntegerPart(a), (range.0 >> frac, range.1 >> frac), 0)
    }

    /// Adds the integer part and the fraction part of `a`, and returns the two nodes in this order. `a` must have fraction
    /// bits. For example, −1.25 gives −2 and 0.75. Fails if the node has more than 64 bits.
    pub(crate) fn split(&mut self, name: &str, a: NodeId) -> Result<[NodeId; 2], PlanRefusal> {
        let integer = self.integer_part(&format!("{name}_integer"), a)?;
        let frac = self.node(a).format.frac;
        let format = Format::unsigned(0, frac);
        let fraction = self.insert(
            &format!("{name}_fraction"),
            Operation::FractionPart(a, integer),
            format,
            format.range(),
        )?;
        Ok([integer, fraction])
    }

    /// Adds the normalised word of [`Operation::Normalise`] and the number of bits, or of pairs of bits, by which the word is
    /// shifted. Returns the two nodes in this order. Fails if the node has more than 64 bits.
    pub(crate) fn normalise(
        &mut self,
        name: &str,
        word: NodeId,
        by_pairs: bool,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let width = self.node(word).format.width();
        let format = Format::unsigned(0, width as i32);
        let operation = Operation::Normalise { word, by_pairs };
        let normalised = self.insert(name, operation, format, format.range())?;
        let count = normalising_shifts(width, by_pairs).len().max(1);
        let format = Format::unsigned(count as i32, 0);
        let name = format!("{name}_places");
        let places = self.insert(&name, Operation::Places(normalised), format, format.range())?;
        Ok([normalised, places])
    }

    /// Adds a · 2^`places` in `format`, and returns its node. The caller must prove that no value exceeds the format. Fails if
    /// the node has more than 64 bits.
    pub(crate) fn shift_left(
        &mut self,
        name: &str,
        a: NodeId,
        places: NodeId,
        format: Format,
    ) -> Result<NodeId, PlanRefusal> {
        self.insert(name, Operation::ShiftLeft(a, places), format, format.range())
    }

    pub(crate) fn shift_right(
        &mut self,
        name: &str,
        a: NodeId,
        places: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let (format, range) = (node.format, (node.range.0.min(0), node.range.1.max(0)));
        self.insert(name, Operation::ShiftRight(a, places), format, range)
    }

    /// Adds the unsigned word `a` with its bits in the opposite order, and returns its node. Fails if the node has more than 64 bits.
    pub(crate) fn reverse(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let format = self.node(a).format;
        debug_assert!(!format.signed, "a word without a sign");
        self.insert(name, Operation::Reverse(a), format, format.range())
    }

    /// Adds a table of raw constants with `frac` fraction bits, and returns the node of the constant that `address` selects.
    /// Address 0 selects the first constant. Fails if the node has more than 64 bits.
    pub(crate) fn lookup(
        &mut self,
        name: &str,
        address: NodeId,
        words: Vec<i128>,
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let low = words.iter().copied().min().unwrap_or(0);
        let high = words.iter().copied().max().unwrap_or(0);
        self.exact(name, Operation::Lookup { address, words }, (low, high), frac)
    }

    /// Adds a function of the node `a`, computed by polynomials, and returns its node. `values` are limits of the function's
    /// raw values, widened by the allowed error; they give the format if no polynomials are known yet. Fails if the node has
    /// more than 64 bits.
    pub(crate) fn polynomial(
        &mut self,
        name: &str,
        a: NodeId,
        approximation: Approximation,
        values: Interval,
    ) -> Result<NodeId, PlanRefusal> {
        let frac = approximation.function.fraction as i32;
        let format = match &approximation.polynomials {
            Some(found) => found.result,
            None => Format::holding(values.0, values.1, frac),
        };
        let operation = Operation::Polynomial(a, Box::new(approximation));
        self.insert(name, operation, format, format.range())
    }
}

/// Returns the raw range of a node, converted to `frac` fraction bits, which must not be fewer than the node has. Fails if a
/// value then has more than 64 bits.
fn with_fraction(node: &PlanNode, frac: i32) -> Result<Interval, PlanRefusal> {
    let places = frac - node.format.frac;
    let [low, high] = [node.range.0, node.range.1].map(|raw| shifted_left(raw, places));
    let fits = |(low, high): &Interval| Format::holding(*low, *high, frac).width() <= MAX_WIDTH;
    let range = low.zip(high).filter(fits);
    range.ok_or_else(|| PlanRefusal::too_wide(node.format.width() as i32 + places))
}

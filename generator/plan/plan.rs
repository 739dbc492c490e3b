//! Defines the plan of an expression. Its methods append nodes, and compute the formats of their results.

use glint_base::fixed::{Format, MAX_WIDTH, Rounding, exp2, shifted_left};
use glint_base::interval::{self, Interval};
use glint_formula::Enclosure;

use super::memory::TableMemory;
use super::node::{Approximation, NodeId, Operation, PlanNode, middle};
use super::refusal::PlanRefusal;

/// The limits of a node's value before the rewriting of the formula has stated any.
const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

/// The plan of an expression: a list of fixed-point operations that computes all results.
#[derive(Clone, Debug, Default)]
pub struct ExpressionPlan {
    /// The operations. Each reads only operations before it.
    pub nodes: Vec<PlanNode>,
    /// The node of each result, in the order of the statement.
    pub results: Vec<NodeId>,
    /// For each result the node whose error is proved. This is the node in `results`, except for a result that wraps: for such
    /// a result it is the node before the high bits are dropped.
    pub proved: Vec<NodeId>,
    /// Whether several functions share the operations, so that an opcode selects their inputs.
    pub is_shared: bool,
    /// The memory for the tables of polynomials. The estimates of look-up tables depend on it.
    pub memory: TableMemory,
}

impl ExpressionPlan {
    /// Returns the node with this index.
    pub fn node(&self, id: NodeId) -> &PlanNode {
        &self.nodes[id.0]
    }

    /// Returns for each node whether the proved value of result number `result` depends on it.
    pub fn needed_for(&self, result: usize) -> Vec<bool> {
        self.needed_by(self.proved[result])
    }

    /// Returns for each node whether the node `id` depends on it. A node depends on itself.
    pub(super) fn needed_by(&self, id: NodeId) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        needed[id.0] = true;
        for at in (0..self.nodes.len()).rev() {
            if needed[at] {
                for input in self.nodes[at].operation.inputs() {
                    needed[input.0] = true;
                }
            }
        }
        needed
    }

    /// Returns for each node whether the hardware of a result reads it. Operands count as read, because they are ports.
    ///
    /// A node can have no reader, although its result is a part of the formula. For example, the table of a function that covers
    /// one octave has the function's values, and nothing shifts them back.
    pub fn read_nodes(&self) -> Vec<bool> {
        let mut is_read = vec![false; self.nodes.len()];
        for result in &self.results {
            is_read[result.0] = true;
        }
        for at in (0..self.nodes.len()).rev() {
            let operation = &self.nodes[at].operation;
            is_read[at] |= matches!(operation, Operation::Operand(_));
            if is_read[at] {
                for input in operation.hardware_inputs() {
                    is_read[input.0] = true;
                }
            }
        }
        is_read
    }

    /// Returns the widths of the two inputs of one multiplier that can compute all products of the plan, including the products
    /// in polynomials. If any factor has a sign, both widths have room for one.
    pub(super) fn multiplier_widths(&self) -> [u32; 2] {
        let mut factors: Vec<[Format; 2]> = Vec::new();
        for node in &self.nodes {
            match &node.operation {
                Operation::Multiply(a, b) => {
                    factors.push([self.node(*a).format, self.node(*b).format]);
                }
                Operation::Polynomial(a, approximation) => {
                    let Some(found) = &approximation.polynomials else { continue };
                    let operand = Format { signed: true, ..self.node(*a).format };
                    factors.extend(found.sums.iter().skip(1).map(|sum| [*sum, operand]));
                }
                _ => {}
            }
        }
        let is_signed = factors.iter().flatten().any(|factor| factor.signed);
        let mut widths = [0; 2];
        for pair in factors {
            for (width, factor) in widths.iter_mut().zip(pair) {
                let with_sign = factor.width() + u32::from(is_signed && !factor.signed);
                *width = with_sign.max(*width);
            }
        }
        widths
    }

    /// Returns the prefix of the names of all nets that belong to a node's table: the name of the node and an underscore, so
    /// that each table has nets of its own. The prefix is empty in a plan with the single operand `x` and a single table.
    pub fn table_prefix(&self, id: NodeId) -> String {
        let mut operands = Vec::new();
        for node in &self.nodes {
            if matches!(node.operation, Operation::Operand(_)) {
                operands.push(node.name.as_str());
            }
        }
        let is_single = operands == ["x"] && self.approximations().len() == 1;
        if is_single { String::new() } else { format!("{}_", self.node(id).name) }
    }

    /// Returns the names of the registers for a node's polynomial. The first register is for the polynomial itself, and the
    /// others are for the partial sums of Horner's rule. For example, a node `curve` has `curve`, `curve_sum1` and
    /// `curve_sum2`.
    pub fn sum_names(&self, id: NodeId) -> [String; 3] {
        let prefix = self.table_prefix(id);
        [self.node(id).name.clone(), format!("{prefix}sum1"), format!("{prefix}sum2")]
    }

    /// Returns the name of the register for the highest coefficient of a node's polynomial.
    pub fn highest_name(&self, id: NodeId) -> String {
        format!("{}highest", self.table_prefix(id))
    }

    /// Returns whether a − b inverts the bits of b, because a is a constant whose bits are all 1. For example, 7 − 2 is 5, and the
    /// bits of 2, which are 010, become 101.
    pub fn is_inversion(&self, a: NodeId, b: NodeId) -> bool {
        let [all, subtrahend] = [a, b].map(|id| self.node(id));
        let Operation::Constant { raw, .. } = all.operation else { return false };
        let (own, other) = (all.format, subtrahend.format);
        let are_unsigned = !own.signed && !other.signed;
        let is_as_wide = own.frac == other.frac && other.width() <= own.width();
        are_unsigned && is_as_wide && raw == own.max_raw()
    }

    /// Returns the number of the rounding operation that gives a value its fraction bits: the one of the node itself, or of the only earlier
    /// node with the same bits. Returns `None` if the value is exact or has several inputs.
    pub(super) fn rounding_before(&self, id: NodeId) -> Option<usize> {
        let node = self.node(id);
        if node.source.is_some() {
            return node.source;
        }
        let before = match node.operation {
            Operation::Scale(a) | Operation::Narrow(a, _) | Operation::Absolute(a) => a,
            Operation::Maximum(a, b) | Operation::Minimum(a, b) => {
                let is_constant =
                    |id: NodeId| matches!(self.node(id).operation, Operation::Constant { .. });
                match (is_constant(a), is_constant(b)) {
                    (false, true) => a,
                    (true, false) => b,
                    _ => return None,
                }
            }
            _ => return None,
        };
        self.rounding_before(before)
    }

    /// Returns for each node how often operations read it. A square counts its input twice.
    pub fn readers(&self) -> Vec<usize> {
        let mut readers = vec![0; self.nodes.len()];
        for node in &self.nodes {
            for input in node.operation.inputs() {
                readers[input.0] += 1;
            }
        }
        readers
    }
}

/// Methods that add nodes to a plan. Each returns the node of its result, whose format can represent every value that the
/// ranges of the inputs allow. If the plan already has the same exact operation, they return its node instead. The methods fail
/// if the result needs more bits than a net can have.
impl ExpressionPlan {
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
        self.nodes.push(PlanNode {
            name,
            operation,
            format,
            range,
            limits: ANYTHING,
            actual_limits: ANYTHING,
            stated: None,
            agreement: None,
            source: None,
        });
        Ok(NodeId(self.nodes.len() - 1))
    }

    /// Adds a copy of a node of another plan, with the operation replaced by `operation`, which must read nodes of this plan.
    pub(super) fn push_copy(&mut self, node: &PlanNode, operation: Operation) -> NodeId {
        let name = match operation {
            Operation::Operand(_) => node.name.clone(),
            _ => self.unused_name(&node.name),
        };
        self.nodes.push(PlanNode { name, operation, ..node.clone() });
        NodeId(self.nodes.len() - 1)
    }

    /// Returns the node that already computes `operation` in this format. Returns `None` without one, or if the operation may
    /// round.
    fn same_node(&self, operation: &Operation, format: Format) -> Option<NodeId> {
        let wanted = operation.identity()?;
        let is_same = |node: &PlanNode| {
            node.source.is_none()
                && node.limits == ANYTHING
                && node.stated.is_none()
                && node.format == format
                && node.operation.identity().as_ref() == Some(&wanted)
        };
        self.nodes.iter().position(is_same).map(NodeId)
    }

    /// Returns `name`, or `name` followed by a number if a node already has this name. For example, a second `product` is
    /// `product2`.
    ///
    /// The name also gives way to operands. Nets of the hardware have the name of a node with an ending, such as `sum_next`, so
    /// that beside an operand `sum_next` a node `sum` becomes `sum2`.
    fn unused_name(&self, name: &str) -> String {
        let is_used = |name: &str| {
            let owns = |end: &str| end.is_empty() || end.starts_with('_');
            self.nodes.iter().any(|node| match node.operation {
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
    pub(super) fn rename(&mut self, id: NodeId, name: &str) {
        if self.node(id).name != name {
            self.nodes[id.0].name = self.unused_name(name);
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

    pub(super) fn operand(
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
    pub(super) fn constant(
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
    pub(super) fn rounded_constant(
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
        if let Some(at) = self.nodes.iter().position(is_same) {
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
    pub(super) fn add(&mut self, name: &str, a: NodeId, b: NodeId) -> Result<NodeId, PlanRefusal> {
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

    pub(super) fn subtract(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0 - second.1, first.1 - second.0);
        self.exact(name, Operation::Subtract(a, b), range, frac)
    }

    /// Returns whether a node is the exact constant 0.
    fn is_exactly_zero(&self, id: NodeId) -> bool {
        let zero = Enclosure::exactly(0.0);
        matches!(&self.node(id).operation, Operation::Constant { value, .. } if *value == zero)
    }

    pub(super) fn negate(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let frac = self.node(a).format.frac;
        let zero = self.constant("zero", 0, frac)?;
        self.subtract(name, zero, a)
    }

    /// Adds the product of two nodes, and returns its node. The wider factor comes first, so that one multiplier for all products
    /// of a sequential core has as few bits as possible. Fails if the node has more than 64 bits.
    pub(super) fn multiply(
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

    pub(super) fn absolute(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let (low, high) = node.range;
        if low >= 0 {
            return Ok(a);
        }
        let least = if high >= 0 { 0 } else { -high };
        self.exact(name, Operation::Absolute(a), (least, high.max(-low)), node.format.frac)
    }

    pub(super) fn minimum(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0.min(second.0), first.1.min(second.1));
        self.exact(name, Operation::Minimum(a, b), range, frac)
    }

    pub(super) fn maximum(
        &mut self,
        name: &str,
        a: NodeId,
        b: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let (first, second, frac) = self.aligned(a, b)?;
        let range = (first.0.max(second.0), first.1.max(second.1));
        self.exact(name, Operation::Maximum(a, b), range, frac)
    }

    pub(super) fn less(&mut self, name: &str, a: NodeId, b: NodeId) -> Result<NodeId, PlanRefusal> {
        self.aligned(a, b)?;
        self.insert(name, Operation::Less(a, b), Format::BIT, (0, 1))
    }

    pub(super) fn nonzero(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        self.insert(name, Operation::NonZero(a), Format::BIT, (0, 1))
    }

    pub(super) fn choose(
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
    pub(super) fn scale(
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
    pub(super) fn copy(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
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
    pub(super) fn is_narrower(&self, a: NodeId, limits: Enclosure) -> bool {
        self.format_within(a, limits).width() < self.node(a).format.width()
    }

    /// Adds a node for the values of the exact node `a` within limits, and returns it. The caller must know that the limits
    /// contain the value wherever the new node's value matters. For other values, high bits are dropped. Fails if the node has
    /// more than 64 bits.
    pub(super) fn limited(
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
        self.nodes[node.0].limits = limits;
        Ok(node)
    }

    /// Adds the node `a` converted to `format` with the given rounding, and returns the new node. Returns `a` itself if it
    /// already has this format. The caller must prove that no value exceeds the format. Fails if the node has more than 64
    /// bits.
    pub(super) fn narrow(
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

    /// Returns the low bits of the node `a` in `format`, which drops the bits below it. Adds a node unless the plan has one with these
    /// bits. The caller must prove that no value exceeds the format. Fails if the node has more than 64 bits.
    pub(super) fn low_bits(
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
        match self.nodes.iter().position(is_same) {
            Some(same) => Ok(NodeId(same)),
            None => self.narrow(name, a, format, Rounding::Truncate),
        }
    }

    /// Adds the node `a` rounded to `frac` fraction bits, with as many integer bits as its values need, and returns the new
    /// node. Returns `a` itself if it does not have more fraction bits. Fails if the node has more than 64 bits.
    pub(super) fn shorten(
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
    pub(super) fn middle(
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
    pub(super) fn shorten_for_table(
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
    pub(super) fn bit(
        &mut self,
        name: &str,
        a: NodeId,
        number: u32,
    ) -> Result<NodeId, PlanRefusal> {
        self.insert(name, Operation::Bit(a, number), Format::BIT, (0, 1))
    }

    /// Adds the greatest integer that is not above `a`, and returns its node. `a` must have fraction bits. For example, −1.5
    /// gives −2. Fails if the node has more than 64 bits.
    pub(super) fn integer_part(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let node = self.node(a);
        let (frac, range) = (node.format.frac, node.range);
        self.exact(name, Operation::IntegerPart(a), (range.0 >> frac, range.1 >> frac), 0)
    }

    /// Adds the integer part and the fraction part of `a`, and returns the two nodes in this order. `a` must have fraction
    /// bits. For example, −1.25 gives −2 and 0.75. Fails if the node has more than 64 bits.
    pub(super) fn split(&mut self, name: &str, a: NodeId) -> Result<[NodeId; 2], PlanRefusal> {
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
    pub(super) fn normalise(
        &mut self,
        name: &str,
        word: NodeId,
        by_pairs: bool,
    ) -> Result<[NodeId; 2], PlanRefusal> {
        let width = self.node(word).format.width();
        let format = Format::unsigned(0, width as i32);
        let operation = Operation::Normalise { word, by_pairs };
        let normalised = self.insert(name, operation, format, format.range())?;
        let count = super::node::normalising_shifts(width, by_pairs).len().max(1);
        let format = Format::unsigned(count as i32, 0);
        let name = format!("{name}_places");
        let places = self.insert(&name, Operation::Places(normalised), format, format.range())?;
        Ok([normalised, places])
    }

    /// Adds a · 2^`places` in `format`, and returns its node. The caller must prove that no value exceeds the format. Fails if
    /// the node has more than 64 bits.
    pub(super) fn shift_left(
        &mut self,
        name: &str,
        a: NodeId,
        places: NodeId,
        format: Format,
    ) -> Result<NodeId, PlanRefusal> {
        self.insert(name, Operation::ShiftLeft(a, places), format, format.range())
    }

    pub(super) fn shift_right(
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
    pub(super) fn reverse(&mut self, name: &str, a: NodeId) -> Result<NodeId, PlanRefusal> {
        let format = self.node(a).format;
        debug_assert!(!format.signed, "a word without a sign");
        self.insert(name, Operation::Reverse(a), format, format.range())
    }

    /// Adds a table of raw constants with `frac` fraction bits, and returns the node of the constant that `address` selects.
    /// Address 0 selects the first constant. Fails if the node has more than 64 bits.
    pub(super) fn lookup(
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
    pub(super) fn polynomial(
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

    /// Returns the functions that the plan computes by tables of polynomials, in the order of their nodes.
    pub fn approximations(&self) -> Vec<&Approximation> {
        let mut all = Vec::new();
        for node in &self.nodes {
            if let Operation::Polynomial(_, approximation) = &node.operation {
                all.push(&**approximation);
            }
        }
        all
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

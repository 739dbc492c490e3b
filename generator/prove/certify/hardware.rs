//! Translates the hardware's computation to real expressions with roundings for the prover Gappa, one case at a time.
//!
//! For example, in one case a saturation limits the value, and the result is a constant. In another case the result is a term
//! with the value's rounding. The translation fails for bitwise logic with a result that is used as a number, unless the result
//! is constant in the case. An inversion can be translated.

use std::collections::{BTreeMap, HashMap};

use super::cases::{Case, UnrolledComputation};
use super::exact::word_variable;
use super::quotient::{Quotient, widened};
use super::terms::{RealTerm, RealTermId, RealTerms, RoundingDirection};
use glint_base::fixed::exp2;
use glint_base::interval::{Interval, wrap};
use glint_rtl::netlist::RomId;
use glint_rtl::pipeline::{Cell, Graph, Node, NodeId, NodeOp};

/// The raw value of a node in one case: a constant, or a term in a Gappa script.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeValue {
    Constant(i128),
    /// The raw value is the term `id` times 2^`scale`.
    Term {
        id: RealTermId,
        /// The number of fraction bits of the node.
        scale: i32,
    },
}

/// The script's variables: the name and the number of fraction bits of each.
pub type Variables = Vec<(String, i32)>;

/// Translates the nodes of one case to terms in a Gappa script.
#[derive(Clone)]
pub struct Hardware<'a> {
    graph: &'a Graph,
    quotients: &'a BTreeMap<NodeId, Quotient>,
    case: &'a Case,
    /// The operands, followed by other nodes that are treated as variables.
    pub variables: Variables,
    tables: &'a [String],
    /// Known intervals of terms, for example of variables that the translation added.
    pub facts: BTreeMap<RealTermId, (f64, f64)>,
    known: HashMap<NodeId, NodeValue>,
}

impl<'a> Hardware<'a> {
    /// Makes the translation of `case`. `variables` are the operands, in the computation's order, and `tables` the names of the
    /// ROMs, by index.
    pub fn new(
        view: UnrolledComputation<'a>,
        case: &'a Case,
        variables: Variables,
        tables: &'a [String],
    ) -> Self {
        let UnrolledComputation { graph, quotients, .. } = view;
        let (facts, known) = (BTreeMap::new(), HashMap::new());
        Self { graph, quotients, case, variables, tables, facts, known }
    }

    fn range(&self, id: NodeId) -> Interval {
        self.case.ranges[id.index()]
    }

    /// Adds the variable `variable` for a node, with `scale` fraction bits. The node's interval becomes a fact.
    fn variable(
        &mut self,
        terms: &mut RealTerms,
        node: NodeId,
        variable: String,
        scale: i32,
    ) -> NodeValue {
        let id = terms.insert(RealTerm::Variable(variable.clone()), &variable);
        let (low, high) = self.range(node);
        let unit = exp2(-scale);
        self.facts.insert(id, (low as f64 * unit, high as f64 * unit));
        if !self.variables.iter().any(|(name, _)| *name == variable) {
            self.variables.push((variable, scale));
        }
        NodeValue::Term { id, scale }
    }

    /// Returns a word of a table as a variable. If an operand addresses the table, the variable has the same name as in the
    /// translated formula.
    fn read(
        &mut self,
        terms: &mut RealTerms,
        node: NodeId,
        rom: RomId,
        address: NodeId,
    ) -> NodeValue {
        let table = &self.tables[rom.index()];
        let variable = match self.graph.node(address).cell {
            Cell::Operand(at) => word_variable(table, &self.variables[at].0),
            _ => format!("{table}_{}", node.0),
        };
        let scale = self.graph.node(node).format.frac;
        self.variable(terms, node, variable, scale)
    }

    /// Returns a divider's result as a variable, with a fact: the real quotient exceeds the variable by at most one unit of the
    /// variable's last bit.
    fn quotient(
        &mut self,
        terms: &mut RealTerms,
        node: NodeId,
        quotient: Quotient,
    ) -> Result<NodeValue, String> {
        let (dividend, divisor) = self.fraction(terms, quotient)?;
        let name = &self.graph.node(node).label.name;
        let real = terms.insert(RealTerm::Div(dividend, divisor), &format!("{name}_exact"));
        let scale = quotient.bits as i32;
        let value = self.variable(terms, node, format!("{name}_{}", node.0), scale);
        if let NodeValue::Term { id, .. } = value {
            let rest = terms.insert(RealTerm::Sub(real, id), &format!("{name}_rest"));
            self.facts.insert(rest, (0.0, exp2(-scale)));
        }
        Ok(value)
    }

    /// Returns the difference a − b of two nodes as a term, and the interval of this difference, in real values. The caller must
    /// know that a < b (if `less`) or that a ≥ b. For example, if `less` is true and the nodes have 4 fraction bits, the interval
    /// ends at −1/16. Returns `None` if a node is constant in this case or has no term, or if the nodes have different numbers of
    /// fraction bits.
    pub fn compared(
        &mut self,
        terms: &mut RealTerms,
        (a, b): (NodeId, NodeId),
        less: bool,
    ) -> Option<(RealTermId, (f64, f64))> {
        let ((a_low, a_high), (b_low, b_high)) = (self.range(a), self.range(b));
        let (a, b) = (self.value(terms, a).ok()?, self.value(terms, b).ok()?);
        let (NodeValue::Term { scale, .. }, NodeValue::Term { scale: other_scale, .. }) = (a, b)
        else {
            return None;
        };
        let difference = add(terms, a, b, RealTerm::Sub, "compared");
        let NodeValue::Term { id, .. } = difference else { return None };
        // The nodes have the same binary point, so they are compared as raw values.
        if scale != other_scale {
            return None;
        }
        let unit = exp2(-scale);
        let range = if less {
            ((a_low - b_high) as f64 * unit, -unit)
        } else {
            (0.0, (a_high - b_low) as f64 * unit)
        };
        Some((id, range))
    }

    /// Returns the dividend and a divider's divisor as terms with the same number of fraction bits.
    ///
    /// # Errors
    ///
    /// Fails if the dividend or the divisor has no translation.
    pub fn fraction(
        &mut self,
        terms: &mut RealTerms,
        of: Quotient,
    ) -> Result<(RealTermId, RealTermId), String> {
        let (dividend, divisor) = (self.value(terms, of.dividend)?, self.value(terms, of.divisor)?);
        let scale = match (dividend, divisor) {
            (NodeValue::Term { scale: a, .. }, NodeValue::Term { scale: b, .. }) => a.max(b),
            (NodeValue::Term { scale, .. }, NodeValue::Constant(_))
            | (NodeValue::Constant(_), NodeValue::Term { scale, .. }) => scale,
            (NodeValue::Constant(_), NodeValue::Constant(_)) => 0,
        };
        Ok((pointed(terms, dividend, scale, "dividend"), pointed(terms, divisor, scale, "divisor")))
    }

    /// Translates node `id` to a constant or a term.
    ///
    /// # Errors
    ///
    /// Fails if an operation has no translation. The error names the operation's result.
    pub fn value(&mut self, terms: &mut RealTerms, id: NodeId) -> Result<NodeValue, String> {
        if let Some(&value) = self.known.get(&id) {
            return Ok(value);
        }
        let (low, high) = self.range(id);
        let value =
            if low == high { NodeValue::Constant(low) } else { self.translated(terms, id)? };
        self.known.insert(id, value);
        Ok(value)
    }

    /// Returns a node as a term even if it has only one value in this case. A hypothesis about this term limits the node's
    /// operands. Returns `None` for such a node if it is a slice or an operand, or if it has no translation.
    pub fn expression(&mut self, terms: &mut RealTerms, id: NodeId) -> Option<NodeValue> {
        let is_cut =
            matches!(self.graph.node(id).cell, Cell::Op(NodeOp::Slice { .. }) | Cell::Operand(_));
        let (low, high) = self.range(id);
        if low != high {
            return self.value(terms, id).ok();
        }
        if is_cut { None } else { self.translated(terms, id).ok() }
    }

    fn translated(&mut self, terms: &mut RealTerms, id: NodeId) -> Result<NodeValue, String> {
        let graph = self.graph;
        let node = graph.node(id);
        let name = node.label.name.clone();
        if let Some(&quotient) = self.quotients.get(&id) {
            return self.quotient(terms, id, quotient);
        }
        let op = match &node.cell {
            Cell::Op(op) => op,
            Cell::Operand(at) => {
                let (variable, scale) = self.variables[*at].clone();
                let id = terms.insert(RealTerm::Variable(variable.clone()), &variable);
                return Ok(NodeValue::Term { id, scale });
            }
            Cell::Read { rom, address } => return Ok(self.read(terms, id, *rom, *address)),
            _ => return Err(format!("the operands do not determine `{name}`")),
        };
        let case = self.case;
        let range = |id: &NodeId| case.ranges[id.index()];
        match op {
            NodeOp::Relabel(a) | NodeOp::Extend(a) => {
                let wrap = wrap_of(node, range(a))?;
                let a = self.value(terms, *a)?;
                Ok(add(terms, a, NodeValue::Constant(wrap), RealTerm::Add, &name))
            }
            NodeOp::Mux { select, inputs } => {
                let chosen = range(select).0 as usize;
                self.value(terms, inputs[chosen.min(inputs.len() - 1)])
            }
            NodeOp::Slice { of, low } => {
                let (from, to) = range(of);
                let wrap = wrap_of(node, (from >> low, to >> low))?;
                let whole = self.value(terms, *of)?;
                if graph.width(id) == 1 && *low > 0 && from >= 0 && to < 2 << low {
                    // The bit is the top bit of a fraction below 1.0, so it is the fraction rounded to the nearest integer.
                    return Ok(cut(terms, whole, low + 1, RoundingDirection::Nearest, &name));
                }
                let upper = cut(terms, whole, *low, RoundingDirection::Down, &name);
                Ok(add(terms, upper, NodeValue::Constant(wrap), RealTerm::Add, &name))
            }
            NodeOp::Concat(parts) => {
                let mut sum = NodeValue::Constant(0);
                let mut position = 0;
                for part in parts.iter().rev() {
                    let is_sign = node.format.signed && Some(part) == parts.first();
                    if range(part).0 < 0 && !is_sign {
                        return Err(format!("`{name}` joins bits of a negative number"));
                    }
                    let raised = raised(self.value(terms, *part)?, position);
                    sum = add(terms, sum, raised, RealTerm::Add, &name);
                    position += graph.width(*part) as i32;
                }
                Ok(sum)
            }
            NodeOp::Not(a) => {
                let most = if node.format.signed { -1 } else { node.format.range().1 };
                let value = self.value(terms, *a)?;
                // The bitwise inverse of an unsigned number is 1.0 − ulp minus the number, if the binary point is above its
                // top bit.
                let inverted = match (value, node.format.signed) {
                    (NodeValue::Term { id, scale }, false) => {
                        let wanted = node.format.width() as i32;
                        NodeValue::Term {
                            id: scaled(terms, id, scale - wanted, &name),
                            scale: wanted,
                        }
                    }
                    _ => value,
                };
                Ok(add(terms, NodeValue::Constant(most), inverted, RealTerm::Sub, &name))
            }
            NodeOp::Add { a, b, carry } => {
                if let Some((of, low)) = self.rounded(*a, *b) {
                    let half = 1 << (low - 1);
                    let (from, to) = range(&of);
                    let wrap = wrap_of(node, ((from + half) >> low, (to + half) >> low))?;
                    let whole = self.value(terms, of)?;
                    let rounded = cut(terms, whole, low, RoundingDirection::Nearest, &name);
                    return Ok(add(
                        terms,
                        rounded,
                        NodeValue::Constant(wrap),
                        RealTerm::Add,
                        &name,
                    ));
                }
                let carried = match carry {
                    Some(carry) => range(carry),
                    None => (0, 0),
                };
                let least = range(a).0 + range(b).0 + carried.0;
                let most = range(a).1 + range(b).1 + carried.1;
                let wrap = wrap_of(node, (least, most))?;
                let (a, b) = (self.value(terms, *a)?, self.value(terms, *b)?);
                let (a, b) = match (a, b) {
                    (NodeValue::Constant(a), b) => (NodeValue::Constant(a + wrap), b),
                    (a, NodeValue::Constant(b)) => (a, NodeValue::Constant(b + wrap)),
                    (a, b) => (add(terms, a, NodeValue::Constant(wrap), RealTerm::Add, &name), b),
                };
                let sum = add(terms, a, b, RealTerm::Add, &name);
                match carry {
                    None => Ok(sum),
                    Some(carry) => {
                        let carry = self.value(terms, *carry)?;
                        Ok(add(terms, sum, carry, RealTerm::Add, &name))
                    }
                }
            }
            NodeOp::Sub(a, b) => {
                let wrap = wrap_of(node, (range(a).0 - range(b).1, range(a).1 - range(b).0))?;
                let (a, b) = (self.value(terms, *a)?, self.value(terms, *b)?);
                let difference = add(terms, a, b, RealTerm::Sub, &name);
                Ok(add(terms, difference, NodeValue::Constant(wrap), RealTerm::Add, &name))
            }
            NodeOp::Mul(a, b) => {
                let (a_value, b_value) = (self.value(terms, *a)?, self.value(terms, *b)?);
                let (a_term, a_scale) = placed(terms, a_value, graph.node(*a).format.frac);
                let (b_term, b_scale) = placed(terms, b_value, graph.node(*b).format.frac);
                let id = terms.insert(RealTerm::Mul(a_term, b_term), &name);
                Ok(NodeValue::Term { id, scale: a_scale + b_scale })
            }
            NodeOp::And(..)
            | NodeOp::Or(..)
            | NodeOp::Xor(..)
            | NodeOp::Equal(..)
            | NodeOp::Less(..)
            | NodeOp::Any(_)
            | NodeOp::All(_) => {
                Err(format!("`{name}` is logic, but its result is used as a number"))
            }
        }
    }

    /// Returns y and a number of bits, if `a` + `b` is y without these bits, rounded to the nearest, halves up. One of the nodes
    /// has the bits of y from `low` up, and the other node has the bit below. With y divided by 2^low, ⌊y⌋ + (⌊2y⌋ − 2⌊y⌋) = ⌊y +
    /// 1/2⌋. y must not be negative.
    fn rounded(&self, a: NodeId, b: NodeId) -> Option<(NodeId, u32)> {
        self.upper_and_half(a, b).or_else(|| self.upper_and_half(b, a))
    }

    /// Returns y and `low` if `upper` has the bits of y from position `low` up, and `half` has the bit below.
    fn upper_and_half(&self, upper: NodeId, half: NodeId) -> Option<(NodeId, u32)> {
        let (upper, half) = (unextended(self.graph, upper), unextended(self.graph, half));
        let (of, low) = sliced(self.graph, upper)?;
        let (below, bit) = sliced(self.graph, half)?;
        let (least, most) = self.range(of);
        let is_rounding = of == below
            && bit + 1 == low
            && self.graph.width(half) == 1
            && least >= 0
            && most >> (low + self.graph.width(upper)) == 0;
        if is_rounding { Some((of, low)) } else { None }
    }
}

/// Returns the amount by which a format that drops bits changes a computed raw value. For example, sums from 16 to 20 in an
/// unsigned format of 4 bits have the amount −16.
///
/// # Errors
///
/// Fails if the amount is not the same for the whole interval `range`.
fn wrap_of(node: &Node, range: Interval) -> Result<i128, String> {
    let Some(amount) = wrap(range, node.format) else {
        let ((low, high), format, name) = (range, node.format, &node.label.name);
        return Err(format!(
            "`{name}` is {format}, but by intervals its values can be from {low} to {high} ulp"
        ));
    };
    Ok(amount)
}

/// Returns the node that node `id` extends or renames, or `id` itself.
fn unextended(graph: &Graph, id: NodeId) -> NodeId {
    match &graph.node(id).cell {
        Cell::Op(NodeOp::Extend(of) | NodeOp::Relabel(of)) => *of,
        _ => id,
    }
}

/// Returns the node from which a slice takes its bits, and the lowest bit of the slice.
fn sliced(graph: &Graph, id: NodeId) -> Option<(NodeId, u32)> {
    match &graph.node(id).cell {
        Cell::Op(NodeOp::Slice { of, low }) => Some((widened(graph, *of), *low)),
        _ => None,
    }
}

/// Drops the lowest `low` bits of a value. For example, the constant 14 without 2 bits is 3 rounded down, and 4 to the
/// nearest.
fn cut(
    terms: &mut RealTerms,
    value: NodeValue,
    low: u32,
    direction: RoundingDirection,
    name: &str,
) -> NodeValue {
    match value {
        NodeValue::Constant(raw) => NodeValue::Constant(match direction {
            RoundingDirection::Down => raw >> low,
            RoundingDirection::Nearest => (raw + (1 << low >> 1)) >> low,
        }),
        NodeValue::Term { .. } if low == 0 => value,
        NodeValue::Term { id, scale } => {
            let fraction = scale - low as i32;
            let id = terms.insert(RealTerm::Round { of: id, fraction, direction }, name);
            NodeValue::Term { id, scale: fraction }
        }
    }
}

fn raised(value: NodeValue, position: i32) -> NodeValue {
    match value {
        NodeValue::Constant(raw) => NodeValue::Constant(raw << position),
        NodeValue::Term { id, scale } => NodeValue::Term { id, scale: scale + position },
    }
}

/// Returns the sum or the difference of `a` and `b`, with the larger number of fraction bits. `operation` is [`RealTerm::Add`] or
/// [`RealTerm::Sub`].
fn add(
    terms: &mut RealTerms,
    a: NodeValue,
    b: NodeValue,
    operation: fn(RealTermId, RealTermId) -> RealTerm,
    name: &str,
) -> NodeValue {
    let scale = match (a, b) {
        (NodeValue::Constant(a), NodeValue::Constant(b)) => {
            return NodeValue::Constant(match operation(0, 0) {
                RealTerm::Sub(..) => a - b,
                _ => a + b,
            });
        }
        (NodeValue::Constant(0), NodeValue::Term { .. })
            if matches!(operation(0, 0), RealTerm::Add(..)) =>
        {
            return b;
        }
        (NodeValue::Term { .. }, NodeValue::Constant(0)) => return a,
        (NodeValue::Term { scale, .. }, NodeValue::Constant(_))
        | (NodeValue::Constant(_), NodeValue::Term { scale, .. }) => scale,
        (NodeValue::Term { scale: a, .. }, NodeValue::Term { scale: b, .. }) => a.max(b),
    };
    let (a, b) = (pointed(terms, a, scale, name), pointed(terms, b, scale, name));
    NodeValue::Term { id: terms.insert(operation(a, b), name), scale }
}

fn pointed(terms: &mut RealTerms, value: NodeValue, scale: i32, name: &str) -> RealTermId {
    match value {
        NodeValue::Constant(raw) => terms.number(raw as f64 * exp2(-scale)),
        NodeValue::Term { id, scale: own } => scaled(terms, id, own - scale, name),
    }
}

/// Multiplies the term `id` by 2^`power`. `name` names its definition in the script.
pub fn scaled(terms: &mut RealTerms, id: RealTermId, power: i32, name: &str) -> RealTermId {
    if power == 0 {
        return id;
    }
    let factor = terms.number(exp2(power));
    terms.insert(RealTerm::Mul(id, factor), name)
}

/// Returns a value as a term, and its number of fraction bits. A constant gets `frac` fraction bits. For example, the constant 3
/// with a `frac` of 2 is 0.75.
pub fn placed(terms: &mut RealTerms, value: NodeValue, frac: i32) -> (RealTermId, i32) {
    match value {
        NodeValue::Constant(raw) => (terms.number(raw as f64 * exp2(-frac)), frac),
        NodeValue::Term { id, scale } => (id, scale),
    }
}

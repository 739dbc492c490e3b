//! Cells as Verilog expressions.
//!
//! The operands of every cell have one width, which is also that of the result, so that no context
//! can extend or cut a carry. The exceptions are handled by name: a product is written only as the
//! whole right-hand side of a net of its full width, and the carry into an adder is extended to the
//! adder's width. Signedness matters to products and comparisons alone, which state it.

use std::collections::BTreeSet;

use super::bits::{Bits, Piece};
use super::plan::{Form, Plan, Reader};
use super::text::literal;
use crate::netlist::{Driver, NetId, Op, Rom};

/// Writes the expressions of one module.
pub struct Expressions<'a> {
    plan: &'a Plan<'a>,
    /// The named constants that were used: they become localparams.
    pub constants: BTreeSet<NetId>,
}

impl<'a> Expressions<'a> {
    /// For a module in which nothing was written yet.
    pub fn new(plan: &'a Plan<'a>) -> Self {
        Self {
            plan,
            constants: BTreeSet::new(),
        }
    }

    /// The right-hand side that drives a net.
    pub fn driver(&mut self, id: NetId) -> String {
        match &self.plan.design.net(id).driver {
            Driver::Op(op) => self.cell(id, op),
            Driver::Constant(value) => literal(*value, self.plan.design.width(id)),
            Driver::Field(_) => {
                let word = self.plan.design.rom(self.plan.design.control.rom).data;
                self.bits(&self.plan.operand_bits(Reader::Cell(id), word))
            }
            _ => self.plan.design.net(id).name.clone(),
        }
    }

    /// A net as the whole right-hand side.
    pub fn whole(&mut self, id: NetId) -> String {
        match self.inline(id) {
            Some(cell) => self.driver(cell),
            None => self.operand(id),
        }
    }

    /// A net as an operand: a name, a selection, a concatenation, or a cell in parentheses.
    pub fn operand(&mut self, id: NetId) -> String {
        let net = self.plan.design.net(id);
        if net.named && matches!(net.driver, Driver::Constant(_)) && !self.plan.is_port(id) {
            self.constants.insert(id);
            return net.name.clone();
        }
        match self.inline(id) {
            Some(cell) => {
                let text = self.driver(cell);
                if is_primary(&text) {
                    text
                } else {
                    format!("({text})")
                }
            }
            None => self.bits(&self.plan.bits[id.index()]),
        }
    }

    /// The word number for a ROM, exactly as wide as its depth asks.
    pub fn address(&mut self, rom: &Rom) -> String {
        let width = super::plan::address_width(rom.words.len());
        let bits = &self.plan.bits[rom.address.index()];
        let exact = if bits.width() > width {
            bits.slice(0, width)
        } else {
            bits.extend(width, false)
        };
        self.bits(&exact)
    }

    /// The cell that a net stands for, if that is written in its place.
    fn inline(&self, id: NetId) -> Option<NetId> {
        match self.plan.bits[id.index()].single() {
            Some(Piece::Net { net, .. }) if self.plan.forms[net.index()] == Form::Inline => {
                Some(net)
            }
            _ => None,
        }
    }

    /// Wiring.
    pub fn bits(&self, bits: &Bits) -> String {
        let parts: Vec<_> = bits
            .pieces()
            .iter()
            .map(|piece| self.piece(*piece))
            .collect();
        match &parts[..] {
            [only] => only.clone(),
            _ => format!("{{{}}}", parts.join(", ")),
        }
    }

    fn piece(&self, piece: Piece) -> String {
        let name = |net: NetId| self.plan.design.net(net).name.as_str();
        match piece {
            Piece::Constant { value, width } => literal(value, width),
            Piece::Copies { net, bit, count } if self.plan.design.width(net) == 1 => {
                debug_assert_eq!(bit, 0, "a net of one bit has no other");
                format!("{{{count}{{{}}}}}", name(net))
            }
            Piece::Copies { net, bit, count } => format!("{{{count}{{{}[{bit}]}}}}", name(net)),
            Piece::Net { net, width, .. } if width == self.plan.design.width(net) => {
                name(net).to_owned()
            }
            Piece::Net { net, low, width: 1 } => format!("{}[{low}]", name(net)),
            Piece::Net { net, low, width } => format!("{}[{}:{low}]", name(net), low + width - 1),
        }
    }

    fn cell(&mut self, id: NetId, op: &Op) -> String {
        match op {
            Op::Relabel(a) => self.whole(*a),
            Op::Extend(a) => {
                let net = self.plan.design.net(*a);
                let bits =
                    self.plan.bits[a.index()].extend(self.plan.design.width(id), net.format.signed);
                self.bits(&bits)
            }
            Op::Slice { of, low } => {
                self.bits(&self.plan.bits[of.index()].slice(*low, self.plan.design.width(id)))
            }
            Op::Concat(parts) => {
                let all = parts.iter().fold(Bits::default(), |all, part| {
                    all.followed_by(&self.plan.bits[part.index()])
                });
                self.bits(&all)
            }
            Op::Not(a) => format!("~{}", self.operand(*a)),
            Op::And(a, b) => self.binary(*a, "&", *b),
            Op::Or(a, b) => self.binary(*a, "|", *b),
            Op::Xor(a, b) => self.binary(*a, "^", *b),
            Op::Add { a, b, carry: None } => self.binary(*a, "+", *b),
            Op::Add {
                a,
                b,
                carry: Some(carry),
            } => {
                let sum = self.binary(*a, "+", *b);
                let carry = self.extended_carry(*carry, self.plan.design.width(id));
                format!("{sum} + {carry}")
            }
            Op::Sub(a, b) => self.binary(*a, "-", *b),
            Op::Mul(a, b) => {
                format!("{} * {}", self.with_sign(*a), self.with_sign(*b))
            }
            Op::Equal(a, b) => self.binary(*a, "==", *b),
            Op::Less(a, b) => match self.constant_comparison(*a, *b) {
                Some(known) => literal(known, 1),
                None => format!("{} < {}", self.with_sign(*a), self.with_sign(*b)),
            },
            Op::Any(a) if self.plan.design.width(*a) == 1 => self.whole(*a),
            Op::All(a) if self.plan.design.width(*a) == 1 => self.whole(*a),
            Op::Any(a) => format!("|{}", self.operand(*a)),
            Op::All(a) => format!("&{}", self.operand(*a)),
            Op::Mux { select, inputs } => match &inputs[..] {
                [zero, one] => {
                    let select = self.operand(*select);
                    let (one, zero) = (self.operand(*one), self.operand(*zero));
                    format!("{select} ? {one} : {zero}")
                }
                _ => self.plan.design.net(id).name.clone(),
            },
        }
    }

    fn binary(&mut self, a: NetId, sign: &str, b: NetId) -> String {
        let (a, b) = (self.operand(a), self.operand(b));
        format!("{a} {sign} {b}")
    }

    fn extended_carry(&mut self, carry: NetId, width: u32) -> String {
        let carry = self.operand(carry);
        if width == 1 {
            carry
        } else {
            format!("{{{}, {carry}}}", literal(0, width - 1))
        }
    }

    /// An operand whose signedness in the Verilog is that of its format.
    fn with_sign(&mut self, id: NetId) -> String {
        let text = self.operand(id);
        let wanted = self.plan.design.net(id).format.signed;
        let written = match self.plan.bits[id.index()].single() {
            Some(Piece::Net { net, width, .. }) if width == self.plan.design.width(net) => {
                self.plan.design.net(net).format.signed
            }
            _ => false,
        };
        match (written, wanted) {
            (false, true) => format!("$signed({text})"),
            (true, false) => format!("$unsigned({text})"),
            _ => text,
        }
    }

    /// A comparison that the format alone decides (`a < 0` without a sign), which linters refuse.
    fn constant_comparison(&self, a: NetId, b: NetId) -> Option<u64> {
        let format = self.plan.design.net(a).format;
        let constant = |id: NetId| match self.plan.bits[id.index()].single() {
            Some(Piece::Constant { value, .. }) => Some(format.raw(value)),
            _ => None,
        };
        match (constant(a), constant(b)) {
            (Some(a), Some(b)) => Some(u64::from(a < b)),
            (Some(a), None) if a == format.max_raw() => Some(0),
            (None, Some(b)) if b == format.min_raw() => Some(0),
            _ => None,
        }
    }
}

/// Whether a text needs no parentheses as an operand: a name, a selection, a concatenation or the
/// inverse of one.
fn is_primary(text: &str) -> bool {
    let inner = text.strip_prefix('~').unwrap_or(text);
    !inner.starts_with(['~', '|', '&', '-'])
        && (!inner.contains(' ') || (inner.starts_with('{') && closes_at_end(inner)))
}

/// Whether the first brace closes with the last character.
fn closes_at_end(text: &str) -> bool {
    let mut depth = 0usize;
    for (at, sign) in text.char_indices() {
        match sign {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return at + 1 == text.len();
        }
    }
    false
}

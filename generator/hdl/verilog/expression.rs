//! Writes the cells of a netlist as Verilog expressions, such as `a + b` for a sum.
//!
//! The operands of a sum or a difference have the same width as the result, so that no context can extend or truncate a carry.
//! Only a product is instead written as the whole right-hand side of a net of its full width. The carry into an adder is extended
//! to the adder's width. Operands of products and comparisons are written with `$signed` or `$unsigned` if necessary.

use super::bits::{BitRun, Bits};
use super::plan::{NetForm, Plan, Reader};
use super::text::{Names, constant_name, literal, together};
use crate::netlist::{Driver, NetId, NetlistRom, Op, WritePort};
use glint_base::fixed::mask;

/// A localparam, such as `COS_GAMMA_MOST` for `21'h100000`, with the note `1.0 in u1.20`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// The name of the localparam.
    pub name: String,
    /// The name in the description, without the number of a generated name.
    base: String,
    /// The value as a bit pattern.
    pub bits: u64,
    pub width: u32,
    /// The comment behind the localparam: the value as text, unless the bit pattern itself is the value.
    pub note: String,
}

/// Writes the expressions of one module, and collects the constants that they use.
pub struct Expressions<'a> {
    plan: &'a Plan<'a>,
    names: Names,
    /// The constants, in the order of use.
    pub constants: Vec<Constant>,
}

impl<'a> Expressions<'a> {
    /// `names` are the identifiers that the module uses already.
    pub fn new(plan: &'a Plan<'a>, names: Names) -> Self {
        Self { plan, names, constants: Vec::new() }
    }

    /// Returns an identifier that is new in the module: `wish`, or a similar name such as `wish_2`.
    pub fn fresh(&mut self, wish: &str) -> String {
        self.names.fresh(wish)
    }

    /// Returns the right-hand side of the assignment that drives a net, such as `a + b`. A register, a ROM, an input, or a mux of
    /// more than two inputs gives the name of the net.
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

    /// Returns the text that reads a net as a complete right-hand side, without parentheses.
    pub fn whole(&mut self, id: NetId) -> String {
        match self.inline(id) {
            Some(cell) => self.driver(cell),
            None => self.operand(id),
        }
    }

    /// Returns the text that reads a net within a larger expression. The text is a name, a selection, a concatenation, or a
    /// cell in parentheses, such as `(a + b)`.
    pub fn operand(&mut self, id: NetId) -> String {
        if let Some(constant) = self.constant(id) {
            return constant;
        }
        match self.inline(id) {
            Some(cell) => {
                let text = self.driver(cell);
                if is_primary(&text) { text } else { format!("({text})") }
            }
            None => self.bits(&self.plan.bits[id.index()]),
        }
    }

    /// Returns the operand of a unary operator, in parentheses if the operand is inverted.
    fn primary(&mut self, id: NetId) -> String {
        let text = self.operand(id);
        if text.starts_with('~') { format!("({text})") } else { text }
    }

    /// Returns the name of the localparam for a net that is a constant, possibly extended or relabelled, and collects the
    /// localparam. Unnamed constants that are clear as literals have none: 0, 1, and all ones from 8 bits on.
    fn constant(&mut self, id: NetId) -> Option<String> {
        let design = self.plan.design;
        let Some(BitRun::Constant { value, width }) = self.plan.bits[id.index()].single() else {
            return None;
        };
        let mut origin = id;
        while let Driver::Op(Op::Relabel(of) | Op::Extend(of)) = &design.net(origin).driver {
            origin = *of;
        }
        let from = design.net(origin);
        if !matches!(from.driver, Driver::Constant(_)) {
            return None;
        }
        if !from.named && (value <= 1 || (value == mask(width) && width >= 8)) {
            return None;
        }
        let (name, origin) = (&from.name, from.format);
        // The description language adds numbers to constants of the same name. Only constants with different bits need different
        // names here.
        let base = if from.named { name } else { unnumbered(name) };
        let same = |constant: &&Constant| {
            constant.base == base && (constant.bits, constant.width) == (value, width)
        };
        if let Some(known) = self.constants.iter().find(same) {
            return Some(known.name.clone());
        }
        let name = match from.named {
            true if width == origin.width() => name.clone(),
            _ => self.names.fresh(&constant_name(base)),
        };
        let Driver::Constant(bits) = from.driver else {
            return None;
        };
        self.constants.push(Constant {
            name: name.clone(),
            base: base.to_owned(),
            bits: value,
            width,
            note: if origin.signed || origin.frac != 0 {
                format!("{:?} in {origin}", origin.to_f64(origin.raw(bits)))
            } else {
                String::new()
            },
        });
        Some(name)
    }

    /// Returns the text of a ROM's address, with exactly as many bits as its number of words needs: 10 for 584 words.
    pub fn address(&mut self, rom: &NetlistRom) -> String {
        self.exact_address(rom, rom.address)
    }

    /// Returns the address of the word that a write port replaces, as wide as the address of the memory.
    pub fn write_address(&mut self, rom: &NetlistRom, write: &WritePort) -> String {
        self.exact_address(rom, write.address)
    }

    fn exact_address(&mut self, rom: &NetlistRom, address: NetId) -> String {
        let width = super::plan::address_width(rom.words.len());
        let bits = &self.plan.bits[address.index()];
        let exact =
            if bits.width() > width { bits.slice(0, width) } else { bits.extend(width, false) };
        self.bits(&exact)
    }

    /// Returns the net whose expression is written where the Verilog reads the net `id`: `id` itself, or the net whose bits
    /// `id` passes on unchanged. Returns `None` if `id` is declared, a constant, or other wiring.
    fn inline(&self, id: NetId) -> Option<NetId> {
        match self.plan.bits[id.index()].single() {
            Some(BitRun::Net { net, .. }) if self.plan.forms[net.index()] == NetForm::Inline => {
                Some(net)
            }
            _ => None,
        }
    }

    /// Returns the text of bits that need no logic: a selection such as `a[5:2]`, or a concatenation of several.
    pub fn bits(&self, bits: &Bits) -> String {
        together(bits.pieces().iter().map(|piece| self.piece(*piece)).collect())
    }

    fn piece(&self, piece: BitRun) -> String {
        let name = |net: NetId| self.plan.design.net(net).name.as_str();
        match piece {
            BitRun::Constant { value, width } => literal(value, width),
            BitRun::Copies { net, bit, count } if self.plan.design.width(net) == 1 => {
                debug_assert_eq!(bit, 0, "a net of one bit has no other");
                format!("{{{count}{{{}}}}}", name(net))
            }
            BitRun::Copies { net, bit, count } => format!("{{{count}{{{}[{bit}]}}}}", name(net)),
            BitRun::Net { net, width, .. } if width == self.plan.design.width(net) => {
                name(net).to_owned()
            }
            BitRun::Net { net, low, width: 1 } => format!("{}[{low}]", name(net)),
            BitRun::Net { net, low, width } => format!("{}[{}:{low}]", name(net), low + width - 1),
        }
    }

    fn cell(&mut self, id: NetId, op: &Op) -> String {
        match op {
            Op::Relabel(a) => self.whole(*a),
            Op::Extend(_) | Op::Slice { .. } | Op::Concat(_) => {
                let bits = self.plan.wiring(id).unwrap_or_default();
                self.bits(&bits)
            }
            Op::Not(a) => format!("~{}", self.primary(*a)),
            Op::And(a, b) => self.binary(*a, "&", *b),
            Op::Or(a, b) => self.binary(*a, "|", *b),
            Op::Xor(a, b) => self.binary(*a, "^", *b),
            Op::Add { a, b, carry: None } => self.binary(*a, "+", *b),
            Op::Add { a, b, carry: Some(carry) } => {
                let is_zero = |id: NetId| {
                    let bits = self.plan.bits[id.index()].single();
                    matches!(bits, Some(BitRun::Constant { value: 0, .. }))
                };
                let sum = match (is_zero(*a), is_zero(*b)) {
                    (true, _) => self.operand(*b),
                    (_, true) => self.operand(*a),
                    _ => self.binary(*a, "+", *b),
                };
                let carry = self.extended_carry(*carry, self.plan.design.width(id));
                format!("{sum} + {carry}")
            }
            Op::Sub(a, b) => self.binary(*a, "-", *b),
            Op::Mul(a, b) => format!("{} * {}", self.with_sign(*a), self.with_sign(*b)),
            Op::Equal(a, b) => self.binary(*a, "==", *b),
            Op::Less(a, b) => match self.plan.constant_comparison(*a, *b) {
                Some(known) => literal(known, 1),
                // A comparison has its constant on the right.
                None if matches!(
                    self.plan.bits[a.index()].single(),
                    Some(BitRun::Constant { .. })
                ) =>
                {
                    format!("{} > {}", self.with_sign(*b), self.with_sign(*a))
                }
                None => format!("{} < {}", self.with_sign(*a), self.with_sign(*b)),
            },
            Op::Any(a) if self.plan.design.width(*a) == 1 => self.whole(*a),
            Op::All(a) if self.plan.design.width(*a) == 1 => self.whole(*a),
            Op::Any(a) => format!("|{}", self.primary(*a)),
            Op::All(a) => format!("&{}", self.primary(*a)),
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
        if width == 1 { carry } else { format!("{{{}, {carry}}}", literal(0, width - 1)) }
    }

    /// Adds `$signed` or `$unsigned` if the text would not have the sign of the net's format.
    fn with_sign(&mut self, id: NetId) -> String {
        let text = self.operand(id);
        let wanted = self.plan.design.net(id).format.signed;
        let written = match self.plan.bits[id.index()].single() {
            Some(BitRun::Net { net, width, .. }) if width == self.plan.design.width(net) => {
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
}

/// Removes an underscore and a number at the end: `one_2` becomes `one`, and `base2` stays.
fn unnumbered(name: &str) -> &str {
    let base = name.trim_end_matches(|sign: char| sign.is_ascii_digit());
    match base.strip_suffix('_') {
        Some(base) if base.len() + 1 < name.len() => base,
        _ => name,
    }
}

/// Returns whether a text needs no parentheses as an operand: a name, a selection or a concatenation, possibly inverted.
fn is_primary(text: &str) -> bool {
    let inner = text.strip_prefix('~').unwrap_or(text);
    !inner.starts_with(['~', '|', '&', '-'])
        && (!inner.contains(' ') || (inner.starts_with('{') && closes_at_end(inner)))
}

/// Returns whether the brace at the beginning of `text` closes with its last character, unlike in `{a} + {b}`.
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

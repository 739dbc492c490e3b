//! The graph of an unrolled computation: an acyclic graph of values, each computed once.
//!
//! A node is the value of one net in one clock of the computation. Equal nodes are merged, constant operations are replaced by
//! their results, and wiring without an effect disappears. The remaining nodes are the operations for one point (one set of
//! operands).

use std::collections::HashMap;
use std::panic::Location;

use crate::netlist::{self, RomId, eval, interval::of_cell};
use glint_base::cone;
use glint_base::fixed::{Format, mask};
use glint_base::interval::{self, Interval};

netlist::id!(
    /// The number of a node in a [`Graph`].
    NodeId
);

/// A combinational cell whose operands are nodes of a [`Graph`].
pub type NodeOp = netlist::Op<NodeId>;

/// The operation that computes the value of a node of a [`Graph`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Cell {
    /// An operand of the design, by its position among all operands.
    Operand(usize),
    /// The content of the named register or ROM output before its first load.
    Unknown(String),
    /// A constant bit pattern.
    Constant(u64),
    /// The word of a ROM at an address.
    Read {
        rom: RomId,
        address: NodeId,
    },
    Op(NodeOp),
}

/// The texts by which people recognise a value in Verilog and in diagrams.
#[derive(Clone, Debug)]
pub struct Label {
    /// The net or register of the sequential design that has the value.
    pub name: String,
    /// A comment of one line from the sequential design, or an empty text.
    pub doc: String,
    /// The number of the block that computes the value in the source's block diagram, if it has one.
    pub block: Option<u16>,
    /// Whether the author of the description chose the name, not Glint.
    pub named: bool,
    /// The name of the whole value if the node is a part: `base` for `base_low`.
    pub part_of: Option<String>,
    /// The line of the Rust source that describes the value.
    pub location: &'static Location<'static>,
}

impl Label {
    /// Labels a value whose name the author of the description chose.
    pub fn new(name: String, location: &'static Location<'static>) -> Self {
        Self { name, doc: String::new(), block: None, named: true, part_of: None, location }
    }

    /// Returns the label of a part, such as the low bits. A part of a part is named after the whole value, so that names stay
    /// short. The part `low` of `base` is `base_low`, and the part `high` of that part `base_high`.
    pub fn part(&self, name: &str) -> Self {
        let whole = self.part_of.as_ref().unwrap_or(&self.name);
        let part_of = Some(whole.clone());
        Self { part_of, ..Self::new(format!("{whole}_{name}"), self.location) }
    }
}

#[derive(Clone, Debug)]
pub struct Node {
    pub cell: Cell,
    pub format: Format,
    /// The raw values that the node can have.
    pub range: Interval,
    pub label: Label,
    /// The first executed microinstruction that made the value, as a position in [`super::unroll::Unrolled::steps`].
    pub step: usize,
    /// Whether a register of the sequential design loads the value, so that the node has the register's label.
    pub held: bool,
}

/// All values of a computation. A node has a higher number than its operands.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// The number of a node is its index.
    pub nodes: Vec<Node>,
    known: HashMap<(Cell, u32, bool), NodeId>,
    /// The microinstruction that is being unrolled, as a position in [`super::unroll::Unrolled::steps`], which new nodes get.
    pub step: usize,
}

impl Graph {
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// Returns the width in bits.
    pub fn width(&self, id: NodeId) -> u32 {
        self.node(id).format.width()
    }

    /// Returns the bit pattern of a constant node.
    pub fn constant_of(&self, id: NodeId) -> Option<u64> {
        match self.node(id).cell {
            Cell::Constant(bits) => Some(bits),
            _ => None,
        }
    }

    /// Returns `roots` and all nodes on which they depend, each behind its operands.
    pub fn cone(&self, roots: impl IntoIterator<Item = NodeId>) -> Vec<NodeId> {
        let operands = |at: usize| self.nodes[at].cell.operands().into_iter().map(NodeId::index);
        let live = cone::needed(self.nodes.len(), roots.into_iter().map(NodeId::index), operands);
        (0..live.len()).filter(|&at| live[at]).map(|at| NodeId(at as u32)).collect()
    }

    /// Narrows the interval of node `id` to its intersection with `range`, unless the intersection is empty. Returns `id`.
    pub fn refine(&mut self, id: NodeId, range: Interval) -> NodeId {
        let node = &mut self.nodes[id.index()];
        // On a path that is never taken, the intersection can be empty.
        node.range = interval::common(node.range, range).unwrap_or(node.range);
        id
    }

    /// Gives node `id` the label of the register that loads its value. Constants and nodes of other registers keep their labels.
    pub fn name_after(&mut self, id: NodeId, register: &Label) {
        let node = &mut self.nodes[id.index()];
        if !matches!(node.cell, Cell::Constant(_)) && !node.held {
            node.label = register.clone();
            node.held = true;
        }
    }

    /// Returns the node of a constant. Bits of `bits` beyond the width of `format` are dropped.
    pub fn constant(&mut self, bits: u64, format: Format, label: &Label) -> NodeId {
        let bits = bits & mask(format.width());
        let raw = format.raw(bits);
        self.insert(Cell::Constant(bits), format, (raw, raw), label)
    }

    /// Returns the node of a constant of the description. `label` replaces the label of an equal constant of the
    /// microprogram, such as the value of a select line.
    pub fn described_constant(&mut self, bits: u64, format: Format, label: &Label) -> NodeId {
        let id = self.constant(bits, format, label);
        let node = &mut self.nodes[id.index()];
        if !node.held {
            node.label = label.clone();
            node.held = true;
        }
        id
    }

    /// Returns the node for the word at `address` of a ROM with the contents `words`. A constant `address` gives the constant
    /// word, or 0 behind the last one.
    pub fn read(
        &mut self,
        rom: RomId,
        address: NodeId,
        words: &[u64],
        format: Format,
        label: &Label,
    ) -> NodeId {
        if let Some(at) = self.constant_of(address) {
            let word = words.get(at as usize).copied().unwrap_or(0);
            return self.constant(word, format, label);
        }
        let (low, high) = self.node(address).range;
        let from = usize::try_from(low).unwrap_or(0).min(words.len().saturating_sub(1));
        let to = usize::try_from(high).map_or(words.len(), |high| words.len().min(high + 1));
        let raws = words[from..to.max(from + 1)].iter().map(|&word| format.raw(word));
        let range = interval::of_values(raws).unwrap_or((0, 0));
        self.insert(Cell::Read { rom, address }, format, range, label)
    }

    /// Returns the node for the operation `cell`, an existing one if operation, width and sign agree; the binary point does not
    /// matter. The interval of an existing node narrows to `range`, and a name that an author chose replaces a generated one.
    pub fn insert(&mut self, cell: Cell, format: Format, range: Interval, label: &Label) -> NodeId {
        let key = (cell.clone(), format.width(), format.signed);
        if let Some(&id) = self.known.get(&key) {
            let node = &mut self.nodes[id.index()];
            if label.named && !node.label.named {
                node.label = label.clone();
            }
            return self.refine(id, range);
        }
        let id = NodeId(self.nodes.len() as u32);
        let (label, step) = (label.clone(), self.step);
        self.nodes.push(Node { cell, format, range, label, step, held: false });
        self.known.insert(key, id);
        id
    }

    /// Truncates node `id` to `width` bits, or extends it by its sign or zeros. The result is signed if `signed`.
    pub fn resize(&mut self, id: NodeId, width: u32, signed: bool) -> NodeId {
        let node = self.node(id);
        let (format, label) = (node.format, Label { named: false, ..node.label.clone() });
        let frac = format.frac;
        let wanted = Format { signed, int: width as i32 - frac - i32::from(signed), frac };
        match width.cmp(&format.width()) {
            std::cmp::Ordering::Less => self.op(NodeOp::Slice { of: id, low: 0 }, wanted, &label),
            std::cmp::Ordering::Equal => self.op(NodeOp::Relabel(id), wanted, &label),
            std::cmp::Ordering::Greater => self.op(NodeOp::Extend(id), wanted, &label),
        }
    }

    /// Returns a node with the value of the cell `op`, simplified if possible: a sum of two constants becomes a constant.
    pub fn op(&mut self, op: NodeOp, format: Format, label: &Label) -> NodeId {
        if let Some(id) = self.fold(&op, format, label) {
            let node = &mut self.nodes[id.index()];
            let plain = !matches!(node.cell, Cell::Constant(_) | Cell::Operand(_));
            if plain && label.named && !node.label.named {
                node.label = label.clone();
            }
            return id;
        }
        let range = of_cell(&op, format, &|id| self.node(id).format, &|id| self.node(id).range);
        let range = (range.0, self.limit(&op).map_or(range.1, |limit| range.1.min(limit)));
        if range.0 == range.1 {
            return self.constant(format.bits(range.0), format, label);
        }
        self.insert(Cell::Op(op), format, range, label)
    }

    /// Returns the largest value of `limit` as an upper limit of a mux `value < limit ? value : limit`.
    fn limit(&self, op: &NodeOp) -> Option<i128> {
        let NodeOp::Mux { select, inputs } = op else { return None };
        match (&self.node(*select).cell, &inputs[..]) {
            (Cell::Op(NodeOp::Less(value, limit)), [other, one])
                if (limit, value) == (other, one) =>
            {
                Some(self.node(*limit).range.1)
            }
            _ => None,
        }
    }

    /// Returns whether the mux `select ? limit : value` is superfluous because `value` never exceeds the constant `limit`:
    /// `limit` is a power of two, and `select` is the bit of `value` with this weight.
    fn is_kept(&self, value: NodeId, select: NodeId, limit: u64) -> bool {
        let (low, high) = self.node(value).range;
        let Cell::Op(NodeOp::Slice { of, low: bit }) = self.node(select).cell else { return false };
        of == value
            && limit.checked_ilog2() == Some(bit)
            && low >= 0
            && high <= limit.into()
            && limit.is_power_of_two()
    }

    /// Returns a simpler or existing node with the value of the cell `op`, if there is one: `x + 0` gives `x`.
    fn fold(&mut self, op: &NodeOp, format: Format, label: &Label) -> Option<NodeId> {
        let known = op.operands().into_iter();
        let known: Option<HashMap<NodeId, [u64; 1]>> =
            known.map(|id| Some((id, [self.constant_of(id)?]))).collect();
        if let Some(values) = known {
            let formats = |id: NodeId| self.node(id).format;
            let [bits] = eval::cell(op, format.width(), &formats, &|id| &values[&id]);
            return Some(self.constant(bits, format, label));
        }
        let width = format.width();
        let same = |graph: &Self, id: NodeId| {
            let other = graph.node(id).format;
            other.width() == width && other.signed == format.signed
        };
        let again = |graph: &mut Self, op: NodeOp| Some(graph.op(op, format, label));
        match op {
            NodeOp::Relabel(a) if same(self, *a) => Some(*a),
            NodeOp::Relabel(a) => match self.node(*a).cell {
                Cell::Op(NodeOp::Relabel(b)) => again(self, NodeOp::Relabel(b)),
                _ => None,
            },
            NodeOp::Extend(a) => {
                let inner = self.node(*a);
                let Cell::Op(NodeOp::Extend(b)) = inner.cell else { return None };
                let b_signed = self.node(b).format.signed;
                (b_signed == inner.format.signed || !b_signed)
                    .then(|| self.op(NodeOp::Extend(b), format, label))
            }
            NodeOp::Slice { of, low } => self.fold_slice(*of, *low, format, label),
            NodeOp::Concat(parts) => match &parts[..] {
                [only] => again(self, NodeOp::Relabel(*only)),
                _ => None,
            },
            NodeOp::Not(a) => match self.node(*a).cell {
                Cell::Op(NodeOp::Not(b)) if same(self, b) => Some(b),
                _ => None,
            },
            NodeOp::And(a, b) | NodeOp::Or(a, b) | NodeOp::Xor(a, b) => {
                let (a, b) = if self.constant_of(*a).is_some() { (*b, *a) } else { (*a, *b) };
                let ones = mask(width);
                match (op, self.constant_of(b)) {
                    (NodeOp::And(..), Some(0)) => Some(self.constant(0, format, label)),
                    (NodeOp::Or(..), Some(bits)) if bits == ones => {
                        Some(self.constant(ones, format, label))
                    }
                    (NodeOp::And(..), Some(bits)) if bits == ones && same(self, a) => Some(a),
                    (NodeOp::Or(..) | NodeOp::Xor(..), Some(0)) if same(self, a) => Some(a),
                    (NodeOp::Xor(..), Some(bits)) if bits == ones => again(self, NodeOp::Not(a)),
                    (NodeOp::And(..) | NodeOp::Or(..), None) if a == b && same(self, a) => Some(a),
                    (_, None) if self.is_inverse(a, b) || self.is_inverse(b, a) => {
                        let bits = if matches!(op, NodeOp::And(..)) { 0 } else { ones };
                        Some(self.constant(bits, format, label))
                    }
                    _ => None,
                }
            }
            NodeOp::Add { a, b, carry } => {
                let no_carry = carry.is_none_or(|carry| self.constant_of(carry) == Some(0));
                match (self.constant_of(*a), self.constant_of(*b)) {
                    (Some(0), _) if no_carry && same(self, *b) => Some(*b),
                    (_, Some(0)) if no_carry && same(self, *a) => Some(*a),
                    _ => None,
                }
            }
            NodeOp::Sub(a, b) => (self.constant_of(*b) == Some(0) && same(self, *a)).then_some(*a),
            NodeOp::Mul(a, b) => self.fold_product(*a, *b, format, label),
            NodeOp::Any(a) => {
                let (low, high) = self.node(*a).range;
                if low > 0 || high < 0 {
                    return Some(self.constant(1, format, label));
                }
                if let Cell::Op(NodeOp::Extend(b)) = self.node(*a).cell {
                    return again(self, NodeOp::Any(b));
                }
                if self.width(*a) == 1 {
                    return again(self, NodeOp::Relabel(*a));
                }
                let bits = self.without_zeros(*a, label)?;
                again(self, NodeOp::Any(bits))
            }
            NodeOp::All(a) if self.width(*a) == 1 => again(self, NodeOp::Relabel(*a)),
            NodeOp::Equal(..) | NodeOp::Less(..) | NodeOp::All(_) => None,
            NodeOp::Mux { select, inputs } => {
                if let Some(value) = self.constant_of(*select) {
                    let input = inputs[(value as usize).min(inputs.len() - 1)];
                    return again(self, NodeOp::Relabel(input));
                }
                if inputs.iter().all(|input| *input == inputs[0]) {
                    return again(self, NodeOp::Relabel(inputs[0]));
                }
                let bits: Vec<_> = inputs.iter().map(|&input| self.constant_of(input)).collect();
                match bits[..] {
                    [Some(0), Some(1)] if width == 1 => again(self, NodeOp::Relabel(*select)),
                    [Some(1), Some(0)] if width == 1 => again(self, NodeOp::Not(*select)),
                    [None, Some(limit)] if self.is_kept(inputs[0], *select, limit) => {
                        again(self, NodeOp::Relabel(inputs[0]))
                    }
                    _ => None,
                }
            }
        }
    }

    fn is_inverse(&self, inverse: NodeId, of: NodeId) -> bool {
        matches!(self.node(inverse).cell, Cell::Op(NodeOp::Not(it)) if it == of)
    }

    /// Drops the zeros in a slice that an extension has put above an unsigned number, if there are any. If a number of 3 bits is
    /// extended to 8, the slice of all 8 bits becomes the slice of the lowest 3.
    fn without_zeros(&mut self, slice: NodeId, label: &Label) -> Option<NodeId> {
        let Cell::Op(NodeOp::Slice { of, low }) = self.node(slice).cell else { return None };
        let Cell::Op(NodeOp::Extend(number)) = self.node(of).cell else { return None };
        let inner = self.node(number).format;
        let left = inner.width() - low;
        (!inner.signed && left < self.width(slice)).then(|| {
            let bits = Format::unsigned(left as i32, 0);
            self.op(NodeOp::Slice { of: number, low }, bits, label)
        })
    }

    /// Simplifies the slice of node `of` from bit `low`, as wide as `format`, if possible. A slice of a slice becomes one slice.
    fn fold_slice(
        &mut self,
        of: NodeId,
        low: u32,
        format: Format,
        label: &Label,
    ) -> Option<NodeId> {
        let width = format.width();
        if low == 0 && width == self.width(of) {
            return Some(self.op(NodeOp::Relabel(of), format, label));
        }
        let again = |graph: &mut Self, of: NodeId, low: u32| {
            Some(graph.op(NodeOp::Slice { of, low }, format, label))
        };
        match self.node(of).cell.clone() {
            Cell::Op(NodeOp::Slice { of, low: inner }) => again(self, of, low + inner),
            Cell::Op(NodeOp::Relabel(a)) => again(self, a, low),
            Cell::Op(NodeOp::Extend(a)) => {
                let inner = self.node(a).format;
                if low + width <= inner.width() {
                    return again(self, a, low);
                }
                if low == 0 {
                    return Some(self.op(NodeOp::Extend(a), format, label));
                }
                if inner.signed && width == 1 {
                    return again(self, a, inner.width() - 1);
                }
                (low >= inner.width() && !inner.signed).then(|| self.constant(0, format, label))
            }
            Cell::Op(NodeOp::Concat(parts)) => {
                // The bits of each part that the slice takes, from the lowest part up.
                let (mut from, mut wanted) = (0, Vec::new());
                for part in parts.into_iter().rev() {
                    let end = from + self.width(part);
                    let (first, last) = (low.max(from), (low + width).min(end));
                    if first < last {
                        wanted.push((part, first - from, last - first));
                    }
                    from = end;
                }
                if let [(part, low, _)] = wanted[..] {
                    return again(self, part, low);
                }
                let label = Label { named: false, ..self.node(of).label.clone() };
                let mut pieces = Vec::new();
                for (of, low, width) in wanted.into_iter().rev() {
                    let format = Format::unsigned(width as i32, 0);
                    pieces.push(self.op(NodeOp::Slice { of, low }, format, &label));
                }
                Some(self.op(NodeOp::Concat(pieces), format, &label))
            }
            _ => None,
        }
    }

    /// Returns a product whose factors are no wider than their values require, and unsigned if neither can be negative. Returns
    /// `None` if the product already has this form.
    fn fold_product(
        &mut self,
        a: NodeId,
        b: NodeId,
        format: Format,
        label: &Label,
    ) -> Option<NodeId> {
        let ranges = [self.node(a).range, self.node(b).range];
        let signed = ranges.iter().any(|range| range.0 < 0);
        let [wa, wb] = ranges.map(|range| bits_for(range, signed));
        if [(a, wa), (b, wb)]
            .iter()
            .all(|&(id, width)| self.width(id) == width && self.node(id).format.signed == signed)
            && format.width() == wa + wb
        {
            return None;
        }
        let (a, b) = (self.resize(a, wa, signed), self.resize(b, wb, signed));
        let int = (wa + wb) as i32 - format.frac - i32::from(signed);
        let exact = Format { signed, int, frac: format.frac };
        let product = self.op(NodeOp::Mul(a, b), exact, label);
        Some(self.resize(product, format.width(), format.signed))
    }
}

impl Cell {
    /// Returns the nodes that the operation reads, in order.
    pub fn operands(&self) -> Vec<NodeId> {
        match self {
            Self::Op(op) => op.operands(),
            Self::Read { address, .. } => vec![*address],
            Self::Operand(_) | Self::Unknown(_) | Self::Constant(_) => Vec::new(),
        }
    }

    /// Returns whether the operation takes no logic: it is a constant, or it renames, extends, slices or joins bits.
    pub fn is_wiring(&self) -> bool {
        matches!(
            self,
            Self::Op(
                NodeOp::Relabel(_) | NodeOp::Extend(_) | NodeOp::Slice { .. } | NodeOp::Concat(_)
            ) | Self::Constant(_)
        )
    }
}

/// Returns how many bits a number of this range takes, at least 1, with a sign if `signed`: 0 to 5 take 3 bits, and −4 to 3 take
/// 3 with the sign.
fn bits_for(range: Interval, signed: bool) -> u32 {
    let [low, high] = [range.0, range.1].map(|raw| {
        let magnitude = if raw < 0 { !raw } else { raw };
        128 - magnitude.leading_zeros()
    });
    (low.max(high) + u32::from(signed)).max(1)
}

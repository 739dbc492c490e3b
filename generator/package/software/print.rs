//! Values as expressions and statements of C99.
//!
//! Every value is a bit pattern in an unsigned type of 32 or 64 bits, with zeros above its width: the only
//! arithmetic that C defines on every machine. Signs are made by `(x ^ s) - s`, with s the sign bit's weight.

use std::collections::BTreeMap;

use super::graph::{Graph, Node};
use crate::base::fixed::mask;
use crate::hdl::netlist::{Design, NetId, Op, RegId};
use crate::hdl::verilog::text::{Names, ascii};

/// The words of C99 and the names that the model's own text uses.
const TAKEN: &str = "
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while _Bool _Complex _Imaginary
    asm bool false true NULL main
    int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t
    INT32_C INT64_C UINT32_C UINT64_C
    operands results points count capacity at point";

/// The names that a function or a structure may not use for its own.
pub fn taken() -> Names {
    Names::new(TAKEN.split_ascii_whitespace())
}

/// A field of a structure: the port's name, unless that is a word of C.
pub fn field(port: &str) -> String {
    taken().fresh(port)
}

/// The type of a bit pattern.
pub fn pattern_type(width: u32) -> &'static str {
    if width <= 32 { "uint32_t" } else { "uint64_t" }
}

/// A literal of the type of a bit pattern.
pub fn literal(bits: u64, width: u32) -> String {
    match (width <= 32, bits < 1024) {
        (true, true) => format!("{bits}u"),
        (true, false) => format!("0x{bits:x}u"),
        (false, true) => format!("UINT64_C({bits})"),
        (false, false) => format!("UINT64_C(0x{bits:x})"),
    }
}

/// An expression, and whether it stands without brackets beside any operator.
struct Text(String, bool);

impl Text {
    fn inner(self) -> String {
        if self.1 { self.0 } else { format!("({})", self.0) }
    }
}

/// Prints the values of a function.
pub struct Printer<'a> {
    graph: &'a Graph,
    design: &'a Design,
    /// The tables, by ROM.
    tables: &'a [String],
    /// Names of values that have a statement of their own.
    locals: BTreeMap<NetId, String>,
    /// Names of registers and of what was read, where they are not known otherwise.
    states: BTreeMap<RegId, String>,
}

/// A statement, and the section that it belongs to.
pub struct Line {
    /// The number of the section.
    pub section: usize,
    /// The text, without indentation.
    pub text: String,
}

impl<'a> Printer<'a> {
    /// A printer and the statements that compute `wanted`. `states` names registers.
    pub fn new(
        graph: &'a Graph,
        design: &'a Design,
        tables: &'a [String],
        states: BTreeMap<RegId, String>,
        names: &mut Names,
        wanted: &[NetId],
    ) -> (Self, Vec<Line>) {
        let needed = graph.needed(wanted);
        let mut uses = vec![0_u32; graph.values.len()];
        let ids = (0..graph.values.len() as u32).map(NetId).filter(|id| needed[id.index()]);
        let ids: Vec<NetId> = ids.collect();
        for id in &ids {
            for operand in graph.operands(*id) {
                uses[operand.index()] += 1;
            }
        }
        for id in wanted {
            uses[id.index()] += 1;
        }
        let mut printer = Self { graph, design, tables, locals: BTreeMap::new(), states };
        let mut lines = Vec::new();
        for id in ids {
            let value = graph.value(id);
            let local = match &value.node {
                // Another name for the same bits.
                Node::Op(Op::Relabel(_)) => false,
                Node::Op(Op::Extend(of)) if !graph.value(*of).format.signed => false,
                Node::Op(_) | Node::Rom(..) => uses[id.index()] > 1 || !value.name.is_empty(),
                Node::Input(_) => true,
                Node::Constant(_) | Node::State(_) | Node::Read(_) => false,
            };
            if !local {
                continue;
            }
            let wish = match &value.node {
                Node::Input(port) => design.net(*port).name.as_str(),
                _ if value.name.is_empty() => "value",
                _ => &value.name,
            };
            let text = printer.expression(id).0;
            let name = names.fresh(wish);
            let kind = pattern_type(graph.width(id));
            lines.push(Line {
                section: value.section,
                text: format!("const {kind} {name} = {text};"),
            });
            printer.locals.insert(id, name);
        }
        (printer, lines)
    }

    /// Whether a value stands for itself, whatever becomes of the state.
    pub fn is_settled(&self, id: NetId) -> bool {
        self.locals.contains_key(&id) || self.graph.constant_of(id).is_some()
    }

    /// A value that the statements have computed.
    pub fn text(&self, id: NetId) -> String {
        self.value(id).0
    }

    fn value(&self, id: NetId) -> Text {
        match self.locals.get(&id) {
            Some(name) => Text(name.clone(), true),
            None => self.expression(id),
        }
    }

    /// In the type of `width` bits.
    fn in_type(&self, id: NetId, width: u32) -> Text {
        let (from, to) = (pattern_type(self.graph.width(id)), pattern_type(width));
        let text = self.value(id);
        if let Some(bits) = self.graph.constant_of(id) {
            return Text(literal(bits, width), true);
        }
        if from == to { text } else { Text(format!("({to}){}", text.inner()), true) }
    }

    fn masked(&self, text: String, width: u32) -> Text {
        match width {
            32 | 64 => Text(text, false),
            _ => Text(format!("({text}) & {}", literal(mask(width), width)), false),
        }
    }

    /// With copies of the sign bit above it, in the type of `width` bits.
    fn with_sign(&self, id: NetId, width: u32) -> String {
        let own = self.graph.width(id);
        let text = self.in_type(id, width).inner();
        if (own == 32 && width == 32) || own == 64 {
            text
        } else {
            let sign = literal(1 << (own - 1), width);
            format!("(({text} ^ {sign}) - {sign})")
        }
    }

    /// As a condition.
    fn condition(&self, id: NetId) -> String {
        match (&self.graph.value(id).node, self.locals.get(&id)) {
            (Node::Op(op @ (Op::Equal(..) | Op::Less(..) | Op::Any(_) | Op::All(_))), None) => {
                self.comparison(op)
            }
            _ => format!("{} != 0u", self.value(id).inner()),
        }
    }

    fn comparison(&self, op: &Op) -> String {
        let text = |id: NetId| self.value(id).inner();
        match op {
            Op::Equal(a, b) => format!("{} == {}", text(*a), text(*b)),
            Op::Less(a, b) if self.graph.value(*a).format.signed => {
                let width = self.graph.width(*a);
                let sign = literal(1 << (width - 1), width);
                format!("({} ^ {sign}) < ({} ^ {sign})", text(*a), text(*b))
            }
            Op::Less(a, b) => format!("{} < {}", text(*a), text(*b)),
            Op::All(of) => {
                let width = self.graph.width(*of);
                format!("{} == {}", text(*of), literal(mask(width), width))
            }
            _ => {
                let of = op.operands()[0];
                format!("{} != {}", text(of), literal(0, self.graph.width(of)))
            }
        }
    }

    fn expression(&self, id: NetId) -> Text {
        let value = self.graph.value(id);
        let width = value.format.width();
        match &value.node {
            Node::Constant(bits) => Text(literal(*bits, width), true),
            Node::Input(port) => {
                let net = self.design.net(*port);
                let field = field(&net.name);
                let text = if net.format.signed {
                    format!("({})operands.{field}", pattern_type(width))
                } else {
                    format!("operands.{field}")
                };
                match width {
                    32 | 64 => Text(text, true),
                    _ => Text(format!("{text} & {}", literal(mask(width), width)), false),
                }
            }
            Node::State(register) => {
                let name = self.states.get(register).cloned();
                Text(name.unwrap_or_else(|| literal(0, width)), true)
            }
            Node::Read(rom) => Text(read_name(self.design, rom.index()), true),
            Node::Rom(rom, address) => {
                let kind = pattern_type(width);
                let table = &self.tables[rom.index()];
                Text(format!("({kind}){table}[{}]", self.value(*address).0), true)
            }
            Node::Op(op) => self.operation(op, width),
        }
    }

    fn operation(&self, op: &Op, width: u32) -> Text {
        let graph = self.graph;
        let text = |id: NetId| self.value(id).inner();
        let wide = |id: NetId| self.in_type(id, width).inner();
        match op {
            Op::Relabel(of) => self.value(*of),
            Op::Extend(of) if graph.value(*of).format.signed => {
                self.masked(self.with_sign(*of, width), width)
            }
            Op::Extend(of) => self.in_type(*of, width),
            Op::Slice { of, low } => {
                let whole = graph.width(*of);
                let shifted = match low {
                    0 => text(*of),
                    _ => format!("{} >> {low}", text(*of)),
                };
                let cut = match low + width < whole {
                    true if *low == 0 => format!("{shifted} & {}", literal(mask(width), whole)),
                    true => format!("({shifted}) & {}", literal(mask(width), whole)),
                    false => shifted,
                };
                let (from, to) = (pattern_type(whole), pattern_type(width));
                if from == to { Text(cut, false) } else { Text(format!("({to})({cut})"), true) }
            }
            Op::Concat(parts) => {
                let mut low = width;
                let mut pieces = Vec::new();
                for part in parts {
                    low -= graph.width(*part);
                    if graph.constant_of(*part) != Some(0) {
                        pieces.push(match low {
                            0 => wide(*part),
                            _ => format!("({} << {low})", wide(*part)),
                        });
                    }
                }
                Text(pieces.join(" | "), pieces.len() == 1)
            }
            Op::Not(of) => Text(format!("{} ^ {}", text(*of), literal(mask(width), width)), false),
            Op::And(a, b) => Text(format!("{} & {}", text(*a), text(*b)), false),
            Op::Or(a, b) => Text(format!("{} | {}", text(*a), text(*b)), false),
            Op::Xor(a, b) => Text(format!("{} ^ {}", text(*a), text(*b)), false),
            Op::Add { a, b, carry } => {
                let mut sum = format!("{} + {}", text(*a), text(*b));
                if let Some(carry) = carry {
                    sum += &format!(" + {}", wide(*carry));
                }
                self.masked(sum, width)
            }
            Op::Sub(a, b) => self.masked(format!("{} - {}", text(*a), text(*b)), width),
            Op::Mul(a, b) if graph.value(*a).format.signed => {
                let (a, b) = (self.with_sign(*a, width), self.with_sign(*b, width));
                self.masked(format!("{a} * {b}"), width)
            }
            Op::Mul(a, b) => Text(format!("{} * {}", wide(*a), wide(*b)), false),
            Op::Equal(..) | Op::Less(..) | Op::Any(_) | Op::All(_) => {
                Text(format!("(uint32_t)({})", self.comparison(op)), true)
            }
            Op::Mux { select, inputs } => {
                let (last, others) = inputs.split_last().expect("a multiplexer has inputs");
                if let [at_0] = others {
                    let condition = self.condition(*select);
                    return Text(format!("{condition} ? {} : {}", text(*last), text(*at_0)), false);
                }
                let mut chain = String::new();
                for (at, input) in others.iter().enumerate() {
                    let number = literal(at as u64, graph.width(*select));
                    chain += &format!("{} == {number} ? {} : ", text(*select), text(*input));
                }
                Text(chain + &text(*last), false)
            }
        }
    }
}

/// The variable with the word that a synchronous ROM read.
pub fn read_name(design: &Design, rom: usize) -> String {
    design.net(design.roms[rom].data).name.clone()
}

/// A comment of one line.
pub fn comment(text: &str) -> String {
    // Nothing in a heading may end the comment.
    format!("/* {} */", ascii(text).replace("*/", "* /").replace("/*", "/ *"))
}

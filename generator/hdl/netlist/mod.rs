//! The netlist: what a description becomes, and what everything else is derived from.
//!
//! A [`Design`] is a set of *nets* in an arena. Every net has a name, a [`Format`], the interval of
//! raw values that it can take, and exactly one driver: an input port, a constant, a register, a ROM,
//! a field of the control word, or a combinational [`Op`]. There is one clock; registers and
//! synchronous ROMs change on its rising edge and nothing else holds state.
//!
//! Invariants that [`crate::hdl::dsl::rules`] establishes and everything downstream relies on:
//!
//! * operands have the widths that the [`Op`] documents; nothing is extended or cut implicitly;
//! * the combinational part is acyclic ([`Design::levelise`] gives an evaluation order);
//! * names are distinct, legal Verilog identifiers, and no net is wider than 64 bits;
//! * a value never leaves the interval of its net, and the interval fits the format.

pub mod microcode;
pub mod termination;

use std::fmt::{self, Write as _};
use std::panic::Location;

use crate::base::fixed::Format;
pub use termination::latest_done;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The position in the arena.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A net of a [`Design`].
    NetId
);
id!(
    /// A register of a [`Design`].
    RegId
);
id!(
    /// A ROM of a [`Design`].
    RomId
);
id!(
    /// A field of the control word of a [`Design`].
    FieldId
);

/// Which of the two modules of the emitted Verilog a net belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unit {
    /// The control unit: sequencer and control ROM.
    Control,
    /// Operand registers, arithmetic, result registers.
    Datapath,
}

/// A wire of the design.
#[derive(Clone, Debug)]
pub struct Net {
    /// A legal Verilog identifier, distinct in the design.
    pub name: String,
    /// Where the binary point lies and whether the top bit is a sign.
    pub format: Format,
    /// The smallest and the largest raw value that the net can carry.
    pub range: (i128, i128),
    /// What drives it.
    pub driver: Driver,
    /// The number of the block in the source's figure whose output this is.
    pub block: Option<u16>,
    /// One line for the reader of the Verilog; may be empty.
    pub doc: String,
    /// Named by the author of the description, so that waveforms and Verilog show it. The rest is
    /// wiring that the DSL adds (extensions, slices, rounding), named after what it serves.
    pub named: bool,
    /// The module that the net is in.
    pub unit: Unit,
    /// Where in the description it was written.
    pub location: &'static Location<'static>,
}

/// What drives a net.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Driver {
    /// Nothing yet: an error that [`crate::hdl::dsl::rules`] reports.
    Undriven,
    /// An input port.
    Input,
    /// A bit pattern.
    Constant(u64),
    /// The output of a register.
    Register(RegId),
    /// The data output of a ROM.
    Rom(RomId),
    /// A field of the control word.
    Field(FieldId),
    /// A combinational cell.
    Op(Op),
}

/// A combinational cell. Widths are those of the nets; "same width" includes the result.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// The operand's bits under another name or format; same width.
    Relabel(NetId),
    /// The operand with copies of its sign bit (signed operand) or zeros (unsigned) above it; the
    /// result is wider.
    Extend(NetId),
    /// The bits of the operand from `low` up, as many as the result is wide.
    Slice {
        /// The operand.
        of: NetId,
        /// The lowest bit taken.
        low: u32,
    },
    /// The operands side by side, the first in the top bits; the result is as wide as all together.
    Concat(Vec<NetId>),
    /// Every bit inverted; same width.
    Not(NetId),
    /// Bitwise and; same width.
    And(NetId, NetId),
    /// Bitwise or; same width.
    Or(NetId, NetId),
    /// Bitwise exclusive or; same width.
    Xor(NetId, NetId),
    /// Sum modulo 2^width; operands and result of the same width, the carry one bit.
    Add {
        /// First operand.
        a: NetId,
        /// Second operand.
        b: NetId,
        /// Carry in.
        carry: Option<NetId>,
    },
    /// Difference `a − b` modulo 2^width; same width.
    Sub(NetId, NetId),
    /// The whole product; operands both signed or both unsigned, the result as wide as both together.
    Mul(NetId, NetId),
    /// 1 when the operands, of one width, are equal; the result is one bit.
    Equal(NetId, NetId),
    /// 1 when `a < b`; operands of one width, both signed or both unsigned; the result is one bit.
    Less(NetId, NetId),
    /// 1 when any bit of the operand is 1; the result is one bit.
    Any(NetId),
    /// 1 when every bit of the operand is 1; the result is one bit.
    All(NetId),
    /// Input number `select`; inputs of the result's width. Beyond the last input: the last input.
    Mux {
        /// As wide as the number of inputs needs.
        select: NetId,
        /// Two or more.
        inputs: Vec<NetId>,
    },
}

impl Op {
    /// Every operand, in order of writing.
    pub fn operands(&self) -> Vec<NetId> {
        match self {
            Self::Relabel(a) | Self::Extend(a) | Self::Not(a) | Self::Any(a) | Self::All(a) => {
                vec![*a]
            }
            Self::Slice { of, .. } => vec![*of],
            Self::Concat(parts) => parts.clone(),
            Self::And(a, b)
            | Self::Or(a, b)
            | Self::Xor(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Equal(a, b)
            | Self::Less(a, b) => vec![*a, *b],
            Self::Add { a, b, carry } => {
                [Some(*a), Some(*b), *carry].into_iter().flatten().collect()
            }
            Self::Mux { select, inputs } => {
                [*select].into_iter().chain(inputs.iter().copied()).collect()
            }
        }
    }

    /// Every operand, in order of writing, to be replaced by others.
    pub fn operands_mut(&mut self) -> Vec<&mut NetId> {
        match self {
            Self::Relabel(a)
            | Self::Extend(a)
            | Self::Not(a)
            | Self::Any(a)
            | Self::All(a)
            | Self::Slice { of: a, .. } => vec![a],
            Self::Concat(parts) => parts.iter_mut().collect(),
            Self::And(a, b)
            | Self::Or(a, b)
            | Self::Xor(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::Equal(a, b)
            | Self::Less(a, b) => vec![a, b],
            Self::Add { a, b, carry } => {
                [Some(a), Some(b), carry.as_mut()].into_iter().flatten().collect()
            }
            Self::Mux { select, inputs } => {
                std::iter::once(select).chain(inputs.iter_mut()).collect()
            }
        }
    }

    /// The name of the cell in dumps and diagrams.
    pub fn mnemonic(&self) -> &'static str {
        match self {
            Self::Relabel(_) => "relabel",
            Self::Extend(_) => "extend",
            Self::Slice { .. } => "slice",
            Self::Concat(_) => "concat",
            Self::Not(_) => "not",
            Self::And(..) => "and",
            Self::Or(..) => "or",
            Self::Xor(..) => "xor",
            Self::Add { .. } => "add",
            Self::Sub(..) => "sub",
            Self::Mul(..) => "mul",
            Self::Equal(..) => "equal",
            Self::Less(..) => "less",
            Self::Any(_) => "any",
            Self::All(_) => "all",
            Self::Mux { .. } => "mux",
        }
    }
}

/// A register: takes `data` on a rising edge when `enable` is 1 or absent.
#[derive(Clone, Debug)]
pub struct Register {
    /// The net that it drives; the register has its name, format, block number and location.
    pub q: NetId,
    /// What it takes; `None` is an error that [`crate::hdl::dsl::rules`] reports.
    pub data: Option<NetId>,
    /// One bit.
    pub enable: Option<NetId>,
    /// The bit pattern after a clock with `rst_n` low; without it reset leaves the register alone.
    pub reset: Option<u64>,
    /// What it is for.
    pub kind: RegisterKind,
}

/// What a register is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegisterKind {
    /// Loaded from an input port by its write strobe.
    Operand,
    /// Of the source's datapath; a golden model predicts it on every clock.
    Architectural,
    /// Of the sequencer; a golden model predicts it too.
    Sequencer,
    /// A pipeline register inside a block (behind a synchronous ROM or a multiplier); only its effects
    /// are compared.
    Internal,
}

/// A read-only memory.
#[derive(Clone, Debug)]
pub struct Rom {
    /// A legal Verilog identifier; the contents go to `<design>_<name>.mem`.
    pub name: String,
    /// The word number; its range lies within the contents.
    pub address: NetId,
    /// The net that carries the word read; all words have its width.
    pub data: NetId,
    /// Reads on the rising edge (block RAM) instead of at once (logic).
    pub synchronous: bool,
    /// One bit; a synchronous read keeps its word while it is 0. Without it every edge reads.
    pub enable: Option<NetId>,
    /// Another ROM, of the same words: this is the second read port of its memory.
    pub shares: Option<RomId>,
    /// Bit patterns.
    pub words: Vec<u64>,
    /// What one entry means, in one or more lines.
    pub doc: Vec<String>,
    /// A comment for each word, or empty.
    pub comments: Vec<String>,
    /// The number of the block in the source's figure.
    pub block: Option<u16>,
    /// Where in the description it was written.
    pub location: &'static Location<'static>,
}

/// A port of the top module, other than `clk`.
#[derive(Clone, Debug)]
pub struct Port {
    /// The port has the net's name, format, block number and comment.
    pub net: NetId,
    /// What the environment does with it.
    pub role: Role,
}

/// The part that a port plays in the handshake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Input `rst_n`: initial set, active low, synchronous.
    Reset,
    /// Input `start`: begins a computation when the device is not busy.
    Start,
    /// Input: the data of an operand register, and the strobe that writes it.
    Operand {
        /// One-bit input port.
        strobe: NetId,
    },
    /// Input: a write strobe.
    Strobe,
    /// Input `in_valid`: the operands are those of a point, which is taken in this clock if `in_ready`.
    InValid,
    /// Input: an operand of the point that is offered.
    Point,
    /// Input `side_in`: travels with the point.
    SideIn,
    /// Input `out_ready`: the results are taken in this clock.
    OutReady,
    /// Output `in_ready`.
    InReady,
    /// Output `side_out`: what came in with the point whose results are on the outputs.
    SideOut,
    /// Output: high exactly in the words that set it; results are then on the outputs.
    Valid,
    /// Output: high from the clock after start to the end.
    Busy,
    /// Output: high for the last clock of a computation.
    Done,
    /// Output: a result.
    Result,
    /// Output: a signal of the source's control block that is none of the above.
    Status,
}

impl Role {
    /// Whether the port is an input.
    pub fn is_input(self) -> bool {
        matches!(
            self,
            Self::Reset
                | Self::Start
                | Self::Operand { .. }
                | Self::Strobe
                | Self::InValid
                | Self::Point
                | Self::SideIn
                | Self::OutReady
        )
    }
}

/// The control unit: an address counter, a run flag and a ROM of words.
///
/// Idle, the address is 0 and `run` is 0. `start` sets `run`; from then on every clock executes the
/// word at the address and moves on as the word's [`Sequence`] says.
#[derive(Clone, Debug)]
pub struct Control {
    /// Most significant first, as in the ROM word.
    pub fields: Vec<Field>,
    /// One for each address, from 0.
    pub words: Vec<Word>,
    /// The control ROM.
    pub rom: RomId,
    /// The counter that addresses it.
    pub address: RegId,
    /// 1 while a program runs.
    pub run: RegId,
}

/// A field of the control word.
#[derive(Clone, Debug)]
pub struct Field {
    /// A legal Verilog identifier.
    pub name: String,
    /// The net that it drives in the datapath or the sequencer.
    pub net: NetId,
    /// What it turns.
    pub kind: FieldKind,
    /// The numbers of its lines in the source's figure, most significant first, or empty.
    pub lines: Vec<u16>,
}

/// What a field of the control word turns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Select lines of muxes; the names of the choices, by value.
    Select(Vec<String>),
    /// The enable of registers.
    Enable,
    /// An output of the device.
    Flag,
    /// Used by the sequencer itself.
    Sequence,
}

/// A word of the microprogram.
#[derive(Clone, Debug)]
pub struct Word {
    /// What it does.
    pub name: String,
    /// The value of each field, in the order of [`Control::fields`].
    pub values: Vec<u64>,
    /// Where control goes from here.
    pub sequence: Sequence,
    /// Where in the description it was written.
    pub location: &'static Location<'static>,
}

/// Where control goes after a word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sequence {
    /// To the next word.
    Next,
    /// Stays until `start` is high, then to the next word. The device is not busy here.
    WaitStart,
    /// To word `to`, back or ahead, while `condition` is 1, else to the next word.
    LoopWhile {
        /// One bit of the datapath.
        condition: NetId,
        /// A word number.
        to: usize,
    },
    /// To idle.
    End,
}

impl Control {
    /// That of a pipeline: no microinstruction, and so neither fields nor a sequencer.
    pub fn none() -> Self {
        Self {
            fields: Vec::new(),
            words: Vec::new(),
            rom: RomId(u32::MAX),
            address: RegId(u32::MAX),
            run: RegId(u32::MAX),
        }
    }
}

/// What a design is that takes a point every clock.
#[derive(Clone, Debug)]
pub struct Pipeline {
    /// Whose delays the stages keep, by the name of the target.
    pub target: String,
    /// The clock that they keep.
    pub clock_mhz: f64,
    /// The environment can hold the results back by `out_ready`.
    pub stall: bool,
    /// Bits that travel with a point.
    pub side: u32,
    /// From the operands on. Results are behind the registers of the last: there are as many stages as
    /// clocks from a point to its results.
    pub stages: Vec<Stage>,
    /// For each net its stage. A register of stage k holds what stage k - 1 made.
    pub stage_of: Vec<usize>,
    /// The nets that say which stage has a point, and when points move.
    pub handshake: Vec<NetId>,
    /// Where values are to be seen that the sequential design has in registers.
    pub checkpoints: Vec<Checkpoint>,
}

/// The logic between two rows of registers.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The microinstructions of the sequential design that compute what it computes.
    pub microinstructions: Vec<String>,
    /// Nanoseconds that the longest way through it takes on the target.
    pub logic_ns: f64,
    /// Bits of the registers that end it.
    pub register_bits: u32,
}

/// A value of a pipeline that a register of the sequential design has in some microinstruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// The register, by name.
    pub register: String,
    /// The microinstruction while which it has the value, by its place in the microprogram.
    pub word: usize,
    /// How often this was executed before in the same computation.
    pub visit: usize,
    /// The net with the value, in its stage.
    pub net: NetId,
}

/// What the header of the emitted Verilog, the manifest and the documentation say of a device.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The device as the registry knows it, `rough`.
    pub device: String,
    /// What it is, in one line.
    pub title: String,
    /// What it computes, as a formula.
    pub formula: String,
    /// The document, and the part of it, that describes the device.
    pub source: String,
    /// Paragraphs on readings, formats and limits.
    pub notes: Vec<String>,
}

/// A device: datapath, control unit and ports.
#[derive(Clone, Debug)]
pub struct Design {
    /// The name of the top module: a legal Verilog identifier.
    pub name: String,
    /// For people.
    pub about: About,
    /// All wires.
    pub nets: Vec<Net>,
    /// All registers.
    pub registers: Vec<Register>,
    /// All ROMs, the control ROM among them.
    pub roms: Vec<Rom>,
    /// Inputs, then outputs, in order of declaration.
    pub ports: Vec<Port>,
    /// The control unit; [`Control::none`] of a pipeline.
    pub control: Control,
    /// The stages, of a pipeline.
    pub pipeline: Option<Pipeline>,
}

impl Design {
    /// The net `id`.
    pub fn net(&self, id: NetId) -> &Net {
        &self.nets[id.index()]
    }

    /// The width of the net `id`.
    pub fn width(&self, id: NetId) -> u32 {
        self.net(id).format.width()
    }

    /// The register `id`.
    pub fn register(&self, id: RegId) -> &Register {
        &self.registers[id.index()]
    }

    /// The ROM `id`.
    pub fn rom(&self, id: RomId) -> &Rom {
        &self.roms[id.index()]
    }

    /// The net of the given name.
    pub fn find(&self, name: &str) -> Option<NetId> {
        let at = self.nets.iter().position(|net| net.name == name)?;
        Some(NetId(at as u32))
    }

    /// Every net with its id.
    pub fn iter(&self) -> impl Iterator<Item = (NetId, &Net)> {
        self.nets.iter().enumerate().map(|(at, net)| (NetId(at as u32), net))
    }

    /// Ports that are inputs, in order.
    pub fn inputs(&self) -> impl Iterator<Item = &Port> {
        self.ports.iter().filter(|port| port.role.is_input())
    }

    /// Ports that are outputs, in order.
    pub fn outputs(&self) -> impl Iterator<Item = &Port> {
        self.ports.iter().filter(|port| !port.role.is_input())
    }

    /// The ports of the given kind.
    pub fn port(&self, wanted: impl Fn(Role) -> bool) -> Option<&Port> {
        self.ports.iter().find(|port| wanted(port.role))
    }

    /// The nets that `id` depends on within one clock: operands of its cell, the address of an
    /// asynchronous ROM, the control ROM behind a field. Nothing for inputs, constants, registers and
    /// synchronous ROMs.
    pub fn combinational_inputs(&self, id: NetId) -> Vec<NetId> {
        match &self.net(id).driver {
            Driver::Op(op) => op.operands(),
            Driver::Rom(rom) if !self.rom(*rom).synchronous => vec![self.rom(*rom).address],
            Driver::Field(_) => vec![self.rom(self.control.rom).data],
            Driver::Undriven
            | Driver::Input
            | Driver::Constant(_)
            | Driver::Register(_)
            | Driver::Rom(_) => Vec::new(),
        }
    }

    /// An order of all nets in which each stands after what it depends on within one clock.
    ///
    /// # Errors
    /// A combinational loop, as the nets along it.
    pub fn levelise(&self) -> Result<Vec<NetId>, Vec<NetId>> {
        #[derive(Clone, Copy, PartialEq)]
        enum Mark {
            New,
            Open,
            Done,
        }
        let mut mark = vec![Mark::New; self.nets.len()];
        let mut order = Vec::with_capacity(self.nets.len());
        for root in 0..self.nets.len() as u32 {
            if mark[root as usize] != Mark::New {
                continue;
            }
            // Each entry: a net and the inputs of it that are still to be visited.
            let mut path = vec![(NetId(root), self.combinational_inputs(NetId(root)))];
            mark[root as usize] = Mark::Open;
            while let Some((net, pending)) = path.last_mut() {
                let net = *net;
                let Some(input) = pending.pop() else {
                    mark[net.index()] = Mark::Done;
                    order.push(net);
                    path.pop();
                    continue;
                };
                match mark[input.index()] {
                    Mark::Done => {}
                    Mark::New => {
                        mark[input.index()] = Mark::Open;
                        path.push((input, self.combinational_inputs(input)));
                    }
                    Mark::Open => {
                        let from = path.iter().position(|(net, _)| *net == input);
                        return Err(path[from.unwrap_or(0)..]
                            .iter()
                            .map(|(net, _)| *net)
                            .collect());
                    }
                }
            }
        }
        Ok(order)
    }

    /// The number of the lowest bit of each field in the control word.
    pub fn field_positions(&self) -> Vec<u32> {
        let mut low = self.width(self.rom(self.control.rom).data);
        self.control
            .fields
            .iter()
            .map(|field| {
                low -= self.width(field.net);
                low
            })
            .collect()
    }

    /// The bits in all ROMs.
    pub fn rom_bits(&self) -> u64 {
        self.roms.iter().map(|rom| rom.words.len() as u64 * u64::from(self.width(rom.data))).sum()
    }
}

/// The netlist as text: one line a net, in order of declaration. Snapshots use it.
impl fmt::Display for Design {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let name = |id: NetId| self.net(id).name.as_str();
        writeln!(f, "design {}", self.name)?;
        for port in &self.ports {
            let direction = if port.role.is_input() { "input" } else { "output" };
            writeln!(f, "{direction} {} {:?}", name(port.net), port.role)?;
        }
        for net in &self.nets {
            let (low, high) = net.range;
            write!(f, "{}: {} [{low}, {high}]", net.name, net.format)?;
            if let Some(block) = net.block {
                write!(f, " #{block}")?;
            }
            match &net.driver {
                Driver::Undriven => f.write_str(" undriven")?,
                Driver::Input => f.write_str(" input")?,
                Driver::Constant(bits) => write!(f, " = {bits}")?,
                Driver::Rom(rom) => {
                    let rom = self.rom(*rom);
                    let edge = if rom.synchronous { " on the clock" } else { "" };
                    write!(
                        f,
                        " = rom {}[{}]{edge}, {} words",
                        rom.name,
                        name(rom.address),
                        rom.words.len()
                    )?;
                }
                Driver::Field(field) => {
                    write!(f, " = field {}", self.control.fields[field.index()].name)?
                }
                Driver::Register(id) => {
                    let register = self.register(*id);
                    write!(f, " <= {}", register.data.map_or("nothing", name))?;
                    if let Some(enable) = register.enable {
                        write!(f, " when {}", name(enable))?;
                    }
                    if let Some(reset) = register.reset {
                        write!(f, " reset {reset}")?;
                    }
                }
                Driver::Op(op) => {
                    write!(f, " = {}", op.mnemonic())?;
                    for operand in op.operands() {
                        write!(f, " {}", name(operand))?;
                    }
                    if let Op::Slice { low, .. } = op {
                        write!(f, " from {low}")?;
                    }
                }
            }
            f.write_char('\n')?;
        }
        for (at, word) in self.control.words.iter().enumerate() {
            writeln!(f, "word {at} {:?} {:?} {:?}", word.name, word.values, word.sequence)?;
        }
        Ok(())
    }
}

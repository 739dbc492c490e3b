//! Defines the netlist of a device, which the description language builds, and which the simulator, the pipeline builder and the
//! Verilog emitter read.
//!
//! A [`Design`] is a list of *nets*. Every net has a [`Format`], the interval of its raw values, and exactly one [`Driver`], such
//! as a register or a combinational [`Op`]. [`Design::verify`] checks widths, names and drivers, and [`Design::levelise`] finds
//! combinational loops. Only registers and synchronous ROMs have state, which changes on the rising edge of the one clock.

mod builder;
mod cell;
mod control;
mod decisions;
mod delay;
mod dump;
pub mod eval;
mod function;
mod handshake;
pub mod interval;
pub mod microcode;
mod pipeline;
mod settings;
pub mod termination;
mod timing;
mod verify;
mod write_port;

pub use cell::Op;
pub use control::{Control, Field, FieldKind, Microinstruction, Sequence};
pub use decisions::{decided_by_data, delay_of_valid};
pub use delay::{DelayLine, Delayed};
pub use eval::Interpreter;
pub use function::{CoreFunction, FunctionPort, OPCODE};
use glint_base::diagnostic::{Diagnostic, SourceLocation};
use glint_base::fixed::Format;
use glint_base::interval::Interval;
pub use handshake::Handshake;
pub use pipeline::{Checkpoint, Multiplier, Pipeline, Stage, Unit};
pub(crate) use settings::passed_on;
pub use settings::setting_of;
pub use termination::latest_done;
pub use timing::HandshakeTiming;
pub(crate) use write_port::joined;
pub use write_port::{TABLE_ADDRESS, TABLE_LOAD, TABLE_READY, TABLE_WRITE, WritePort};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}
pub(crate) use id;

id!(
    /// A position in [`Design::nets`].
    NetId
);
id!(
    /// A position in [`Design::registers`].
    RegId
);
id!(
    /// A position in `Design::roms`.
    RomId
);
id!(
    /// A position in [`Control::fields`].
    FieldId
);

/// The Verilog module to which a net belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Partition {
    /// The sequencer and the control ROM.
    Control,
    /// Operand registers, arithmetic and result registers.
    Datapath,
}

/// A wire of the design, with its format, its interval and its one driver.
#[derive(Clone, Debug)]
pub struct Net {
    /// A legal Verilog identifier, distinct in the design.
    pub name: String,
    pub format: Format,
    /// The smallest and the largest raw value that the net can carry, such as (0, 255) for `u8.0`.
    pub range: Interval,
    pub driver: Driver,
    /// The number of the block that drives this net in the source's block diagram, if it has one.
    pub block: Option<u16>,
    /// A comment of one line for the Verilog, or an empty text.
    pub doc: String,
    /// The topic of `doc`. A pipeline shows only comments on the device itself.
    pub doc_topic: Topic,
    /// Whether the author of the description named the net, so that waveforms and Verilog show it. All other nets are wiring that
    /// the description language adds (extensions, slices, rounding).
    pub named: bool,
    pub partition: Partition,
    /// The place in the Rust source that makes the net.
    pub location: SourceLocation,
}

/// Determines the value of a net.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Driver {
    /// No driver yet, an error that [`Design::verify`] reports.
    Undriven,
    Input,
    /// A constant, as a bit pattern.
    Constant(u64),
    /// The output of a register.
    Register(RegId),
    /// The data output of a ROM.
    Rom(RomId),
    /// A field of the control word.
    Field(FieldId),
    Op(Op),
}

/// A register, which loads `data` on a rising edge if `enable` is 1 or absent.
#[derive(Clone, Debug)]
pub struct NetlistRegister {
    /// The net that the register drives, which has its name, format, block number and location.
    pub q: NetId,
    /// The data input; `None` is an error that [`Design::verify`] reports.
    pub data: Option<NetId>,
    /// The load enable, one bit; without it, the register loads on every rising edge.
    pub enable: Option<NetId>,
    /// The bit pattern that the register loads on a rising edge with `rst_n` low. `None` if a reset does not affect it.
    pub reset: Option<u64>,
    pub kind: RegisterKind,
}

/// The purpose of a register. Checks compare the architectural registers with the golden model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegisterKind {
    /// A register of an operand. The write strobe loads it from an input port, or `start` from its buffer. The register does
    /// not change during a computation. For example, `cos_gamma_reg` of `rough`.
    Operand,
    /// A buffer in front of an operand register, which accepts the next operand at any time.
    Buffer,
    /// A register of the datapath that the description declares. The golden model predicts it on every clock.
    Architectural,
    /// Part of the sequencer. The golden model predicts it on every clock too.
    Sequencer,
    /// Inside a block, for example behind a synchronous ROM or a multiplier. No golden model predicts it.
    Internal,
}

#[derive(Clone, Debug)]
pub struct NetlistRom {
    /// A legal Verilog identifier. The contents go to `<design>_<name>.mem`, for example `rough_sine.mem`.
    pub name: String,
    /// The address, whose interval must lie between 0 and the number of words less one.
    pub address: NetId,
    /// The word that was read. The net must be wide enough for every word.
    pub data: NetId,
    /// Whether the ROM is read at the rising edge (block RAM) rather than without a clock (logic).
    pub synchronous: bool,
    /// The read enable of a synchronous ROM, one bit. The ROM keeps its output while the enable is 0. Without an enable, the
    /// ROM reads at every rising edge.
    pub enable: Option<NetId>,
    /// The first read port of this ROM's memory, if this ROM is the second one; both must have the same words.
    pub shares: Option<RomId>,
    /// Bit patterns, from address 0. A memory with a write port has them until the first write.
    pub words: Vec<u64>,
    /// The port that replaces words at run time; `None` for a read-only memory.
    pub write: Option<WritePort>,
    pub doc: Vec<String>,
    /// A comment for each word, or an empty list.
    pub comments: Vec<String>,
    /// The number of the ROM in the source's block diagram, if it has one.
    pub block: Option<u16>,
    /// The place in the Rust source that makes the ROM.
    pub location: SourceLocation,
}

/// A port of the design, other than the clock `clk`.
#[derive(Clone, Debug)]
pub struct Port {
    /// The net that has the port's name, format, block number and comment.
    pub net: NetId,
    pub role: Role,
}

/// The role of a port in the interface of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Input `rst_n`, the reset: active low, synchronous.
    Reset,
    /// Input `start`, which begins a computation if the device is not busy, with operand buffers also in the last clock of a
    /// computation.
    Start,
    /// Input for the value of an operand, which the write strobe loads.
    Operand {
        /// The input of one bit that loads the operand register or its buffer.
        strobe: NetId,
    },
    /// Input, the write strobe of an operand register. For example, `cos_gamma_write` writes `cos_gamma_reg`.
    Strobe,
    /// Input `in_valid` of a pipeline: the operand inputs have a point. The pipeline accepts it in this clock if `in_ready` is 1.
    InValid,
    /// Input, an operand of the point that the environment offers to a pipeline.
    Point,
    /// Input `side_in` of a pipeline: data that travel with the point unchanged.
    SideIn,
    /// Input `out_ready` of a pipeline: the environment takes the results in this clock.
    OutReady,
    /// Input `table_write`: the other inputs of the write port have a word.
    TableWrite,
    /// Input `table_address`: the address of the word to write.
    TableAddress,
    /// Input, a part of the word to write, such as `table_c0`.
    TableWord,
    /// Output `table_ready`: 1 if the core would load a word that is written in this clock.
    TableReady,
    /// Output `in_ready` of a pipeline: 1 if the pipeline would accept a point in this clock.
    InReady,
    /// Output `side_out` of a pipeline: the value of `side_in` that came with the point whose results are on the outputs.
    SideOut,
    /// Output `valid`, or `out_valid` of a pipeline: high while the results of a point are on the outputs.
    Valid,
    /// Output `busy`, high from the clock after `start` to the end of the computation.
    Busy,
    /// Output `done`, high in the last clock of a computation.
    Done,
    /// Output that carries a result of the computation.
    Result,
    /// Output that shows a signal of the control unit, such as a control line, and no result.
    Status,
}

impl Role {
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
                | Self::TableWrite
                | Self::TableAddress
                | Self::TableWord
        )
    }
}

/// Texts about a device, for the header of the Verilog, the manifest and the documentation.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The device's name, such as `rough`.
    pub device: String,
    /// The title has one line.
    pub title: String,
    pub formula: String,
    /// The document that describes the device, and the part of the document, for people. Empty if there is no such document.
    pub source: String,
    /// How the description interprets the source document, its formats and its limits.
    pub notes: Vec<Note>,
}

impl About {
    pub fn paragraphs(&self) -> impl Iterator<Item = &str> {
        self.notes.iter().map(|note| note.text.as_str())
    }
}

/// A paragraph about a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    pub topic: Topic,
    pub text: String,
}

/// The topic of a paragraph or comment. A pipeline shows only texts on the device itself, because the rest is true only of the
/// sequential design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// The device itself, whatever its architecture.
    Device,
    /// Hardware that a microprogram uses several times: multipliers, the control ROM, the clocks of a loop.
    Microprogram,
    /// Writes to operands, and how long the outputs keep their values.
    Writes,
    /// The number of clocks from `start` to `valid`.
    Latency,
}

impl Topic {
    pub fn note(self, text: impl Into<String>) -> Note {
        Note { topic: self, text: text.into() }
    }
}

impl<T: Into<String>> From<T> for Note {
    fn from(text: T) -> Self {
        Topic::Device.note(text)
    }
}

/// The netlist of a device: datapath, control unit and ports.
#[derive(Clone, Debug)]
pub struct Design {
    /// The name of the top module, a legal Verilog identifier.
    pub name: String,
    pub about: About,
    /// A [`NetId`] is an index into this list.
    pub nets: Vec<Net>,
    /// A [`RegId`] is an index into this list.
    pub registers: Vec<NetlistRegister>,
    /// All ROMs, the control ROM among them.
    pub roms: Vec<NetlistRom>,
    /// Inputs, then outputs, in the order of declaration.
    pub ports: Vec<Port>,
    /// The control unit; for a pipeline it is [`Control::none`].
    pub control: Control,
    /// The facts about the stages, if the design is a pipeline.
    pub pipeline: Option<Pipeline>,
    /// The functions that the operand [`OPCODE`] selects, in the order of their opcodes; none for most cores.
    pub functions: Vec<CoreFunction>,
    /// Logic on which no output depends, muxes that always pass the same input, and choices that no microinstruction makes.
    pub warnings: Vec<Diagnostic>,
}

impl Design {
    pub fn net(&self, id: NetId) -> &Net {
        &self.nets[id.index()]
    }

    /// Returns the width in bits.
    pub fn width(&self, id: NetId) -> u32 {
        self.net(id).format.width()
    }

    pub fn register(&self, id: RegId) -> &NetlistRegister {
        &self.registers[id.index()]
    }

    /// Returns whether `rom` belongs to the sequencer: the control ROM, another ROM at the same address for the fields that do not
    /// fit into it, or the ROM with the targets of dispatches.
    pub fn is_control_memory(&self, rom: &NetlistRom) -> bool {
        let control = &self.control;
        let has_data = |id: RomId| self.rom(id).data == rom.data;
        self.roms.get(control.rom.index()).is_some_and(|it| it.address == rom.address)
            || control.dispatch.is_some_and(has_data)
    }

    pub fn rom(&self, id: RomId) -> &NetlistRom {
        &self.roms[id.index()]
    }

    pub fn find(&self, name: &str) -> Option<NetId> {
        let at = self.nets.iter().position(|net| net.name == name)?;
        Some(NetId(at as u32))
    }

    /// Returns the net that net `id` only renames, through any number of names, or `id` itself.
    pub fn renamed(&self, id: NetId) -> NetId {
        match self.net(id).driver {
            Driver::Op(Op::Relabel(of)) => self.renamed(of),
            _ => id,
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = (NetId, &Net)> {
        self.nets.iter().enumerate().map(|(at, net)| (NetId(at as u32), net))
    }

    pub fn inputs(&self) -> impl Iterator<Item = &Port> {
        self.ports.iter().filter(|port| port.role.is_input())
    }

    pub fn outputs(&self) -> impl Iterator<Item = &Port> {
        self.ports.iter().filter(|port| !port.role.is_input())
    }

    /// Returns whether a memory of the design can be written.
    pub fn has_write_port(&self) -> bool {
        self.roms.iter().any(|rom| rom.write.is_some())
    }

    /// Returns the first port with a wanted role.
    pub fn port(&self, wanted: impl Fn(Role) -> bool) -> Option<&Port> {
        self.ports.iter().find(|port| wanted(port.role))
    }

    /// Returns the nets on which net `id` depends within one clock: the operands of its cell, the address of an asynchronous
    /// ROM, or the control word of a field.
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

    /// Returns all nets, each behind the nets on which it depends within one clock.
    ///
    /// # Errors
    /// Fails if there is a combinational loop. The error lists its nets: each depends on the next, and the last on the first.
    pub fn levelise(&self) -> Result<Vec<NetId>, Vec<NetId>> {
        #[derive(Clone, Copy, PartialEq)]
        enum VisitMark {
            New,
            Open,
            Done,
        }
        let mut mark = vec![VisitMark::New; self.nets.len()];
        let mut order = Vec::with_capacity(self.nets.len());
        for root in 0..self.nets.len() as u32 {
            if mark[root as usize] != VisitMark::New {
                continue;
            }
            // Each entry has a net and its unvisited inputs.
            let mut path = vec![(NetId(root), self.combinational_inputs(NetId(root)))];
            mark[root as usize] = VisitMark::Open;
            while let Some((net, pending)) = path.last_mut() {
                let net = *net;
                let Some(input) = pending.pop() else {
                    mark[net.index()] = VisitMark::Done;
                    order.push(net);
                    path.pop();
                    continue;
                };
                match mark[input.index()] {
                    VisitMark::Done => {}
                    VisitMark::New => {
                        mark[input.index()] = VisitMark::Open;
                        path.push((input, self.combinational_inputs(input)));
                    }
                    VisitMark::Open => {
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

    /// Returns the number of bits in all ROMs together.
    pub fn rom_bits(&self) -> u64 {
        self.roms.iter().map(|rom| rom.words.len() as u64 * u64::from(self.width(rom.data))).sum()
    }
}

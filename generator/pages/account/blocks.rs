//! The blocks of the datapath: what stands in the source's figure, and what it takes to be complete.

use std::fmt;

use super::{NUMBER, Table, code, format_text};
use crate::hdl::netlist::{Design, Driver, FieldId, NetId, Op, Partition, RegisterKind, Rom};

/// The blocks in order of their number; those that the source does not number follow.
pub fn table(design: &Design) -> Table {
    let blocks = Blocks::new(design);
    let mut table = Table::of("no.: | block | kind | format | takes | what it is");
    for block in blocks.all() {
        let list = |nets: &[NetId]| {
            let names: Vec<String> = nets.iter().map(|&net| code(blocks.name(net))).collect();
            names.join(", ")
        };
        let takes = match block.selected_by[..] {
            [] => list(&block.inputs),
            _ => format!("{}; by {}", list(&block.inputs), list(&block.selected_by)),
        };
        let number = block.number.map(|number| number.to_string());
        table.row([
            number.unwrap_or_default(),
            code(block.name),
            block.kind.to_string(),
            block.format,
            takes,
            block.doc,
        ]);
    }
    table.without_empty(NUMBER)
}

/// A block of the datapath.
#[derive(Clone, Debug)]
pub struct Block<'a> {
    /// Its number in the source's figure.
    pub number: Option<u16>,
    /// Its name.
    pub name: &'a str,
    /// What it is made of.
    pub kind: BlockKind,
    /// Of its output.
    pub format: String,
    /// The net that it drives.
    pub output: NetId,
    /// The blocks, ports and ROMs that it works on, by the nets that they drive.
    pub inputs: Vec<NetId>,
    /// What selects among them: a field of the control word, or blocks.
    pub selected_by: Vec<NetId>,
    /// One line; may be empty.
    pub doc: String,
}

/// What a block is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockKind {
    /// A register that a port writes.
    Operand,
    /// A register.
    Register,
    /// A ROM.
    Rom,
    /// A constant.
    Constant,
    /// Narrowing that saturates.
    Limiter,
    /// A multiplexer with this number of inputs.
    Mux(usize),
    /// A multiplier of operands that are so wide.
    Multiplier(u32, u32),
    /// An adder.
    Adder,
    /// A subtractor.
    Subtractor,
    /// A comparison of two numbers.
    Comparator,
    /// All bits inverted.
    Inverter,
    /// Any other logic of single bits.
    Gate,
    /// Bits under another name.
    Wiring,
    /// None of these.
    Other,
}

impl fmt::Display for BlockKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Mux(inputs) => return write!(f, "{inputs}:1 mux"),
            Self::Multiplier(a, b) => return write!(f, "{a} × {b} multiplier"),
            Self::Operand => "operand register",
            Self::Register => "register",
            Self::Rom => "ROM",
            Self::Constant => "constant",
            Self::Limiter => "limiter",
            Self::Adder => "adder",
            Self::Subtractor => "subtractor",
            Self::Comparator => "comparator",
            Self::Inverter => "inverter",
            Self::Gate => "gate",
            Self::Wiring => "wiring",
            Self::Other => "",
        })
    }
}

fn is_control(design: &Design, rom: &Rom) -> bool {
    design.roms.get(design.control.rom.index()).is_some_and(|control| control.data == rom.data)
}

/// The blocks of a design, with the wiring between them left out.
pub struct Blocks<'a> {
    design: &'a Design,
    /// The nets that are the output of a block.
    shown: Vec<bool>,
    ports: Vec<NetId>,
}

impl<'a> Blocks<'a> {
    /// Everything that the description names and documents.
    pub fn new(design: &'a Design) -> Self {
        let ports: Vec<NetId> = design.ports.iter().map(|port| port.net).collect();
        let shown = design
            .iter()
            .map(|(id, net)| {
                let hardware = match &net.driver {
                    Driver::Register(register) => {
                        design.register(*register).kind != RegisterKind::Internal
                    }
                    Driver::Op(op) => matches!(op, Op::Mul(..)) || !net.doc.is_empty(),
                    _ => false,
                };
                net.partition == Partition::Datapath
                    && (net.named && hardware || net.block.is_some())
                    && !ports.contains(&id)
            })
            .collect();
        Self { design, shown, ports }
    }

    /// What a figure shows: logic of single bits and wiring stay out of it unless the source numbers them.
    #[must_use]
    pub fn figure(mut self) -> Self {
        let shown: Vec<bool> = self
            .design
            .iter()
            .map(|(id, net)| {
                let small = || {
                    matches!(
                        self.kind(id),
                        BlockKind::Inverter | BlockKind::Gate | BlockKind::Wiring
                    )
                };
                self.shown[id.index()] && (net.block.is_some() || !small())
            })
            .collect();
        self.shown = shown;
        self
    }

    /// All blocks, ROMs among them, in order of their number; those without one follow.
    pub fn all(&self) -> Vec<Block<'a>> {
        let design = self.design;
        let mut blocks: Vec<Block> = design
            .iter()
            .filter(|(id, _)| self.shown[id.index()])
            .map(|(id, net)| {
                let (inputs, selected_by) = self.takes(id);
                Block {
                    number: net.block,
                    name: &net.name,
                    kind: self.kind(id),
                    format: format_text(net.format),
                    output: id,
                    inputs,
                    selected_by,
                    doc: net.doc.clone(),
                }
            })
            .collect();
        let roms = design.roms.iter();
        blocks.extend(roms.filter(|rom| !is_control(design, rom)).map(|rom| Block {
            number: rom.block,
            name: &rom.name,
            kind: BlockKind::Rom,
            format: format!("{} bits", design.width(rom.data)),
            output: rom.data,
            inputs: self.sources([rom.address]),
            selected_by: Vec::new(),
            doc: format!("{} words, see below", rom.words.len()),
        }));
        blocks.sort_by_key(|block| block.number.map_or(u32::MAX, u32::from));
        blocks
    }

    /// The name of the block, port or ROM that drives a net of [`Block::inputs`].
    pub fn name(&self, id: NetId) -> &'a str {
        match &self.design.net(id).driver {
            Driver::Rom(rom) if !self.shown[id.index()] => &self.design.rom(*rom).name,
            _ => &self.design.net(id).name,
        }
    }

    fn kind(&self, id: NetId) -> BlockKind {
        // Of what is multiplied, before it is extended to a sign.
        let width = |net: &NetId| match &self.design.net(*net).driver {
            Driver::Op(Op::Extend(of)) if !self.shown[net.index()] => self.design.width(*of),
            _ => self.design.width(*net),
        };
        match &self.design.net(id).driver {
            Driver::Register(register) => match self.design.register(*register).kind {
                RegisterKind::Operand | RegisterKind::Buffer => BlockKind::Operand,
                _ => BlockKind::Register,
            },
            Driver::Constant(_) => BlockKind::Constant,
            Driver::Rom(_) => BlockKind::Rom,
            Driver::Op(op) => match op {
                // What the selection is made by is what it is made of: narrowing that saturates.
                Op::Mux { select, inputs } if self.limits(*select, inputs) => BlockKind::Limiter,
                Op::Mux { inputs, .. } => BlockKind::Mux(inputs.len()),
                Op::Mul(a, b) => BlockKind::Multiplier(width(a), width(b)),
                Op::Add { .. } => BlockKind::Adder,
                Op::Sub(..) => BlockKind::Subtractor,
                Op::Equal(..) | Op::Less(..) => BlockKind::Comparator,
                Op::Not(_) => BlockKind::Inverter,
                Op::And(..) | Op::Or(..) | Op::Xor(..) | Op::Any(_) | Op::All(_) => BlockKind::Gate,
                Op::Relabel(of) | Op::Slice { of, .. } | Op::Extend(of)
                    if !self.shown[of.index()]
                        && matches!(self.design.net(*of).driver, Driver::Op(_)) =>
                {
                    self.kind(*of)
                }
                Op::Relabel(_) | Op::Slice { .. } | Op::Extend(_) | Op::Concat(_) => {
                    BlockKind::Wiring
                }
            },
            Driver::Undriven | Driver::Input | Driver::Field(_) => BlockKind::Other,
        }
    }

    fn limits(&self, select: NetId, inputs: &[NetId]) -> bool {
        let by = self.sources([select]);
        !by.is_empty() && by == self.sources(inputs.iter().copied())
    }

    /// What a block works on, and what selects among it.
    fn takes(&self, id: NetId) -> (Vec<NetId>, Vec<NetId>) {
        match &self.design.net(id).driver {
            Driver::Register(register) => {
                let data = self.design.register(*register).data;
                (self.sources(data), Vec::new())
            }
            Driver::Op(Op::Mux { select, inputs }) if !self.limits(*select, inputs) => {
                let by = match self.design.net(*select).driver {
                    Driver::Field(_) => vec![*select],
                    _ => self.sources([*select]),
                };
                (self.sources(inputs.iter().copied()), by)
            }
            // Of a limiter, whose select says nothing new, this is what it limits.
            Driver::Op(op) => (self.sources(op.operands()), Vec::new()),
            _ => (Vec::new(), Vec::new()),
        }
    }

    /// The outputs of the blocks, ports and ROMs behind nets, in the order in which they are met.
    pub fn sources(&self, nets: impl IntoIterator<Item = NetId>) -> Vec<NetId> {
        self.behind(nets).0
    }

    /// The fields of the control word that control a block: its select or enable, and what its logic takes of them.
    pub fn fields(&self, id: NetId) -> Vec<FieldId> {
        self.behind(match &self.design.net(id).driver {
            Driver::Register(register) => {
                self.design.register(*register).enable.into_iter().collect()
            }
            Driver::Rom(rom) => vec![self.design.rom(*rom).address],
            Driver::Op(op) => op.operands(),
            _ => Vec::new(),
        })
        .1
    }

    /// The outputs of blocks, ports and ROMs behind nets, and the fields of the control word.
    fn behind(&self, nets: impl IntoIterator<Item = NetId>) -> (Vec<NetId>, Vec<FieldId>) {
        let (mut found, mut fields) = (Vec::new(), Vec::new());
        let mut seen = vec![false; self.design.nets.len()];
        let mut pending: Vec<NetId> = nets.into_iter().collect();
        pending.reverse();
        while let Some(id) = pending.pop() {
            if std::mem::replace(&mut seen[id.index()], true) {
                continue;
            }
            if self.shown[id.index()] || self.ports.contains(&id) {
                found.push(id);
                continue;
            }
            match &self.design.net(id).driver {
                Driver::Rom(_) => found.push(id),
                Driver::Register(register) => pending.extend(self.design.register(*register).data),
                Driver::Op(op) => pending.extend(op.operands().into_iter().rev()),
                Driver::Field(field) => fields.push(*field),
                Driver::Undriven | Driver::Input | Driver::Constant(_) => {}
            }
        }
        (found, fields)
    }
}

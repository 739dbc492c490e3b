//! Finds a datapath's blocks, which pages list and the block diagram draws.
//!
//! A block is the hardware of one statement in the device's description, or a part of it: for example a rounding with its limits,
//! a tree of muxes, or a product in parts. Every register, ROM and operator of the datapath is in exactly one block. Wiring, and
//! gates with one signal, belong to the connection between two blocks. In a pipeline, a register belongs to the block or port
//! whose value it delays, and the handshake's registers are in no block.

mod groups;
mod kind;

use std::collections::BTreeSet;

use super::{NUMBER, TextTable, code, format_text, short};
use glint_rtl::netlist::{Design, Driver, FieldId, NetId, Op, Pipeline, RegisterKind, Role};
use groups::Groups;
pub use kind::BlockKind;
use kind::{ADDER, MULTIPLIER, operator};

/// Returns a table of the blocks, in the order of their numbers in the source document's figure. Blocks without a number come
/// last.
pub fn table(design: &Design) -> TextTable {
    let blocks = Blocks::new(design, false);
    let mut table = TextTable::of("no.: | block | kind | format | takes | what it is");
    for block in blocks.all() {
        let mut takes = blocks.names(&block.inputs);
        if !block.selected_by.is_empty() {
            takes += &format!("; by {}", blocks.names(&block.selected_by));
        }
        let number = match block.number {
            Some(number) => number.to_string(),
            None => String::new(),
        };
        table.row([
            number,
            code(&block.name),
            block.kind.to_string(),
            block.format,
            takes,
            block.doc,
        ]);
    }
    table.without_empty(NUMBER)
}

fn stage(design: &Design, pipeline: &Pipeline, cell: NetId) -> usize {
    let clock = pipeline.clock_of(cell);
    match design.net(cell).driver {
        // The word of a block memory is available one stage after the address.
        Driver::Rom(rom) => clock - usize::from(design.rom(rom).synchronous),
        _ => clock,
    }
}

/// The hardware of one statement of the description.
#[derive(Clone, Debug)]
pub struct Block {
    pub number: Option<u16>,
    /// The name of the net that the block drives.
    pub name: String,
    pub kind: BlockKind,
    pub format: String,
    pub output: NetId,
    /// The nets that the block reads, each driven by another block, a port, a constant or a ROM. A block with a single operator
    /// has one for each operand.
    pub inputs: Vec<NetId>,
    /// The nets that select among the inputs of muxes: fields of the control word, or outputs of blocks.
    pub selected_by: Vec<NetId>,
    /// The comment in the description, of one line; may be empty.
    pub doc: String,
    pub cells: Vec<NetId>,
    /// In a pipeline, additional names of the value that the block computes.
    pub aliases: Vec<String>,
}

pub struct Blocks<'a> {
    design: &'a Design,
    groups: Groups<'a>,
}

impl<'a> Blocks<'a> {
    /// Finds the blocks of `design`. With `figure`, they are for a block diagram: gates and wiring are then blocks only if the
    /// source document numbers them, or if several signals meet in them.
    pub fn new(design: &'a Design, figure: bool) -> Self {
        Self { design, groups: Groups::new(design, figure) }
    }

    /// Returns the blocks in the order of their numbers. Blocks without a number come last.
    pub fn all(&self) -> Vec<Block> {
        let mut blocks: Vec<Block> = Vec::new();
        for head in self.groups.heads() {
            blocks.push(self.block(head));
        }
        for &joint in &self.groups.joints {
            blocks.push(self.meeting(joint));
        }
        blocks.sort_by_key(|block| block.number.map_or(u32::MAX, u32::from));
        blocks
    }

    fn block(&self, head: NetId) -> Block {
        let design = self.design;
        let inside = self.groups.inside(head);
        let (cells, around): (Vec<NetId>, Vec<NetId>) =
            inside.iter().partition(|it| self.groups.cell[it.index()]);
        let (mut inputs, mut selected_by) = self.inputs(head, &cells, &around);
        let kind = self.kind(head, &cells, &inputs, &selected_by);
        match kind {
            // The select says nothing new.
            BlockKind::Limiter | BlockKind::Rounding | BlockKind::RoundingLimiter => {
                inputs.retain(|it| !self.is_constant(*it));
                inputs.dedup();
                selected_by.clear();
            }
            BlockKind::Several(counts) => {
                selected_by.retain(|it| !inputs.contains(it));
                // A square takes one number twice.
                if counts[MULTIPLIER] > 0 && inputs.len() == 1 {
                    inputs.push(inputs[0]);
                }
            }
            _ => {}
        }
        let net = design.net(head);
        let (name, doc, format, number) = match &net.driver {
            Driver::Rom(rom) => {
                let rom = design.rom(*rom);
                let doc = format!("{} words, see below", rom.words.len());
                (rom.name.clone(), doc, format!("{} bits", design.width(head)), rom.block)
            }
            _ => {
                // The result is the last net. The shortest name describes the whole block.
                let result = match (&kind, inside.last()) {
                    (BlockKind::Several(_), Some(last)) if design.pipeline.is_some() => *last,
                    _ => head,
                };
                let format = format_text(design.net(result).format);
                (self.called(&inside, head), self.doc(&inside, head), format, net.block)
            }
        };
        let aliases = self.aliases(head, &name);
        Block {
            number,
            name,
            kind,
            format,
            output: head,
            inputs,
            selected_by,
            doc,
            cells: self.cells(head),
            aliases,
        }
    }

    /// Returns the inputs of the block with the output `head`, and the nets that select among them. `cells` are the operators,
    /// registers and ROMs of the block, and `around` its wiring and gates, through which bits bypass the operators.
    fn inputs(&self, head: NetId, cells: &[NetId], around: &[NetId]) -> (Vec<NetId>, Vec<NetId>) {
        let (mut inputs, mut selected_by) = (Vec::new(), Vec::new());
        // Operators first: bits that bypass them come from the same signals.
        let mut nets = cells.to_vec();
        // For a mux alone, the bits around it are its inputs, masked by the select if one input is 0.
        if !matches!(cells, [only] if self.is_mux(*only)) {
            nets.extend(around);
        }
        for id in nets {
            for (at, operand) in self.groups.operands(id).into_iter().enumerate() {
                if self.groups.sources[operand.index()] == [head] {
                    continue;
                }
                let is_select = at == 0 && self.is_mux(id);
                let mut found = self.sources_outside(operand, head);
                if is_select && matches!(self.design.net(operand).driver, Driver::Field(_)) {
                    found = vec![operand];
                }
                let list = if is_select { &mut selected_by } else { &mut inputs };
                // An operator alone has an input for each operand.
                let each = cells.len() == 1 && self.groups.cell[id.index()];
                found.retain(|it| each || !(list.contains(it) || self.is_constant(*it)));
                list.extend(found);
            }
        }
        (inputs, selected_by)
    }

    /// Returns the sources of an operand that are outside of the block with the output `head`.
    fn sources_outside(&self, operand: NetId, head: NetId) -> Vec<NetId> {
        if !self.groups.is_part(operand, head) {
            return self.source(operand).into_iter().collect();
        }
        let mut outside = self.groups.sources[operand.index()].clone();
        outside.retain(|source| *source != head);
        outside
    }

    fn is_mux(&self, id: NetId) -> bool {
        matches!(self.design.net(id).driver, Driver::Op(Op::Mux { .. }))
    }

    /// Returns the comment in the description on the net `head`, or else on the last net of `inside` that has a comment.
    fn doc(&self, inside: &[NetId], head: NetId) -> String {
        let of_head = &self.design.net(head).doc;
        if inside.contains(&head) && !of_head.is_empty() {
            return of_head.clone();
        }
        for id in inside.iter().rev() {
            let doc = &self.design.net(*id).doc;
            if !doc.is_empty() {
                return doc.clone();
            }
        }
        String::new()
    }

    /// Returns the registers, ROMs and operators of a block. In a pipeline, the registers that delay its value are included.
    fn cells(&self, head: NetId) -> Vec<NetId> {
        let mut cells = self.groups.inside(head);
        cells.retain(|net| self.groups.cell[net.index()]);
        cells.extend(self.groups.held(head));
        cells
    }

    /// Returns an operand's source: the output net of a block, a port, a constant, or a joint. Returns `None` for a signal of the
    /// control unit.
    fn source(&self, operand: NetId) -> Option<NetId> {
        match self.groups.sources[operand.index()][..] {
            [] => self.constant(operand),
            [only] => Some(only),
            _ => self.groups.joint(operand),
        }
    }

    /// Returns the constant whose value a net has. The search follows the first operand of cells, such as an extension.
    fn constant(&self, mut id: NetId) -> Option<NetId> {
        loop {
            match &self.design.net(id).driver {
                Driver::Constant(_) => return Some(id),
                Driver::Op(op) => id = *op.operands().first()?,
                _ => return None,
            }
        }
    }

    /// Returns a block's name. In a pipeline, it is the shortest name of the block's parts, without the stage.
    fn called(&self, inside: &[NetId], head: NetId) -> String {
        let design = self.design;
        let Some(pipeline) = &design.pipeline else { return design.net(head).name.clone() };
        let mut shortest: Option<&String> = None;
        for part in inside.iter().rev() {
            if design.ports.iter().any(|port| port.net == *part) {
                continue;
            }
            let name = &pipeline.value_of[part.index()];
            if shortest.is_none_or(|before| name.len() < before.len()) {
                shortest = Some(name);
            }
        }
        shortest.unwrap_or(&pipeline.value_of[head.index()]).clone()
    }

    /// Returns additional names of a value in a pipeline: the names of checkpoints with the block as their only source, with
    /// their numbers in the source's figure.
    fn aliases(&self, head: NetId, name: &str) -> Vec<String> {
        let design = self.design;
        let Some(pipeline) = &design.pipeline else { return Vec::new() };
        let mut names: Vec<String> = Vec::new();
        for checkpoint in &pipeline.checkpoints {
            let value = &pipeline.value_of[checkpoint.net.index()];
            let other = match design.net(checkpoint.net).block {
                Some(number) => format!("{number} {value}"),
                None => value.clone(),
            };
            let same = value == name || names.contains(&other);
            if self.groups.sources[checkpoint.net.index()] == [head] && !same {
                names.push(other);
            }
        }
        names
    }

    /// Returns a joint's block, for gates in which several signals meet, or for their concatenation.
    fn meeting(&self, joint: NetId) -> Block {
        let net = self.design.net(joint);
        let inputs = self.groups.sources[joint.index()].clone();
        let kind = match net.driver {
            Driver::Op(Op::Concat(_)) => BlockKind::Wiring,
            _ => BlockKind::Gate,
        };
        Block {
            number: net.block.filter(|_| self.design.pipeline.is_none()),
            name: self.called(&[joint], joint),
            kind,
            format: format_text(net.format),
            output: joint,
            inputs,
            selected_by: Vec::new(),
            doc: net.doc.clone(),
            cells: self.groups.held(joint),
            aliases: Vec::new(),
        }
    }

    fn is_constant(&self, id: NetId) -> bool {
        matches!(self.design.net(id).driver, Driver::Constant(_)) && !self.groups.cell[id.index()]
    }

    fn names(&self, nets: &[NetId]) -> String {
        let names: Vec<String> = nets.iter().map(|net| code(&self.name(*net))).collect();
        names.join(", ")
    }

    /// Returns the name of the block, port or ROM that drives a net of [`Block::inputs`], or a constant's value.
    pub fn name(&self, id: NetId) -> String {
        let net = self.design.net(id);
        match &net.driver {
            Driver::Rom(rom) => self.design.rom(*rom).name.clone(),
            Driver::Constant(bits) if !self.groups.cell[id.index()] => {
                short(net.format.to_f64(net.format.raw(*bits)))
            }
            Driver::Input => net.name.clone(),
            _ => self.called(&self.groups.inside(id), id),
        }
    }

    fn kind(
        &self,
        head: NetId,
        cells: &[NetId],
        inputs: &[NetId],
        selected_by: &[NetId],
    ) -> BlockKind {
        let mut counts = [0; 5];
        let mut first_operator = None;
        let mut rounds = false;
        for &cell in cells {
            let Some(at) = operator(&self.design.net(cell).driver) else { continue };
            if at == ADDER && counts[ADDER] == 0 {
                rounds = self.groups.rounds(cell);
            }
            first_operator = first_operator.or(Some(cell));
            counts[at] += 1;
        }
        let mut taken = BTreeSet::new();
        for &input in inputs.iter().chain(selected_by) {
            if !self.is_constant(input) {
                taken.insert(input);
            }
        }
        let takes_one = taken.len() == 1;
        let limits = inputs.iter().any(|it| self.is_constant(*it)) || cells.len() > 1;
        match counts {
            [0, 0, 0, 0, 1] if takes_one && limits => BlockKind::Limiter,
            [0, 0, 0, 0, 2] if takes_one => BlockKind::Limiter,
            [0, 1, 0, 0, 0] if takes_one && rounds => BlockKind::Rounding,
            [0, 1, 0, 0, 1 | 2] if takes_one && rounds => BlockKind::RoundingLimiter,
            counts if counts.iter().sum::<u16>() > 1 => BlockKind::Several(counts),
            _ => self.kind_of_net(first_operator.unwrap_or(head)),
        }
    }

    /// Returns the width of an operand before a sign or zero extension. For example, 8 bits that were extended to 12 give 8.
    fn narrow_width(&self, operand: NetId) -> u32 {
        match &self.design.net(operand).driver {
            Driver::Op(Op::Extend(of)) => self.design.width(*of),
            _ => self.design.width(operand),
        }
    }

    fn kind_of_net(&self, id: NetId) -> BlockKind {
        match &self.design.net(id).driver {
            Driver::Register(register) => match self.design.register(*register).kind {
                RegisterKind::Operand | RegisterKind::Buffer => BlockKind::Operand,
                _ => BlockKind::Register,
            },
            Driver::Constant(_) => BlockKind::Constant,
            Driver::Rom(_) => BlockKind::Rom,
            Driver::Op(op) => match op {
                Op::Mux { inputs, .. } => BlockKind::Mux(inputs.len()),
                Op::Mul(a, b) => {
                    BlockKind::Multiplier(self.narrow_width(*a), self.narrow_width(*b))
                }
                Op::Add { .. } => BlockKind::Adder,
                Op::Sub(..) => BlockKind::Subtractor,
                Op::Equal(..) | Op::Less(..) => BlockKind::Comparator,
                Op::Not(_) => BlockKind::Inverter,
                Op::And(..) | Op::Or(..) | Op::Xor(..) | Op::Any(_) | Op::All(_) => BlockKind::Gate,
                Op::Relabel(_) | Op::Slice { .. } | Op::Extend(_) | Op::Concat(_) => {
                    BlockKind::Wiring
                }
            },
            Driver::Undriven | Driver::Input | Driver::Field(_) => BlockKind::Other,
        }
    }

    /// Returns the output nets of the blocks, ports and ROMs whose values reach a net through wiring and gates alone.
    pub fn behind(&self, net: NetId) -> &[NetId] {
        &self.groups.sources[net.index()]
    }

    /// Returns the first and the last pipeline stage with operators of the block. A block without operators has the stage of its
    /// output. A sequential core gives 0 and 0.
    pub fn stages(&self, block: &Block) -> (usize, usize) {
        let design = self.design;
        let Some(pipeline) = &design.pipeline else { return (0, 0) };
        let mut stages: Vec<usize> = Vec::new();
        for &cell in &block.cells {
            if self.groups.cell[cell.index()] {
                stages.push(stage(design, pipeline, cell));
            }
        }
        match (stages.iter().min(), stages.iter().max()) {
            (Some(first), Some(last)) => (*first, *last),
            _ => {
                let of_output = stage(design, pipeline, block.output);
                (of_output, of_output)
            }
        }
    }

    /// Returns the fields of the control word that control a block or that its logic reads, and the strobes that write it.
    pub fn controls(&self, block: &Block) -> (Vec<FieldId>, Vec<NetId>) {
        let design = self.design;
        let mut pending: Vec<NetId> = Vec::new();
        for &cell in block.cells.iter().rev() {
            match &design.net(cell).driver {
                Driver::Register(register) if design.pipeline.is_none() => {
                    pending.extend(design.register(*register).enable);
                }
                Driver::Register(_) => {}
                Driver::Rom(rom) => pending.push(design.rom(*rom).address),
                Driver::Op(op) => pending.extend(op.operands().into_iter().rev()),
                _ => {}
            }
        }
        if let Driver::Op(op) = &design.net(block.output).driver
            && block.cells.is_empty()
        {
            pending.extend(op.operands().into_iter().rev());
        }
        let (mut fields, mut strobes) = (Vec::new(), Vec::new());
        let mut seen = vec![false; design.nets.len()];
        while let Some(id) = pending.pop() {
            if self.groups.cell[id.index()] || std::mem::replace(&mut seen[id.index()], true) {
                continue;
            }
            match &design.net(id).driver {
                Driver::Op(op) => pending.extend(op.operands().into_iter().rev()),
                Driver::Field(field) => fields.push(*field),
                Driver::Input => {
                    if let Some(port) = design.ports.iter().find(|port| port.net == id)
                        && port.role == Role::Strobe
                    {
                        strobes.push(id);
                    }
                }
                _ => {}
            }
        }
        (fields, strobes)
    }

    /// Returns the source whose value a net carries: the output net of a block, a port, or the joint in which several sources
    /// meet. Returns `None` for a constant.
    pub fn driver(&self, net: NetId) -> Option<NetId> {
        self.groups.driver(net)
    }

    /// Returns the registers of a pipeline that only delay the value of `source`.
    pub fn held(&self, source: NetId) -> Vec<NetId> {
        self.groups.held(source)
    }
}

//! Finds the blocks of a datapath: every register, table and operator of the netlist is in one of them.
//!
//! A statement of the description makes one block: a rounding with its limits, a tree of muxes, a product in parts.
//! Wires, and gates with one signal, are part of the way from block to block. In a pipeline, a register belongs to the
//! block whose value it holds.

mod groups;
mod kind;

use std::collections::BTreeSet;

use super::{NUMBER, TextTable, code, format_text, short};
use glint_rtl::netlist::{Design, Driver, FieldId, NetId, Op, RegisterKind, Role};
use groups::Groups;
pub use kind::BlockKind;
use kind::{ADDER, MULTIPLIER, operator};

/// Returns the blocks in order of their number. Blocks without a number in the source follow.
pub fn table(design: &Design) -> TextTable {
    let blocks = Blocks::new(design, false);
    let mut table = TextTable::of("no.: | block | kind | format | takes | what it is");
    for block in blocks.all() {
        let list = |nets: &[NetId]| {
            let names: Vec<String> = nets.iter().map(|&net| code(&blocks.name(net))).collect();
            names.join(", ")
        };
        let takes = match block.selected_by[..] {
            [] => list(&block.inputs),
            _ => format!("{}; by {}", list(&block.inputs), list(&block.selected_by)),
        };
        let number = block.number.map(|number| number.to_string());
        table.row([
            number.unwrap_or_default(),
            code(&block.name),
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
pub struct Block {
    /// Its number in the source's figure.
    pub number: Option<u16>,
    /// Its name.
    pub name: String,
    /// The kind of the block.
    pub kind: BlockKind,
    /// The format of its output.
    pub format: String,
    /// The net by which other blocks name it.
    pub output: NetId,
    /// The blocks, ports, constants and ROMs that it reads, by the nets that they drive. An operator has one for each
    /// operand.
    pub inputs: Vec<NetId>,
    /// The select inputs: a field of the control word, or blocks.
    pub selected_by: Vec<NetId>,
    /// One line; may be empty.
    pub doc: String,
    /// The nets of the registers, tables and operators that it is made of.
    pub cells: Vec<NetId>,
    /// In a pipeline, the names of the values that its output has besides its own.
    pub aliases: Vec<String>,
}

/// The blocks of a design.
pub struct Blocks<'a> {
    design: &'a Design,
    groups: Groups<'a>,
}

impl<'a> Blocks<'a> {
    /// Finds the blocks of a design. In a `figure`, gates and wiring are blocks only if the source numbers them, or
    /// if several signals meet in them.
    pub fn new(design: &'a Design, figure: bool) -> Self {
        Self { design, groups: Groups::new(design, figure) }
    }

    /// Returns all blocks, in order of their number. Blocks without a number follow.
    pub fn all(&self) -> Vec<Block> {
        let heads = self.groups.head.iter().copied().flatten();
        let mut blocks: Vec<Block> = heads
            .map(|head| self.block(head))
            .chain(self.groups.joints.iter().map(|&joint| self.meeting(joint)))
            .collect();
        blocks.sort_by_key(|block| block.number.map_or(u32::MAX, u32::from));
        blocks
    }

    fn block(&self, head: NetId) -> Block {
        let design = self.design;
        let inside = self.groups.inside(head);
        let cells: Vec<NetId> =
            inside.iter().copied().filter(|it| self.groups.cell[it.index()]).collect();
        let (mut inputs, mut selected_by) = (Vec::new(), Vec::new());
        // Operators first: bits that go around them come from the same signals.
        let (own, around): (Vec<NetId>, Vec<NetId>) =
            inside.iter().partition(|it| self.groups.cell[it.index()]);
        // For a mux alone, the bits around it are its inputs, masked by the select if one input is 0.
        let is_mux = |it: &NetId| matches!(design.net(*it).driver, Driver::Op(Op::Mux { .. }));
        let around = if matches!(&own[..], [only] if is_mux(only)) { Vec::new() } else { around };
        for id in own.into_iter().chain(around) {
            let operands = self.groups.operands(id).into_iter().enumerate();
            let select = matches!(design.net(id).driver, Driver::Op(Op::Mux { .. }));
            for (at, operand) in
                operands.filter(|(_, it)| self.groups.sources[it.index()] != [head])
            {
                let outside = self.groups.sources[operand.index()].iter().copied();
                let mut found: Vec<NetId> = if self.groups.is_part(operand, head) {
                    outside.filter(|it| *it != head).collect()
                } else {
                    self.source(operand).into_iter().collect()
                };
                let field = matches!(design.net(operand).driver, Driver::Field(_));
                if select && at == 0 && field {
                    found = vec![operand];
                }
                let list = if select && at == 0 { &mut selected_by } else { &mut inputs };
                // An operator alone has an input for each operand.
                let each = cells.len() == 1 && self.groups.cell[id.index()];
                found.retain(|it| each || !(list.contains(it) || self.is_constant(*it)));
                list.extend(found);
            }
        }
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
        let of = |pick: &dyn Fn(&NetId) -> bool| inside.iter().rev().find(|it| pick(it)).copied();
        let doc = of(&|it| *it == head && !net.doc.is_empty())
            .or(of(&|it| !design.net(*it).doc.is_empty()))
            .map_or(String::new(), |it| design.net(it).doc.clone());
        // The result is the last net. The shortest name describes the whole block.
        let result = match kind {
            BlockKind::Several(_) if design.pipeline.is_some() => inside.last().copied(),
            _ => None,
        };
        let result = result.unwrap_or(head);
        let (name, doc, format, number) = match &net.driver {
            Driver::Rom(rom) => {
                let rom = design.rom(*rom);
                let doc = format!("{} words, see below", rom.words.len());
                (rom.name.clone(), doc, format!("{} bits", design.width(head)), rom.block)
            }
            _ => {
                (self.called(&inside, head), doc, format_text(design.net(result).format), net.block)
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

    /// Returns the registers, tables and operators of the block with this output; in a pipeline with the registers that hold it.
    fn cells(&self, head: NetId) -> Vec<NetId> {
        let nets = self.groups.inside(head).into_iter().filter(|it| self.groups.cell[it.index()]);
        nets.chain(self.groups.held(head)).collect()
    }

    /// Returns the block, port or constant that an operand comes from. Returns `None` for a signal of the control
    /// unit.
    fn source(&self, operand: NetId) -> Option<NetId> {
        match self.groups.sources[operand.index()][..] {
            [] => self.constant(operand),
            [only] => Some(only),
            _ => self.groups.joint(operand),
        }
    }

    /// Returns the constant that a net is made of, also through other cells. For example, an extension of the constant
    /// 1 gives the constant 1.
    fn constant(&self, mut id: NetId) -> Option<NetId> {
        loop {
            match &self.design.net(id).driver {
                Driver::Constant(_) => return Some(id),
                Driver::Op(op) => id = *op.operands().first()?,
                _ => return None,
            }
        }
    }

    /// Returns the name of a block. In a pipeline, it is the shortest name of the block's parts, without the stage.
    fn called(&self, inside: &[NetId], head: NetId) -> String {
        let design = self.design;
        let Some(pipeline) = &design.pipeline else { return design.net(head).name.clone() };
        let value = |it: NetId| &pipeline.value_of[it.index()];
        let parts = inside.iter().filter(|it| design.ports.iter().all(|port| port.net != **it));
        let names = parts.rev().map(|it| value(*it));
        let name = names.min_by_key(|name| name.len());
        name.unwrap_or(value(head)).clone()
    }

    /// Returns the other names of a block's output in a pipeline, on its way through wires and registers.
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

    /// Returns the block in which signals meet by gates or side by side.
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

    /// Returns the name of the block, port or ROM that drives a net of [`Block::inputs`], or the value of a constant.
    /// For example, `cos_gamma_reg`, or `0.5`.
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
        let design = self.design;
        let mut counts = [0; 5];
        let operators = cells.iter().filter_map(|it| operator(&design.net(*it).driver));
        operators.for_each(|at| counts[at] += 1);
        let taken: BTreeSet<NetId> =
            inputs.iter().chain(selected_by).copied().filter(|it| !self.is_constant(*it)).collect();
        let one = taken.len() == 1;
        let rounds = || {
            let adder = cells.iter().find(|it| operator(&design.net(**it).driver) == Some(ADDER));
            adder.is_some_and(|it| self.groups.rounds(*it))
        };
        let limits = || inputs.iter().any(|it| self.is_constant(*it)) || cells.len() > 1;
        match counts {
            [0, 0, 0, 0, 1] if one && limits() => BlockKind::Limiter,
            [0, 0, 0, 0, 2] if one => BlockKind::Limiter,
            [0, 1, 0, 0, 0] if one && rounds() => BlockKind::Rounding,
            [0, 1, 0, 0, 1 | 2] if one && rounds() => BlockKind::RoundingLimiter,
            counts if counts.iter().sum::<u16>() > 1 => BlockKind::Several(counts),
            [0, 0, 0, 0, 0] => self.kind_of_net(head),
            _ => {
                let cell = cells.iter().find(|it| operator(&design.net(**it).driver).is_some());
                self.kind_of_net(cell.copied().unwrap_or(head))
            }
        }
    }

    fn kind_of_net(&self, id: NetId) -> BlockKind {
        // The width of an operand before it is extended for a sign.
        let width = |net: &NetId| match &self.design.net(*net).driver {
            Driver::Op(Op::Extend(of)) => self.design.width(*of),
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
                Op::Mux { inputs, .. } => BlockKind::Mux(inputs.len()),
                Op::Mul(a, b) => BlockKind::Multiplier(width(a), width(b)),
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

    /// Returns the outputs of the blocks, ports and ROMs behind a net.
    pub fn behind(&self, net: NetId) -> &[NetId] {
        &self.groups.sources[net.index()]
    }

    /// Returns the stages of a pipeline in which the operators of a block are.
    pub fn stages(&self, block: &Block) -> (usize, usize) {
        let design = self.design;
        let Some(pipeline) = &design.pipeline else { return (0, 0) };
        let stage = |id: &NetId| {
            let at = pipeline.clock_of(*id);
            match design.net(*id).driver {
                // The word of a block memory is there a stage after its address.
                Driver::Rom(rom) => at - usize::from(design.rom(rom).synchronous),
                _ => at,
            }
        };
        let own = block.cells.iter().filter(|it| self.groups.cell[it.index()]).map(stage);
        let own: Vec<usize> = own.collect();
        match (own.iter().min(), own.iter().max()) {
            (Some(first), Some(last)) => (*first, *last),
            _ => (stage(&block.output), stage(&block.output)),
        }
    }

    /// Returns the fields of the control word that control a block, and the strobes that write it. The fields are its
    /// select or enable, and the fields that its logic takes.
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
                    let port = design.ports.iter().find(|port| port.net == id);
                    if port.is_some_and(|port| port.role == Role::Strobe) {
                        strobes.push(id);
                    }
                }
                _ => {}
            }
        }
        (fields, strobes)
    }

    /// Returns the block or port that drives the value of a net.
    pub fn driver(&self, net: NetId) -> Option<NetId> {
        self.groups.driver(net)
    }

    /// Returns the registers of a pipeline that hold the value of a block or port.
    pub fn held(&self, source: NetId) -> Vec<NetId> {
        self.groups.held(source)
    }
}

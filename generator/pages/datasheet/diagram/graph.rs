//! What the block diagram connects: ports, blocks and the control unit.

use std::collections::HashMap;

use crate::hdl::netlist::{Design, Driver, FieldId, NetId, Role, Sequence};
use crate::pages::account::blocks::{Block, BlockKind, Blocks};
use crate::pages::account::format_text;

/// Boxes and the wires between them.
pub struct Graph {
    /// Ports, blocks, and the control unit.
    pub boxes: Vec<Node>,
    /// From the output of a box to another's input, each pair once.
    pub wires: Vec<Wire>,
}

/// A box of the diagram.
pub struct Node {
    /// How it is drawn.
    pub form: BoxForm,
    /// In the source's figure.
    pub number: Option<u16>,
    /// Its name.
    pub name: String,
    /// What it is made of, and its format.
    pub caption: String,
    /// The lines that control it, by number or name; may be empty.
    pub control: String,
    /// Its tooltip.
    pub title: String,
}

/// How a box is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxForm {
    /// A port at the top.
    Input,
    /// A port at the bottom.
    Output,
    /// The control unit.
    Control,
    /// A block of the datapath.
    Block(BlockKind),
}

/// A wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// The box that drives it.
    pub from: usize,
    /// The box that takes it.
    pub to: usize,
}

impl Graph {
    /// Of a design.
    pub fn new(design: &Design) -> Self {
        let mut builder = Builder {
            design,
            blocks: Blocks::new(design).figure(),
            graph: Self { boxes: Vec::new(), wires: Vec::new() },
            driver: HashMap::new(),
        };
        builder.inputs();
        let control = builder.control();
        let blocks = builder.all();
        builder.conditions(control);
        for (at, block) in blocks {
            let selected = block.selected_by.iter();
            let selected = selected.filter(|&&net| !is_field(design, net));
            for &net in block.inputs.iter().chain(selected) {
                builder.wire(net, at);
            }
        }
        builder.outputs(control);
        builder.graph
    }
}

fn is_field(design: &Design, net: NetId) -> bool {
    matches!(design.net(net).driver, Driver::Field(_))
}

struct Builder<'a> {
    design: &'a Design,
    blocks: Blocks<'a>,
    graph: Graph,
    /// The box whose output a net is.
    driver: HashMap<NetId, usize>,
}

impl<'a> Builder<'a> {
    fn add(&mut self, added: Node) -> usize {
        self.graph.boxes.push(added);
        self.graph.boxes.len() - 1
    }

    fn wire(&mut self, net: NetId, to: usize) {
        if let Some(&from) = self.driver.get(&net) {
            self.join(from, to);
        }
    }

    fn join(&mut self, from: usize, to: usize) {
        let wire = Wire { from, to };
        if !self.graph.wires.contains(&wire) {
            self.graph.wires.push(wire);
        }
    }

    fn port(&mut self, net: NetId, form: BoxForm) -> usize {
        let found = self.design.net(net);
        let format = format_text(found.format);
        self.add(Node {
            form,
            number: found.block,
            name: found.name.clone(),
            title: titled(&found.name, &format, &found.doc),
            caption: format,
            control: String::new(),
        })
    }

    /// Operands and `start`; strobes stand at the registers that they write.
    fn inputs(&mut self) {
        for port in self.design.inputs() {
            if matches!(port.role, Role::Operand { .. } | Role::Start) {
                let at = self.port(port.net, BoxForm::Input);
                self.driver.insert(port.net, at);
            }
        }
    }

    fn outputs(&mut self, control: usize) {
        for port in self.design.outputs() {
            let at = self.port(port.net, BoxForm::Output);
            let handshake = port.role.is_status();
            let sources = match &self.design.net(port.net).driver {
                Driver::Op(op) if !handshake => self.blocks.sources(op.operands()),
                _ => Vec::new(),
            };
            for net in &sources {
                self.wire(*net, at);
            }
            if sources.is_empty() {
                self.join(control, at);
            }
        }
    }

    fn control(&mut self) -> usize {
        let control = &self.design.control;
        let rom = self.design.rom(control.rom);
        let (words, width) = (control.microprogram.len(), self.design.width(rom.data));
        let at = self.add(Node {
            form: BoxForm::Control,
            number: rom.block,
            name: "control unit".to_owned(),
            caption: format!("{words} words × {width} bits"),
            control: String::new(),
            title: "Control unit: sequencer and control ROM; its lines control the blocks"
                .to_owned(),
        });
        let start = self.design.port(|role| role == Role::Start);
        if let Some(start) = start {
            self.wire(start.net, at);
        }
        at
    }

    /// What the sequencer looks at.
    fn conditions(&mut self, control: usize) {
        for microinstruction in &self.design.control.microprogram {
            if let Sequence::LoopWhile { condition, .. } = microinstruction.sequence {
                for net in self.blocks.sources([condition]) {
                    self.wire(net, control);
                }
            }
        }
    }

    fn all(&mut self) -> Vec<(usize, Block<'a>)> {
        let mut added = Vec::new();
        for block in self.blocks.all() {
            if self.driver.contains_key(&block.output) {
                continue;
            }
            let kind = block.kind.to_string();
            let at = self.add(Node {
                form: BoxForm::Block(block.kind),
                number: block.number,
                name: block.name.to_owned(),
                caption: caption(&block),
                control: self.turned_by(&block),
                title: titled(&format!("{} ({kind})", block.name), &block.format, &block.doc),
            });
            self.driver.insert(block.output, at);
            added.push((at, block));
        }
        added
    }

    /// The numbers or names of the lines that control a block, and of the port that writes an operand.
    fn turned_by(&self, block: &Block) -> String {
        let fields = self.blocks.fields(block.output);
        let mut lines: Vec<String> = fields.into_iter().map(|field| self.lines(field)).collect();
        if block.kind == BlockKind::Operand {
            let strobes = self.design.inputs().filter_map(|port| match port.role {
                Role::Operand { strobe } if block.inputs.contains(&port.net) => Some(strobe),
                _ => None,
            });
            lines.extend(strobes.map(|strobe| {
                let net = self.design.net(strobe);
                let number = net.block.map(|number| number.to_string());
                number.unwrap_or_else(|| net.name.clone())
            }));
        }
        lines.join(" ")
    }

    fn lines(&self, field: FieldId) -> String {
        let field = &self.design.control.fields[field.index()];
        let lines: Vec<String> = field.lines.iter().map(u16::to_string).collect();
        if lines.is_empty() { field.name.clone() } else { lines.join(" ") }
    }
}

/// What a block is made of, and its format; that a register takes an operand is to be seen from the port above it.
fn caption(block: &Block) -> String {
    match block.kind {
        BlockKind::Operand => format!("{} · {}", BlockKind::Register, block.format),
        kind => format!("{kind} · {}", block.format),
    }
}

/// The tooltip of a box.
fn titled(name: &str, format: &str, doc: &str) -> String {
    match doc {
        "" => format!("{name}, {format}"),
        _ => format!("{name}, {format}: {doc}"),
    }
}

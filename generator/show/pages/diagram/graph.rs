//! Makes the graph of a core's block diagram from the netlist. Its nodes are ports, blocks and the control unit; its edges are
//! the wires between them.

use std::collections::HashMap;

use crate::pages::account::blocks::{Block, BlockKind, Blocks};
use crate::pages::account::format_text;
use glint_rtl::netlist::{Design, Driver, FieldId, NetId, Role, Sequence};

pub struct DiagramGraph {
    pub boxes: Vec<DiagramBox>,
    /// The wires. Each leads from a box's output to one input of a box.
    pub wires: Vec<DiagramWire>,
    /// The number of stages; 0 for a design that is no pipeline.
    pub stages: usize,
}

#[derive(Default)]
pub struct DiagramBox {
    pub form: BoxForm,
    /// The number of the block in the source's figure.
    pub number: Option<u16>,
    pub name: String,
    pub caption: String,
    /// Additional names of the value at the box's output. Only a pipeline has such names.
    pub aliases: Vec<String>,
    /// The control lines of the block, by number or name; may be empty.
    pub control: String,
    /// The text that appears when the pointer is on the box.
    pub title: String,
    /// The stage; `None` for a port, and for every box of a sequential core.
    pub stage: Option<usize>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoxForm {
    /// An input port, at the diagram's top.
    Input,
    /// An output port, at the diagram's bottom.
    Output,
    Control,
    Block(BlockKind),
    /// An empty stage: values only pass through, and nothing is drawn.
    #[default]
    Empty,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiagramWire {
    /// The index of the box that drives the wire.
    pub from: usize,
    /// The index of the box that reads the wire.
    pub to: usize,
}

impl DiagramGraph {
    pub fn new(design: &Design) -> Self {
        let stages = design.pipeline.as_ref().map_or(0, |pipeline| pipeline.stages.len());
        let mut builder = GraphBuilder {
            design,
            blocks: Blocks::new(design, true),
            graph: Self { boxes: Vec::new(), wires: Vec::new(), stages },
            driver: HashMap::new(),
        };
        builder.inputs();
        let control = design.pipeline.is_none().then(|| builder.control());
        let blocks = builder.all();
        control.into_iter().for_each(|control| builder.conditions(control));
        for (at, block) in blocks {
            let selected = block.selected_by.iter();
            let selected = selected.filter(|&&net| !is_field(design, net));
            for &net in block.inputs.iter().chain(selected) {
                builder.takes(net, at);
            }
        }
        builder.outputs(control);
        builder.fill();
        builder.graph
    }
}

fn is_field(design: &Design, net: NetId) -> bool {
    matches!(design.net(net).driver, Driver::Field(_))
}

struct GraphBuilder<'a> {
    design: &'a Design,
    blocks: Blocks<'a>,
    graph: DiagramGraph,
    /// The index of the box that drives each net.
    driver: HashMap<NetId, usize>,
}

impl<'a> GraphBuilder<'a> {
    fn add(&mut self, added: DiagramBox) -> usize {
        self.graph.boxes.push(added);
        self.graph.boxes.len() - 1
    }

    /// Adds a wire from the box that drives `net` to the box `to`, or nothing without such a box.
    fn wire(&mut self, net: NetId, to: usize) {
        if let Some(&from) = self.driver.get(&net) {
            self.graph.wires.push(DiagramWire { from, to });
        }
    }

    /// Adds a wire for an input of the box `to`. A constant gets a box of its own beside the box that reads it.
    fn takes(&mut self, net: NetId, to: usize) {
        if self.driver.contains_key(&net)
            || !matches!(self.design.net(net).driver, Driver::Constant(_))
        {
            return self.wire(net, to);
        }
        let (format, name) = (format_text(self.design.net(net).format), self.blocks.name(net));
        let from = self.add(DiagramBox {
            form: BoxForm::Block(BlockKind::Constant),
            title: titled(&format!("the constant {name}"), &format, &self.design.net(net).doc),
            name,
            stage: self.graph.boxes[to].stage,
            ..DiagramBox::default()
        });
        self.graph.wires.push(DiagramWire { from, to });
    }

    /// Adds an empty box to each stage without a block, so the stage also has a column in the diagram.
    fn fill(&mut self) {
        for stage in 0..self.graph.stages {
            if self.graph.boxes.iter().all(|it| it.stage != Some(stage)) {
                self.add(DiagramBox { stage: Some(stage), ..DiagramBox::default() });
            }
        }
    }

    fn port(&mut self, net: NetId, form: BoxForm) -> usize {
        let found = self.design.net(net);
        let format = format_text(found.format);
        self.add(DiagramBox {
            form,
            number: found.block,
            name: found.name.clone(),
            title: titled(&found.name, &format, &found.doc),
            caption: self.held(format, net, 0),
            ..DiagramBox::default()
        })
    }

    /// Appends the number of clocks for which registers hold the value of `net` to `caption`, if it is at least two. `stage`
    /// computes the value. For example, `adder · u0.8 · held 3 clocks`.
    fn held(&self, caption: String, net: NetId, stage: usize) -> String {
        let Some(pipeline) = &self.design.pipeline else { return caption };
        let held = self.blocks.held(net);
        let last = held.into_iter().map(|it| pipeline.clock_of(it)).max();
        match last.unwrap_or(0).saturating_sub(stage) {
            0 | 1 => caption,
            clocks => format!("{caption} · held {clocks} clocks"),
        }
    }

    /// Adds a box for each input port, except strobes, which are drawn at the registers that they write.
    fn inputs(&mut self) {
        for port in self.design.inputs() {
            if matches!(
                port.role,
                Role::Operand { .. } | Role::Start | Role::Point | Role::InValid | Role::SideIn
            ) {
                let at = self.port(port.net, BoxForm::Input);
                self.driver.insert(port.net, at);
            }
        }
    }

    /// Adds a box for each output port, except `in_ready`, which carries no data of a point.
    fn outputs(&mut self, control: Option<usize>) {
        for port in self.design.outputs().filter(|port| port.role != Role::InReady) {
            let at = self.port(port.net, BoxForm::Output);
            let source = match control {
                Some(_) if port.role.is_status() => None,
                _ => self.blocks.driver(port.net),
            };
            match (source, control) {
                (Some(net), _) => self.wire(net, at),
                (None, Some(control)) => {
                    self.graph.wires.push(DiagramWire { from: control, to: at })
                }
                (None, None) => {}
            }
        }
    }

    fn control(&mut self) -> usize {
        let control = &self.design.control;
        let rom = self.design.rom(control.rom);
        let (words, width) = (control.microprogram.len(), self.design.width(rom.data));
        let at = self.add(DiagramBox {
            form: BoxForm::Control,
            number: rom.block,
            name: "control unit".to_owned(),
            caption: format!("{words} words × {width} bits"),
            title: "Control unit: sequencer and control ROM; its lines control the blocks"
                .to_owned(),
            ..DiagramBox::default()
        });
        let start = self.design.port(|role| role == Role::Start);
        if let Some(start) = start {
            self.wire(start.net, at);
        }
        at
    }

    /// Adds a wire to the control unit from each block or port on which a loop or a dispatch of the microprogram depends.
    fn conditions(&mut self, control: usize) {
        for microinstruction in &self.design.control.microprogram {
            let (Sequence::LoopWhile { condition: deciding, .. }
            | Sequence::Dispatch { selector: deciding, .. }) = microinstruction.sequence
            else {
                continue;
            };
            for net in self.blocks.behind(deciding).to_vec() {
                self.wire(net, control);
            }
        }
    }

    /// Adds a box for each block of the datapath. Returns the blocks, each with the index of its box.
    fn all(&mut self) -> Vec<(usize, Block)> {
        let mut added = Vec::new();
        for block in self.blocks.all() {
            let kind = block.kind.to_string();
            let (first, last) = self.blocks.stages(&block);
            let caption = match last - first {
                0 => caption(&block),
                _ => format!("{} · stages {first}–{last}", caption(&block)),
            };
            let caption = self.held(caption, block.output, last);
            let mut doc = block.doc.clone();
            if let [_, _, ..] = block.aliases[..] {
                doc = format!("{doc} ({})", block.aliases.join(", "));
            }
            let at = self.add(DiagramBox {
                form: BoxForm::Block(block.kind),
                number: block.number,
                name: block.name.clone(),
                caption,
                aliases: block.aliases.iter().take(1).cloned().collect(),
                control: self.turned_by(&block),
                title: titled(&format!("{} ({kind})", block.name), &block.format, &doc),
                stage: self.design.pipeline.as_ref().map(|_| last),
            });
            self.driver.insert(block.output, at);
            added.push((at, block));
        }
        added
    }

    /// Returns the numbers or names of a block's control lines, and of the strobe that writes it.
    fn turned_by(&self, block: &Block) -> String {
        let (fields, strobes) = self.blocks.controls(block);
        let mut lines: Vec<String> = fields.into_iter().map(|field| self.lines(field)).collect();
        lines.extend(strobes.into_iter().map(|strobe| {
            let net = self.design.net(strobe);
            let number = net.block.map(|number| number.to_string());
            number.unwrap_or_else(|| net.name.clone())
        }));
        lines.join(" ")
    }

    /// Returns the numbers of a field's control lines in the source's figure, or the name of a field without numbers.
    fn lines(&self, field: FieldId) -> String {
        let field = &self.design.control.fields[field.index()];
        let lines: Vec<String> = field.lines.iter().map(u16::to_string).collect();
        if lines.is_empty() { field.name.clone() } else { lines.join(" ") }
    }
}

/// Returns a block's caption, for example `adder · u0.8`. An operand is called a register, because the port above it shows that
/// it is an operand.
fn caption(block: &Block) -> String {
    match block.kind {
        BlockKind::Operand => format!("{} · {}", BlockKind::Register, block.format),
        kind => format!("{kind} · {}", block.format),
    }
}

/// Returns the tooltip, for example `exponent, u10.0: specular exponent n`.
fn titled(name: &str, format: &str, doc: &str) -> String {
    match doc {
        "" => format!("{name}, {format}"),
        _ => format!("{name}, {format}: {doc}"),
    }
}

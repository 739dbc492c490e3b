//! Chooses the names that the Verilog has besides the names of nets.

use super::text::{Names, constant_name};
use crate::netlist::{
    Control, Design, Driver, FieldKind, Net, NetId, NetlistRom, Op, Partition, RomId,
};

/// The names that the Verilog has besides the names of nets.
pub struct Naming {
    /// The control unit's instance in the top module.
    pub control_instance: String,
    /// The datapath's instance in the top module.
    pub datapath_instance: String,
    /// For each ROM, its memory, such as `control_rom`.
    pub memories: Vec<String>,
    /// For each ROM, the parameter with the name of its memory file, such as `SINE_FILE`.
    pub parameters: Vec<String>,
    /// For each ROM, its memory file, such as `rough_sine.mem`.
    pub files: Vec<String>,
    pub style: Style,
    /// The second read ports of other ROMs' memories.
    pub second: Vec<RomId>,
    /// For each select field of the control word, the localparams of its values from 0 on: `OPERAND_SELECT_COSINES` is 0. Other
    /// fields have none.
    pub choices: Vec<Vec<String>>,
    /// The net that reads all unread bits. Linters accept an unread net if its name contains `unused`.
    pub unused: String,
    /// The shift register with a bit for each stage of a pipeline, which is 1 if the stage has a point.
    pub valid: String,
    /// All names of nets, and the names in this structure.
    pub names: Names,
    design: String,
}

/// How the Verilog writes memories and registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Whether the Verilog itself contains the words of ROMs, instead of memory files.
    pub inline: bool,
    /// Whether a ROM is a case statement in a function.
    pub case: bool,
    /// The part of an FPGA for synchronous ROMs; `None` lets the synthesiser decide.
    pub rom_style: Option<RomStyle>,
    /// Whether an initial block sets registers to 0.
    pub initial: bool,
}

/// The part of an FPGA that stores a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RomStyle {
    /// In block memories.
    Block,
    /// In look-up tables.
    Distributed,
}

impl RomStyle {
    /// Returns the attributes of a memory, without `(*` and `*)`. Yosys reads the first one. For Yosys, distributed memory is memory
    /// that can be written, so that the attribute of a ROM in look-up tables is `logic`.
    pub fn attributes(self, is_written: bool) -> &'static str {
        match (self, is_written) {
            (Self::Block, false) => "rom_style = \"block\"",
            (Self::Block, true) => "ram_style = \"block\"",
            (Self::Distributed, false) => "ram_style = \"logic\", rom_style = \"distributed\"",
            (Self::Distributed, true) => "ram_style = \"distributed\"",
        }
    }
}

impl Naming {
    /// Chooses names that no net has, with the default style.
    pub fn new(design: &Design) -> Self {
        let mut names = Names::new(design.nets.iter().map(|net| net.name.as_str()));
        names.fresh("clk");
        let control_instance = names.fresh("control");
        let datapath_instance = names.fresh("datapath");
        let mut memories: Vec<String> = Vec::new();
        for rom in &design.roms {
            memories.push(match rom.shares {
                Some(first) => memories[first.index()].clone(),
                None => names.fresh(&format!("{}_rom", rom.name)),
            });
        }
        let numbers = (0..design.roms.len() as u32).map(RomId);
        let mut files = Vec::new();
        for rom in &design.roms {
            files.push(format!("{}_{}.mem", design.name, rom.name));
        }
        Self {
            control_instance,
            datapath_instance,
            memories,
            style: Style::default(),
            second: numbers.filter(|&rom| design.rom(rom).shares.is_some()).collect(),
            parameters: design
                .roms
                .iter()
                .map(|rom| names.fresh(&format!("{}_FILE", constant_name(&rom.name))))
                .collect(),
            files,
            choices: choices(&design.control, &mut names),
            unused: names.fresh("unused"),
            valid: names.fresh("valid"),
            names,
            design: design.name.clone(),
        }
    }

    pub fn styled(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// Returns the name of a module, such as `rough_control` or `rough_datapath`.
    pub fn module(&self, partition: Partition) -> String {
        match partition {
            Partition::Control => format!("{}_control", self.design),
            Partition::Datapath => format!("{}_datapath", self.design),
        }
    }

    /// Returns the module of a multiplier with an output register, such as `blinn_pipelined_multiplier`.
    pub fn multiplier(&self) -> String {
        format!("{}_multiplier", self.design)
    }

    /// Returns the module of delay lines, such as `rough_pipelined_delay`.
    pub fn delay(&self) -> String {
        format!("{}_delay", self.design)
    }

    /// Returns the name of a module's instance in the top module.
    pub fn instance(&self, partition: Partition) -> &str {
        match partition {
            Partition::Control => &self.control_instance,
            Partition::Datapath => &self.datapath_instance,
        }
    }
}

fn choices(control: &Control, names: &mut Names) -> Vec<Vec<String>> {
    let mut all = Vec::new();
    for field in &control.fields {
        let mut of_field = Vec::new();
        if let FieldKind::Select(choices) = &field.kind {
            for choice in choices {
                let wish = constant_name(&format!("{} {choice}", field.name));
                of_field.push(names.fresh(&wish));
            }
        }
        all.push(of_field);
    }
    all
}

pub fn is_control_rom(design: &Design, rom: RomId) -> bool {
    design.control.rom == rom
}

/// Returns the comment behind the declaration of a net, such as `mux 8, s1.20: first operand`. The comment has the net's block
/// number, format and description, as far as they exist. A field of the control word has its lines in place of a block number,
/// such as `line 4`.
pub fn remark(design: &Design, id: NetId) -> String {
    let net = design.net(id);
    // The declared width already states the format of an unsigned integer.
    let format = if net.format.signed || net.format.frac != 0 {
        net.format.to_string()
    } else {
        String::new()
    };
    let label = match &net.driver {
        Driver::Field(field) => field_label(&design.control, field.index()),
        _ => net
            .block
            .map(|number| {
                let port = design.ports.iter().find(|port| port.net == id);
                let kind = match port {
                    Some(port) if port.role.is_input() => "input",
                    Some(_) => "output",
                    None => kind(design, net),
                };
                format!("{kind} {number}")
            })
            .unwrap_or_default(),
    };
    let what: Vec<_> = [label, format].into_iter().filter(|part| !part.is_empty()).collect();
    match (what.is_empty(), net.doc.is_empty()) {
        (_, true) => what.join(", "),
        (true, false) => net.doc.clone(),
        (false, false) => format!("{}: {}", what.join(", "), net.doc),
    }
}

/// Returns the name of a ROM for comments: `ROM 18` with its number in the source's block diagram, or `ROM sine` with its name.
pub fn rom_label(rom: &NetlistRom) -> String {
    match rom.block {
        Some(number) => format!("ROM {number}"),
        None => format!("ROM {}", rom.name),
    }
}

fn field_label(control: &Control, field: usize) -> String {
    let lines: Vec<_> = control.fields[field].lines.iter().map(ToString::to_string).collect();
    match lines.len() {
        0 => String::new(),
        1 => format!("line {}", lines[0]),
        _ => format!("lines {}", lines.join(", ")),
    }
}

/// Returns the kind of block that drives a net, such as `adder`, as a source's block diagram calls it.
fn kind(design: &Design, net: &Net) -> &'static str {
    match &net.driver {
        Driver::Register(_) => "register",
        Driver::Rom(_) => "ROM",
        Driver::Op(op) => match op {
            Op::Mux { .. } => "mux",
            Op::Add { .. } | Op::Sub(..) => "adder",
            Op::Mul(..) => "multiplier",
            Op::Equal(..) | Op::Less(..) => "comparator",
            Op::Relabel(of) | Op::Slice { of, .. } => kind(design, design.net(*of)),
            _ => "block",
        },
        _ => "block",
    }
}

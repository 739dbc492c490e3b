//! Lists the facts of a core that its files and pages describe: ports, fields of the control word, microprogram and ROMs.
//!
//! The manifest prints these lists as JSON, and documentation pages print them as tables.

use serde::{Serialize, Serializer, ser::SerializeMap};

use glint_rtl::netlist::{self, Design, FieldKind, NetId, Role, RomId};
use glint_rtl::verilog::naming::{Naming, is_control_rom};

/// A port of the top module. For example, `cos_gamma` of `rough` is an operand of 21 bits in `u1.20`, and `cos_gamma_write`
/// writes it.
#[derive(Default, Serialize)]
pub struct PortFacts<'a> {
    pub name: &'a str,
    /// The text `input` or `output`.
    pub direction: &'static str,
    /// The role of the port, for example `operand` or `strobe`.
    pub role: &'static str,
    pub width: u32,
    /// The number format, if the port is an operand, a result, a status bit or a part of a table's word.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signed: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fraction_bits: Option<i32>,
    /// The write strobe of an operand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strobe: Option<&'a str>,
    /// The number of the port's block in the source's block diagram.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block: Option<u16>,
    /// A description in one line; may be empty.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub doc: &'a str,
}

/// A field of the control word. For example, `operand_select` of `rough` has 2 bits from bit 7 on, and the choices `cosines`,
/// `sines`, `half_n` and `square`.
#[derive(Serialize)]
pub struct FieldFacts<'a> {
    pub name: &'a str,
    /// The kind of field: `select`, `enable`, `flag` or `sequence`.
    pub kind: &'static str,
    pub low: u32,
    pub width: u32,
    /// The names of a select field's choices, from the value 0 on.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub choices: &'a [String],
    /// The numbers of the field's control lines in the source's block diagram.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub lines: &'a [u16],
}

/// A microinstruction. For example, microinstruction 3 of `rough` is named `12 <- sin gamma * sin dgamma`.
#[derive(Serialize)]
pub struct MicroinstructionFacts<'a> {
    pub address: usize,
    pub name: &'a str,
    /// The name and the value of each field of the control word, in the order of the fields.
    #[serde(serialize_with = "as_map")]
    pub fields: Vec<(&'a str, u64)>,
    pub sequence: SequenceFacts<'a>,
}

#[derive(Serialize)]
#[serde(untagged)]
pub enum SequenceFacts<'a> {
    /// The plain rules `next`, `wait for start` or `end`.
    Plain(&'static str),
    /// A jump back, which makes a loop.
    Loop {
        loop_to: usize,
        #[serde(rename = "while")]
        condition: &'a str,
    },
    /// A jump ahead to one of several microinstructions.
    Dispatch {
        /// An address for each value of the selector.
        dispatch_to: &'a [usize],
        /// The register of the operand that selects the address.
        by: &'a str,
    },
    /// A jump ahead, over some microinstructions.
    Jump {
        jump_to: usize,
        #[serde(rename = "if")]
        condition: &'a str,
    },
}

/// A ROM of a core. For example, `sine` of `rough` has 584 words of 35 bits, which are 20440 bits in all.
#[derive(Serialize)]
pub struct RomFacts<'a> {
    pub name: &'a str,
    /// The file with the ROM's contents; `None` if the Verilog contains the words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameter: Option<&'a str>,
    pub depth: usize,
    pub width: u32,
    pub bits: u64,
    pub format: String,
    /// Whether the ROM is read on the clock edge.
    pub synchronous: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    radix: Option<u8>,
    /// The words, if the Verilog contains them.
    #[serde(skip_serializing_if = "Option::is_none")]
    words: Option<&'a [u64]>,
    /// The meaning of a word, in one or more lines.
    pub doc: &'a [String],
    /// The number in the source's block diagram.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block: Option<u16>,
}

fn as_map<S: Serializer>(pairs: &[(&str, u64)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(pairs.len()))?;
    for (name, value) in pairs {
        map.serialize_entry(name, value)?;
    }
    map.end()
}

pub fn ports(design: &Design) -> Vec<PortFacts<'_>> {
    let clock = PortFacts {
        name: "clk",
        direction: "input",
        role: "clock",
        width: 1,
        ..PortFacts::default()
    };
    let mut ports = vec![clock];
    for port in &design.ports {
        let net = design.net(port.net);
        let strobe = match port.role {
            Role::Operand { strobe } => Some(name(design, strobe)),
            _ => None,
        };
        let number = matches!(
            port.role,
            Role::Operand { .. } | Role::Point | Role::Result | Role::Status | Role::TableWord
        );
        ports.push(PortFacts {
            name: &net.name,
            direction: if port.role.is_input() { "input" } else { "output" },
            role: role(port.role),
            width: net.format.width(),
            format: number.then(|| net.format.to_string()),
            signed: number.then_some(net.format.signed),
            fraction_bits: number.then_some(net.format.frac),
            strobe,
            block: net.block,
            doc: &net.doc,
        });
    }
    ports
}

fn name(design: &Design, net: NetId) -> &str {
    &design.net(net).name
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Reset => "reset",
        Role::Start => "start",
        Role::Operand { .. } => "operand",
        Role::Strobe => "strobe",
        Role::Valid => "valid",
        Role::Busy => "busy",
        Role::Done => "done",
        Role::Result => "result",
        Role::Status => "status",
        Role::InValid => "in_valid",
        Role::InReady => "in_ready",
        Role::Point => "operand",
        Role::SideIn => "side_in",
        Role::SideOut => "side_out",
        Role::OutReady => "out_ready",
        Role::TableWrite => "table_write",
        Role::TableAddress => "table_address",
        Role::TableWord => "table_word",
        Role::TableReady => "table_ready",
    }
}

/// Returns the fields from the highest bits to the lowest.
pub fn fields(design: &Design) -> Vec<FieldFacts<'_>> {
    let positions = design.field_positions();
    design
        .control
        .fields
        .iter()
        .zip(positions)
        .map(|(field, low)| {
            let (kind, choices): (_, &[String]) = match &field.kind {
                FieldKind::Select(choices) => ("select", choices),
                FieldKind::Enable => ("enable", &[]),
                FieldKind::Flag => ("flag", &[]),
                FieldKind::Sequence => ("sequence", &[]),
            };
            FieldFacts {
                name: &field.name,
                kind,
                low,
                width: design.width(field.net),
                choices,
                lines: &field.lines,
            }
        })
        .collect()
}

pub fn microprogram(design: &Design) -> Vec<MicroinstructionFacts<'_>> {
    let control = &design.control;
    let mut facts = Vec::new();
    for (address, microinstruction) in control.microprogram.iter().enumerate() {
        let names = control.fields.iter().map(|field| field.name.as_str());
        let fields = names.zip(microinstruction.values.iter().copied()).collect();
        let sequence = match &microinstruction.sequence {
            netlist::Sequence::Next => SequenceFacts::Plain("next"),
            netlist::Sequence::WaitStart => SequenceFacts::Plain("wait for start"),
            netlist::Sequence::End => SequenceFacts::Plain("end"),
            netlist::Sequence::Dispatch { selector, to } => {
                SequenceFacts::Dispatch { dispatch_to: to, by: name(design, *selector) }
            }
            netlist::Sequence::LoopWhile { condition, to } => {
                let condition = name(design, *condition);
                if *to > address {
                    SequenceFacts::Jump { jump_to: *to, condition }
                } else {
                    SequenceFacts::Loop { loop_to: *to, condition }
                }
            }
        };
        let name = &microinstruction.name;
        facts.push(MicroinstructionFacts { address, name, fields, sequence });
    }
    facts
}

/// Returns the ROMs, including the control ROM, but not a ROM that is only the second read port of another.
pub fn roms<'a>(design: &'a Design, naming: &'a Naming) -> Vec<RomFacts<'a>> {
    let in_file = !naming.style.inline;
    let mut facts = Vec::new();
    for (at, rom) in design.roms.iter().enumerate() {
        if rom.shares.is_some() {
            continue;
        }
        let width = design.width(rom.data);
        let binary = is_control_rom(design, RomId(at as u32));
        facts.push(RomFacts {
            name: &rom.name,
            file: in_file.then(|| naming.files[at].as_str()),
            parameter: in_file.then(|| naming.parameters[at].as_str()),
            depth: rom.words.len(),
            width,
            bits: rom.words.len() as u64 * u64::from(width),
            format: design.net(rom.data).format.to_string(),
            synchronous: rom.synchronous,
            radix: in_file.then_some(if binary { 2 } else { 16 }),
            words: naming.style.inline.then_some(&rom.words[..]),
            doc: &rom.doc,
            block: rom.block,
        });
    }
    facts
}

//! `<name>.json`: the device for programs.

use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};

use super::naming::{Naming, is_control_rom};
use super::{EmitInputs, OutputFile, Quantity, Timing, digest};
use crate::netlist::{Design, FieldKind, Net, NetId, Role, RomId, Sequence};

#[derive(Serialize)]
struct Manifest<'a> {
    name: &'a str,
    device: &'a str,
    title: &'a str,
    formula: &'a str,
    source: &'a str,
    notes: &'a [String],
    regenerate: String,
    scale: &'static str,
    ports: Vec<PortEntry<'a>>,
    timing: &'a Timing,
    control: Value,
    roms: Vec<Value>,
    files: Value,
    sha256: serde_json::Map<String, Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    example: Option<Value>,
}

#[derive(Serialize)]
struct PortEntry<'a> {
    name: &'a str,
    direction: &'static str,
    role: &'static str,
    width: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    format: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    signed: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fraction_bits: Option<i32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    strobe: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    block: Option<u16>,
    #[serde(skip_serializing_if = "str::is_empty")]
    doc: &'a str,
}

/// The files that the manifest lists.
pub struct Files<'a> {
    /// Verilog, the top module first.
    pub rtl: &'a [String],
    /// ROM contents.
    pub memories: &'a [String],
    /// FuseSoC cores.
    pub cores: &'a [String],
    /// The bench and its vectors, or nothing.
    pub testbench: &'a [String],
}

/// The manifest as text, with the digests of all `others`.
///
/// # Errors
/// A number that JSON cannot carry (a value that is not finite).
pub fn contents(
    design: &Design,
    inputs: &EmitInputs,
    naming: &Naming,
    files: &Files,
    others: &[OutputFile],
) -> Result<String> {
    let about = &design.about;
    let manifest = Manifest {
        name: &design.name,
        device: &about.device,
        title: &about.title,
        formula: &about.formula,
        source: &about.source,
        notes: &about.notes,
        regenerate: format!("glint generate {}", inputs.config),
        scale: "value = raw * 2^-fraction_bits",
        ports: ports(design),
        timing: &inputs.timing,
        control: control(design),
        roms: roms(design, naming),
        files: json!({
            "rtl": files.rtl,
            "memories": files.memories,
            "cores": files.cores,
            "testbench": files.testbench,
        }),
        sha256: others
            .iter()
            .map(|file| (file.path.clone(), json!(digest(file.contents.as_bytes()))))
            .collect(),
        example: inputs.example.as_ref().map(|example| {
            let mut entry = json!({
                "operands": quantities(&example.operands),
                "outputs": quantities(&example.outputs),
            });
            if inputs.timing.valid_to_valid.is_some() {
                entry["result"] = json!("the first");
            }
            entry
        }),
    };
    Ok(serde_json::to_string_pretty(&manifest)? + "\n")
}

fn ports(design: &Design) -> Vec<PortEntry<'_>> {
    let clock = PortEntry {
        name: "clk",
        direction: "input",
        role: "clock",
        width: 1,
        format: None,
        signed: None,
        fraction_bits: None,
        strobe: None,
        block: None,
        doc: "",
    };
    let of_port = |port: &crate::netlist::Port| {
        let net: &Net = design.net(port.net);
        let strobe = match port.role {
            Role::Operand { strobe } => Some(name(design, strobe)),
            _ => None,
        };
        let number = matches!(
            port.role,
            Role::Operand { .. } | Role::Result | Role::Status
        );
        PortEntry {
            name: &net.name,
            direction: if port.role.is_input() {
                "input"
            } else {
                "output"
            },
            role: role(port.role),
            width: net.format.width(),
            format: number.then(|| net.format.to_string()),
            signed: number.then_some(net.format.signed),
            fraction_bits: number.then_some(net.format.frac),
            strobe,
            block: net.block,
            doc: &net.doc,
        }
    };
    std::iter::once(clock)
        .chain(design.ports.iter().map(of_port))
        .collect()
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
    }
}

fn control(design: &Design) -> Value {
    let control = &design.control;
    let positions = design.field_positions();
    let fields: Vec<_> = control
        .fields
        .iter()
        .zip(positions)
        .map(|(field, low)| {
            let (kind, choices) = match &field.kind {
                FieldKind::Select(choices) => ("select", Some(choices)),
                FieldKind::Enable => ("enable", None),
                FieldKind::Flag => ("flag", None),
                FieldKind::Sequence => ("sequence", None),
            };
            let mut entry = json!({
                "name": field.name,
                "kind": kind,
                "low": low,
                "width": design.width(field.net),
            });
            if let Some(choices) = choices {
                entry["choices"] = json!(choices);
            }
            if !field.lines.is_empty() {
                entry["lines"] = json!(field.lines);
            }
            entry
        })
        .collect();
    let words: Vec<_> = control
        .words
        .iter()
        .enumerate()
        .map(|(address, word)| {
            let values: serde_json::Map<_, _> = control
                .fields
                .iter()
                .zip(&word.values)
                .map(|(field, value)| (field.name.clone(), json!(value)))
                .collect();
            let next = match &word.sequence {
                Sequence::Next => json!("next"),
                Sequence::WaitStart => json!("wait for start"),
                Sequence::End => json!("end"),
                Sequence::LoopWhile { condition, to } => {
                    let condition = name(design, *condition);
                    if *to > address {
                        json!({ "jump_to": to, "if": condition })
                    } else {
                        json!({ "loop_to": to, "while": condition })
                    }
                }
            };
            json!({ "address": address, "name": word.name, "fields": values, "sequence": next })
        })
        .collect();
    json!({
        "run": name(design, design.register(control.run).q),
        "address": name(design, design.register(control.address).q),
        "rom": design.rom(control.rom).name,
        "fields": fields,
        "words": words,
    })
}

fn roms(design: &Design, naming: &Naming) -> Vec<Value> {
    let entry = |(at, rom): (usize, &crate::netlist::Rom)| {
        let width = design.width(rom.data);
        let binary = is_control_rom(design, RomId(at as u32));
        let mut entry = json!({
            "name": rom.name,
            "file": naming.files[at],
            "parameter": naming.parameters[at],
            "depth": rom.words.len(),
            "width": width,
            "bits": rom.words.len() as u64 * u64::from(width),
            "format": design.net(rom.data).format.to_string(),
            "synchronous": rom.synchronous,
            "radix": if binary { 2 } else { 16 },
            "doc": rom.doc,
        });
        if let Some(block) = rom.block {
            entry["block"] = json!(block);
        }
        entry
    };
    design.roms.iter().enumerate().map(entry).collect()
}

fn quantities(quantities: &[Quantity]) -> Vec<Value> {
    // Raw values fit 64 bits, as every net does.
    let entry = |quantity: &Quantity| {
        let raw = i64::try_from(quantity.raw)
            .map_or_else(|_| json!(quantity.raw as u64), |raw| json!(raw));
        json!({ "name": quantity.name, "raw": raw, "value": quantity.value })
    };
    quantities.iter().map(entry).collect()
}

//! Generates the manifest of a core, `<name>.json`, which describes the core for programs.
//!
//! For example, `rough.json` has the ports, the timing, the ROMs and the digests of all other files of `rough`.

use anyhow::{Context, Result};
use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};
use serde_json::{Value, json};

use super::emit_job::EmitJob;
use super::facts::{self, PortFacts, RomFacts};
use super::file_kind::FileKind;
use super::inputs::EmitInputs;
use super::map::BusRegister;
use super::output_file::digest;
use super::output_files::OutputFiles;
use super::table_image::TableLayout;
use super::wrap::fields::Transfer;
use crate::observation::{Computation, ContractFacts, Quantity};
use glint_rtl::netlist::{CoreFunction, Design, FunctionPort, HandshakeTiming, Pipeline, RegId};

/// The version of the manifest's structure, for programs that read it. The version increases when a name is renamed, moved, or
/// gets another meaning, and not when a name is added.
const SCHEMA: u32 = 2;

#[derive(Serialize)]
struct Manifest<'a> {
    schema: u32,
    glint: &'static str,
    name: &'a str,
    device: &'a str,
    title: &'a str,
    formula: &'a str,
    source: &'a str,
    notes: Vec<&'a str>,
    regenerate: String,
    scale: &'static str,
    ports: Vec<PortFacts<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    functions: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<Value>,
    timing: &'a HandshakeTiming,
    #[serde(skip_serializing_if = "Option::is_none")]
    control: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pipeline: Option<Value>,
    roms: Vec<RomFacts<'a>>,
    files: serde_json::Map<String, Value>,
    sha256: serde_json::Map<String, Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    example: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    computations: Option<ComputationNames<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    registers: Option<Vec<Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stream: Option<Value>,
}

#[derive(Serialize)]
struct ComputationNames<'a> {
    /// The operands of each point, in the order of the ports.
    operands: Vec<&'a str>,
    /// The results, in the order of the ports.
    results: Vec<&'a str>,
    /// The computations, each as JSON on a single line.
    points: Vec<Box<RawValue>>,
}

/// Returns the paths of all files except the manifest, in lists by purpose. For example, `rtl` lists the Verilog of the core.
/// Paths are relative to the directory of the configuration.
fn file_names(files: &OutputFiles) -> serde_json::Map<String, Value> {
    let lists: [(&str, &[FileKind]); 10] = [
        ("rtl", &[FileKind::CoreVerilog]),
        ("memories", &[FileKind::Memory]),
        ("cores", &[FileKind::CorePackage, FileKind::BenchPackage]),
        (
            "testbench",
            &[
                FileKind::CocotbBench,
                FileKind::WrapperProof,
                FileKind::WrapperProofScript,
                FileKind::CoreProof,
                FileKind::CoreProofScript,
                FileKind::Bench,
                FileKind::BenchVectors,
            ],
        ),
        ("primitives", &[FileKind::TargetVerilog]),
        ("wrappers", FileKind::WRAPPERS),
        ("software", &[FileKind::Software, FileKind::Recomputation]),
        ("constraints", &[FileKind::Constraint]),
        ("scripts", &[FileKind::VendorScript]),
        ("languages", &[FileKind::Vhdl, FileKind::SystemVerilogPackage]),
    ];
    let mut names = serde_json::Map::new();
    for (place, (list, kinds)) in lists.into_iter().enumerate() {
        let paths = files.local_paths(kinds);
        // The first four lists are in the manifest even if they are empty.
        if place < 4 || !paths.is_empty() {
            names.insert(list.to_owned(), json!(paths));
        }
    }
    names
}

/// Returns the manifest as JSON, with the digests of `others`, the configuration's other files.
///
/// # Errors
/// Fails if the configuration asks for streams and the core has no operands or no results. Fails if an operand or a result of the
/// contract has no port.
pub fn contents(job: &EmitJob, others: &OutputFiles) -> Result<String> {
    let EmitJob { design, inputs, naming, .. } = *job;
    let about = &design.about;
    let manifest = Manifest {
        schema: SCHEMA,
        glint: env!("CARGO_PKG_VERSION"),
        name: &design.name,
        device: &about.device,
        title: &about.title,
        formula: &about.formula,
        source: &about.source,
        notes: about.paragraphs().collect(),
        regenerate: inputs.regenerate.clone(),
        scale: "value = raw * 2^-fraction_bits",
        ports: facts::ports(design),
        functions: functions(design),
        table: table(job),
        timing: &inputs.timing,
        control: design.pipeline.is_none().then(|| control(design)),
        pipeline: design.pipeline.as_ref().map(pipeline),
        roms: facts::roms(design, naming),
        files: file_names(others),
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
        accuracy: inputs.accuracy.as_ref().map(accuracy),
        computations: computations(design, inputs)?,
        registers: job
            .registers
            .as_ref()
            .map(|(_, map)| map.registers.iter().map(register).collect()),
        stream: inputs.around.stream.then(|| stream(job)).transpose()?,
    };
    Ok(serde_json::to_string_pretty(&manifest)? + "\n")
}

/// Returns the layout of a writable table, and the functions for which the core has images.
fn table(job: &EmitJob) -> Option<Value> {
    let layout = TableLayout::of(job.design)?;
    let parts = layout
        .parts
        .iter()
        .map(|(port, format)| json!({ "port": port, "format": format.to_string() }));
    let images = job.inputs.images.iter().map(|image| {
        json!({ "name": image.name, "formula": image.formula, "bound": image.bound, "words": image.words })
    });
    Some(json!({
        "layout": format!("{:016x}", layout.digest),
        "words": layout.words,
        "parts": parts.collect::<Vec<Value>>(),
        "images": images.collect::<Vec<Value>>(),
    }))
}

/// Returns the functions of a core that computes several. The place in the list is the opcode.
fn functions(design: &Design) -> Vec<Value> {
    let functions = design.functions.iter().enumerate();
    functions.map(|(opcode, it)| function(it, design.clocks_of_function(opcode))).collect()
}

/// Returns the names and formats of a function's values at the ports, and the number of clocks from `start` to `done`.
fn function(function: &CoreFunction, clocks: Option<u32>) -> Value {
    let values = |ports: &[FunctionPort]| -> Vec<Value> {
        let entry = |it: &FunctionPort| {
            json!({
                "name": it.name,
                "port": it.port,
                "signed": it.format.signed,
                "width": it.format.width(),
                "fraction_bits": it.format.frac,
                "doc": it.doc,
            })
        };
        ports.iter().map(entry).collect()
    };
    json!({
        "name": function.name,
        "start_to_done": clocks,
        "operands": values(&function.operands),
        "results": values(&function.results),
    })
}

fn stream(job: &EmitJob) -> Result<Value> {
    let around = &job.inputs.around;
    Ok(json!({
        "s_axis_tdata": layout(&Transfer::sent(job)?),
        "m_axis_tdata": layout(&Transfer::received(job)?),
        "user_bits": around.user_bits,
        "keep": around.keep,
    }))
}

fn layout(transfer: &Transfer) -> Value {
    let mut fields = Vec::new();
    for field in &transfer.fields {
        fields.push(json!({ "name": field.name, "low": field.low, "width": field.width }));
    }
    json!({ "bits": transfer.bits, "fields": fields })
}

fn register(register: &BusRegister) -> Value {
    let mut bits = Vec::new();
    for it in &register.bits {
        bits.push(json!({ "name": it.name, "low": it.low, "width": it.width }));
    }
    json!({ "name": register.name, "offset": register.offset(), "bits": bits })
}

fn accuracy(accuracy: &ContractFacts) -> Value {
    let mut outputs = serde_json::Map::new();
    for (output, operand) in &accuracy.outputs {
        outputs.insert(output.clone(), json!(operand));
    }
    let mut domain = serde_json::Map::new();
    for (operand, (low, high)) in &accuracy.domain {
        domain.insert(operand.clone(), json!({ "low": low, "high": high }));
    }
    let mut bounds = serde_json::Map::new();
    for ((output, _), bound) in accuracy.outputs.iter().zip(&accuracy.bounds) {
        bounds.insert(output.clone(), json!(bound));
    }
    let highlight = accuracy.outputs.iter().all(|(_, operand)| operand.is_some());
    let value = if highlight { "operand * f" } else { "formula" };
    let mut entry = json!({
        "statement": format!(
            "|output - {value}| <= bounds[output] in units of the output, for raw operands of the domain"
        ),
        "domain": domain,
        "outputs": outputs,
        "f": accuracy.f,
        "bounds": bounds,
    });
    let conditions = accuracy.conditions.iter().flatten();
    let mut wheres = serde_json::Map::new();
    for ((output, _), condition) in accuracy.outputs.iter().zip(conditions) {
        if let Some(condition) = condition {
            wheres.insert(output.clone(), json!(condition.python()));
        }
    }
    if !wheres.is_empty() {
        entry["where"] = json!(wheres);
    }
    if let Some(length) = &accuracy.length {
        entry["length"] = json!(length);
    }
    entry
}

fn computations<'a>(
    design: &'a Design,
    inputs: &'a EmitInputs,
) -> Result<Option<ComputationNames<'a>>> {
    let Some(accuracy) = inputs.accuracy.as_ref().filter(|_| !inputs.computations.is_empty())
    else {
        return Ok(None);
    };
    let operands = in_port_order(design, accuracy.domain.iter().map(|(name, _)| name))?;
    let results = in_port_order(design, accuracy.outputs.iter().map(|(name, _)| name))?;
    let (operand_at, result_at) = (positions(&operands), positions(&results));
    let mut points = Vec::new();
    for computation in &inputs.computations {
        points.push(line(computation, &operand_at, &result_at)?);
    }
    Ok(Some(ComputationNames {
        operands: operands.into_iter().map(|(_, name)| name).collect(),
        results: results.into_iter().map(|(_, name)| name).collect(),
        points,
    }))
}

/// Returns `names` in the order of the ports, each with its index in `names`. Fails if a name has no port.
fn in_port_order<'a>(
    design: &Design,
    names: impl Iterator<Item = &'a String>,
) -> Result<Vec<(usize, &'a str)>> {
    let mut placed = names
        .enumerate()
        .map(|(place, name)| {
            let mut ports = design.ports.iter();
            let port = ports.position(|port| design.net(port.net).name == *name);
            Ok((port.with_context(|| format!("no port `{name}`"))?, (place, name.as_str())))
        })
        .collect::<Result<Vec<_>>>()?;
    placed.sort_unstable();
    Ok(placed.into_iter().map(|(_, named)| named).collect())
}

fn positions(ordered: &[(usize, &str)]) -> Vec<usize> {
    ordered.iter().map(|(place, _)| *place).collect()
}

/// `operands` and `results` are the indices of the raw values of `computation`, in the order in which they are written.
fn line(computation: &Computation, operands: &[usize], results: &[usize]) -> Result<Box<RawValue>> {
    let (mut valid, mut outputs) = (Vec::new(), Vec::new());
    for result in &computation.results {
        valid.push(result.clock);
        outputs.push(in_order(results, &result.outputs));
    }
    Ok(to_raw_value(&json!({
        "operands": in_order(operands, &computation.operands),
        "valid": valid,
        "results": outputs,
        "done": computation.done,
    }))?)
}

fn in_order(places: &[usize], values: &[i64]) -> Vec<i64> {
    places.iter().map(|&place| values[place]).collect()
}

fn control(design: &Design) -> Value {
    let control = &design.control;
    let name = |register: RegId| &design.net(design.register(register).q).name;
    let mut entry = json!({
        "run": name(control.run),
        "address": name(control.address),
        "rom": design.rom(control.rom).name,
        "fields": facts::fields(design),
        "words": facts::microprogram(design),
    });
    if control.overlaps {
        entry["operands_buffered"] = json!(true);
    }
    entry
}

/// Latency and interval are in clocks. `register_bits` of a stage counts the bits of the registers behind the stage.
/// `delayed_bits` counts the bits that are in delay memories in place of these registers.
fn pipeline(pipeline: &Pipeline) -> Value {
    let stages = pipeline.stages.iter().map(|stage| {
        json!({
            "microinstructions": stage.microinstructions,
            "logic_ns": (stage.logic_ns * 100.0).round() / 100.0,
            "register_bits": stage.register_bits,
            "delayed_bits": stage.delayed_bits,
        })
    });
    let mut entry = json!({
        "latency": pipeline.stages.len(),
        "interval": pipeline.interval,
        "target": pipeline.target,
        "clock_mhz": (pipeline.clock_mhz * 10.0).round() / 10.0,
        "stall": pipeline.stall,
        "side_bits": pipeline.side,
        "stages": stages.collect::<Vec<_>>(),
    });
    if !pipeline.registered.is_empty() {
        entry["registered_multipliers"] = json!(pipeline.registered.len());
    }
    entry
}

fn quantities(quantities: &[Quantity]) -> Vec<Value> {
    let mut entries = Vec::new();
    for quantity in quantities {
        // Raw values fit 64 bits, as every net does.
        let raw = match i64::try_from(quantity.raw) {
            Ok(raw) => json!(raw),
            Err(_) => json!(quantity.raw as u64),
        };
        entries.push(json!({ "name": quantity.name, "raw": raw, "value": quantity.value }));
    }
    entries
}

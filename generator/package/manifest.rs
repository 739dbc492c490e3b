//! `<name>.json`: the device for programs.

use anyhow::Result;
use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};
use serde_json::{Value, json};

use super::facts::{self, Port, Rom};
use super::{Accuracy, Computation, EmitInputs, OutputFile, Quantity, Timing, digest};
use crate::hdl::netlist::{Design, Pipeline, RegId};
use crate::hdl::verilog::naming::Naming;

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
    ports: Vec<Port<'a>>,
    timing: &'a Timing,
    #[serde(skip_serializing_if = "Option::is_none")]
    control: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pipeline: Option<Value>,
    roms: Vec<Rom<'a>>,
    files: Value,
    sha256: serde_json::Map<String, Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    example: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<Value>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    computations: Vec<Box<RawValue>>,
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
    /// The model in C, or nothing.
    pub software: &'a [String],
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
        ports: facts::ports(design),
        timing: &inputs.timing,
        control: design.pipeline.is_none().then(|| control(design)),
        pipeline: design.pipeline.as_ref().map(pipeline),
        roms: facts::roms(design, naming),
        files: listed(files),
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
        computations: inputs.computations.iter().map(computation).collect::<Result<_>>()?,
    };
    Ok(serde_json::to_string_pretty(&manifest)? + "\n")
}

fn listed(files: &Files) -> Value {
    let mut listed = json!({
        "rtl": files.rtl,
        "memories": files.memories,
        "cores": files.cores,
        "testbench": files.testbench,
    });
    if !files.software.is_empty() {
        listed["software"] = json!(files.software);
    }
    listed
}

fn accuracy(accuracy: &Accuracy) -> Value {
    let outputs = accuracy.outputs.iter();
    let outputs: serde_json::Map<_, _> =
        outputs.map(|(output, operand)| (output.clone(), json!(operand))).collect();
    let domain = accuracy.domain.iter();
    let domain: serde_json::Map<_, _> = domain
        .map(|(operand, (low, high))| (operand.clone(), json!({ "low": low, "high": high })))
        .collect();
    let mut entry = json!({
        "statement": "|output - operand * f| <= bound in units of the output, for raw operands of the domain",
        "domain": domain,
        "outputs": outputs,
        "f": accuracy.f,
        "bound": accuracy.bound,
    });
    if let Some(length) = &accuracy.length {
        entry["length"] = json!(length);
    }
    entry
}

/// In a line, raw values in the order of `accuracy`.
fn computation(computation: &Computation) -> Result<Box<RawValue>> {
    let results = computation.results.iter();
    let valid: Vec<u32> = results.clone().map(|result| result.clock).collect();
    let results: Vec<_> = results.map(|result| &result.outputs).collect();
    Ok(to_raw_value(&json!({
        "operands": computation.operands,
        "valid": valid,
        "results": results,
        "done": computation.done,
    }))?)
}

fn control(design: &Design) -> Value {
    let control = &design.control;
    let name = |register: RegId| &design.net(design.register(register).q).name;
    json!({
        "run": name(control.run),
        "address": name(control.address),
        "rom": design.rom(control.rom).name,
        "fields": facts::fields(design),
        "words": facts::words(design),
    })
}

/// Latency and interval are in clocks; a register bit counts in each stage that it ends.
fn pipeline(pipeline: &Pipeline) -> Value {
    let stages = pipeline.stages.iter().map(|stage| {
        json!({
            "microinstructions": stage.microinstructions,
            "logic_ns": (stage.logic_ns * 100.0).round() / 100.0,
            "register_bits": stage.register_bits,
        })
    });
    json!({
        "latency": pipeline.stages.len(),
        "interval": 1,
        "target": pipeline.target,
        "clock_mhz": (pipeline.clock_mhz * 10.0).round() / 10.0,
        "stall": pipeline.stall,
        "side_bits": pipeline.side,
        "stages": stages.collect::<Vec<_>>(),
    })
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

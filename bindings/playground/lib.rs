//! Glint as a WebAssembly module for the playground page of the web site: it takes a request in JSON, and returns an answer in
//! JSON.
//!
//! `site/worker.js` reserves memory for the text of a request, writes the text there and calls [`answer`]. The same code as in
//! the command line makes the pages, pictures and files that the playground shows.

mod errors;

use std::cell::RefCell;

use anyhow::{Context, Result};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::Deserialize;
use serde_json::{Value, json};

use glint_config::{self as config, Key, KeyKind, Problems};
use glint_core::core::Core;
use glint_core::cosim::batch::Golden;
use glint_core::package::{self, FileKind, OutputFile};
use glint_core::registry::Registry;
use glint_golden::{Bound, ComputedPart, Contract};
use glint_keys::presets;
use glint_prove::synth::TARGETS;
use glint_prove::tune::Cost;
use glint_show::evidence::chart::Chart;
use glint_show::evidence::curves;
use glint_show::evidence::domain;
use glint_show::pages::{account, datasheet, diagram, plots};
use glint_show::render::{self, BACKGROUND, BuiltIn, Light, Material, Scene, Settings, View};

/// The name under which messages know the text of the editor.
const FILE: &str = "core.toml";

/// The name of the module if the configuration states none: that of [`FILE`].
const MODULE: &str = "core";

thread_local! {
    /// Room for a request or an answer.
    static ROOM: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    /// The configuration of the last request, and its core: most requests in a row are about the same.
    static LAST: RefCell<Option<(String, Core)>> = const { RefCell::new(None) };
}

/// A question of the page.
#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase")]
enum Question {
    /// The devices, and the presets of `function` and `expression`.
    Devices,
    /// The configuration of a preset, as TOML.
    Preset { name: String },
    /// Describes a core: keys, bounds, parts of the computation, clocks, estimates, schedule, diagram.
    Core { toml: String },
    /// A lit sphere beside Blinn's function in f64 and the difference.
    Picture { toml: String, exponent: Option<u32>, side: u32 },
    /// The error over the domain, or over exponents and angles.
    Charts { toml: String },
    /// A sample of the errors of each output over the operands, for a device that is no highlight.
    Errors { toml: String },
    /// The timing diagram of a computation, or of points through the pipeline.
    Waves { toml: String },
    /// The files of `glint generate` that do not depend on the bench, whose points take a while to choose.
    Sources { toml: String },
    /// All files of `glint generate`.
    Files { toml: String },
}

/// Reserves memory for a request of `len` bytes, and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(len: usize) -> *mut u8 {
    ROOM.with_borrow_mut(|room| {
        room.clear();
        room.resize(len, 0);
        room.as_mut_ptr()
    })
}

/// Answers the request in the reserved memory. Returns the address of the answer; [`answer_len`] returns its length.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    let request = ROOM.take();
    let answer = answered(&request).unwrap_or_else(|error| failed(&error));
    ROOM.set(answer.to_string().into_bytes());
    ROOM.with_borrow(|room| room.as_ptr())
}

/// Returns the length of the last answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_len() -> usize {
    ROOM.with_borrow(Vec::len)
}

/// Returns the problems of a configuration, each with its line, or a message.
fn failed(error: &anyhow::Error) -> Value {
    match error.downcast_ref::<Problems>() {
        Some(problems) => json!({ "ok": false, "problems": problems.to_json() }),
        None => {
            let causes: Vec<String> = error.chain().map(ToString::to_string).collect();
            json!({ "ok": false, "problems": [{ "message": causes.join(": ") }] })
        }
    }
}

fn answered(request: &[u8]) -> Result<Value> {
    match serde_json::from_slice(request).context("no request")? {
        Question::Devices => {
            let devices = Registry::shipped();
            let devices: Vec<Value> = devices
                .devices()
                .iter()
                .map(|it| json!({ "name": it.name, "summary": it.summary }))
                .collect();
            let functions: Vec<&str> = presets::names_of_functions().collect();
            let expressions: Vec<&str> = presets::names_of_expressions().collect();
            Ok(
                json!({ "ok": true, "devices": devices, "functions": functions, "expressions": expressions }),
            )
        }
        Question::Preset { name } => {
            let preset = presets::find(&name).context("no such preset")?;
            let module = name.replace('-', "_");
            let mut toml = format!("device = \"{}\"\nname = \"{module}\"\n", preset.device);
            for (key, value) in &preset.values {
                toml += &format!("{key} = {}\n", value.toml());
            }
            Ok(json!({ "ok": true, "toml": toml }))
        }
        Question::Core { toml } => of(&toml, described),
        Question::Picture { toml, exponent, side } => {
            of(&toml, |core| picture(core, exponent, side))
        }
        Question::Charts { toml } => of(&toml, charts),
        Question::Errors { toml } => of(&toml, |core| errors::answer(core.contract.as_ref())),
        Question::Waves { toml } => of(&toml, |core| {
            let (svg, described) = datasheet::timing_diagram(core)?;
            Ok(json!({ "ok": true, "svg": svg, "described": described }))
        }),
        Question::Files { toml } => of(&toml, |core| {
            let files = core.files(FILE, core.shipped_vectors()?)?;
            Ok(listed(files.iter().chain([&package::driver()])))
        }),
        Question::Sources { toml } => of(&toml, |core| {
            let files = core.files(FILE, None)?;
            // The manifest and the FuseSoC core list the bench, too.
            let of_bench = [FileKind::Manifest, FileKind::CorePackage];
            Ok(listed(files.iter().filter(|file| !of_bench.contains(&file.kind))))
        }),
    }
}

fn listed<'a>(files: impl IntoIterator<Item = &'a OutputFile>) -> Value {
    let mut list = Vec::new();
    for file in files {
        list.push(json!({ "name": file.path, "text": file.contents }));
    }
    json!({ "ok": true, "files": list })
}

/// Returns the answer of `ask` to the core of a configuration.
fn of(toml: &str, ask: impl FnOnce(&Core) -> Result<Value>) -> Result<Value> {
    LAST.with_borrow_mut(|last| {
        if last.as_ref().is_none_or(|(text, _)| text != toml) {
            *last = None;
            let registry = Registry::shipped();
            let (opened, source) = registry.parse(FILE, toml)?;
            let core = Core::build(opened).map_err(|error| match source.located(error) {
                Ok(problems) => problems.into(),
                Err(error) => error,
            })?;
            *last = Some((toml.to_owned(), core));
        }
        let (_, core) = last.as_ref().context("no core")?;
        ask(core)
    })
}

/// Returns a value of a key for JSON.
fn plain(value: &config::Value) -> Value {
    match value {
        config::Value::Integer(value) => json!(value),
        config::Value::Number(value) => json!(value),
        config::Value::Text(value) => json!(value),
        config::Value::Flag(value) => json!(value),
        config::Value::Integers(values) => json!(values),
        config::Value::Table(records) => json!(records),
    }
}

/// Returns the type of a key and the values that it may have, for the form.
fn kind(kind: &KeyKind) -> Value {
    match kind {
        KeyKind::Integer { min, max } => json!({ "is": "integer", "min": min, "max": max }),
        KeyKind::Number { min, max, .. } => json!({ "is": "number", "min": min, "max": max }),
        KeyKind::Choice(options) => json!({ "is": "choice", "options": options }),
        KeyKind::Flag => json!({ "is": "flag" }),
        KeyKind::Text(_) => json!({ "is": "text" }),
        KeyKind::Integers { .. } => json!({ "is": "integers" }),
        KeyKind::Table { fields, shorthand, least, most } => {
            let fields: Vec<Value> = fields.iter().map(field).collect();
            json!({ "is": "entries", "fields": fields, "shorthand": shorthand, "least": least, "most": most })
        }
    }
}

/// Returns a key, or a field of an entry, without its value.
fn field(key: &Key) -> Value {
    json!({ "name": key.name, "kind": kind(&key.kind), "doc": key.doc, "default": plain(&key.default) })
}

/// Returns a key for the form.
fn key(core: &Core, key: &Key) -> Value {
    let mut described = field(key);
    described["value"] = plain(core.config().value(key.name));
    described["applies"] = json!(core.config().applies(&(core.device().schema)(), key.name));
    described
}

/// Returns the bound of an output, with the terms that add up to it. A bound that is not stated is `null`.
fn bound(bound: &Bound) -> Value {
    let terms: Vec<Value> = bound
        .terms
        .iter()
        .map(|term| json!({ "key": term.key, "what": term.what, "units": term.units }))
        .collect();
    json!({ "output": bound.output, "units": bound.units, "limit": bound.limit, "terms": terms })
}

/// Returns a part of the computation, with its share in the error of each output.
fn part(part: &ComputedPart) -> Value {
    json!({ "name": part.name, "words": part.words, "format": account::format_text(part.format),
        "shares": part.shares, "cells": part.cells, "products": part.products })
}

/// Returns the estimates of area and clock for every FPGA family, with numbers as `glint estimate` rounds them. `own` marks the
/// family for which a pipeline is scheduled.
fn estimates(core: &Core) -> Vec<Value> {
    let own = core.design.pipeline.as_ref().map_or("", |pipeline| pipeline.target.as_str());
    let mut estimates = Vec::new();
    for target in TARGETS {
        let Some(family) = target.family() else { continue };
        let cost = Cost::new(&core.design, target);
        estimates.push(json!({ "target": family.title, "own": family.name() == own,
            "luts": format!("{:.0}", cost.luts), "dsps": cost.dsps, "block_rams": cost.block_rams,
            "mhz": format!("{:.0}", cost.mhz) }));
    }
    estimates
}

/// Returns whether the page shows a sample of the errors over the operands. The charts of a highlight show its errors over angles
/// and exponents instead.
fn is_sampled(contract: &dyn Contract) -> bool {
    contract.highlight().is_none() && contract.length().is_none()
}

/// Returns everything that the page shows of a core as soon as it is built.
fn described(core: &Core) -> Result<Value> {
    let (design, contract) = (&core.design, core.contract.as_ref());
    let schema = (core.device().schema)();
    let keys: Vec<Value> = schema.all_keys().map(|it| key(core, it)).collect();
    let bounds: Vec<Value> = contract.bounds().outputs.iter().map(bound).collect();
    let parts: Vec<Value> = contract.parts().iter().map(part).collect();
    let (latency, interval) = match &design.pipeline {
        Some(pipeline) => (Some(pipeline.stages.len() as u32), Some(pipeline.interval as u32)),
        None => {
            let timing = core.timing()?;
            (timing.start_to_valid, timing.start_to_start)
        }
    };
    let schedule: Vec<Value> = match &design.pipeline {
        Some(pipeline) => pipeline
            .stages
            .iter()
            .enumerate()
            .map(|(at, stage)| {
                let values: Vec<&str> = pipeline.computed(design, at).map(|it| it.0).collect();
                json!({ "at": at, "does": stage.microinstructions.join("; "), "values": values,
                    "ns": stage.logic_ns, "bits": stage.register_bits })
            })
            .collect(),
        None => {
            let program = design.control.microprogram.iter().enumerate();
            program.map(|(at, it)| json!({ "at": at, "does": it.name })).collect()
        }
    };
    Ok(json!({
        "ok": true,
        "name": core.config().name,
        // The form keeps a name that the text states.
        "named": core.config().name != MODULE,
        "device": core.device().name,
        "summary": core.device().summary,
        "keys": keys,
        "bounds": bounds,
        "proved": core.device().proved,
        "parts": parts,
        "sampled": is_sampled(contract),
        "latency": latency,
        "interval": interval,
        "pipelined": design.pipeline.is_some(),
        "estimates": estimates(core),
        "schedule": schedule,
        "diagram": diagram::svg(design)?,
        "draws": render::draws(core),
        "exponents": render::exponents(contract),
        "exponent": render::usual_exponent(contract),
    }))
}

fn picture(core: &Core, exponent: Option<u32>, side: u32) -> Result<Value> {
    let contract = core.contract.as_ref();
    let exponent = exponent.unwrap_or_else(|| render::usual_exponent(contract));
    let lines = render::walks_lines(contract);
    let settings = Settings {
        size: (side, side),
        samples: 1,
        view: View { eye: None, target: None, field: render::FIELD },
        material: Material::usual(exponent),
        background: BACKGROUND,
        compare: true,
        operands: Vec::new(),
    };
    let objects = Scene::built_in(BuiltIn::Sphere, None, lines)?;
    let scene = Scene { objects, lights: Light::usual(), relief: None };
    let rendered = render::render(core, &mut Golden(contract), &scene, &settings, &mut |_| ())?;
    let png = BASE64_STANDARD.encode(rendered.whole(core.device().name).png()?);
    let units = rendered.comparison.as_ref().map(|it| it.units);
    Ok(json!({ "ok": true, "png": png, "exponent": exponent, "units": units }))
}

fn charts(core: &Core) -> Result<Value> {
    let contract = core.contract.as_ref();
    let of_domain = domain::charts(contract);
    let charts = match of_domain.is_empty() {
        true => curves::configuration(core.device(), contract, &|| ()).charts,
        false => of_domain,
    };
    let drawn = charts.iter().map(drawn).collect::<Result<Vec<_>>>()?;
    Ok(json!({ "ok": true, "charts": drawn }))
}

/// Returns a chart as the page shows it.
fn drawn(chart: &Chart) -> Result<Value> {
    let names: Vec<&str> = chart.series.iter().map(|it| it.name.as_str()).collect();
    Ok(
        json!({ "title": chart.title, "caption": chart.caption, "svg": plots::svg(chart)?, "series": names,
        "y": chart.y.label }),
    )
}

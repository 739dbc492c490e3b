//! `glint schedule`: shows the stages of a pipeline, the passes that rewrite the computation, and the computation after a
//! pass.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load, paths};
use crate::report::CommandReport;
use crate::{Configs, OutputOptions, say, store, tables};
use glint_base::text::counted;
use glint_core::package::{Seal, sealed};
use glint_core::registry::Registry;
use glint_rtl::netlist::{Design, Pipeline};
use glint_rtl::pipeline::PassResult;
use glint_show::pages::diagram;

/// Show the stages of a pipeline
///
/// The table shows for each stage: its microinstructions, the values that it computes, the delay of its longest path on the
/// target, the slack (the clock period minus this delay and the delay of a register), the bits of the registers behind the
/// stage, and the bits of the delay lines that pass through the stage.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint schedule my_pipeline.toml
  glint schedule my_pipeline.toml --svg drawings   a drawing of the stages, drawings/<name>.svg
  glint schedule my_pipeline.toml --passes         the operations and products after each pass
  glint schedule my_pipeline.toml --after split    the computation after a pass, a line for each value
  glint schedule my_pipeline.toml --json")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// Also draw the stages, as one SVG file for each configuration
    #[arg(long, value_name = "DIR")]
    svg: Option<PathBuf>,
    /// Also replace drawings that Glint did not write or that were edited since
    #[arg(long, requires = "svg")]
    force: bool,
    /// List the passes that rewrite the computation before it is scheduled
    #[arg(long, conflicts_with_all = ["svg", "after"])]
    passes: bool,
    /// Print the computation after this pass, as text: `unroll` is the computation before all passes
    #[arg(long, value_name = "PASS", conflicts_with = "svg")]
    after: Option<String>,
}

/// Shows the stages, the passes, or the computation after a pass.
///
/// # Errors
///
/// Fails if a configuration has problems, if a named configuration is sequential, or if no configuration is a pipeline. Fails if
/// no pass has the name in `--after`, or if a drawing was edited or cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let named = paths(&arguments.configs.paths)?;
    let mut list = output.list();
    let mut shown = 0;
    for one in load(registry, &arguments.configs.paths)? {
        let Some(pipeline) = &one.core.design.pipeline else {
            if arguments.configs.paths.is_empty() {
                continue;
            }
            bail!(
                "`{}`: the core is sequential and has no stages; set architecture = \"pipelined\"",
                one.path
            );
        };
        shown += 1;
        if let Some(directory) = &arguments.svg {
            let drawing = sealed(diagram::svg(&one.core.design)?, Seal::Markup);
            let path = directory.join(format!("{}.svg", one.core.config().name));
            store::write_sealed(&path, &drawing, Seal::Markup, arguments.force)
                .with_context(|| format!("the drawing of `{}` was not written", one.path))?;
        }
        match &arguments.after {
            _ if arguments.passes => list.add(&PassList::new(&one)?)?,
            Some(pass) => list.add(&PassText::new(&one, pass)?)?,
            None => list.add(&PipelineSchedule { one: &one, pipeline })?,
        }
    }
    if shown == 0 {
        bail!(
            "none of {} configurations is a pipeline; name the configuration of a pipeline",
            named.len()
        );
    }
    list.finish(|schedules| Ok(json!({ "ok": true, "schedules": schedules })))?;
    Ok(true)
}

/// The passes that rewrite the computation of a configuration, with their results.
struct PassList<'a> {
    path: &'a str,
    results: Vec<PassResult>,
}

impl<'a> PassList<'a> {
    fn new(one: &'a Loaded) -> Result<Self> {
        let results = one.core.opened.pass_results()?;
        Ok(Self { path: &one.path, results })
    }
}

impl CommandReport for PassList<'_> {
    fn json(&self) -> Result<Value> {
        let mut passes = Vec::new();
        for result in &self.results {
            passes.push(json!({
                "pass": result.name,
                "description": result.description,
                "operations": result.operations(),
                "products": result.products(),
            }));
        }
        Ok(json!({ "config": self.path, "passes": passes }))
    }

    fn print(&self) -> Result<()> {
        say!("{}:", self.path);
        let mut rows = Vec::new();
        for result in &self.results {
            rows.push(vec![
                result.name.to_owned(),
                result.operations().to_string(),
                result.products().to_string(),
                result.description.to_owned(),
            ]);
        }
        tables::print("pass | operations: | products: | the pass", rows);
        Ok(())
    }
}

struct PassText<'a> {
    path: &'a str,
    pass: &'a str,
    text: String,
}

impl<'a> PassText<'a> {
    /// Prints the computation to a text. Fails if no pass that rewrites this computation has the name `pass`.
    fn new(one: &'a Loaded, pass: &'a str) -> Result<Self> {
        let results = one.core.opened.pass_results()?;
        let Some(result) = results.iter().find(|result| result.name == pass) else {
            let names: Vec<&str> = results.iter().map(|result| result.name).collect();
            bail!("`{}` has no pass `{pass}`; its passes are: {}", one.path, names.join(", "));
        };
        Ok(Self { path: &one.path, pass, text: result.text() })
    }
}

impl CommandReport for PassText<'_> {
    fn json(&self) -> Result<Value> {
        Ok(json!({ "config": self.path, "pass": self.pass, "computation": self.text }))
    }

    fn print(&self) -> Result<()> {
        say!("# {} after `{}`", self.path, self.pass);
        say!("{}", self.text.trim_end());
        Ok(())
    }
}

struct PipelineSchedule<'a> {
    one: &'a Loaded,
    pipeline: &'a Pipeline,
}

impl CommandReport for PipelineSchedule<'_> {
    fn json(&self) -> Result<Value> {
        Ok(as_json(self.one, self.pipeline))
    }

    fn print(&self) -> Result<()> {
        print(self.one, self.pipeline);
        Ok(())
    }
}

fn print(one: &Loaded, pipeline: &Pipeline) {
    let period = 1000.0 / pipeline.clock_mhz;
    let bits: u32 = pipeline.stages.iter().map(|stage| stage.register_bits).sum();
    let delayed = match pipeline.stages.iter().map(|stage| stage.delayed_bits).sum::<u32>() {
        0 => String::new(),
        bits => format!(", and {bits} bits in delay lines"),
    };
    let multipliers = match pipeline.registered.len() {
        0 => String::new(),
        some => format!(" in addition to the registers in {}", counted(some, "multiplier")),
    };
    say!(
        "{}: {} stages for {:.1} MHz ({period:.2} ns) on {}, {bits} register bits{multipliers}{delayed}",
        one.path,
        pipeline.stages.len(),
        pipeline.clock_mhz,
        pipeline.target,
    );
    let mut stages = Vec::new();
    for (number, stage) in pipeline.stages.iter().enumerate() {
        stages.push(vec![
            number.to_string(),
            stage.microinstructions.join("; "),
            computed(&one.core.design, pipeline, number).join(", "),
            format!("{:.2}", stage.logic_ns),
            format!("{:.2}", stage.slack_ns),
            stage.register_bits.to_string(),
            stage.delayed_bits.to_string(),
        ]);
    }
    tables::print(
        "stage: | microinstructions | computes | logic ns:3 | slack ns:1 | bits:2 | delayed:4",
        stages,
    );
    let units = multiplier_slots(one, pipeline);
    if units.is_empty() {
        return;
    }
    say!(
        "the pipeline takes a point every {} clocks; each multiplier computes these products, by slot:",
        pipeline.interval
    );
    let mut headings = "multiplier".to_owned();
    for slot in 0..pipeline.interval {
        headings += &format!(" | {slot}");
    }
    let mut rows = Vec::new();
    for (name, serves) in units {
        let products = serves.into_iter().map(Option::unwrap_or_default);
        rows.push(std::iter::once(name).chain(products).collect());
    }
    tables::print(&headings, rows);
}

/// Returns the product that each shared multiplier computes in each slot.
fn multiplier_slots(one: &Loaded, pipeline: &Pipeline) -> Vec<(String, Vec<Option<String>>)> {
    match pipeline.interval {
        1 => Vec::new(),
        _ => pipeline.multipliers(&one.core.design),
    }
}

/// Returns the names of the values that a stage computes.
fn computed<'a>(design: &'a Design, pipeline: &'a Pipeline, stage: usize) -> Vec<&'a str> {
    pipeline.computed(design, stage).map(|(value, _)| value).collect()
}

fn as_json(one: &Loaded, pipeline: &Pipeline) -> Value {
    let mut stages = Vec::new();
    for (number, stage) in pipeline.stages.iter().enumerate() {
        stages.push(json!({
            "stage": number,
            "microinstructions": stage.microinstructions,
            "computes": computed(&one.core.design, pipeline, number),
            "logic_ns": stage.logic_ns,
            "slack_ns": stage.slack_ns,
            "register_bits": stage.register_bits,
            "delayed_bits": stage.delayed_bits,
        }));
    }
    let mut reservations = Vec::new();
    for (name, serves) in multiplier_slots(one, pipeline) {
        reservations.push(json!({ "multiplier": name, "slots": serves }));
    }
    json!({
        "config": one.path,
        "name": one.core.config().name,
        "target": pipeline.target,
        "clock_mhz": pipeline.clock_mhz,
        "latency": pipeline.stages.len(),
        "interval": pipeline.interval,
        "registered_multipliers": pipeline.registered.len(),
        "reservations": reservations,
        "stages": stages,
    })
}

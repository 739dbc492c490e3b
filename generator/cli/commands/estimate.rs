//! `glint estimate`: estimates area and clock frequency of a core on each FPGA family, without outside tools.

use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::report::CommandReport;
use crate::{Configs, OutputOptions, say, tables};
use glint_base::program::Program;
use glint_core::registry::Registry;
use glint_prove::synth::{TARGETS, Target};
use glint_prove::tune::Cost;

/// Estimate area and clock on each FPGA family, without outside tools
///
/// The estimate adds the weights of the logic in the netlist. The weights were fitted to the synthesis of some 34 to 59 cores,
/// highlights and expressions. For half of these cores, the look-up tables are within 3 % of the measurement on GateMate, 4 % on
/// iCE40 HX, 6 % on Nexus, 8 % on iCE40 UltraPlus and Gowin, 10 % on ECP5, and 14 % on Xilinx 7. DSP blocks and block RAMs follow
/// from the widths. `glint synth` measures with Yosys and nextpnr.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint estimate my_core.toml
  glint estimate my_core.toml --json             for scripts")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
}

struct EstimateRow {
    target: Target,
    cost: Cost,
    /// The resources that the smallest chip of the family lacks, as a phrase such as `the core does not fit the LFE5U-25F: it
    /// takes 30 of 28 DSP blocks`; empty if the core fits.
    excess: String,
}

/// Prints the estimates.
///
/// # Errors
///
/// Fails if a configuration has problems, or if two configurations name the same module.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    let mut estimates = Vec::new();
    for one in &loaded {
        estimates.push((one, rows(one)));
    }
    output.report(&EstimateTable { estimates })?;
    Ok(true)
}

struct EstimateTable<'a> {
    estimates: Vec<(&'a Loaded, Vec<EstimateRow>)>,
}

impl CommandReport for EstimateTable<'_> {
    fn json(&self) -> Result<Value> {
        let mut estimates = Vec::new();
        for (one, rows) in &self.estimates {
            estimates.push(as_json(one, rows));
        }
        Ok(json!({ "ok": true, "estimates": estimates }))
    }

    fn print(&self) -> Result<()> {
        let mut lines = Vec::new();
        for (one, rows) in &self.estimates {
            for row in rows {
                lines.push(line(one, row));
            }
        }
        tables::print("core | family | LUT: | DSP: | RAM: | MHz: | smallest chip", lines);
        say!("These are estimates; `{Program} synth` measures area and clock.");
        Ok(())
    }
}

fn rows(one: &Loaded) -> Vec<EstimateRow> {
    let fpgas = TARGETS.into_iter().filter(|target| target.family().is_some());
    let row = |target| {
        let cost = Cost::new(&one.core.design, target);
        EstimateRow { target, cost, excess: cost.excess(target) }
    };
    fpgas.map(row).collect()
}

fn line(one: &Loaded, row: &EstimateRow) -> Vec<String> {
    vec![
        one.core.config().name.clone(),
        row.target.title().to_owned(),
        format!("{:.0}", row.cost.luts),
        row.cost.dsps.to_string(),
        row.cost.block_rams.to_string(),
        format!("{:.0}", row.cost.mhz),
        if row.excess.is_empty() { "fits".to_owned() } else { row.excess.clone() },
    ]
}

fn as_json(one: &Loaded, rows: &[EstimateRow]) -> Value {
    let row = |row: &EstimateRow| {
        json!({
            "target": row.target,
            "cost": row.cost,
            "fits": row.excess.is_empty(),
        })
    };
    json!({
        "config": one.path,
        "name": one.core.config().name,
        "targets": rows.iter().map(row).collect::<Vec<Value>>(),
    })
}

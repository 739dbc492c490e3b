//! Defines how nextpnr-ecp5 measures a core on the FPGA family ECP5: its options, the requested frequency, and a check of the
//! multipliers.
//!
//! nextpnr-ecp5 knows the delays of block RAMs, and of multipliers without a register or with a register only at the output. The
//! measurement fails if a multiplier has registers elsewhere.

use anyhow::Result;
use serde_json::Value;

use super::netlist::Netlist;
use super::nextpnr::Recipe;
use super::workspace::Workspace;
use glint_show::figures::Target;

pub const RECIPE: Recipe = Recipe {
    target: Target::Ecp5,
    speed: "speed grade 6",
    options: "--lpf-allow-unconstrained --speed 6",
    goal: 200,
    prepare,
};

fn prepare(_workspace: &Workspace, netlist: &Netlist) -> Result<()> {
    netlist.check_timed("MULT18X18D", is_timed, |is| {
        format!("has registers inside ({is}), which nextpnr does not time")
    })
}

/// Returns whether nextpnr-ecp5 knows the delay of a multiplier with this value of `parameter`. Only the output may have a
/// register: `REG_OUTPUT_CLK` may be a clock, and `REG_INPUTA_CLK` must be `NONE`.
fn is_timed(parameter: &str, value: &Value) -> bool {
    let clocked = parameter.starts_with("REG_") && parameter.ends_with("_CLK");
    !clocked || parameter == "REG_OUTPUT_CLK" || value == "NONE"
}

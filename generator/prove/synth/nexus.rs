//! Defines how nextpnr-nexus measures a core on the FPGA family Nexus: its options, the requested frequency, and the
//! preparation of its input files.
//!
//! nextpnr-nexus knows the delay of every kind of cell, so the module checks no cell. The preparation writes the locations of
//! the pins, and disconnects a grounded carry input that nextpnr-nexus 0.11 refuses.

use std::collections::BTreeSet;

use anyhow::Result;
use serde_json::Value;

use super::netlist::Netlist;
use super::nextpnr::Recipe;
use super::workspace::{NETLIST, Workspace};
use glint_show::figures::Target;

pub const RECIPE: Recipe = Recipe {
    target: Target::Nexus,
    speed: "speed grade 9",
    // The other router of nextpnr-nexus 0.11 finds no way from a pin to the clock network.
    options: "--router router1 --pdc pins.pdc",
    goal: 300,
    prepare,
};

/// The locations of the four pins, which nextpnr-nexus demands: a clock pin, and three ordinary pins of the package CABGA400.
const PINS: &str = "ldc_set_location -site {L5} [get_ports clk]\n\
                    ldc_set_location -site {N14} [get_ports in]\n\
                    ldc_set_location -site {G14} [get_ports take]\n\
                    ldc_set_location -site {G13} [get_ports out]\n";

fn prepare(workspace: &Workspace, _netlist: &Netlist) -> Result<()> {
    let mut netlist = workspace.sources.json(NETLIST)?;
    open_carries(&mut netlist);
    workspace.sources.write(NETLIST, &netlist.to_string())?;
    workspace.sources.write("pins.pdc", PINS)
}

/// Disconnects the carry input of the first cell of each carry chain. Yosys 0.70 ties this input to ground, and nextpnr-nexus
/// 0.11 refuses a carry input that no carry cell drives. The first cell makes its carry from its remaining inputs, so its carry
/// input does not matter.
fn open_carries(netlist: &mut Value) {
    let modules = netlist["modules"].as_object_mut().into_iter().flatten();
    for (_, module) in modules {
        let Some(cells) = module["cells"].as_object_mut() else { continue };
        let mut grounds = BTreeSet::new();
        for cell in cells.values() {
            if cell["type"] == "VLO" {
                grounds.extend(cell["connections"]["Z"][0].as_u64());
            }
        }
        for cell in cells.values_mut() {
            let driver = cell["connections"]["CIN"][0].as_u64();
            let is_grounded = driver.is_some_and(|bit| grounds.contains(&bit));
            if cell["type"] == "CCU2"
                && is_grounded
                && let Some(connections) = cell["connections"].as_object_mut()
            {
                connections.remove("CIN");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_the_first_cell_of_a_chain_is_opened() {
        let first = json!({ "type": "CCU2", "connections": { "CIN": [5], "COUT": [7] } });
        let second = json!({ "type": "CCU2", "connections": { "CIN": [7], "COUT": [8] } });
        let ground = json!({ "type": "VLO", "connections": { "Z": [5] } });
        let cells = json!({ "first": first, "second": second, "ground": ground });
        let mut netlist = json!({ "modules": { "top": { "cells": cells } } });
        open_carries(&mut netlist);
        let cells = &netlist["modules"]["top"]["cells"];
        assert_eq!(cells["first"]["connections"], json!({ "COUT": [7] }));
        assert_eq!(cells["second"]["connections"], json!({ "CIN": [7], "COUT": [8] }));
    }
}

//! Reads the netlist of a core in its harness after synthesis, and maps the names of its nets, flip-flops and DSP blocks to the
//! description's names. A critical path then shows, for example, the net `second` instead of a generated name. For iCE40 and
//! ECP5, the module also checks that every DSP block has a form that the timing analysis knows.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use serde_json::{Map, Value};

use super::harness::{CORE, TOP};
use glint_rtl::netlist::{Design, Driver, Op};
use glint_show::figures::{PathPoint, rounded};

pub struct Netlist {
    /// The name in the description for each bit of a net in the synthesised netlist, such as `core.datapath.product[3]`.
    names: BTreeMap<String, String>,
    /// The name in the description of the net that each flip-flop or DSP block drives.
    registers: BTreeMap<String, String>,
    cells: Map<String, Value>,
}

impl Netlist {
    /// Parses a netlist that Yosys's command `write_json` has written.
    ///
    /// # Errors
    /// Fails if the JSON has no nets or cells of the harness.
    pub fn new(design: &Design, json: &Value) -> Result<Self> {
        let nets = part_of_top(json, "netnames")?;
        let cells = part_of_top(json, "cells")?;
        let known = known(design);
        // A bit has several names, most of them made by tools. The name with the lowest rank is taken.
        let mut best: BTreeMap<u64, (u8, &str)> = BTreeMap::new();
        for (name, net) in nets {
            let Some((rank, shown)) = known.get(own_name(name)) else {
                continue;
            };
            for bit in bits(net) {
                let entry = best.entry(bit).or_insert((*rank, shown));
                if *rank < entry.0 {
                    *entry = (*rank, shown);
                }
            }
        }
        let mut names = BTreeMap::new();
        for (name, net) in nets {
            let Some(all) = net["bits"].as_array() else { continue };
            let offset = net["offset"].as_u64().unwrap_or(0);
            for (at, bit) in all.iter().enumerate() {
                let Some((_, shown)) = bit.as_u64().and_then(|bit| best.get(&bit)) else {
                    continue;
                };
                let bit_name = match all.len() {
                    1 => name.clone(),
                    _ => format!("{name}[{}]", at as u64 + offset),
                };
                names.insert(bit_name, (*shown).to_owned());
            }
        }
        // The outputs of a flip-flop, and of a DSP block with a register at its output.
        let mut outputs = vec!["Q".to_owned()];
        for bit in 0..36 {
            outputs.push(format!("P{bit}"));
        }
        let mut registers = BTreeMap::new();
        for (name, cell) in cells {
            for pin in &outputs {
                let bit = cell["connections"][pin][0].as_u64();
                if let Some((_, shown)) = bit.and_then(|bit| best.get(&bit)) {
                    registers.insert(name.clone(), (*shown).to_owned());
                    break;
                }
            }
        }
        Ok(Self { names, registers, cells: cells.clone() })
    }

    /// Checks that timing analysis includes the delay of every DSP block, a cell of the kind `kind`. `timed` gets the name and a
    /// parameter's value, and returns whether the tool knows the delay of such a cell.
    ///
    /// # Errors
    /// Fails at the first parameter for which `timed` returns false. `why` gets a text such as `REG_INPUTA_CLK is CLK0`, and
    /// returns the message's end, which begins with "the DSP block" and the cell's name.
    pub fn check_timed(
        &self,
        kind: &str,
        timed: impl Fn(&str, &Value) -> bool,
        why: impl Fn(&str) -> String,
    ) -> Result<()> {
        for (name, cell) in &self.cells {
            if cell["type"] != kind {
                continue;
            }
            for (parameter, value) in cell["parameters"].as_object().into_iter().flatten() {
                if !timed(parameter, value) {
                    let is = format!("{parameter} is {}", value.as_str().unwrap_or_default());
                    bail!("the DSP block `{name}` {}", why(&is));
                }
            }
        }
        Ok(())
    }

    /// Returns the description's name of the net that the flip-flop or DSP block `cell` drives, or `None` if the net has no such
    /// name.
    pub fn register(&self, cell: &str) -> Option<&str> {
        self.registers.get(cell).map(String::as_str)
    }

    /// Returns the description's name of the net that contains the bit `net`, or `None` if it has no such name. For example, the
    /// bit `core.datapath.product[3]` may have the name `product`.
    pub fn name(&self, net: &str) -> Option<&str> {
        self.names.get(net).map(String::as_str)
    }
}

/// Returns the nets (`netnames`) or the `cells` of the harness.
fn part_of_top<'j>(json: &'j Value, name: &str) -> Result<&'j Map<String, Value>> {
    let part = json["modules"][TOP][name].as_object();
    part.with_context(|| format!("the netlist of `yosys` has no {name} of `{TOP}`"))
}

/// Returns a timing path's steps. `points` are pairs of a name and the arrival time in nanoseconds. Consecutive points with the
/// same name become one step, at the last time.
pub fn path(points: impl IntoIterator<Item = (String, f64)>) -> Vec<PathPoint> {
    let mut steps: Vec<PathPoint> = Vec::new();
    for (name, ns) in points {
        match steps.last_mut() {
            Some(last) if last.name == name => last.ns = rounded(ns),
            _ => steps.push(PathPoint { name, ns: rounded(ns) }),
        }
    }
    steps
}

/// Returns the nets of a design by name, each with a rank and the text to show. If a wire has several names, the name with the
/// lowest rank is shown. The order is: registers, ROMs, products, nets named by the author, remaining nets, and inputs. For
/// example, the text for the output of the ROM `coefficient` is `ROM coefficient`.
fn known(design: &Design) -> BTreeMap<&str, (u8, String)> {
    let mut known = BTreeMap::new();
    for net in &design.nets {
        let shown = match net.driver {
            Driver::Rom(rom) => (1, format!("ROM {}", design.rom(rom).name)),
            Driver::Register(_) => (0, net.name.clone()),
            Driver::Op(Op::Mul(..)) => (2, net.name.clone()),
            Driver::Input => (5, net.name.clone()),
            _ => (if net.named { 3 } else { 4 }, net.name.clone()),
        };
        known.insert(net.name.as_str(), shown);
    }
    known
}

/// Returns the name of a net in its module, without instances and the number of a bit. For example, `core.datapath.product[3]`
/// is `product`. A net outside the core gives an empty text.
fn own_name(name: &str) -> &str {
    let inside = name.strip_prefix(CORE).and_then(|rest| rest.strip_prefix('.')).unwrap_or("");
    let units = ["control.", "datapath."];
    let inside = units.iter().find_map(|unit| inside.strip_prefix(unit)).unwrap_or(inside);
    inside.split('[').next().unwrap_or(inside)
}

fn bits(net: &Value) -> impl Iterator<Item = u64> {
    let bits = net["bits"].as_array().into_iter().flatten();
    bits.filter_map(Value::as_u64)
}

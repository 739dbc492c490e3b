//! Writes files for the waveform viewers GTKWave and Surfer. With them, a viewer lists each port and each named net under its
//! module or pipeline stage. GTKWave also shows numbers with their binary points.

use std::fmt::Write;

use super::circuit::scopes;
use crate::netlist::{Design, Net};

/// Flags of a trace in GTKWave (`TR_…_B` in its `analyzer.h`). `BINARY` is right-justified binary, `UNSIGNED` and `SIGNED` are
/// decimal, `POINT` adds a binary point, and `TEXT` is a line of text without a value.
const BINARY: u32 = 1 << 3 | 1 << 5;
const UNSIGNED: u32 = 1 << 2 | 1 << 5;
const SIGNED: u32 = 1 << 10 | 1 << 5;
const POINT: u32 = 1 << 30;
const TEXT: u32 = 1 << 9;

/// Returns the scopes of a waveform by their full names; the first one has the ports.
fn shown(design: &Design) -> Vec<(String, Vec<&Net>)> {
    let ports = design.ports.iter().map(|port| design.net(port.net)).collect();
    let mut shown = vec![(design.name.clone(), ports)];
    for (scope, ids) in scopes(design) {
        let nets = ids.into_iter().map(|net| design.net(net)).collect();
        shown.push((format!("{}.{scope}", design.name), nets));
    }
    shown
}

/// Returns the save file for GTKWave: `gtkwave FILE.vcd FILE.gtkw`. For example, a net of the format `u1.20` gets the line
/// `[fpshift_count] 20`, which states its 20 fraction bits.
pub fn gtkwave(design: &Design) -> String {
    // With this zoom, a clock is about twenty pixels wide.
    let mut text = format!("*-17.000000 0\n@{BINARY:x}\n{}.clk\n", design.name);
    for (scope, nets) in shown(design) {
        let _ = writeln!(text, "@{TEXT:x}\n-{scope}");
        if scope.ends_with(".control") && design.pipeline.is_none() {
            let _ = writeln!(text, "@{BINARY:x}\n{scope}.microinstruction");
        }
        for net in nets {
            let format = net.format;
            let (kind, fraction) = match (format.width(), format.signed, format.frac) {
                (1, false, 0) => (BINARY, None),
                (_, signed, frac) => {
                    let point = Some(frac).filter(|&frac| frac > 0);
                    (if signed { SIGNED } else { UNSIGNED }, point)
                }
            };
            let flags = kind | if fraction.is_some() { POINT } else { 0 };
            let _ = writeln!(text, "@{flags:x}");
            if let Some(fraction) = fraction {
                let _ = writeln!(text, "[fpshift_count] {fraction}");
            }
            let range = match format.width() {
                1 => String::new(),
                width => format!("[{}:0]", width - 1),
            };
            let _ = writeln!(text, "{scope}.{}{range}", net.name);
        }
    }
    text
}

/// Returns the command file for Surfer: `surfer --command-file FILE.sucl FILE.vcd`. The file lists the ports, and then the nets
/// of each module or stage.
pub fn surfer(design: &Design) -> String {
    let mut text = format!("variable_add {}.clk\n", design.name);
    for (scope, nets) in shown(design) {
        let _ = writeln!(text, "divider_add {}", scope.rsplit('.').next().unwrap_or(&scope));
        if scope.ends_with(".control") && design.pipeline.is_none() {
            let _ = writeln!(text, "variable_add {scope}.microinstruction");
        }
        for net in nets {
            let _ = writeln!(text, "variable_add {scope}.{}", net.name);
        }
    }
    text + "zoom_fit\n"
}

//! The bench that sends a list of points through a pipeline: operands from a file, results to a file.

use anyhow::{Context, Result};
use askama::Template;

use super::points::{POINTS_FILE, PointsBench, RESULTS_FILE};
use crate::hdl::netlist::{Design, Port, Role};
use crate::hdl::verilog::rows::{Row, separated};
use crate::hdl::verilog::text::{Names, literal};

#[derive(Template)]
#[template(path = "points_pipeline.v")]
struct View {
    name: String,
    module: String,
    points_file: &'static str,
    results_file: &'static str,
    limit: u32,
    names: Variables,
    declarations: Vec<String>,
    connections: Vec<String>,
    reset: String,
    in_valid: String,
    valid: String,
    /// Inputs that never change, with their values.
    held: Vec<(String, String)>,
    operands: Vec<String>,
    results: Vec<String>,
    /// The format strings of a line.
    scan: String,
    print: String,
}

/// The bench's own names, none of which a port has.
struct Variables {
    points: String,
    results: String,
    read: String,
    clocks: String,
    offered: String,
    total: String,
    tick: String,
    dut: String,
}

/// The bench of a pipeline, whose last results come in less than `limit` clocks.
///
/// # Errors
/// A design without the handshake of a pipeline.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    let port_name = |port: &Port| design.net(port.net).name.clone();
    let of_role = |role: Role| {
        let port = design.port(|it| it == role);
        port.map(port_name).with_context(|| format!("`{}` is no pipeline", design.name))
    };
    let mut names = Names::new(design.ports.iter().map(|port| design.net(port.net).name.as_str()));
    names.fresh("clk");
    let declarations: Vec<_> = design
        .ports
        .iter()
        .map(|port| {
            let kind = if port.role.is_input() { "reg" } else { "wire" };
            // Bit patterns, whatever they denote: signed variables would be printed with a sign.
            Row::port("", kind, design.width(port.net), false, &port_name(port), "")
        })
        .collect();
    let held = design.inputs().filter_map(|port| match port.role {
        Role::OutReady => Some((port_name(port), "1'b1".to_owned())),
        Role::SideIn => Some((port_name(port), literal(0, design.width(port.net)))),
        _ => None,
    });
    let all = |role: Role| -> Vec<String> {
        design.ports.iter().filter(|port| port.role == role).map(port_name).collect()
    };
    let (operands, results) = (all(Role::Point), all(Role::Result));
    let line = |count: usize| vec!["%h"; count].join(" ");
    let name = format!("{}_points", design.name);
    let text = super::render(&View {
        name: name.clone(),
        module: design.name.clone(),
        points_file: POINTS_FILE,
        results_file: RESULTS_FILE,
        limit,
        names: Variables {
            points: names.fresh("points"),
            results: names.fresh("results"),
            read: names.fresh("read"),
            clocks: names.fresh("clocks"),
            offered: names.fresh("offered"),
            total: names.fresh("total"),
            tick: names.fresh("tick"),
            dut: names.fresh("dut"),
        },
        declarations: Row::declarations(&declarations),
        connections: separated(
            std::iter::once("clk".to_owned())
                .chain(design.ports.iter().map(port_name))
                .map(|name| format!(".{name}({name})"))
                .collect(),
        ),
        reset: of_role(Role::Reset)?,
        in_valid: of_role(Role::InValid)?,
        valid: of_role(Role::Valid)?,
        held: held.collect(),
        scan: line(operands.len()),
        print: line(results.len()),
        operands: operands.clone(),
        results: results.clone(),
    })?;
    Ok(PointsBench { name, text, operands, results })
}

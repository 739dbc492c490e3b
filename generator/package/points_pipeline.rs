//! The bench that sends a list of points through a pipeline: operands from a file, results to a file.

use anyhow::{Context, Result};
use askama::Template;

use super::points::{POINTS_FILE, PointsBench, RESULTS_FILE};
use crate::hdl::netlist::{Design, Port, Role};
use crate::hdl::verilog::rows::{connections, variables};
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

fresh_names!(Variables { points, results, read, clocks, offered, total, tick, dut });

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
    let mut names = Names::of_ports(design);
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
        names: Variables::new(&mut names),
        // Bit patterns, whatever they denote: signed variables would be printed with a sign.
        declarations: variables(design, false),
        connections: connections(design),
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

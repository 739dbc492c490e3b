//! The bench that computes a list of points: operands from a file, results to a file.

use anyhow::Result;
use askama::Template;

use crate::hdl::netlist::{Design, NetId, Port, Role};
use crate::hdl::verilog::rows::{connections, variables};
use crate::hdl::verilog::text::Names;

/// The file from which the bench reads, by default: a line for each computation, its operands in
/// hexadecimal in the order of [`PointsBench::operands`], with spaces between.
pub const POINTS_FILE: &str = "points.hex";

/// The file to which it writes, by default: a line for each result, its outputs likewise in the order of
/// [`PointsBench::results`], and a line with a dot after the last of each computation.
pub const RESULTS_FILE: &str = "results.hex";

/// A bench that reads operands from a file and writes results to another.
pub struct PointsBench {
    /// The module, which is also the name of its file without `.v`.
    pub name: String,
    /// The text.
    pub text: String,
    /// The operand ports in the order in which a line has them.
    pub operands: Vec<String>,
    /// The result ports in the order in which a line has them.
    pub results: Vec<String>,
}

#[derive(Template)]
#[template(path = "points.v")]
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
    start: String,
    busy: String,
    valid: String,
    operands: Vec<String>,
    strobes: Vec<String>,
    results: Vec<String>,
    /// The format strings of a line.
    scan: String,
    print: String,
}

fresh_names!(Variables { points, results, read, clocks, total, tick, dut });

/// The bench of a design with a microprogram, whose computations take less than `limit` clocks each.
///
/// # Errors
/// A design without the common handshake, or without operands or results.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    let port_name = |port: &Port| design.net(port.net).name.clone();
    let handshake = design.handshake()?;
    let name_of = |net: NetId| design.net(net).name.clone();
    let mut names = Names::of_ports(design);
    let mut operands = Vec::new();
    let mut strobes = Vec::new();
    for port in design.inputs() {
        if let Role::Operand { strobe } = port.role {
            operands.push(port_name(port));
            strobes.push(design.net(strobe).name.clone());
        }
    }
    let results: Vec<String> =
        design.outputs().filter(|port| port.role == Role::Result).map(port_name).collect();
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
        reset: name_of(handshake.reset),
        start: name_of(handshake.start),
        busy: name_of(handshake.busy),
        valid: name_of(handshake.valid),
        scan: line(operands.len()),
        print: line(results.len()),
        operands: operands.clone(),
        strobes,
        results: results.clone(),
    })?;
    Ok(PointsBench { name, text, operands, results })
}

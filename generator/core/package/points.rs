//! Generates a Verilog test bench that computes a list of points with a sequential core.
//!
//! The bench reads the operands of each point from one file and writes the results to another. `glint render --through
//! verilator` computes pictures with it.

pub(super) mod pipeline;

use anyhow::Result;
use glint_base::fill;

use glint_rtl::netlist::{Design, NetId, Role};
use glint_rtl::verilog::rows::{connections, variables};
use glint_rtl::verilog::text::Names;

/// The default name of the operand file. The file has a line for each computation: the operands in hexadecimal, in the order of
/// [`PointsBench::operands`], with spaces between.
pub const POINTS_FILE: &str = "points.hex";

/// The default name of the result file. The file has a line for each result: the outputs in hexadecimal, in the order of
/// [`PointsBench::results`]. A line with a dot follows the last result of each computation.
pub const RESULTS_FILE: &str = "results.hex";

/// A test bench that reads operands from a file and writes results to another file.
pub struct PointsBench {
    /// The name of the module, and of its file without `.v`.
    pub name: String,
    pub text: String,
    /// The operand ports, in the order of the values on a line of the operand file.
    pub operands: Vec<String>,
    /// The result ports, in the order of the values on a line of the result file.
    pub results: Vec<String>,
}

/// The common data of the benches for a pipeline and for a sequential core.
struct PointList {
    name: String,
    module: String,
    points_file: &'static str,
    results_file: &'static str,
    limit: u32,
    declarations: Vec<String>,
    connections: Vec<String>,
    reset: String,
    valid: String,
    operands: Vec<String>,
    results: Vec<String>,
    /// The format strings that read a line of operands and print a line of results.
    scan: String,
    print: String,
}

impl PointList {
    /// A port is an operand if `is_operand` returns true for its role. The last parameter has the nets of the reset and of
    /// `valid`.
    fn new(
        design: &Design,
        limit: u32,
        is_operand: impl Fn(Role) -> bool,
        [reset, valid]: [NetId; 2],
    ) -> Self {
        let name_of = |net: NetId| design.net(net).name.clone();
        let (mut operands, mut results) = (Vec::new(), Vec::new());
        for port in &design.ports {
            if is_operand(port.role) {
                operands.push(name_of(port.net));
            }
            if port.role == Role::Result {
                results.push(name_of(port.net));
            }
        }
        Self {
            name: format!("{}_points", design.name),
            module: design.name.clone(),
            points_file: POINTS_FILE,
            results_file: RESULTS_FILE,
            limit,
            // Bit patterns, whatever they denote: signed variables would be printed with a sign.
            declarations: variables(design, false),
            connections: connections(design),
            reset: name_of(reset),
            valid: name_of(valid),
            scan: vec!["%h"; operands.len()].join(" "),
            print: vec!["%h"; results.len()].join(" "),
            operands,
            results,
        }
    }

    fn bench(self, text: String) -> PointsBench {
        PointsBench { name: self.name, text, operands: self.operands, results: self.results }
    }
}

fresh_names!(Variables { points, results, read, clocks, total, tick, dut });

/// Returns the bench for a sequential core. The simulation ends with `FAIL` if a computation takes `limit` clocks
/// or more.
///
/// # Errors
/// Fails if the design lacks a port of the handshake `rst_n`, `start`, `busy`, `valid`, `done`, or if the template fails.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    let handshake = design.handshake()?;
    let name_of = |net: NetId| design.net(net).name.clone();
    let is_operand = |role| matches!(role, Role::Operand { .. });
    let list = PointList::new(design, limit, is_operand, [handshake.reset, handshake.valid]);
    let mut strobes = Vec::new();
    for port in design.inputs() {
        if let Role::Operand { strobe } = port.role {
            strobes.push(name_of(strobe));
        }
    }
    let text = fill!("points.v" {
        list: &'a PointList = &list,
        names: Variables = Variables::new(&mut Names::of_ports(design)),
        start: String = name_of(handshake.start),
        busy: String = name_of(handshake.busy),
        strobes: Vec<String>,
    })?;
    Ok(list.bench(text))
}

//! Generates a Verilog test bench that sends the points of a file through a pipeline, and writes the results to another file.

use anyhow::{Context, Result};
use glint_base::fill;

use super::{PointList, PointsBench};
use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::text::{Names, literal};

fresh_names!(Variables { points, results, read, clocks, offered, total, tick, dut });

/// Returns the bench. The simulation ends with `FAIL` if the last results do not come within `limit` clocks after the last
/// point.
///
/// # Errors
/// Fails if the design lacks the reset, `in_valid` or `out_valid`, which every pipeline has, or if the template fails.
pub fn points_bench(design: &Design, limit: u32) -> Result<PointsBench> {
    let port_name = |port: &Port| design.net(port.net).name.clone();
    let of_role = |role: Role| {
        let port = design.port(|it| it == role);
        port.with_context(|| format!("`{}` is not a pipeline", design.name))
    };
    let mut held = Vec::new();
    for port in design.inputs() {
        match port.role {
            Role::OutReady => held.push((port_name(port), "1'b1".to_owned())),
            Role::SideIn => held.push((port_name(port), literal(0, design.width(port.net)))),
            _ => {}
        }
    }
    let ends = [of_role(Role::Reset)?.net, of_role(Role::Valid)?.net];
    let list = PointList::new(design, limit, |role| role == Role::Point, ends);
    let names = Variables::new(&mut Names::of_ports(design));
    // A pipeline that accepts a point only every few clocks shows with `in_ready` when it does.
    let slots = design.pipeline.as_ref().is_some_and(|it| it.interval > 1);
    let ready = design.port(|it| it == Role::InReady).filter(|_| slots);
    let text = fill!("points_pipeline.v" {
        list: &'a PointList = &list,
        every: &'a str = if slots { "whenever in_ready is high" } else { "every clock" },
        taken: String = ready.map_or(String::new(), |it| format!(" && {}", port_name(it))),
        waits: String = match slots {
            true => format!("if ({} != {}) ", names.read, list.operands.len()),
            false => String::new(),
        },
        names: Variables,
        in_valid: String = port_name(of_role(Role::InValid)?),
        // Inputs that never change, with their values.
        held: Vec<(String, String)>,
    })?;
    Ok(list.bench(text))
}

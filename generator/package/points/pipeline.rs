//! The bench that sends a list of points through a pipeline: operands from a file, results to a file.

use anyhow::{Context, Result};
use askama::Template;

use super::{List, PointsBench};
use crate::hdl::netlist::{Design, Port, Role};
use crate::hdl::verilog::text::{Names, literal};

#[derive(Template)]
#[template(path = "points_pipeline.v")]
struct View<'a> {
    list: &'a List,
    names: Variables,
    in_valid: String,
    /// Inputs that never change, with their values.
    held: Vec<(String, String)>,
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
        port.with_context(|| format!("`{}` is no pipeline", design.name))
    };
    let held = design.inputs().filter_map(|port| match port.role {
        Role::OutReady => Some((port_name(port), "1'b1".to_owned())),
        Role::SideIn => Some((port_name(port), literal(0, design.width(port.net)))),
        _ => None,
    });
    let ends = [of_role(Role::Reset)?.net, of_role(Role::Valid)?.net];
    let list = List::new(design, limit, |role| role == Role::Point, ends);
    let text = crate::package::render(&View {
        list: &list,
        names: Variables::new(&mut Names::of_ports(design)),
        in_valid: port_name(of_role(Role::InValid)?),
        held: held.collect(),
    })?;
    Ok(list.bench(text))
}

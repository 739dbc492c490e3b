//! Properties of the emitted Verilog of a pipeline, proved by k-induction.
//!
//! A wrapper holds a queue beside the pipeline, and states that its stages have points exactly where the
//! queue has them. With a side channel it follows any one point, and states that its side value stays
//! with it. No property depends on a product or a ROM, which are cut out.

use anyhow::Result;
use askama::Template;

use super::formal::{Script, Sources, inputs_of, outputs_of};
use crate::hdl::netlist::{Design, NetId, Pipeline, Role};
use crate::hdl::verilog::naming::Naming;
use crate::hdl::verilog::rows::{connections, separated};
use crate::hdl::verilog::text::{Names, literal, range};

/// Steps of the induction: every property follows from the clock before.
const DEPTH: u32 = 2;

#[derive(Template)]
#[template(path = "pipeline_formal.sv")]
struct Wrapper {
    name: String,
    module: String,
    depth: u32,
    instance: String,
    /// Ports with their commas.
    ports: Vec<String>,
    outputs: Vec<String>,
    connections: Vec<String>,
    /// The declarations of the proof's view of the inside.
    inside: Vec<String>,
    stages: usize,
    /// One bit a stage, under its path.
    valid: String,
    stall: bool,
    moves_when: &'static str,
    /// No point in any stage.
    empty: String,
    results: Vec<String>,
    /// Names of the wrapper.
    present: String,
    moves: String,
    queue: String,
    queue_next: String,
    chosen: String,
    begins: String,
    followed: String,
    followed_next: String,
    side: Option<Side>,
}

/// The side channel.
struct Side {
    range: String,
    tag: String,
    stages: Vec<SideStage>,
}

/// The side value of a stage.
struct SideStage {
    number: usize,
    value: String,
}

/// Wrapper and scripts, as names and texts.
///
/// # Errors
/// A template that fails.
pub fn files(
    design: &Design,
    pipeline: &Pipeline,
    sources: Sources<'_>,
) -> Result<Vec<(String, String)>> {
    let module = &design.name;
    let name = format!("{module}_formal");
    let port_name = |net: NetId| design.net(net).name.clone();
    let mut names = Names::of_ports(design);
    let instance = names.fresh("dut");
    let chosen = names.fresh("chosen");
    let mut ports = inputs_of(design);
    if pipeline.side > 0 {
        ports.push(format!("input  wire {chosen}"));
    }
    // A net of the inside under its path; Yosys joins the two when it flattens.
    let mut inside = Vec::new();
    let mut seen = |name: &str, range: &str| {
        let path = format!("\\{instance}.{name} ");
        let space = if range.is_empty() { "" } else { " " };
        inside.push(format!("(* hierconn *) wire {range}{space}{path};"));
        path
    };
    let latency = pipeline.stages.len();
    let valid = seen(&Naming::new(design).valid, &format!("[{latency}:1]"));
    let side = (pipeline.side > 0).then(|| Side {
        range: range(pipeline.side),
        tag: names.fresh("tag"),
        stages: (1..)
            .zip(&pipeline.side_values)
            .map(|(number, &net)| {
                let value = seen(&port_name(net), &range(design.width(net)));
                SideStage { number, value }
            })
            .collect(),
    });
    let (queue, followed, begins) =
        (names.fresh("queue"), names.fresh("followed"), names.fresh("begins"));
    let shifted = |register: &str, first: &str| match latency {
        1 => first.to_owned(),
        _ => format!("{{{register}[{}:1], {first}}}", latency - 1),
    };
    let result = |role: Role| matches!(role, Role::Result | Role::Status | Role::SideOut);
    let results = design.outputs().filter(|port| result(port.role));
    let wrapper = Wrapper {
        name: name.clone(),
        module: module.clone(),
        depth: DEPTH,
        instance: instance.clone(),
        ports: separated(ports),
        outputs: outputs_of(design),
        connections: connections(design),
        stages: latency,
        valid,
        stall: pipeline.stall,
        moves_when: if pipeline.stall { "out_ready | ~out_valid" } else { "1'b1" },
        empty: literal(0, latency as u32),
        results: results.map(|port| port_name(port.net)).collect(),
        present: names.fresh("present"),
        moves: names.fresh("moves"),
        queue_next: shifted(&queue, "in_valid"),
        followed_next: shifted(&followed, &begins),
        queue,
        chosen,
        begins,
        followed,
        side,
        inside,
    };
    let within = format!("{instance}.*");
    let script = Script { name: &name, within: &within, rtl: sources.rtl, initial: false };
    script.files(&wrapper, DEPTH, "smtbmc --unroll z3", sources.memories)
}

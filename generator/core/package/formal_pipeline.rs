//! Generates formal properties of a pipeline, which Yosys and an SMT solver prove by k-induction.
//!
//! The generated wrapper has a reference queue, which moves points from stage to stage as the pipeline should. The proof shows
//! that the pipeline holds points in exactly the same stages as the queue. If the pipeline has a side channel, the wrapper
//! also follows one arbitrary point, and asserts that its side value arrives with it. Multipliers and ROMs are replaced by
//! free values, since no property depends on them.

use anyhow::Result;
use glint_base::fill;

use super::emit_job::EmitJob;
use super::formal::{Script, inputs_of, outputs_of};
use super::output_files::OutputFiles;
use glint_rtl::netlist::{NetId, Pipeline, Role, TABLE_LOAD};
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::rows::{connections, separated};
use glint_rtl::verilog::text::{Names, literal, range};

/// The depth of the induction, in clocks. Every property follows from the state one clock earlier.
const DEPTH: u32 = 2;

/// The side channel: bits that enter with a point and leave with its results. `tag` is the wrapper's register with the side
/// value of the followed point, and `stages` has the side value of each stage.
struct SideChannel {
    range: String,
    tag: String,
    stages: Vec<SideStage>,
}

/// Two counters from 0 to k − 1 of a pipeline that accepts a point every k clocks. `slot` is the path of the pipeline's own
/// counter. `name` is the wrapper's counter, and `next` the expression of its next value. The proof shows that the two counters
/// are equal.
struct Turn {
    range: String,
    name: String,
    next: String,
    slot: String,
}

/// The number of a stage, and the net with its side value.
struct SideStage {
    number: usize,
    value: String,
}

pub fn files(job: &EmitJob, pipeline: &Pipeline, files: &mut OutputFiles) -> Result<()> {
    let (module, design) = (job.name(), job.design);
    let name = format!("{module}_formal");
    let port_name = |net: NetId| design.net(net).name.clone();
    let mut names = Names::of_ports(design);
    let instance = names.fresh("dut");
    let chosen = names.fresh("chosen");
    let mut ports = inputs_of(design);
    if pipeline.side > 0 {
        ports.push(format!("input  wire {chosen}"));
    }
    // Declares an inner net of the core by its path, and returns the path.
    let mut inside = Vec::new();
    let mut seen = |name: &str, range: &str| {
        let path = format!("\\{instance}.{name} ");
        let space = if range.is_empty() { "" } else { " " };
        inside.push(format!("(* hierconn *) wire {range}{space}{path};"));
        path
    };
    let latency = pipeline.stages.len();
    let valid = seen(&Naming::new(design).valid, &format!("[{latency}:1]"));
    let turn = pipeline.slot.map(|net| {
        let (bits, name) = (range(design.width(net)), names.fresh("turn"));
        let range = if bits.is_empty() { bits } else { format!("{bits} ") };
        let slot = seen(&port_name(net), range.trim_end());
        let next = format!("({name} == {}) ? 0 : {name} + 1", pipeline.interval - 1);
        Turn { range, next, slot, name }
    });
    // The expression that is 1 if a point is offered in a clock in which the pipeline may accept one.
    let offered = match &turn {
        Some(turn) => format!("(in_valid & ({} == 0))", turn.name),
        None => "in_valid".to_owned(),
    };
    let side = (pipeline.side > 0).then(|| SideChannel {
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
    let table_load = design.find(TABLE_LOAD).map(|_| seen(TABLE_LOAD, ""));
    let (queue, followed, begins) =
        (names.fresh("queue"), names.fresh("followed"), names.fresh("begins"));
    let shifted = |register: &str, first: &str| match latency {
        1 => first.to_owned(),
        _ => format!("{{{register}[{}:1], {first}}}", latency - 1),
    };
    let results = design
        .outputs()
        .filter(|port| matches!(port.role, Role::Result | Role::Status | Role::SideOut));
    let within = format!("{instance}.*");
    let wrapper = fill!("pipeline_formal.sv" {
        name: &'a str = &name,
        module: &'a str,
        depth: u32 = DEPTH,
        instance: String,
        ports: Vec<String> = separated(ports),
        outputs: Vec<String> = outputs_of(design),
        connections: Vec<String> = connections(design),
        inside: Vec<String>,
        table_load: Option<String>,
        stages: usize = latency,
        // The net that has one bit for each stage: whether the stage holds a point.
        valid: String,
        stall: bool = pipeline.stall,
        moves_when: &'a str = if pipeline.stall { "out_ready | ~out_valid" } else { "1'b1" },
        empty: String = literal(0, latency as u32),
        results: Vec<String> = results.map(|port| port_name(port.net)).collect(),
        present: String = names.fresh("present"),
        moves: String = names.fresh("moves"),
        queue_next: String = shifted(&queue, &offered),
        offered: String,
        turn: Option<Turn>,
        followed_next: String = shifted(&followed, &begins),
        queue: String,
        chosen: String,
        begins: String,
        followed: String,
        side: Option<SideChannel>,
    })?;
    let script = Script { name: &name, within: &within, initial: false };
    script.files(wrapper, DEPTH, "smtbmc --unroll z3", files)
}

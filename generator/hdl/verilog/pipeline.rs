//! The module of a pipeline: the handshake, then a section for every stage.

use super::delays;
use super::header::{self, Origin};
use super::interface::Interface;
use super::module::{Builder, parameters};
use super::naming::Naming;
use super::plan::Plan;
use super::text::{ascii, comment};
use super::view::{PipelineModule, StageSection};
use crate::hdl::netlist::{Driver, NetId, Partition, Pipeline};

/// The module.
pub fn module(
    plan: &Plan,
    naming: &Naming,
    pipeline: &Pipeline,
    origin: &Origin,
) -> PipelineModule {
    let design = plan.design;
    let interface = Interface::new(plan, Partition::Datapath);
    let mut builder = Builder::new(plan, naming, &interface, Partition::Datapath);
    let flow = |net: NetId| pipeline.handshake.contains(&net);
    let clocked = |net: NetId| match design.net(net).driver {
        Driver::Register(_) => true,
        Driver::Rom(rom) => design.rom(rom).synchronous,
        _ => false,
    };
    // What the clock changes stands in the stage that makes it.
    let section = |net: NetId| pipeline.stage_of[net.index()] - usize::from(clocked(net));
    let mut stages = vec![StageSection {
        title: comment(4, "The handshake: which stage has a point, and when all of them move on"),
        registers: builder.state(&flow),
        items: builder.items(&flow),
        groups: builder.groups(&flow),
    }];
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let here = |net: NetId| !flow(net) && section(net) == number;
        stages.push(StageSection {
            title: title(number, &stage.microinstructions),
            registers: builder.state(&here),
            items: builder.items(&here),
            groups: builder.groups(&here),
        });
    }
    stages.extend(delays::section(&mut builder));
    let results = |net: NetId| !flow(net) && section(net) == pipeline.stages.len();
    stages.push(StageSection {
        title: comment(4, "Results"),
        registers: Vec::new(),
        items: builder.items(&results),
        groups: Vec::new(),
    });
    PipelineModule {
        header: header::top(design, origin),
        name: design.name.clone(),
        parameters: parameters(naming, &interface.roms),
        ports: builder.ports(),
        constants: builder.constants(),
        stages,
        unused: builder.unused(),
    }
}

/// `Stage 3, part of: accumulator <- base^2`.
fn title(number: usize, microinstructions: &[String]) -> Vec<String> {
    let what = match microinstructions {
        [] => ": values on their way".to_owned(),
        some => format!(", part of: {}", some.join("; ")),
    };
    comment(4, &ascii(&format!("Stage {number}{what}")))
}

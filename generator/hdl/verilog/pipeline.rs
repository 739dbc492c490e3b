//! The module of a pipeline: the handshake, then a section for every stage.

use super::delays;
use super::header::{self, Origin};
use super::interface::Interface;
use super::module::{Builder, parameters};
use super::naming::Naming;
use super::plan::Plan;
use super::rows::Row;
use super::text::{ascii, comment, literal};
use super::writer;
use crate::netlist::{Design, Driver, NetId, Partition, Pipeline, Role};

/// The module of delay lines, under the name `delay`.
const DELAY: &str = include_str!("delay.v");

/// Returns the text of the module, and of that of its delay lines.
pub fn module(plan: &Plan, naming: &Naming, pipeline: &Pipeline, origin: &Origin) -> String {
    let design = plan.design;
    let interface = Interface::new(plan, Partition::Datapath);
    let mut builder = Builder::new(plan, naming, &interface, Partition::Datapath);
    let clocked = |net: NetId| match design.net(net).driver {
        Driver::Register(_) => true,
        Driver::Rom(rom) => design.rom(rom).synchronous,
        _ => false,
    };
    let is_word = |net: NetId| matches!(design.net(net).driver, Driver::Rom(_));
    // What the clock changes stands in the stage that makes it.
    let section = |net: NetId| pipeline.clock_of(net) - usize::from(clocked(net));
    let enable = enable(design, pipeline);
    let here =
        |net: NetId, number: usize| !pipeline.handshake.contains(&net) && section(net) == number;
    let mut stages = handshake(plan, naming, pipeline);
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let here = |net: NetId| here(net, number);
        stages.push(String::new());
        stages.extend(title(number, &stage.microinstructions));
        stages.extend(Row::declarations(&builder.state(&|net| here(net) && is_word(net))));
        stages.extend(builder.items(&here).concat());
        let registers = Row::together(builder.state(&|net| here(net) && !is_word(net)));
        stages.extend(Row::declarations(&registers));
        stages.extend(builder.stage(enable, &here));
    }
    stages.extend(delays::section(&mut builder, naming));
    let results = builder.items(&|net| here(net, pipeline.stages.len())).concat();
    stages.extend(writer::section("Results", results));
    let delay = match plan.delays.is_empty() {
        true => String::new(),
        false => DELAY.replace("module delay", &format!("module {}", naming.delay())),
    };
    writer::module(
        header::top(design, origin),
        &design.name,
        &parameters(naming, &interface.roms),
        builder.ports(),
        [writer::section("Constants", builder.constants()), stages, builder.unused()].concat(),
        &delay,
    )
}

/// Returns the valid bits of the stages and their enables: a shift register in place of the bits of the netlist.
fn handshake(plan: &Plan, naming: &Naming, pipeline: &Pipeline) -> Vec<String> {
    let design = plan.design;
    let port = |role: Role| {
        let port = design.port(|it| it == role);
        port.map(|it| design.net(it.net).name.as_str())
    };
    let [offered, shown, reset] =
        [Role::InValid, Role::Valid, Role::Reset].map(|role| port(role).unwrap_or_default());
    let (valid, last) = (&naming.valid, pipeline.stages.len());
    let next = match last {
        1 => offered.to_owned(),
        2 => format!("{{{valid}[1], {offered}}}"),
        _ => format!("{{{valid}[{}:1], {offered}}}", last - 1),
    };
    let mut lines =
        vec![format!("reg  [{last}:1] {valid};"), format!("assign {shown} = {valid}[{last}];")];
    let enable = enable(design, pipeline);
    if let (Some(enable), Some(ready), Some(taken)) =
        (enable, port(Role::OutReady), port(Role::InReady))
    {
        let advance = &design.net(enable).name;
        lines.push(format!("wire {advance} = {ready} | ~{valid}[{last}];"));
        lines.push(format!("assign {taken} = {advance};"));
    }
    let when = enable.map_or(String::new(), |it| format!("if ({}) ", design.net(it).name));
    lines.push("always @(posedge clk) begin".to_owned());
    lines.push(format!("    if (!{reset}) {valid} <= {};", literal(0, last as u32)));
    lines.push(format!("    else {when}{valid} <= {next};"));
    lines.push("end".to_owned());
    writer::section(
        "The handshake: a bit for each stage that has a point; all points move on together",
        lines.into_iter().map(|line| format!("    {line}")).collect(),
    )
}

/// When all points move on; none if they always do.
fn enable(design: &Design, pipeline: &Pipeline) -> Option<NetId> {
    design.registers.iter().find(|it| pipeline.valid.contains(&it.q))?.enable
}

/// `Stage 3, part of: accumulator <- base^2`.
fn title(number: usize, microinstructions: &[String]) -> Vec<String> {
    let what = match microinstructions {
        [] => ": values on their way".to_owned(),
        some => format!(", part of: {}", some.join("; ")),
    };
    comment(4, &ascii(&format!("Stage {number}{what}")))
}

//! Writes the module of a pipeline: the handshake, then a section for every stage.

use super::delays;
use super::header::{self, Origin};
use super::interface::Interface;
use super::module::{Builder, parameters};
use super::naming::Naming;
use super::plan::Plan;
use super::rows::Row;
use super::text::{ascii, comment, literal, range};
use super::writer;
use crate::netlist::{Design, Driver, NetId, Partition, Pipeline, Role, Unit};

/// The module of delay lines, under the name `delay`.
const DELAY: &str = include_str!("delay.v");

/// Returns the Verilog of a pipelined core: its module, and the module of its delay lines.
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
    // A net that changes at the clock belongs to the stage that computes it.
    let section = |net: NetId| pipeline.clock_of(net) - usize::from(clocked(net));
    let shared = |net: NetId| pipeline.is_shared(net);
    let here = |net: NetId, number: usize| {
        !pipeline.handshake.contains(&net) && !shared(net) && section(net) == number
    };
    let mut stages = handshake(plan, naming, pipeline);
    // Stages read the register behind a multiplier before the logic in front of it is written.
    let behind = |net: NetId| pipeline.units.iter().any(|unit| unit.nets.last() == Some(&net));
    stages.extend(Row::declarations(&builder.state(&behind)));
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let here = |net: NetId| here(net, number);
        let mut lines = Row::declarations(&builder.state(&|net| here(net) && is_word(net)));
        lines.extend(builder.items(&here).concat());
        let registers = Row::together(builder.state(&|net| here(net) && !is_word(net)));
        lines.extend(Row::declarations(&registers));
        lines.extend(builder.stage(&here));
        // In some stages shared multipliers alone work, or values are on their way in memories.
        if !lines.is_empty() {
            stages.push(String::new());
            stages.extend(title(number, &stage.microinstructions));
            stages.extend(lines);
        }
    }
    stages.extend(delays::section(&mut builder, naming));
    let results = builder.items(&|net| here(net, pipeline.stages.len())).concat();
    stages.extend(writer::section("Results", results));
    for unit in &pipeline.units {
        let here = |net: NetId| unit.nets.contains(&net);
        let mut lines = reservations(unit);
        lines.extend(Row::declarations(&builder.state(&|net| here(net) && !behind(net))));
        lines.extend(builder.items(&here).concat());
        lines.extend(builder.stage(&here));
        stages.push(String::new());
        stages.extend(lines);
    }
    let delay = match plan.delays.is_empty() {
        true => String::new(),
        false => DELAY.replace("module delay", &format!("module {}", naming.delay())),
    };
    let (header, parameters) = (header::top(design, origin), parameters(naming, &interface.roms));
    let constants = writer::section("Constants", builder.constants());
    let body = [constants, stages, builder.unused()].concat();
    writer::module(header, &design.name, &parameters, builder.ports(), body, &delay)
}

/// Writes `multiplier_1: in slots 0, 1, 2, 3 it takes the factors of base, -, red_product, green_product`: a slot before it
/// computes them.
fn reservations(unit: &Unit) -> Vec<String> {
    let slots = unit.serves.len();
    let numbers: Vec<String> = (0..slots).map(|slot| slot.to_string()).collect();
    let taken = (1..=slots).map(|slot| unit.serves[slot % slots].as_deref().unwrap_or("-"));
    let taken: Vec<&str> = taken.collect();
    let (slots, taken) = (numbers.join(", "), taken.join(", "));
    let text = format!("{}: in slots {slots} it takes the factors of {taken}", unit.name);
    comment(4, &ascii(&text))
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
    let slot = pipeline.slot.map(|slot| (&design.net(slot).name, design.width(slot)));
    // The condition of a slot; `None` if there is one slot.
    let in_slot = |number: usize| {
        slot.map(|(name, bits)| format!("({name} == {})", literal(number as u64, bits)))
    };
    let offered = match in_slot(0) {
        Some(first) => format!("{offered} & {first}"),
        None => offered.to_owned(),
    };
    let next = match last {
        1 => offered,
        2 => format!("{{{valid}[1], {offered}}}"),
        _ => format!("{{{valid}[{}:1], {offered}}}", last - 1),
    };
    let mut lines =
        vec![format!("reg  [{last}:1] {valid};"), format!("assign {shown} = {valid}[{last}];")];
    if let Some((name, bits)) = slot {
        let bits = if bits == 1 { String::new() } else { format!("{} ", range(bits)) };
        lines.insert(1, format!("reg  {bits}{name};"));
    }
    let enable = enable(design, pipeline).map(|it| &design.net(it).name);
    if let (Some(advance), Some(ready)) = (enable, port(Role::OutReady)) {
        lines.push(format!("wire {advance} = {ready} | ~{valid}[{last}];"));
    }
    if let Some(taken) = port(Role::InReady) {
        let when = enable.cloned().into_iter().chain(in_slot(0)).collect::<Vec<_>>().join(" & ");
        lines.push(format!("assign {taken} = {when};"));
    }
    let when = enable.map_or(String::new(), |it| format!("if ({it}) "));
    let empty = literal(0, last as u32);
    lines.push("always @(posedge clk) begin".to_owned());
    match slot {
        None => {
            lines.push(format!("    if (!{reset}) {valid} <= {empty};"));
            lines.push(format!("    else {when}{valid} <= {next};"));
        }
        Some((slot, bits)) => {
            let [begin, one] = [0, 1].map(|number| literal(number, bits));
            let end =
                in_slot(pipeline.interval - 1).filter(|_| !pipeline.interval.is_power_of_two());
            let after = match end {
                Some(end) => format!("{end} ? {begin} : {slot} + {one}"),
                None => format!("{slot} + {one}"),
            };
            lines.push(format!("    if (!{reset}) begin"));
            lines.extend([
                format!("        {valid} <= {empty};"),
                format!("        {slot} <= {begin};"),
            ]);
            lines.push(format!("    end else {when}begin"));
            lines.extend([
                format!("        {valid} <= {next};"),
                format!("        {slot} <= {after};"),
            ]);
            lines.push("    end".to_owned());
        }
    }
    lines.push("end".to_owned());
    for (&number, &load) in &pipeline.loads {
        let (name, here) = (&design.net(load).name, in_slot(number).unwrap_or_default());
        let when = enable.map_or(String::new(), |it| format!("{it} & "));
        lines.push(format!("wire {name} = {when}{here};"));
    }
    writer::section(
        match pipeline.slot {
            None => {
                "The handshake: a bit for each stage that has a point; all points move on together"
            }
            Some(_) => {
                "The handshake: a bit for each stage that has a point; all points move on together, and the slot with them"
            }
        },
        lines.into_iter().map(|line| format!("    {line}")).collect(),
    )
}

/// Returns the net that says when all points move on; `None` if they always do.
fn enable(design: &Design, pipeline: &Pipeline) -> Option<NetId> {
    design.registers.iter().find(|it| pipeline.valid.contains(&it.q))?.enable
}

/// Writes `Stage 3, of the microinstructions accumulator <- base^2`.
fn title(number: usize, microinstructions: &[String]) -> Vec<String> {
    let what = match microinstructions {
        [] => ": values on their way".to_owned(),
        some => format!(", of the microinstructions {}", some.join("; ")),
    };
    comment(4, &ascii(&format!("Stage {number}{what}")))
}

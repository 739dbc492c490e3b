//! Writes the Verilog module of a pipeline: its handshake, and a section for each stage.

use super::delays;
use super::header::{self, Origin};
use super::interface::Interface;
use super::module::{Builder, parameters};
use super::naming::Naming;
use super::plan::Plan;
use super::rows::Row;
use super::text::{ascii, comment, literal, range};
use super::writer;
use crate::netlist::{Design, Driver, NetId, Partition, Pipeline, Role, TABLE_LOAD, Unit};

/// The module of delay lines, under the name `delay`.
const DELAY: &str = include_str!("delay.v");

const DELAY_COMMENT: &str = "Delays a value by WORDS + 1 enabled clocks. The memory is a circular buffer: each enabled clock \
                             reads the oldest word, replaces it by the new value, and advances slot to the next word.";

/// Returns the file with the module of the delay lines; `pipeline` is the pipeline's module.
pub fn delay_module(pipeline: &str, naming: &Naming, origin: &Origin) -> String {
    let name = naming.delay();
    let mut lines = comment(0, &format!("{name}: delay line of {pipeline}"));
    lines.push("//".to_owned());
    lines.extend(comment(0, DELAY_COMMENT));
    lines.extend(header::regenerated(origin));
    let module = DELAY.replace("module delay", &format!("module {name}"));
    format!(
        "{}\n\n`default_nettype none\n\n{}\n\n`default_nettype wire\n",
        lines.join("\n"),
        module.trim_end()
    )
}

pub fn module(plan: &Plan, naming: &Naming, pipeline: &Pipeline, origin: &Origin) -> String {
    let design = plan.design;
    let interface = Interface::new(plan, Partition::Datapath);
    let mut builder = Builder::new(plan, naming, &interface, Partition::Datapath);
    let is_word = |net: NetId| matches!(design.net(net).driver, Driver::Rom(_));
    let mut stages = handshake(plan, naming, pipeline);
    // Stages read the register behind a shared multiplier before its section is written, so it is declared first.
    let behind = |net: NetId| pipeline.units.iter().any(|unit| unit.nets.last() == Some(&net));
    stages.extend(Row::declarations(&builder.state(&behind)));
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let here = |net: NetId| is_written_in(design, pipeline, net, number);
        let mut lines = Row::declarations(&builder.state(&|net| here(net) && is_word(net)));
        lines.extend(builder.items(&here).concat());
        let registers = Row::together(builder.state(&|net| here(net) && !is_word(net)));
        lines.extend(Row::declarations(&registers));
        lines.extend(builder.stage(&here));
        // For example, only shared multipliers work in the stage, or all its values are in memories.
        if !lines.is_empty() {
            stages.push(String::new());
            stages.extend(title(number, &stage.microinstructions));
            stages.extend(lines);
        }
    }
    stages.extend(delays::section(&mut builder, naming));
    let last = pipeline.stages.len();
    let results = builder.items(&|net| is_written_in(design, pipeline, net, last)).concat();
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
    let (header, parameters) = (header::top(design, origin), parameters(naming, &interface.roms));
    let constants = writer::section("Constants", builder.constants());
    let body = [constants, stages, builder.unused()].concat();
    writer::module(header, &design.name, &parameters, builder.ports(), body)
}

/// Returns whether the section of a stage contains a net. A register or a synchronous ROM belongs to the stage that computes its
/// value. Nets of the handshake and of shared multipliers are in no stage's section.
fn is_written_in(design: &Design, pipeline: &Pipeline, net: NetId, stage: usize) -> bool {
    if pipeline.handshake.contains(&net) || pipeline.is_shared(net) {
        return false;
    }
    let is_clocked = match design.net(net).driver {
        Driver::Register(_) => true,
        Driver::Rom(rom) => design.rom(rom).synchronous,
        _ => false,
    };
    pipeline.clock_of(net) - usize::from(is_clocked) == stage
}

/// Returns the comment on a shared multiplier, such as `multiplier_1: in slots 0, 1 it loads the factors of base, -`. The
/// operand registers load the factors of a product in the slot before the product.
fn reservations(unit: &Unit) -> Vec<String> {
    let slots = unit.serves.len();
    let (mut numbers, mut products) = (Vec::new(), Vec::new());
    for slot in 0..slots {
        numbers.push(slot.to_string());
        products.push(unit.serves[(slot + 1) % slots].as_deref().unwrap_or("-"));
    }
    let (numbers, products) = (numbers.join(", "), products.join(", "));
    let text = format!("{}: in slots {numbers} it loads the factors of {products}", unit.name);
    comment(4, &ascii(&text))
}

fn port_name(design: &Design, role: Role) -> &str {
    match design.port(|it| it == role) {
        Some(port) => &design.net(port.net).name,
        None => "",
    }
}

/// Writes the handshake. A shift register takes the place of the netlist's single valid bits.
fn handshake(plan: &Plan, naming: &Naming, pipeline: &Pipeline) -> Vec<String> {
    let design = plan.design;
    let in_valid = port_name(design, Role::InValid);
    let in_ready = port_name(design, Role::InReady);
    let out_valid = port_name(design, Role::Valid);
    let out_ready = port_name(design, Role::OutReady);
    let reset = port_name(design, Role::Reset);
    let (valid, last) = (&naming.valid, pipeline.stages.len());
    let slot = pipeline.slot.map(|slot| (&design.net(slot).name, design.width(slot)));
    // The condition that the counter is in slot `number`; `None` if there is no counter.
    let in_slot = |number: usize| {
        slot.map(|(name, bits)| format!("({name} == {})", literal(number as u64, bits)))
    };
    let offered = match in_slot(0) {
        Some(first) => format!("{in_valid} & {first}"),
        None => in_valid.to_owned(),
    };
    let next = match last {
        1 => offered,
        2 => format!("{{{valid}[1], {offered}}}"),
        _ => format!("{{{valid}[{}:1], {offered}}}", last - 1),
    };
    let mut lines =
        vec![format!("reg  [{last}:1] {valid};"), format!("assign {out_valid} = {valid}[{last}];")];
    if let Some((name, bits)) = slot {
        let width = if bits == 1 { String::new() } else { format!("{} ", range(bits)) };
        lines.insert(1, format!("reg  {width}{name};"));
    }
    let enable = enable(design, pipeline).map(|it| design.net(it).name.as_str());
    if let Some(advance) = enable
        && !out_ready.is_empty()
    {
        lines.push(format!("wire {advance} = {out_ready} | ~{valid}[{last}];"));
    }
    if !in_ready.is_empty() {
        let taken = match (enable, in_slot(0)) {
            (Some(advance), Some(first)) => format!("{advance} & {first}"),
            (Some(advance), None) => advance.to_owned(),
            (None, first) => first.unwrap_or_default(),
        };
        lines.push(format!("assign {in_ready} = {taken};"));
    }
    let table_ready = port_name(design, Role::TableReady);
    if !table_ready.is_empty() {
        let table_write = port_name(design, Role::TableWrite);
        lines.push(format!("assign {table_ready} = ~({in_valid} | (|{valid}));"));
        lines.push(format!("wire {TABLE_LOAD} = {table_write} & {table_ready};"));
    }
    let when = match enable {
        Some(advance) => format!("if ({advance}) "),
        None => String::new(),
    };
    let empty = literal(0, last as u32);
    lines.push("always @(posedge clk) begin".to_owned());
    match slot {
        None => {
            lines.push(format!("    if (!{reset}) {valid} <= {empty};"));
            lines.push(format!("    else {when}{valid} <= {next};"));
        }
        Some((slot, bits)) => {
            let (begin, one) = (literal(0, bits), literal(1, bits));
            let after = match in_slot(pipeline.interval - 1) {
                Some(end) if !pipeline.interval.is_power_of_two() => {
                    format!("{end} ? {begin} : {slot} + {one}")
                }
                _ => format!("{slot} + {one}"),
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
        lines.push(match enable {
            Some(advance) => format!("wire {name} = {advance} & {here};"),
            None => format!("wire {name} = {here};"),
        });
    }
    writer::section(
        match pipeline.slot {
            None => {
                "The handshake: bit s is 1 while stage s holds a point; all points advance together"
            }
            Some(_) => {
                "The handshake: bit s is 1 while stage s holds a point; points and slot advance together"
            }
        },
        lines.into_iter().map(|line| format!("    {line}")).collect(),
    )
}

/// Returns the net that is 1 if all points move to the next stage, or `None` if points always move.
fn enable(design: &Design, pipeline: &Pipeline) -> Option<NetId> {
    design.registers.iter().find(|it| pipeline.valid.contains(&it.q))?.enable
}

/// Returns the comment above a stage, such as `Stage 3, from the microinstructions: accumulator <- base^2`.
fn title(number: usize, microinstructions: &[String]) -> Vec<String> {
    let what = match microinstructions {
        [] => ": only delays values".to_owned(),
        some => format!(", from the microinstructions: {}", some.join("; ")),
    };
    comment(4, &ascii(&format!("Stage {number}{what}")))
}

//! Writes the delay lines of a pipeline as Verilog. A memory in a separate module replaces the registers that carry a value which
//! no logic reads for several stages.

use std::collections::BTreeMap;

use super::module::Builder;
use super::naming::Naming;
use super::plan::address_width;
use super::text::{literal, statement, together};
use super::writer;
use crate::netlist::{DelayLine, NetId};

const TITLE: &str =
    "Delay lines: a small memory delays values that no logic reads for several stages";

/// The number of words of a delay line's memory, and the net that enables the line's steps; `None` if every clock is a step.
type Pace = (usize, Option<NetId>);

/// Returns the Verilog section of the delay lines, with one instance for all lines of the same length and enable.
pub fn section(builder: &mut Builder<'_>, naming: &Naming) -> Vec<String> {
    let plan = builder.plan;
    let mut paces: BTreeMap<Pace, Vec<&DelayLine>> = BTreeMap::new();
    for line in &plan.delays {
        paces.entry((line.words(), line.enable)).or_default().push(line);
    }
    let mut text = Vec::new();
    for ((words, enable), lines) in paces {
        let instance = builder.expressions.fresh(&format!("delay_of_{}", words + 1));
        let values: Vec<_> = lines.iter().flat_map(|line| &line.values).collect();
        let bits: u32 = values.iter().map(|it| plan.design.width(it.data)).sum();
        let enable = match enable {
            Some(enable) => builder.expressions.whole(enable),
            None => literal(1, 1),
        };
        let mut leaving = Vec::new();
        let mut entering = Vec::new();
        for value in &values {
            leaving.push(plan.design.net(plan.design.register(value.last()).q).name.clone());
            entering.push(builder.expressions.whole(value.data));
        }
        let (leave, enter) = (together(leaving), together(entering));
        let reset = plan.reset.map_or(literal(1, 1), |reset| plan.design.net(reset).name.clone());
        let head = format!(
            "{} #(.WIDTH({bits}), .WORDS({words}), .BITS({})) {instance} (",
            naming.delay(),
            address_width(words)
        );
        let flow = format!(".clk(clk), .rst_n({reset}), .enable({enable}),");
        text.extend(statement(4, &head));
        for line in [flow, format!(".entering({enter}),"), format!(".leaving({leave})")] {
            text.extend(statement(8, &line));
        }
        text.push("    );".to_owned());
    }
    writer::section(TITLE, text)
}

//! Delay lines as memories: what nothing reads on its way through several stages.

use std::collections::BTreeMap;

use super::module::Builder;
use super::plan::address_width;
use super::text::{comment, literal, range, statement};
use super::view::StageSection;
use crate::hdl::netlist::{DelayLine, NetId};

const TITLE: &str = "Delay lines: values that nothing reads for several stages lie in small memories. Whenever points \
                     move on, a slot gives the value that it holds and takes a new one; its turn comes again when all \
                     others have had theirs.";

/// The memory that synthesis is to take, as Yosys and Vivado want it said, and as Synplify does.
const STYLE: &str = "(* ram_style = \"distributed\", syn_ramstyle = \"distributed\" *)";

/// How many words go round, and when they do.
type Pace = (usize, Option<NetId>);

/// The section of the delay lines; none without any.
pub fn section(builder: &mut Builder<'_>) -> Option<StageSection> {
    let plan = builder.plan;
    let mut paces: BTreeMap<Pace, Vec<&DelayLine>> = BTreeMap::new();
    for line in &plan.delays {
        paces.entry((line.words(), line.enable)).or_default().push(line);
    }
    let (mut registers, mut groups) = (Vec::new(), Vec::new());
    for ((words, enable), lines) in paces {
        let (slot, width) =
            (builder.expressions.fresh(&format!("slot_of_{words}")), address_width(words));
        let (zero, one) = (literal(0, width), literal(1, width));
        let last = literal(words as u64 - 1, width);
        let space = if width > 1 { " " } else { "" };
        registers.push(format!("    reg {}{space}{slot};", range(width)));
        registers.push(format!("    initial {slot} = {zero};"));
        // Of a power of two the number after the last is 0.
        let mut takes = vec![if words.is_power_of_two() {
            format!("{slot} <= {slot} + {one};")
        } else {
            format!("{slot} <= {slot} == {last} ? {zero} : {slot} + {one};")
        }];
        for line in lines {
            let wish = format!("delay_s{}_s{}", line.from, line.to);
            let memory = builder.expressions.fresh(&wish);
            let bits = line.values.iter().map(|it| plan.design.width(it.data)).sum();
            let last = words - 1;
            registers.push(format!("    {STYLE}"));
            registers.push(format!("    reg {} {memory} [0:{last}];", range(bits)));
            let leave = line.values.iter().map(|it| plan.design.register(it.last()).q);
            let leave = leave.map(|q| plan.design.net(q).name.clone());
            let leave = together(leave.collect());
            takes.push(format!("{leave} <= {memory}[{slot}];"));
            let enter = line.values.iter().map(|it| builder.expressions.whole(it.data));
            let enter = together(enter.collect());
            takes.push(format!("{memory}[{slot}] <= {enter};"));
        }
        let enable = enable.map(|enable| builder.expressions.whole(enable));
        let indent = if enable.is_some() { 12 } else { 8 };
        let takes = takes.iter().flat_map(|it| statement(indent, it));
        groups.push(match enable {
            Some(enable) => {
                let begin = statement(8, &format!("if ({enable}) begin"));
                begin.into_iter().chain(takes).chain(["        end".to_owned()]).collect()
            }
            None => takes.collect(),
        });
    }
    (!groups.is_empty()).then(|| StageSection {
        title: comment(4, TITLE),
        registers,
        items: Vec::new(),
        groups,
    })
}

/// One value, or several side by side.
fn together(values: Vec<String>) -> String {
    match &values[..] {
        [only] => only.clone(),
        _ => format!("{{{}}}", values.join(", ")),
    }
}

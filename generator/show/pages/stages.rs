//! The stages of a pipeline as a table.

use super::account::{Table, code};
use glint_rtl::netlist::{Design, Pipeline};

/// The stages with their microinstructions, values, time and registers.
pub fn table(design: &Design, pipeline: &Pipeline) -> Table {
    let mut table = Table::of(
        "stage: | microinstructions | logic, ns: | slack, ns: | register bits: | in delay lines: | computes",
    );
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let values = pipeline.computed(design, number).map(|(value, net)| match net.block {
            None => code(value),
            Some(block) => format!("{} ({block})", code(value)),
        });
        table.row([
            number.to_string(),
            stage.microinstructions.join("; "),
            format!("{:.2}", stage.logic_ns),
            format!("{:.2}", stage.slack_ns),
            stage.register_bits.to_string(),
            stage.delayed_bits.to_string(),
            values.collect::<Vec<_>>().join(", "),
        ]);
    }
    table
}

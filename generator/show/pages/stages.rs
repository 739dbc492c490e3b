//! Makes the two tables on the page of a pipeline: the stages with their delays and registers, and the product that each shared
//! multiplier computes in each slot.

use super::account::{TextTable, code};
use glint_rtl::netlist::{Design, Pipeline};

/// Makes a table of the product that each shared multiplier computes in each slot. The cell of an idle slot is `–`. Returns
/// `None` if no multiplier is shared.
pub fn reservations(pipeline: &Pipeline) -> Option<TextTable> {
    let slots = (0..pipeline.interval).map(|slot| format!("slot {slot}"));
    let headings: Vec<String> = ["multiplier".to_owned()].into_iter().chain(slots).collect();
    let mut table = TextTable::of(&headings.join(" | "));
    for unit in &pipeline.units {
        let serves = unit.serves.iter().map(|it| it.as_deref().map_or("–".to_owned(), code));
        table.row([code(&unit.name)].into_iter().chain(serves));
    }
    (!pipeline.units.is_empty()).then_some(table)
}

/// Makes a table with a row for each stage. The row has the microinstructions whose values the stage computes, and the delay and
/// slack of its logic in nanoseconds. It also has the register bits, the bits in delay lines, and the names of the values.
pub fn table(design: &Design, pipeline: &Pipeline) -> TextTable {
    let mut table = TextTable::of(
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

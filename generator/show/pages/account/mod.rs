//! Writes the tables and sentences that describe a configuration, for pages in Markdown and in HTML.

pub mod blocks;
mod table;

use crate::evidence::advice::Advice;
use glint_base::fixed::Format;
use glint_base::program::Program;
use glint_base::text::{counted, rounded_up};
use glint_config::{Config, Key, Schema, shared_keys};
use glint_core::cosim::exhaustive::Backing;
use glint_core::package::facts::{self, SequenceFacts};
use glint_core::package::{HandshakeTiming, LineClocks, Linear, Surroundings, WorkedExample};
use glint_golden::{Bound, Bounds, Contract, Values};
use glint_rtl::netlist::{Design, Pipeline};
use glint_rtl::verilog::naming::Naming;
pub use table::{Align, Column, TextTable, code};

/// The heading of the column with the numbers in the source document's figure.
const NUMBER: &str = "no.";

pub struct PageInputs<'a> {
    /// The path that the user gave, for example `configs/<name>.toml`.
    pub path: &'a str,
    pub config: &'a Config,
    pub schema: &'a Schema,
    pub contract: &'a dyn Contract,
    pub backing: &'a Backing,
    /// The changes of keys that would reduce the error bound, if any would.
    pub advice: Option<Advice>,
    pub timing: &'a HandshakeTiming,
    pub example: &'a WorkedExample,
    /// A line's clocks, for a device that computes several points after one `start`.
    pub line: Option<&'a LineClocks>,
}

/// The largest number of combinations for which an exhaustive check of a highlight takes only minutes. A combination takes some
/// 30 ns.
const MOST_OF_F: u64 = 1 << 34;

/// The largest number of combinations for which an exhaustive check of any other device takes only minutes. A combination takes
/// some µs.
const MOST_OF_OUTPUTS: u64 = 1 << 28;

pub const FORMATS: &str = "Formats: `uI.F` is unsigned, `sI.F` two's complement, with I integer bits (a sign bit apart) \
                           and F fraction bits; the value of a signal is its integer times 2⁻ᶠ.";

/// Says whether the source document's figure, such as a patent, numbers the blocks.
pub fn numbering(design: &Design) -> &'static str {
    if design.nets.iter().any(|net| net.block.is_some()) {
        "In order of their numbers in the source's figure; those without a number are ours."
    } else {
        "The source gives them no numbers."
    }
}

/// Returns a format as text, for example `u0.8`; a single bit gives `1 bit`.
pub fn format_text(format: Format) -> String {
    match format.width() {
        1 => "1 bit".to_owned(),
        _ => format.to_string(),
    }
}

/// Returns a sentence with [`PageInputs::advice`], or an empty text.
pub fn limit(inputs: &PageInputs) -> String {
    match &inputs.advice {
        Some(advice) => format!("The key that helps most: {advice}."),
        None => String::new(),
    }
}

/// Describes the error bound and the evidence for it.
pub fn accuracy(contract: &dyn Contract, backing: &Backing) -> String {
    let bounds = contract.bounds();
    if !bounds.are_stated() {
        return format!(
            "The contract states no bound of the error; `{Program} certify` finds one where it can."
        );
    }
    let proven = format!("{}; this is what it is made of:", backing.sentence());
    let sentence_of = |bound: &Bound| {
        let side = if bound.keeps() { "inside" } else { "outside" };
        let unit = if bound.limit == 1.0 { "unit" } else { "units" };
        format!("which is {side} the contract (less than {} {unit})", bound.limit)
    };
    if !bounds.are_alike() {
        let mut each = Vec::new();
        for bound in &bounds.outputs {
            let (output, units) = (code(&bound.output), bound.words());
            each.push(format!("{output} by at most {units} units, {}", sentence_of(bound)));
        }
        return format!(
            "The outputs differ from the formulas in f64, unrounded, at the quantised operands: {}. A unit is the last \
             place of the output. {proven}",
            each.join("; ")
        );
    }
    let bound = bounds.governing();
    let verdict = sentence_of(bound);
    if contract.highlight().is_none() {
        return format!(
            "An output differs from the formula in f64, unrounded, at the quantised operands, by at most {} units, \
             {verdict}. A unit is the last place of the output. {proven}",
            bound.words()
        );
    }
    format!(
        "An output differs from K·f by at most {} units, {verdict}. K is the integer of its colour operand, f the \
         formula in f64, unrounded, at the quantised operands. The word f itself is off by at most {:.2e}. {proven}",
        bound.words(),
        bounds.f
    )
}

/// Describes the operands that an exhaustive check of the configuration visits.
pub fn proof(inputs: &PageInputs) -> String {
    let sweep = inputs.contract.sweep();
    let mut ranges: Vec<String> = Vec::new();
    for axis in &sweep.axes {
        ranges.push(match &axis.values {
            Values::Range(low, high) => format!("{} = {low} … {high}", code(&axis.name)),
            Values::List(values) => {
                format!("{} of {}", counted(values.len(), "value"), code(&axis.name))
            }
        });
    }
    let axes = ranges.join(", ");
    let omits = match sweep.omits.as_str() {
        "" => String::new(),
        omits => format!(" Not covered: {omits}."),
    };
    let checked = format!("`{Program} cosim {} --exhaustive`", inputs.path);
    let combinations = sweep.axes.iter().map(|axis| axis.values.count());
    let combinations = combinations.fold(1, u64::saturating_mul);
    let is_highlight = inputs.contract.highlight().is_some();
    if combinations > if is_highlight { MOST_OF_F } else { MOST_OF_OUTPUTS } {
        return format!(
            "A check of every {axes} (integers) would take hours or longer. {checked} estimates the time before it starts, \
             visits fewer values with `--values`, and divides the work with `--shard`.{omits}"
        );
    }
    if !is_highlight {
        return format!("{checked} checks it: the outputs at every {axes} (integers).{omits}");
    }
    format!(
        "{checked} checks it: every word f with every colour, and f at every combination of {axes} (integers, as on \
         the ports).{omits}"
    )
}

fn number(number: Option<u16>) -> String {
    match number {
        Some(number) => number.to_string(),
        None => String::new(),
    }
}

/// Lists the ports. A write strobe has no row of its own: the row of `exponent` has `exponent_write` in the column "written by".
pub fn ports(design: &Design) -> TextTable {
    let mut table =
        TextTable::of("port | no.: | direction | role | format | written by | what it is");
    let ports = facts::ports(design);
    // A strobe is in the row of its operand.
    for port in &ports {
        if port.role == "strobe" {
            continue;
        }
        let strobe = ports.iter().find(|strobe| port.strobe == Some(strobe.name));
        let written = match strobe.map(|strobe| (strobe.name, strobe.block)) {
            None => String::new(),
            Some((name, None)) => code(name),
            Some((name, Some(number))) => format!("{} ({number})", code(name)),
        };
        let format = match (port.width, &port.format) {
            (1, _) => "1 bit".to_owned(),
            (_, Some(format)) => format.clone(),
            (width, None) => format!("{width} bits"),
        };
        let doc = match port.role {
            "clock" => "everything happens on its rising edge",
            _ => port.doc,
        };
        table.row([
            code(port.name),
            number(port.block),
            port.direction.to_owned(),
            port.role.to_owned(),
            format,
            written,
            doc.to_owned(),
        ]);
    }
    table.without_empty(NUMBER).without_empty("written by")
}

/// Lists the ROMs, including the control ROM.
pub fn roms(design: &Design, config: &Config) -> TextTable {
    let naming = Naming::new(design).styled(Surroundings::new(config, None).style);
    let mut table = TextTable::of("ROM | no.: | words × bits: | bits: | reads | file | an entry");
    for rom in facts::roms(design, &naming) {
        let reads = if rom.synchronous { "on the clock" } else { "at once" };
        let file = match rom.file {
            Some(file) => code(file),
            None => "in the Verilog".to_owned(),
        };
        table.row([
            code(rom.name),
            number(rom.block),
            format!("{} × {}", rom.depth, rom.width),
            rom.bits.to_string(),
            reads.to_owned(),
            file,
            rom.doc.join(" "),
        ]);
    }
    table.without_empty(NUMBER)
}

/// Returns the numbers of control lines in the source's figure, for example `30 31`.
fn lines(lines: &[u16]) -> String {
    let numbers: Vec<String> = lines.iter().map(u16::to_string).collect();
    numbers.join(" ")
}

/// Lists the control word's fields. The column "bits" has `4:2` for a field of three bits from bit 2 on.
pub fn fields(design: &Design) -> TextTable {
    let mut table = TextTable::of("field | lines | bits | controls");
    for field in facts::fields(design) {
        let width = field.width as usize;
        let controls = match field.kind {
            "select" => {
                let mut choices: Vec<String> = Vec::new();
                for (value, choice) in field.choices.iter().enumerate() {
                    choices.push(format!("{value:0width$b} {}", code(choice)));
                }
                format!("selects: {}", choices.join(", "))
            }
            "enable" => "loads a register or moves a counter".to_owned(),
            "flag" => "is an output of the device".to_owned(),
            _ => "tells the sequencer where to go".to_owned(),
        };
        let bits = match width {
            1 => field.low.to_string(),
            _ => format!("{}:{}", field.low + field.width - 1, field.low),
        };
        table.row([code(field.name), lines(field.lines), bits, controls]);
    }
    table.without_empty("lines")
}

/// Lists the microprogram in the form of the source patents: a row for each microinstruction, and a column for each field of the
/// control word.
pub fn microprogram(design: &Design) -> TextTable {
    let fields = facts::fields(design);
    let mut headings = String::new();
    for field in &fields {
        headings += &match field.lines {
            [] => code(field.name),
            numbers => lines(numbers),
        };
        headings += " | ";
    }
    let mut table = TextTable::of(&format!("address: | {headings}what it does | then"));
    for microinstruction in facts::microprogram(design) {
        let mut cells = vec![microinstruction.address.to_string()];
        for (field, (_, value)) in fields.iter().zip(&microinstruction.fields) {
            let width = field.width as usize;
            let bits: Vec<String> = format!("{value:0width$b}").chars().map(String::from).collect();
            cells.push(bits.join(" "));
        }
        cells.push(microinstruction.name.to_owned());
        cells.push(match microinstruction.sequence {
            SequenceFacts::Plain("next") => String::new(),
            SequenceFacts::Plain(what) => what.to_owned(),
            SequenceFacts::Loop { loop_to, condition } => {
                format!("to {loop_to} while {}", code(condition))
            }
            SequenceFacts::Dispatch { dispatch_to, by } => {
                let targets: Vec<String> = dispatch_to.iter().map(usize::to_string).collect();
                format!("to {} by {}", targets.join(", "), code(by))
            }
            SequenceFacts::Jump { jump_to, condition } => {
                format!("to {jump_to} if {}", code(condition))
            }
        });
        table.row(cells);
    }
    table
}

/// Lists a computation's clocks, counted from the clock that takes `start`. A clock may depend on the operands. The table then
/// has a formula for the length of a line, a row for each function of a unit, or a remark.
pub fn clocks(timing: &HandshakeTiming, line: Option<&LineClocks>, design: &Design) -> TextTable {
    let mut events: Vec<(&str, Option<u32>, Option<Linear>)> =
        vec![("`valid` is high, first", timing.start_to_valid, None)];
    if let Some(line) = line {
        events.push(("`valid` is high, last", None, Some(line.last_valid)));
    }
    events.push(("`done` is high", timing.start_to_done, line.map(|line| line.done)));
    let next_start = line.map(|line| line.next_start);
    events.push(("the next `start` is taken", timing.start_to_start, next_start));
    let mut table = TextTable::of("event | clock:");
    for (event, clock, clock_of_line) in events {
        let text = match (clock, line, clock_of_line) {
            (Some(clock), ..) => clock.to_string(),
            (None, Some(line), Some(clocks)) => clocks.text(&code(&line.length)),
            _ => "depends on the operands".to_owned(),
        };
        table.row([event.to_owned(), text]);
    }
    if timing.start_to_done.is_none() {
        for (opcode, function) in design.functions.iter().enumerate() {
            if let Some(clock) = design.clocks_of_function(opcode) {
                let event = format!("`done` is high, function {}", function.name);
                table.row([event, clock.to_string()]);
            }
        }
    }
    table
}

/// Returns sentences about the clocks in which a pipeline takes a point, and in which its results are on the outputs.
pub fn handshake(pipeline: &Pipeline) -> &'static str {
    if pipeline.stall {
        "A point is taken in each clock in which `in_valid` and `in_ready` are high: the operands of that clock are its \
             own. Its results are taken in the clock in which `out_valid` and `out_ready` are high. While `out_valid` is high \
             and `out_ready` low, no point moves, and `in_ready` is low."
    } else {
        "A point is taken in each clock in which `in_valid` is high: the operands of that clock are its own. Its results \
             are on the outputs for one clock, that in which `out_valid` is high."
    }
}

/// Lists a pipeline's clocks, counted from the clock that takes a point.
pub fn pipeline_clocks(pipeline: &Pipeline) -> TextTable {
    let mut table = TextTable::of("event | clock:");
    table.row(["the next point is taken".to_owned(), pipeline.interval.to_string()]);
    let latency = pipeline.stages.len().to_string();
    table.row(["the results are on the outputs".to_owned(), latency]);
    table
}

/// Lists the terms of the bound of each output, or of all outputs if they have the same bound.
pub fn terms(bounds: &Bounds) -> TextTable {
    if bounds.are_alike() {
        let mut table = TextTable::of("key | units: | what rounds or approximates");
        for term in &bounds.governing().terms {
            table.row([code(term.key), rounded_up(term.units, 3), term.what.to_owned()]);
        }
        return table;
    }
    let mut table = TextTable::of("output | key | units: | what rounds or approximates");
    for bound in &bounds.outputs {
        for term in &bound.terms {
            let units = rounded_up(term.units, 3);
            table.row([code(&bound.output), code(term.key), units, term.what.to_owned()]);
        }
    }
    table
}

/// Lists the computation's operations, with the share of each in the error of each output and in the area. Returns `None` if the
/// contract does not know the operations.
pub fn parts(contract: &dyn Contract) -> Option<TextTable> {
    let parts = contract.parts();
    if parts.is_empty() {
        return None;
    }
    let mut headings = "part | computes | format".to_owned();
    for output in contract.outputs() {
        headings += &format!(" | share in `{}`:", output.name);
    }
    headings += " | LUTs, about: | products:";
    let mut table = TextTable::of(&headings);
    let count_text = |count: usize| if count == 0 { String::new() } else { count.to_string() };
    let cells_text = |cells: f64| count_text(cells.round() as usize);
    for part in &parts {
        let mut row = vec![code(&part.name), part.words.clone(), format_text(part.format)];
        for share in &part.shares {
            row.push(if *share == 0.0 { String::new() } else { rounded_up(*share, 3) });
        }
        row.extend([cells_text(part.cells), count_text(part.products)]);
        table.row(row);
    }
    let mut sums = vec!["all parts".to_owned(), String::new(), String::new()];
    sums.extend(contract.outputs().iter().map(|_| String::new()));
    sums.push(cells_text(parts.iter().map(|part| part.cells).sum()));
    sums.push(count_text(parts.iter().map(|part| part.products).sum()));
    table.row(sums);
    Some(table)
}

/// Lists the operands, with the values for which the contract holds.
pub fn domain(design: &Design, contract: &dyn Contract) -> TextTable {
    let mut table = TextTable::of("operand | format | from: | to: | what it is");
    for operand in contract.operands() {
        let (low, high) = operand.domain;
        table.row([
            code(&operand.name),
            format_text(operand.format),
            short(operand.format.to_f64(i128::from(low))),
            short(operand.format.to_f64(i128::from(high))),
            // If the contract says nothing about the operand, the description does.
            match (operand.doc.as_str(), design.find(&operand.name)) {
                ("", Some(port)) => design.net(port).doc.clone(),
                (doc, _) => doc.to_owned(),
            },
        ]);
    }
    table
}

/// Lists operands and outputs as raw integers and as values, and the value of the formula in f64 beside each output.
pub fn example(contract: &dyn Contract, example: &WorkedExample) -> TextTable {
    let mut table = TextTable::of("port | integer: | value: | formula in f64:");
    let operands: Vec<i64> = example.operands.iter().map(|it| it.raw as i64).collect();
    for operand in &example.operands {
        let (raw, value) = (operand.raw.to_string(), short(operand.value));
        table.row([code(&operand.name), raw, value, String::new()]);
    }
    let mut exact = Vec::new();
    for (index, outputs) in (0..).zip(&example.results) {
        exact.clear();
        contract.exact(&operands, index, &mut exact);
        for (output, [exact, _]) in outputs.iter().zip(&exact) {
            let mut name = code(&output.name);
            if example.results.len() != 1 {
                name += &format!(", point {index}");
            }
            table.row([name, output.raw.to_string(), short(output.value), short(*exact)]);
        }
    }
    table
}

/// Lists the keys and their values. Keys that every device has are listed only if they are not at their defaults. A key that does
/// not apply has the value `–`.
pub fn keys(schema: &Schema, config: &Config) -> TextTable {
    let mut table = TextTable::of("key | value | accepts | what it governs");
    let mut keys: Vec<&Key> = schema.keys.iter().collect();
    for key in shared_keys() {
        if *config.value(key.name) != key.default {
            keys.push(key);
        }
    }
    for key in keys {
        let now = shortened(config.value(key.name).toml());
        let default = shortened(key.default.toml());
        let value = match config.applies(schema, key.name) {
            false => "–".to_owned(),
            true if now == default => code(&now),
            true => format!("{} (default {})", code(&now), code(&default)),
        };
        let mut doc = key.doc.to_owned();
        if let Some(condition) = key.condition {
            let words = condition.words(config.value(condition.key));
            doc += &format!(" Only with {}.", code(&words));
        }
        table.row([code(key.name), value, key.accepts(), doc]);
    }
    table
}

/// Cuts a text after 520 characters, and adds the number of characters of the whole text.
fn shortened(text: String) -> String {
    const ROOM: usize = 520;
    match text.char_indices().nth(ROOM) {
        None => text,
        Some((end, _)) => format!("{} … ({} characters)", &text[..end], text.chars().count()),
    }
}

/// Writes a value with six decimals, without trailing zeros, for example `0.866026`, `-0.25` and `1000`.
pub fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_short() {
        assert_eq!(short(1.0), "1");
        assert_eq!(short(0.866_025_924_682_617_2), "0.866026");
        assert_eq!(short(1000.0), "1000");
        assert_eq!(short(-0.25), "-0.25");
    }
}

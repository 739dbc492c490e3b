//! Prints the result of `glint compare` as tables for people, as CSV and as JSON.

use anyhow::Result;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{Arguments, ComparisonEntry};
use crate::report::CommandReport;
use crate::{failure, say, tables};
use glint_base::program::Program;
use glint_base::target::COMPARED;
use glint_base::text;
use glint_golden::contract;
use glint_prove::synth::{Frequency, RECORDED_TARGETS, Rate, Target, tools};
use glint_show::evidence::comparison::{ANGLES, ANGLES_PER_DEGREE, Accuracy, MultiplierSize};
use glint_tools::synthesis::Usage;

pub struct ComparisonReport<'a> {
    pub arguments: &'a Arguments,
    pub entries: &'a [ComparisonEntry],
    pub notes: &'a [String],
    pub failures: &'a [String],
}

impl CommandReport for ComparisonReport<'_> {
    fn json(&self) -> Result<Value> {
        Ok(as_json(self.arguments, self.entries, self.notes, self.failures))
    }

    fn print(&self) -> Result<()> {
        let Self { arguments, entries, notes, failures } = *self;
        if arguments.csv {
            tables::print_csv(as_csv(arguments, entries))?;
            for note in notes.iter().chain(failures) {
                failure::warn(note);
            }
            return Ok(());
        }
        print_errors(arguments, entries);
        print_hardware(entries);
        print_speed(entries);
        for note in entries.iter().filter_map(at_rest).chain(notes.iter().cloned()) {
            say!("Note: {note}.");
        }
        for failure in failures {
            say!("FAILS: {failure}");
        }
        Ok(())
    }
}

/// Returns a sentence about the operands at which the errors are measured, or `None` if the cosine and n are the only control
/// operands.
fn at_rest(entry: &ComparisonEntry) -> Option<String> {
    let contract = entry.core.contract.as_ref();
    if !contract.operands().iter().any(|operand| operand.name == contract::COSINE) {
        return None;
    }
    // Any angle and exponent may be used, because the other operands do not depend on them.
    let point = (1..=1000).find_map(|n| contract.highlight()?.at(0.1, f64::from(n)))?;
    let control = contract.operands().iter().filter(|operand| !operand.colour);
    let mut others: Vec<String> = Vec::new();
    for (operand, raw) in control.zip(point) {
        if operand.name != contract::COSINE && operand.name != contract::EXPONENT {
            let value = operand.format.to_f64(i128::from(raw));
            others.push(format!("{} = {value}", operand.name));
        }
    }
    if others.is_empty() {
        return None;
    }
    Some(format!(
        "the errors of {} are measured at {}; over all operands, the fixed-point error of f is at most \
         {:.1e}, its bound",
        entry.label,
        others.join(", "),
        contract.bounds().f
    ))
}

/// Returns the largest and the mean error, in this order, of the whole, the formula, the operands and the fixed point.
fn errors(accuracy: &Accuracy) -> Vec<f64> {
    let Accuracy { whole, formula, operands, fixed_point } = *accuracy;
    let mut errors = Vec::new();
    for error in [whole, formula, operands, fixed_point] {
        errors.extend([error.largest, error.mean]);
    }
    errors
}

fn print_errors(arguments: &Arguments, entries: &[ComparisonEntry]) {
    say!(
        "Errors of f against cos^n gamma for n = {}, over gamma = 0 to 90 degrees in steps of {}:",
        arguments.exponent,
        1.0 / f64::from(ANGLES_PER_DEGREE)
    );
    let mut rows = Vec::new();
    for entry in entries {
        let mut row = vec![entry.label.clone()];
        match &entry.figures.accuracy {
            None => row.resize(9, "-".to_owned()),
            Some(accuracy) => {
                for error in errors(accuracy) {
                    row.push(format!("{error:.6}"));
                }
            }
        }
        row.push(entry.core.contract.bounds().words());
        rows.push(row);
    }
    tables::print(
        "device | largest: | mean:3 | formula, largest: | mean:6 | operands, largest:1 | mean:5 | fixed point, largest: | mean:4 | bound, units:2",
        rows,
    );
    tables::print_line(
        "The error at an angle is the sum of three errors: the error of the formula, in f64 at the quantised \
         operands; the error of the quantised operands, from which cos gamma follows; and the error of the \
         fixed point, f against the formula. The bound limits the error of an output, which is f times a \
         colour and rounded, against the formula.",
    );
    tables::print_line("");
}

fn print_hardware(entries: &[ComparisonEntry]) {
    let synthesised = entries.iter().any(|entry| !entry.usage.is_empty());
    let mut headings = "device | clocks a point: | ROM bits: | multipliers;1".to_owned();
    if synthesised {
        for family in &COMPARED {
            for resource in ["LUT", "DSP", "RAM"] {
                headings += &format!(" | {} {resource}:", family.title);
            }
        }
    }
    let mut rows = Vec::new();
    for entry in entries {
        let mut row = vec![
            entry.label.clone(),
            clocks(entry.figures.clocks_per_point),
            text::grouped(entry.core.design.rom_bits()),
            sizes(&entry.figures.multipliers),
        ];
        if synthesised {
            row.extend(taken(entry, "-"));
        }
        rows.push(row);
    }
    tables::print(&headings, rows);
    tables::print_line(
        "ROM bits include the control ROM. Clocks are counted from one start to the next. For a device that \
         computes lines of points, they are divided by the points of the longest line.",
    );
    if synthesised {
        tables::print_line(
            "Yosys counts the LUTs, DSP blocks and block RAMs before placement. A block RAM has 4 kbit on \
             iCE40, and 18 kbit on the other families.",
        );
    }
}

/// Returns the resources of all families as cells. `unknown` replaces an unknown number.
fn taken(entry: &ComparisonEntry, unknown: &str) -> Vec<String> {
    let mut cells = Vec::new();
    for at in 0..COMPARED.len() {
        match entry.usage.get(at) {
            Some(Ok(usage)) => {
                for (_, number) in numbers(usage) {
                    cells.push(number.to_string());
                }
            }
            _ => cells.extend([unknown; 3].map(str::to_owned)),
        }
    }
    cells
}

/// Returns the targets with a frequency in the record, with the core's frequency and rate.
fn speeds(entry: &ComparisonEntry) -> Vec<(Target, Frequency, Rate)> {
    let mut speeds = Vec::new();
    let Some(record) = &entry.record else { return speeds };
    for figures in &record.targets {
        if let Some(frequency) = figures.frequency
            && let Some(rate) = Rate::new(figures, entry.figures.clocks_per_point)
        {
            speeds.push((figures.target, frequency, rate));
        }
    }
    speeds
}

/// Writes `number` times `scale` with one digit after the point, or `-` for `None`.
fn scaled(number: Option<f64>, scale: f64) -> String {
    match number {
        Some(number) => format!("{:.1}", number * scale),
        None => "-".to_owned(),
    }
}

fn print_speed(entries: &[ComparisonEntry]) {
    if entries.iter().all(|entry| entry.record.is_none()) {
        return;
    }
    let mut rows = Vec::new();
    for entry in entries {
        for (target, frequency, rate) in speeds(entry) {
            rows.push(vec![
                entry.label.clone(),
                target.title().to_owned(),
                format!("{:.1}", frequency.median),
                format!("{:.1} to {:.1}", frequency.lowest, frequency.highest),
                format!("{:.1}", rate.points),
                scaled(rate.per_lut, 1000.0),
                scaled(rate.per_dsp, 1.0),
            ]);
        }
    }
    tables::print_line("");
    tables::print(
        "device | target | MHz: | lowest to highest:1 | M points/s: | k/s per LUT: | M/s per DSP:",
        rows,
    );
    let records = entries.iter().filter_map(|entry| entry.record.as_ref());
    let tools = tools(records.flat_map(|record| &record.targets));
    say!(
        "Measured by `{Program} synth` with registers around the core, as the median of several runs of \
         place and route, with {}.",
        Vec::from_iter(tools).join(", ")
    );
}

/// Writes a whole number without decimals, and any other number with three. For example, 5 gives `5`, and 5.5 gives `5.500`.
fn clocks(clocks: f64) -> String {
    if clocks.fract() == 0.0 { format!("{clocks}") } else { format!("{clocks:.3}") }
}

/// Writes the sizes of multipliers, with a count for equal neighbours.
fn sizes(multipliers: &[MultiplierSize]) -> String {
    let mut texts = Vec::new();
    for alike in multipliers.chunk_by(|a, b| a == b) {
        texts.push(match alike {
            [one] => one.to_string(),
            several => format!("{} of {}", several.len(), several[0]),
        });
    }
    texts.join(", ")
}

fn numbers(usage: &Usage) -> [(&'static str, u64); 3] {
    [("luts", usage.luts), ("dsps", usage.dsps), ("block_rams", usage.block_rams)]
}

/// Returns the headings, and then a row for each entry. The cell of an unknown value is empty.
fn as_csv(arguments: &Arguments, entries: &[ComparisonEntry]) -> Vec<Vec<String>> {
    let synthesised = entries.iter().any(|entry| !entry.usage.is_empty());
    let measured = entries.iter().any(|entry| entry.record.is_some());
    let mut rows = vec![csv_heading(synthesised, measured)];
    for entry in entries {
        rows.push(csv_row(entry, arguments.exponent, synthesised, measured));
    }
    rows
}

/// Returns the headings. For example, the columns of iCE40 are `ice40_luts`, `ice40_dsps` and `ice40_block_rams`. `synthesised`
/// and `measured` say whether the columns of resources and of frequencies are included.
fn csv_heading(synthesised: bool, measured: bool) -> Vec<String> {
    let mut heading: Vec<String> = ["name", "device", "exponent"].map(str::to_owned).to_vec();
    for name in ["error", "formula", "operands", "fixed_point"] {
        heading.extend([format!("{name}_largest"), format!("{name}_mean")]);
    }
    heading
        .extend(["bound_units", "clocks_per_point", "rom_bits", "multipliers"].map(str::to_owned));
    if synthesised {
        for family in &COMPARED {
            for resource in ["luts", "dsps", "block_rams"] {
                heading.push(format!("{}_{resource}", family.name()));
            }
        }
    }
    if measured {
        for target in RECORDED_TARGETS {
            heading.push(format!("{target}_mhz"));
            heading.push(format!("{target}_million_points_per_second"));
        }
    }
    heading
}

fn csv_row(
    entry: &ComparisonEntry,
    exponent: u32,
    synthesised: bool,
    measured: bool,
) -> Vec<String> {
    let mut row =
        vec![entry.label.clone(), entry.core.device().name.to_owned(), exponent.to_string()];
    match &entry.figures.accuracy {
        None => row.extend(vec![String::new(); 8]),
        Some(accuracy) => row.extend(errors(accuracy).iter().map(f64::to_string)),
    }
    row.extend([
        entry.core.contract.bounds().governing().units.to_string(),
        entry.figures.clocks_per_point.to_string(),
        entry.core.design.rom_bits().to_string(),
        sizes(&entry.figures.multipliers),
    ]);
    if synthesised {
        row.extend(taken(entry, ""));
    }
    if measured {
        let speeds = speeds(entry);
        for target in RECORDED_TARGETS {
            match speeds.iter().find(|(measured_target, ..)| *measured_target == target) {
                Some((_, frequency, rate)) => {
                    row.extend([frequency.median.to_string(), rate.points.to_string()]);
                }
                None => row.extend([String::new(), String::new()]),
            }
        }
    }
    row
}

#[derive(Serialize)]
struct Speed {
    #[serde(rename = "mhz")]
    frequency: Frequency,
    #[serde(flatten)]
    rate: Rate,
}

fn as_json(
    arguments: &Arguments,
    entries: &[ComparisonEntry],
    notes: &[String],
    failed: &[String],
) -> Value {
    let entries: Vec<Value> = entries.iter().map(entry_json).collect();
    let problems: Vec<Value> = failed.iter().map(|failure| failure::problem(failure)).collect();
    json!({
        "ok": failed.is_empty(),
        "exponent": arguments.exponent,
        "angles": { "from_degrees": 0, "to_degrees": 90, "count": ANGLES },
        "entries": entries,
        "notes": notes,
        "problems": problems,
    })
}

fn entry_json(entry: &ComparisonEntry) -> Value {
    let core = &entry.core;
    let schema = (core.device().schema)();
    let multipliers: Vec<_> =
        entry.figures.multipliers.iter().map(|size| [size.first, size.second]).collect();
    let mut value = json!({
        "name": entry.label,
        "device": core.device().name,
        "toml": core.config().to_toml(&schema),
        "bound_units": core.contract.bounds().governing().units,
        "clocks_per_point": entry.figures.clocks_per_point,
        "rom_bits": core.design.rom_bits(),
        "errors": entry.figures.accuracy,
        "multipliers": multipliers,
    });
    if !entry.usage.is_empty() {
        let mut synthesis = Map::new();
        for (family, usage) in COMPARED.iter().zip(&entry.usage) {
            let taken = usage.as_ref().map_or(Value::Null, usage_json);
            synthesis.insert(family.name().to_owned(), taken);
        }
        value["synthesis"] = Value::Object(synthesis);
    }
    if entry.record.is_some() {
        let mut speed = Map::new();
        for (target, frequency, rate) in speeds(entry) {
            speed.insert(target.name().to_owned(), json!(Speed { frequency, rate }));
        }
        value["speed"] = Value::Object(speed);
    }
    value
}

fn usage_json(usage: &Usage) -> Value {
    let mut named = Map::new();
    for (name, number) in numbers(usage) {
        named.insert(name.to_owned(), json!(number));
    }
    Value::Object(named)
}

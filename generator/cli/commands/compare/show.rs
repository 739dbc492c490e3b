//! Prints a comparison as tables, as CSV and as JSON.

use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Arguments, ComparisonEntry};
use crate::{OutputOptions, failure, say, tables};
use glint_base::program::Program;
use glint_base::target::FAMILIES;
use glint_base::text;
use glint_golden::contract;
use glint_prove::synth::{Frequency, Rate, TARGETS, Target, tools};
use glint_show::evidence::comparison::{ANGLES, ANGLES_PER_DEGREE, Accuracy, MultiplierSize};
use glint_tools::synthesis::Usage;

/// Prints everything in the form that was asked for.
pub fn show(
    output: OutputOptions,
    arguments: &Arguments,
    entries: &[ComparisonEntry],
    notes: &[String],
    failures: &[String],
) -> Result<()> {
    if output.json {
        tables::print_json(&as_json(arguments, entries, notes, failures));
        return Ok(());
    }
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

/// Returns a sentence about the operands at which the errors of a device are computed, if the device has more
/// operands than the angle and n. Returns `None` for all other devices.
fn at_rest(entry: &ComparisonEntry) -> Option<String> {
    let contract = entry.core.contract.as_ref();
    let control = contract.operands().iter().filter(|operand| !operand.colour);
    let is_other = |name: &str| ![contract::COSINE, contract::EXPONENT].contains(&name);
    if !contract.operands().iter().any(|operand| operand.name == contract::COSINE) {
        return None;
    }
    // Any angle and exponent: the others do not depend on them.
    let point = (1..=1000).find_map(|n| contract.highlight()?.at(0.1, f64::from(n)))?;
    let others: Vec<String> = control
        .zip(point)
        .filter(|(operand, _)| is_other(&operand.name))
        .map(|(operand, raw)| {
            format!("{} = {}", operand.name, operand.format.to_f64(i128::from(raw)))
        })
        .collect();
    (!others.is_empty()).then(|| {
        format!(
            "the errors of {} are those at {}; over all operands the fixed point of f is off by at most {:.1e}, its bound",
            entry.label,
            others.join(", "),
            contract.bound().f
        )
    })
}

/// Returns the largest and the mean error for the whole, the formula, the operands and the fixed point.
fn errors(accuracy: &Accuracy) -> impl Iterator<Item = f64> {
    let Accuracy { whole, formula, operands, fixed_point } = *accuracy;
    [whole, formula, operands, fixed_point].into_iter().flat_map(|it| [it.largest, it.mean])
}

fn print_errors(arguments: &Arguments, entries: &[ComparisonEntry]) {
    say!(
        "Errors of f against cos^n gamma for n = {}, over gamma = 0 to 90 degrees in steps of {}:",
        arguments.exponent,
        1.0 / f64::from(ANGLES_PER_DEGREE)
    );
    let rows = entries.iter().map(|entry| {
        let mut row = vec![entry.label.clone()];
        match &entry.figures.accuracy {
            None => row.resize(9, "-".to_owned()),
            Some(accuracy) => row.extend(errors(accuracy).map(|error| format!("{error:.6}"))),
        }
        row.push(entry.core.contract.bound().words());
        row
    });
    tables::print(
        "device | largest: | mean:3 | formula, largest: | mean:6 | operands, largest:1 | mean:5 | fixed point, largest: | mean:4 | bound, units:2",
        rows,
    );
    tables::print_line(
        "The error at an angle is the sum of three: of the formula, in f64 at the quantised operands; of cos gamma \
         as the operands denote it; and of the fixed point, f against the formula. The bound is on an output, \
         f times a colour and rounded, against the formula.",
    );
    tables::print_line("");
}

fn print_hardware(entries: &[ComparisonEntry]) {
    let synthesised = entries.iter().any(|entry| !entry.usage.is_empty());
    let mut headings = "device | clocks a point: | ROM bits: | multipliers;1".to_owned();
    for family in FAMILIES.iter().filter(|_| synthesised) {
        let resources = ["LUT", "DSP", "RAM"].map(|it| format!(" | {} {it}:", family.title));
        headings += &resources.concat();
    }
    let rows = entries.iter().map(|entry| {
        let mut row = vec![
            entry.label.clone(),
            clocks(entry.figures.clocks_per_point),
            text::grouped(entry.core.design.rom_bits()),
            sizes(&entry.figures.multipliers),
        ];
        if synthesised {
            row.extend(taken(entry, "-"));
        }
        row
    });
    tables::print(&headings, rows);
    tables::print_line(
        "ROM bits count the control ROM. Clocks are from start to start, per point of the longest line where a \
         start shows several.",
    );
    if synthesised {
        tables::print_line(
            "By Yosys, before placement; block RAMs are of 4 kbit in iCE40 and of 18 kbit in the others.",
        );
    }
}

/// Returns the usage of all families, with `unknown` for a usage that is not known.
fn taken(entry: &ComparisonEntry, unknown: &str) -> Vec<String> {
    let of = |at: usize| entry.usage.get(at).and_then(|usage| usage.as_ref().ok());
    let families = (0..FAMILIES.len()).flat_map(|at| match of(at) {
        Some(usage) => numbers(usage).map(|(_, number)| number.to_string()),
        None => [unknown; 3].map(str::to_owned),
    });
    families.collect()
}

/// Returns the targets for which a frequency was measured, with the core's rate there.
fn speeds(entry: &ComparisonEntry) -> impl Iterator<Item = (Target, Frequency, Rate)> {
    let figures = entry.record.iter().flat_map(|record| &record.targets);
    figures.filter_map(|it| {
        Some((it.target, it.frequency?, Rate::new(it, entry.figures.clocks_per_point)?))
    })
}

fn print_speed(entries: &[ComparisonEntry]) {
    if entries.iter().all(|entry| entry.record.is_none()) {
        return;
    }
    let per = |number: Option<f64>, scale: f64| {
        number.map_or_else(|| "-".to_owned(), |it| format!("{:.1}", it * scale))
    };
    let rows = entries.iter().flat_map(|entry| {
        speeds(entry).map(|(target, frequency, rate)| {
            vec![
                entry.label.clone(),
                target.title().to_owned(),
                format!("{:.1}", frequency.median),
                format!("{:.1} to {:.1}", frequency.lowest, frequency.highest),
                format!("{:.1}", rate.points),
                per(rate.per_lut, 1000.0),
                per(rate.per_dsp, 1.0),
            ]
        })
    });
    tables::print_line("");
    tables::print(
        "device | target | MHz: | lowest to highest:1 | M points/s: | k/s per LUT: | M/s per DSP:",
        rows,
    );
    let tools =
        tools(entries.iter().filter_map(|it| it.record.as_ref()).flat_map(|it| &it.targets));
    say!(
        "Measured by `{Program} synth` with registers around the core, the median of several runs of place and route: {}.",
        Vec::from_iter(tools).join(", ")
    );
}

/// Writes a number of clocks, a whole one as an integer. For example, 5 is `5`, and 5.5 is `5.500`.
fn clocks(clocks: f64) -> String {
    if clocks.fract() == 0.0 { format!("{clocks}") } else { format!("{clocks:.3}") }
}

/// Writes the sizes of multipliers, in the order of the list. For example, one of 21 by 10 bits and three of 10 by 8
/// bits are `21x10, 3 of 10x8`.
fn sizes(multipliers: &[MultiplierSize]) -> String {
    let alike = multipliers.chunk_by(|a, b| a == b);
    let texts: Vec<String> = alike
        .map(|alike| match alike {
            [one] => one.to_string(),
            several => format!("{} of {}", several.len(), several[0]),
        })
        .collect();
    texts.join(", ")
}

/// Returns the usage of a design, with names.
fn numbers(usage: &Usage) -> [(&'static str, u64); 3] {
    [("luts", usage.luts), ("dsps", usage.dsps), ("block_rams", usage.block_rams)]
}

/// Returns the heading, then a row for each entry. A value that is not known is empty. For example, the columns of
/// iCE40 are `ice40_luts`, `ice40_dsps` and `ice40_block_rams`.
fn as_csv(arguments: &Arguments, entries: &[ComparisonEntry]) -> Vec<Vec<String>> {
    let synthesised = entries.iter().any(|entry| !entry.usage.is_empty());
    let mut heading: Vec<String> = ["name", "device", "exponent"].map(str::to_owned).to_vec();
    for name in ["error", "formula", "operands", "fixed_point"] {
        heading.extend([format!("{name}_largest"), format!("{name}_mean")]);
    }
    heading
        .extend(["bound_units", "clocks_per_point", "rom_bits", "multipliers"].map(str::to_owned));
    if synthesised {
        for family in &FAMILIES {
            heading
                .extend(["luts", "dsps", "block_rams"].map(|it| format!("{}_{it}", family.name())));
        }
    }
    let measured = entries.iter().any(|entry| entry.record.is_some());
    if measured {
        for target in TARGETS {
            heading.extend(["mhz", "million_points_per_second"].map(|it| format!("{target}_{it}")));
        }
    }
    let row = |entry: &ComparisonEntry| {
        let mut row = vec![
            entry.label.clone(),
            entry.core.device.name.to_owned(),
            arguments.exponent.to_string(),
        ];
        match &entry.figures.accuracy {
            None => row.extend(vec![String::new(); 8]),
            Some(accuracy) => row.extend(errors(accuracy).map(|error| error.to_string())),
        }
        row.extend([
            entry.core.contract.bound().units.to_string(),
            entry.figures.clocks_per_point.to_string(),
            entry.core.design.rom_bits().to_string(),
            sizes(&entry.figures.multipliers),
        ]);
        if synthesised {
            row.extend(taken(entry, ""));
        }
        if measured {
            for target in TARGETS {
                let (mhz, points) = speeds(entry).find(|(of, ..)| *of == target).map_or_else(
                    || (String::new(), String::new()),
                    |(_, frequency, rate)| (frequency.median.to_string(), rate.points.to_string()),
                );
                row.extend([mhz, points]);
            }
        }
        row
    };
    std::iter::once(heading).chain(entries.iter().map(row)).collect()
}

/// For scripts.
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
    let schema = (core.device.schema)();
    let multipliers = entry.figures.multipliers.iter();
    let mut value = json!({
        "name": entry.label,
        "device": core.device.name,
        "toml": core.config.to_toml(&schema),
        "bound_units": core.contract.bound().units,
        "clocks_per_point": entry.figures.clocks_per_point,
        "rom_bits": core.design.rom_bits(),
        "errors": entry.figures.accuracy,
        "multipliers": Vec::from_iter(multipliers.map(|it| [it.first, it.second])),
    });
    if !entry.usage.is_empty() {
        let taken = |usage: &Result<Usage, String>| match usage {
            Ok(usage) => {
                let named = numbers(usage).map(|(name, number)| (name.to_owned(), json!(number)));
                Value::Object(named.into_iter().collect())
            }
            Err(_) => Value::Null,
        };
        let families = FAMILIES.iter().map(|family| family.name().to_owned());
        value["synthesis"] = Value::Object(families.zip(entry.usage.iter().map(taken)).collect());
    }
    if entry.record.is_some() {
        let speed = |(target, frequency, rate): (Target, Frequency, Rate)| {
            let told = Speed { frequency, rate };
            (target.name().to_owned(), json!(told))
        };
        value["speed"] = Value::Object(speeds(entry).map(speed).collect());
    }
    value
}

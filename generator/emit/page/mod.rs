//! The page of a configuration: what the device is, for people, in Markdown.

mod blocks;
mod markdown;

use anyhow::Result;
use askama::Template;

use super::facts::{self, Sequence};
use super::naming::Naming;
use super::seal::{Comment, sealed};
use super::{Quantity, Timing, WorkedExample};
use crate::config::{Config, Schema, Value};
use crate::golden::{Bound, Contract, Values};
use crate::netlist::Design;
use markdown::{Align, Table, code, prose};

/// What the page says beyond the design.
pub struct PageInputs<'a> {
    /// The configuration as the command line names it, `configs/<name>.toml`.
    pub path: &'a str,
    /// The values of the keys.
    pub config: &'a Config,
    /// The keys.
    pub schema: &'a Schema,
    /// The accuracy contract.
    pub contract: &'a dyn Contract,
    /// Clocks.
    pub timing: &'a Timing,
    /// One computation with all its numbers.
    pub example: &'a WorkedExample,
}

#[derive(Template)]
#[template(path = "page.md")]
struct Page<'a> {
    title: String,
    device: &'a str,
    name: &'a str,
    formula: &'a str,
    source: String,
    notes: Vec<String>,
    ports: String,
    numbering: &'static str,
    blocks: String,
    roms: String,
    fields: String,
    words: String,
    clocks: String,
    accuracy: String,
    terms: String,
    limit: String,
    proof: String,
    domain: String,
    remarks: Vec<String>,
    example: String,
    keys: String,
    config: &'a str,
}

/// The page of a design, ending with a newline.
///
/// # Errors
/// A template that fails to print.
pub fn page(design: &Design, inputs: &PageInputs) -> Result<String> {
    let about = &design.about;
    let bound = inputs.contract.bound();
    let numbered = design.nets.iter().any(|net| net.block.is_some());
    let text = super::render(&Page {
        title: prose(&about.title),
        device: &about.device,
        name: &design.name,
        formula: &about.formula,
        source: prose(&about.source),
        notes: about.notes.iter().map(|note| prose(note)).collect(),
        ports: ports(design),
        numbering: match numbered {
            true => {
                "In order of their numbers in the source's figure; those without a number are ours."
            }
            false => "The source gives them no numbers.",
        },
        blocks: blocks::table(design).text(),
        roms: roms(design),
        fields: fields(design),
        words: words(design),
        clocks: clocks(inputs.timing),
        accuracy: accuracy(&bound),
        terms: terms(&bound),
        limit: bound.limiting().map_or_else(String::new, |term| {
            format!(
                "The key to change first is `{}`: {}, {:.3} units.",
                term.key,
                prose(term.what),
                term.units
            )
        }),
        proof: proof(inputs),
        domain: domain(inputs.contract),
        remarks: inputs
            .contract
            .remarks()
            .iter()
            .map(|remark| format!("Remark: {}.", prose(remark)))
            .collect(),
        example: example(inputs.contract, inputs.example),
        keys: keys(inputs.schema, inputs.config),
        config: inputs.path,
    })?;
    Ok(sealed(text, Comment::Markdown))
}

fn number(number: Option<u16>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

fn ports(design: &Design) -> String {
    let mut table = Table::new(&[
        ("port", Align::Left),
        (blocks::NUMBER, Align::Right),
        ("direction", Align::Left),
        ("role", Align::Left),
        ("format", Align::Left),
        ("written by", Align::Left),
        ("what it is", Align::Left),
    ]);
    let ports = facts::ports(design);
    // A strobe stands with its operand.
    for port in ports.iter().filter(|port| port.role != "strobe") {
        let strobe = ports.iter().find(|strobe| port.strobe == Some(strobe.name));
        let written = strobe.map_or_else(String::new, |strobe| match strobe.block {
            None => code(strobe.name),
            Some(number) => format!("{} ({number})", code(strobe.name)),
        });
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
            prose(doc),
        ]);
    }
    table.without_empty(blocks::NUMBER).text()
}

fn roms(design: &Design) -> String {
    let naming = Naming::new(design);
    let mut table = Table::new(&[
        ("ROM", Align::Left),
        (blocks::NUMBER, Align::Right),
        ("words × bits", Align::Right),
        ("bits", Align::Right),
        ("reads", Align::Left),
        ("file", Align::Left),
        ("an entry", Align::Left),
    ]);
    for rom in facts::roms(design, &naming) {
        let reads = match rom.synchronous {
            true => "on the clock",
            false => "at once",
        };
        table.row([
            code(rom.name),
            number(rom.block),
            format!("{} × {}", rom.depth, rom.width),
            rom.bits.to_string(),
            reads.to_owned(),
            code(rom.file),
            prose(&rom.doc.join(" ")),
        ]);
    }
    table.without_empty(blocks::NUMBER).text()
}

/// The lines of a field as the source numbers them.
fn lines(lines: &[u16]) -> String {
    let lines: Vec<String> = lines.iter().map(u16::to_string).collect();
    lines.join(" ")
}

fn fields(design: &Design) -> String {
    let mut table = Table::new(&[
        ("field", Align::Left),
        ("lines", Align::Left),
        ("bits", Align::Left),
        ("turns", Align::Left),
    ]);
    for field in facts::fields(design) {
        let width = field.width as usize;
        let turns = match field.kind {
            "select" => {
                let choices: Vec<String> = (0..)
                    .zip(field.choices)
                    .map(|(value, choice): (u64, _)| format!("{value:0width$b} {}", code(choice)))
                    .collect();
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
        table.row([code(field.name), lines(field.lines), bits, turns]);
    }
    table.without_empty("lines").text()
}

/// The microprogram as the patents print theirs: a word a row, a line a column.
fn words(design: &Design) -> String {
    let fields = facts::fields(design);
    let headings: Vec<String> = fields
        .iter()
        .map(|field| match field.lines {
            [] => code(field.name),
            numbers => lines(numbers),
        })
        .collect();
    let mut columns = vec![("word", Align::Right)];
    columns.extend(
        headings
            .iter()
            .map(|heading| (heading.as_str(), Align::Left)),
    );
    columns.extend([("what it does", Align::Left), ("then", Align::Left)]);
    let mut table = Table::new(&columns);
    for word in facts::words(design) {
        let mut cells = vec![word.address.to_string()];
        for (field, (_, value)) in fields.iter().zip(&word.fields) {
            let width = field.width as usize;
            let bits: Vec<String> = format!("{value:0width$b}")
                .chars()
                .map(String::from)
                .collect();
            cells.push(bits.join(" "));
        }
        cells.push(prose(word.name));
        cells.push(match word.sequence {
            Sequence::Plain("next") => String::new(),
            Sequence::Plain(what) => what.to_owned(),
            Sequence::Loop { loop_to, condition } => {
                format!("word {loop_to} while {}", code(condition))
            }
            Sequence::Jump { jump_to, condition } => {
                format!("word {jump_to} if {}", code(condition))
            }
        });
        table.row(cells);
    }
    table.text()
}

fn clocks(timing: &Timing) -> String {
    let mut table = Table::new(&[("event", Align::Left), ("clock", Align::Right)]);
    let events = [
        ("`valid` is high, first", timing.start_to_valid),
        ("`done` is high", timing.start_to_done),
        ("the next `start` is taken", timing.start_to_start),
    ];
    for (event, clock) in events {
        let clock = clock.map_or_else(
            || "depends on the operands".to_owned(),
            |clock| clock.to_string(),
        );
        table.row([event.to_owned(), clock]);
    }
    table.text()
}

fn accuracy(bound: &Bound) -> String {
    let verdict = match bound.units < 1.0 {
        true => "which is inside the contract (less than 1 unit)",
        false => "which is outside the contract (less than 1 unit)",
    };
    format!(
        "An output differs from K·f by at most {:.3} units, {verdict}. K is the integer of its colour operand, f the \
         formula in f64, unrounded, at the quantised operands. The word f itself is off by at most {:.2e}. The bound is \
         proven, not measured; this is what it is made of:",
        bound.units, bound.f
    )
}

fn terms(bound: &Bound) -> String {
    let mut table = Table::new(&[
        ("key", Align::Left),
        ("units", Align::Right),
        ("what rounds or approximates", Align::Left),
    ]);
    for term in &bound.terms {
        table.row([
            code(term.key),
            format!("{:.3}", term.units),
            prose(term.what),
        ]);
    }
    table.text()
}

/// What an exhaustive check of `f` goes through.
fn proof(inputs: &PageInputs) -> String {
    let sweep = inputs.contract.sweep();
    let axes: Vec<String> = sweep
        .axes
        .iter()
        .map(|axis| match &axis.values {
            Values::Range(low, high) => format!("{} = {low} … {high}", code(&axis.name)),
            Values::List(values) => format!("{} settings of {}", values.len(), code(&axis.name)),
        })
        .collect();
    let omits = match sweep.omits.as_str() {
        "" => String::new(),
        omits => format!(" Not covered: {}.", prose(omits)),
    };
    format!(
        "`glint cosim {} --exhaustive` checks it: every word f with every colour, and f at every combination of {} \
         (integers, as on the ports).{omits}",
        inputs.path,
        axes.join(", ")
    )
}

fn domain(contract: &dyn Contract) -> String {
    let mut table = Table::new(&[
        ("operand", Align::Left),
        ("format", Align::Left),
        ("from", Align::Right),
        ("to", Align::Right),
        ("what it is", Align::Left),
    ]);
    for operand in contract.operands() {
        let value = |raw: i64| short(operand.format.to_f64(i128::from(raw)));
        table.row([
            code(&operand.name),
            blocks::format(operand.format),
            value(operand.domain.0),
            value(operand.domain.1),
            prose(&operand.doc),
        ]);
    }
    table.text()
}

fn example(contract: &dyn Contract, example: &WorkedExample) -> String {
    let mut table = Table::new(&[
        ("port", Align::Left),
        ("integer", Align::Right),
        ("value", Align::Right),
        ("formula in f64", Align::Right),
    ]);
    let mut row = |quantity: &Quantity, formula: String| {
        table.row([
            code(&quantity.name),
            quantity.raw.to_string(),
            short(quantity.value),
            formula,
        ]);
    };
    let (mut control, mut colours) = (Vec::new(), Vec::new());
    for (operand, quantity) in contract.operands().iter().zip(&example.operands) {
        row(quantity, String::new());
        match operand.colour {
            true => colours.push(quantity.value),
            false => control.push(quantity.raw as i64),
        }
    }
    let f = contract.reference(&contract.point(&control, 0));
    for (output, colour) in example.outputs.iter().zip(colours) {
        row(output, short(f * colour));
    }
    table.text()
}

fn keys(schema: &Schema, config: &Config) -> String {
    let mut table = Table::new(&[
        ("key", Align::Left),
        ("value", Align::Left),
        ("accepts", Align::Left),
        ("what it governs", Align::Left),
    ]);
    for key in &schema.keys {
        let (now, default) = (config.value(key.name).toml(), key.default.toml());
        let value = match config.applies(schema, key.name) {
            false => "–".to_owned(),
            true if now == default => code(&now),
            true => format!("{} (default {})", code(&now), code(&default)),
        };
        let only = key.only_when.map_or_else(String::new, |(other, value)| {
            let value = match config.value(other) {
                Value::Text(_) => Value::Text(value.to_owned()).toml(),
                _ => value.to_owned(),
            };
            format!(" Only with {}.", code(&format!("{other} = {value}")))
        });
        table.row([code(key.name), value, key.accepts(), prose(key.doc) + &only]);
    }
    table.text()
}

/// A value in six decimals, without the zeros at their end.
fn short(value: f64) -> String {
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

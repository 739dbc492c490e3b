//! The stages of a pipeline: as a table, and as a drawing with what each computes and how much of the clock it takes.

use anyhow::Result;
use askama::Template;

use super::account::{Table, code, format_text};
use super::drawing::{Drawing, Item, text_width};
use crate::hdl::netlist::{Design, Net, Pipeline, value_name};

/// The size of the font.
const SIZE: f64 = 11.0;

/// The drawing from left to right: what a page shows without scrolling.
const WIDTH: i32 = 1120;

/// The margin of the drawing.
const BORDER: i32 = 12;

/// Where the microinstructions of a stage begin.
const STEPS: i32 = 56;

/// Where its values begin.
const VALUES: i32 = 290;

/// Where the bar of its clock begins.
const BAR: i32 = 930;

/// From one line of text to the next.
const LINE: i32 = 16;

/// The box of a value, from top to bottom.
const BOX: i32 = 20;

/// From one row of boxes to the next.
const PITCH: i32 = 26;

/// The registers that end a stage, from top to bottom.
const REGISTERS: i32 = 18;

/// The stages with their microinstructions, values, time and registers.
pub fn table(design: &Design, pipeline: &Pipeline) -> Table {
    let mut table = Table::of(
        "stage: | microinstructions | logic, ns: | slack, ns: | register bits: | in delay lines: | computes",
    );
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let values = pipeline.computed(design, number).map(|net| match net.block {
            None => code(value_name(&net.name)),
            Some(block) => format!("{} ({block})", code(value_name(&net.name))),
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

/// Draws the stages, one below the other.
pub fn drawing(design: &Design, pipeline: &Pipeline) -> Drawing {
    let mut items = Vec::new();
    let period = 1000.0 / pipeline.clock_mhz;
    let mut top = BORDER;
    for (number, stage) in pipeline.stages.iter().enumerate() {
        let steps = wrapped(&stage.microinstructions, VALUES - STEPS - 2 * BORDER);
        let values: Vec<&Net> = pipeline.computed(design, number).collect();
        let rows = boxes(&values, top, &mut items);
        items.push(Item::text("name", BORDER, top + 14, number.to_string()));
        for (at, line) in (0..).zip(&steps) {
            items.push(Item::text("step", STEPS, top + 14 + LINE * at, line.clone()));
        }
        let taken = (period - stage.slack_ns).clamp(0.0, period);
        bar(taken / period, top, &mut items);
        let time = format!("{:.2} of {period:.2} ns", period - stage.slack_ns);
        items.push(Item::text("step small", BAR, top + 34, time));
        top += (PITCH * rows).max(LINE * steps.len() as i32 + 4).max(40) + 4;
        let mut bits = format!("{} register bits", stage.register_bits);
        if stage.delayed_bits > 0 {
            bits += &format!(", {} in delay lines", stage.delayed_bits);
        }
        items.push(Item::Open { class: "block", title: bits.clone() });
        items.push(Item::path("box register", outline(BORDER, top, WIDTH - 2 * BORDER, REGISTERS)));
        items.push(Item::text("tick small", WIDTH / 2, top + 13, bits));
        items.push(Item::Close);
        top += REGISTERS + 12;
    }
    Drawing {
        id: "stage-diagram".to_owned(),
        title: format!("Stages of {}", design.name),
        description: format!(
            "{} stages from the operands at the top to the results at the bottom, with the registers that end each. The table \
             of stages says the same in words.",
            pipeline.stages.len()
        ),
        width: WIDTH,
        height: top,
        items,
    }
}

/// Boxes of values, in rows; how many rows there are.
fn boxes(values: &[&Net], top: i32, items: &mut Vec<Item>) -> i32 {
    let (mut x, mut row) = (VALUES, 0);
    for net in values {
        let name = value_name(&net.name);
        let text = match net.block {
            None => name.to_owned(),
            Some(block) => format!("{block} {name}"),
        };
        let width = text_width(&text, SIZE) + 16;
        if x > VALUES && x + width > BAR - BORDER {
            (x, row) = (VALUES, row + 1);
        }
        let doc = if net.doc.is_empty() { String::new() } else { format!(": {}", net.doc) };
        let title = format!("{name}, {}{doc}", format_text(net.format));
        let y = top + PITCH * row;
        items.push(Item::Open { class: "block", title });
        items.push(Item::path("box", outline(x, y, width, BOX)));
        items.push(Item::text("tick", x + width / 2, y + 14, text));
        items.push(Item::Close);
        x += width + 6;
    }
    row + 1
}

/// The share of the clock that a stage takes.
fn bar(share: f64, top: i32, items: &mut Vec<Item>) {
    let width = WIDTH - BORDER - BAR;
    let filled = (f64::from(width) * share).round() as i32;
    items.push(Item::path("box", outline(BAR, top + 4, width, 14)));
    items.push(Item::path("box memory", outline(BAR, top + 4, filled, 14)));
}

fn outline(x: i32, y: i32, width: i32, height: i32) -> String {
    format!("M{x} {y}H{}V{}H{x}Z", x + width, y + height)
}

/// Names, each from a line of its own, in lines that are no wider.
fn wrapped(names: &[String], width: i32) -> Vec<String> {
    let mut lines = Vec::new();
    for name in names {
        let mut line = String::new();
        for word in name.split(' ') {
            if !line.is_empty() && text_width(&format!("{line} {word}"), SIZE) > width {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line += word;
        }
        lines.push(line);
    }
    lines
}

#[derive(Template)]
#[template(path = "standalone.svg")]
struct Standalone<'a> {
    drawing: &'a str,
    width: i32,
    height: i32,
}

/// The drawing as a file of its own, ending with a newline.
///
/// # Errors
/// A template that fails to print.
pub fn svg(design: &Design, pipeline: &Pipeline) -> Result<String> {
    let drawing = drawing(design, pipeline);
    let (width, height) = (drawing.width, drawing.height);
    Ok(Standalone { drawing: &drawing.svg()?, width, height }.render()? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_break_between_words() {
        let names = ["load the operands".to_owned(), "result".to_owned()];
        assert_eq!(
            wrapped(&names, text_width("load the", SIZE)),
            ["load the", "operands", "result"]
        );
    }
}

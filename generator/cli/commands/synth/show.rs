//! Prints the measurements of `glint synth`, as text for people and as JSON for scripts.

use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};

use super::{FigureRecord, Measurement};
use crate::report::CommandReport;
use crate::say;
use crate::tables;
use glint_prove::synth::{Figures, Frequency, Rate, tools};

/// The text of a cell without a figure.
const NONE: &str = "–";

pub struct SynthesisReport<'a> {
    pub measured: Vec<Measurement<'a>>,
    /// The targets that were not measured, each with the reason.
    pub notes: Vec<String>,
    /// The paths of the records that were written.
    pub written: Vec<String>,
}

impl CommandReport for SynthesisReport<'_> {
    fn json(&self) -> Result<Value> {
        Ok(as_json(&self.measured, &self.notes))
    }

    fn print(&self) -> Result<()> {
        print(&self.measured, &self.notes);
        for file in &self.written {
            say!("{file} written");
        }
        Ok(())
    }
}

fn print(measured: &[Measurement], notes: &[String]) {
    let mut rows = Vec::new();
    for one in measured {
        for figures in &one.figures {
            rows.push(row(one, figures));
        }
    }
    tables::print(
        "configuration | target | LUT: | DSP: | RAM: | FF:3 | gates:2 | µm²:5 | MHz: | spread:4 | clocks/point:1 | \
         M points/s: | k/s per LUT:6 | M/s per DSP:6",
        rows,
    );
    for one in measured {
        for figures in &one.figures {
            let about = format!("{}, {}", one.one.core.config().name, figures.device);
            if !figures.critical_path.is_empty() {
                say!("{about}: {}", figures.path_in_words());
            }
            if let Some(reason) = &figures.untimed {
                say!("{about}: {reason}");
            }
        }
    }
    let tools = tools(measured.iter().flat_map(|one| &one.figures));
    say!("Measured with {}.", Vec::from_iter(tools).join(", "));
    for note in notes {
        say!("Note: {note}");
    }
}

/// Returns the figures as a line, for example `ECP5: 367 LUT, 1 DSP, 0 RAM, 112.30 MHz`.
pub fn in_a_line(figures: &Figures) -> String {
    let area = &figures.area;
    let mut parts: Vec<String> = Vec::new();
    for (unit, count) in [("LUT", area.luts), ("DSP", area.dsps), ("RAM", area.block_rams)] {
        if let Some(count) = count {
            parts.push(format!("{count} {unit}"));
        }
    }
    if let Some(gates) = area.gates {
        parts.push(format!("{gates:.0} gates"));
    }
    if let Some(frequency) = figures.frequency {
        parts.push(format!("{:.2} MHz", frequency.median));
    }
    format!("{}: {}", figures.target.title(), parts.join(", "))
}

fn count(number: Option<u64>) -> String {
    match number {
        Some(number) => number.to_string(),
        None => NONE.to_owned(),
    }
}

/// Writes `digits` digits after the decimal point.
fn decimal(number: Option<f64>, digits: usize) -> String {
    match number {
        Some(number) => format!("{number:.digits$}"),
        None => NONE.to_owned(),
    }
}

fn row(one: &Measurement, figures: &Figures) -> Vec<String> {
    let area = &figures.area;
    let spread = match figures.frequency {
        Some(Frequency { runs: 2.., lowest, highest, .. }) => format!("{lowest:.1}–{highest:.1}"),
        _ => NONE.to_owned(),
    };
    let (mut points, mut per_lut, mut per_dsp) = (None, None, None);
    if let Some(rate) = one.rate(figures) {
        points = Some(rate.points);
        per_lut = rate.per_lut.map(|millions| millions * 1000.0);
        per_dsp = rate.per_dsp;
    }
    vec![
        one.one.core.config().name.clone(),
        figures.target.to_string(),
        count(area.luts),
        count(area.dsps),
        count(area.block_rams),
        area.flip_flops.to_string(),
        decimal(area.gates, 0),
        decimal(area.square_micrometres, 0),
        decimal(figures.frequency.map(|frequency| frequency.median), 2),
        spread,
        format!("{:.3}", one.clocks_per_point)
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        decimal(points, 2),
        decimal(per_lut, 2),
        decimal(per_dsp, 2),
    ]
}

#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    recorded: FigureRecord<'a>,
    #[serde(flatten)]
    rate: Option<Rate>,
}

fn as_json(measured: &[Measurement], notes: &[String]) -> Value {
    let mut all: Vec<Value> = Vec::new();
    for one in measured {
        let mut targets: Vec<Value> = Vec::new();
        for figures in &one.figures {
            targets.push(json!(Told { recorded: one.recorded(figures), rate: one.rate(figures) }));
        }
        all.push(json!({
            "config": one.one.path,
            "name": one.one.core.config().name,
            "device": one.one.core.device().name,
            "clocks_per_point": one.clocks_per_point,
            "targets": targets,
        }));
    }
    json!({ "ok": true, "synthesis": all, "notes": notes })
}

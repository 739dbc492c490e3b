//! Makes the datasheet's tables from a record of `glint synth`: area, frequency, points a second and critical path on each
//! target.

use super::table::TableView;
use crate::figures::{Figures, Frequency, Rate, SynthesisRecord};
use crate::pages::account::TextTable;

/// A cell's text if the target has no such resource, or if nothing was measured.
const NONE: &str = "–";

pub struct RecordView {
    pub table: TableView,
    /// The name of each chip or cell library with a frequency, and its longest path as text.
    pub paths: Vec<(String, String)>,
    /// The chips on which no frequency was measured, with the reason.
    pub untimed: Vec<(String, String)>,
    pub tools: String,
}

impl RecordView {
    /// Makes the tables. The row of the target named `target` comes first, if the record has it.
    pub fn new(record: &SynthesisRecord, target: Option<&str>) -> Self {
        let mut measured: Vec<&Figures> = record.targets.iter().collect();
        measured.sort_by_key(|figures| Some(figures.target.name()) != target);
        let mut table = TextTable::of(
            "target | LUT: | DSP: | RAM: | FF: | gates: | MHz: | M points/s: | k/s per LUT: | M/s per DSP:",
        );
        let mut paths = Vec::new();
        let mut untimed = Vec::new();
        for figures in measured {
            table.rows.push(row(figures, record.clocks_per_point));
            if !figures.critical_path.is_empty() {
                paths.push((figures.device.clone(), figures.path_in_words()));
            }
            if let Some(reason) = &figures.untimed {
                untimed.push((figures.device.clone(), reason.clone()));
            }
        }
        let tools = Vec::from_iter(record.tools()).join(", ");
        Self { table: TableView::new("Area and speed", &table), paths, untimed, tools }
    }
}

/// Returns the measurement for the summary at the datasheet's head. It is for the FPGA `target` if the record has it, and
/// otherwise for the FPGA with the most points per second.
pub fn leading<'r>(
    record: &'r SynthesisRecord,
    target: Option<&str>,
) -> Option<(&'r Figures, Frequency, Rate)> {
    let mut timed: Vec<(&Figures, Frequency, Rate)> = Vec::new();
    for figures in &record.targets {
        let is_fpga = figures.area.luts.is_some();
        if is_fpga
            && let Some(frequency) = figures.frequency
            && let Some(rate) = Rate::new(figures, record.clocks_per_point)
        {
            timed.push((figures, frequency, rate));
        }
    }
    let on_target = timed.iter().find(|(figures, ..)| Some(figures.target.name()) == target);
    let fastest = timed.iter().max_by(|a, b| a.2.points.total_cmp(&b.2.points));
    on_target.or(fastest).copied()
}

fn row(figures: &Figures, clocks_per_point: f64) -> Vec<String> {
    let area = &figures.area;
    let frequency = match figures.frequency {
        Some(Frequency { median, runs: 1, .. }) => format!("{median:.1}"),
        Some(Frequency { median, lowest, highest, .. }) => {
            format!("{median:.1} ({lowest:.1}–{highest:.1})")
        }
        None => NONE.to_owned(),
    };
    let (mut points, mut per_lut, mut per_dsp) = (None, None, None);
    if let Some(rate) = Rate::new(figures, clocks_per_point) {
        points = Some(rate.points);
        per_lut = rate.per_lut.map(|millions| millions * 1000.0);
        per_dsp = rate.per_dsp;
    }
    vec![
        figures.device.clone(),
        count(area.luts),
        count(area.dsps),
        count(area.block_rams),
        area.flip_flops.to_string(),
        decimal(area.gates, 0),
        frequency,
        decimal(points, 1),
        decimal(per_lut, 1),
        decimal(per_dsp, 1),
    ]
}

fn count(number: Option<u64>) -> String {
    match number {
        Some(number) => number.to_string(),
        None => NONE.to_owned(),
    }
}

fn decimal(number: Option<f64>, digits: usize) -> String {
    match number {
        Some(number) => format!("{number:.digits$}"),
        None => NONE.to_owned(),
    }
}

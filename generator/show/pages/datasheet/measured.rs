//! Tabulates the record of `glint synth` for the datasheet: area, frequency, rate and critical path on each target.

use super::table::TableView;
use crate::figures::{Figures, Frequency, Rate, Record};
use crate::pages::account::Table;

/// The cell of a target without such a thing, or without a measurement.
const NONE: &str = "–";

/// The record as the page prints it.
pub struct RecordView {
    pub table: TableView,
    /// A target, and its longest path.
    pub paths: Vec<(String, String)>,
    /// Why a target has no frequency.
    pub untimed: Vec<(String, String)>,
    pub tools: String,
}

impl RecordView {
    pub fn new(record: &Record) -> Self {
        let mut table = Table::of(
            "target | LUT: | DSP: | RAM: | FF: | gates: | MHz: | M points/s: | k/s per LUT: | M/s per DSP:",
        );
        table.rows = record.targets.iter().map(|it| row(it, record.clocks_per_point)).collect();
        let of = |figures: &Figures, text: String| (figures.device.clone(), text);
        let timed = record.targets.iter().filter(|it| !it.critical_path.is_empty());
        let untimed = record.targets.iter();
        Self {
            table: TableView::new("Area and speed", &table),
            paths: timed.map(|it| of(it, it.path_in_words())).collect(),
            untimed: untimed.filter_map(|it| Some(of(it, it.untimed.clone()?))).collect(),
            tools: Vec::from_iter(record.tools()).join(", "),
        }
    }
}

/// Returns the frequency and the rate on the FPGA with the most points a second, for a reader in a hurry.
pub fn fastest(record: &Record) -> Option<(&Figures, Frequency, Rate)> {
    let timed = record
        .targets
        .iter()
        .filter(|it| it.area.luts.is_some())
        .filter_map(|it| Some((it, it.frequency?, Rate::new(it, record.clocks_per_point)?)));
    timed.max_by(|a, b| a.2.points.total_cmp(&b.2.points))
}

fn row(figures: &Figures, clocks_per_point: f64) -> Vec<String> {
    let area = &figures.area;
    let known = |text: Option<String>| text.unwrap_or_else(|| NONE.to_owned());
    let count = |number: Option<u64>| known(number.map(|it| it.to_string()));
    let decimal = |number: Option<f64>| known(number.map(|it| format!("{it:.1}")));
    let rate = Rate::new(figures, clocks_per_point);
    vec![
        figures.device.clone(),
        count(area.luts),
        count(area.dsps),
        count(area.block_rams),
        area.flip_flops.to_string(),
        known(area.gates.map(|it| format!("{it:.0}"))),
        known(figures.frequency.map(|it| match it.runs {
            1 => format!("{:.1}", it.median),
            _ => format!("{:.1} ({:.1}–{:.1})", it.median, it.lowest, it.highest),
        })),
        decimal(rate.map(|it| it.points)),
        decimal(rate.and_then(|it| it.per_lut).map(|it| it * 1000.0)),
        decimal(rate.and_then(|it| it.per_dsp)),
    ]
}

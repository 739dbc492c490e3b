//! Tabulates the record of `glint synth` for the datasheet: area, frequency, rate and critical path on each target.

use super::table::TableView;
use crate::figures::{Figures, Frequency, Rate, SynthesisRecord};
use crate::pages::account::TextTable;

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
    /// Makes the tables of a record. The first row has the figures of `target`, if it was measured.
    pub fn new(record: &SynthesisRecord, target: Option<&str>) -> Self {
        let mut measured: Vec<&Figures> = record.targets.iter().collect();
        measured.sort_by_key(|figures| Some(figures.target.name()) != target);
        let mut table = TextTable::of(
            "target | LUT: | DSP: | RAM: | FF: | gates: | MHz: | M points/s: | k/s per LUT: | M/s per DSP:",
        );
        table.rows = measured.iter().map(|it| row(it, record.clocks_per_point)).collect();
        let of = |figures: &Figures, text: String| (figures.device.clone(), text);
        let timed = measured.iter().filter(|it| !it.critical_path.is_empty());
        let untimed = measured.iter();
        Self {
            table: TableView::new("Area and speed", &table),
            paths: timed.map(|it| of(it, it.path_in_words())).collect(),
            untimed: untimed.filter_map(|it| Some(of(it, it.untimed.clone()?))).collect(),
            tools: Vec::from_iter(record.tools()).join(", "),
        }
    }
}

/// Returns the frequency and the rate on one FPGA, for a reader in a hurry. It is `target` if that was measured, and
/// else the FPGA with the most points a second. For example, a pipeline for ECP5 has the figures of ECP5, even if
/// another FPGA is faster.
pub fn leading<'r>(
    record: &'r SynthesisRecord,
    target: Option<&str>,
) -> Option<(&'r Figures, Frequency, Rate)> {
    let on_fpgas = record.targets.iter().filter(|it| it.area.luts.is_some());
    let timed: Vec<(&Figures, Frequency, Rate)> = on_fpgas
        .filter_map(|it| Some((it, it.frequency?, Rate::new(it, record.clocks_per_point)?)))
        .collect();
    let on_target = timed.iter().find(|(figures, ..)| Some(figures.target.name()) == target);
    let fastest = timed.iter().max_by(|a, b| a.2.points.total_cmp(&b.2.points));
    on_target.or(fastest).copied()
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

//! Prints the figures of synthesis for people and for scripts.

use serde::Serialize;
use serde_json::{Value, json};

use super::{FigureRecord, Measurement};
use crate::say;
use crate::tables;
use glint_prove::synth::{Figures, Rate, tools};

/// The cell without a figure.
const NONE: &str = "–";

pub fn print(measured: &[Measurement], notes: &[String]) {
    let rows =
        measured.iter().flat_map(|one| one.figures.iter().map(move |figures| row(one, figures)));
    tables::print(
        "configuration | target | LUT: | DSP: | RAM: | FF:3 | gates:2 | µm²:5 | MHz: | spread:4 | clocks/point:1 | \
         M points/s: | k/s per LUT:6 | M/s per DSP:6",
        rows,
    );
    for one in measured {
        for figures in &one.figures {
            let about = format!("{}, {}", one.one.core.config.name, figures.device);
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

/// Returns the figures of a target in a line. For example, `ECP5: 367 LUT, 1 DSP, 0 RAM, 112.30 MHz`.
pub fn in_a_line(figures: &Figures) -> String {
    let area = &figures.area;
    let counts = [("LUT", area.luts), ("DSP", area.dsps), ("RAM", area.block_rams)];
    let counts = counts.into_iter().filter_map(|(unit, count)| Some(format!("{} {unit}", count?)));
    let gates = area.gates.map(|gates| format!("{gates:.0} gates"));
    let clock = figures.frequency.map(|frequency| format!("{:.2} MHz", frequency.median));
    let parts: Vec<String> = counts.chain(gates).chain(clock).collect();
    format!("{}: {}", figures.target.title(), parts.join(", "))
}

fn row(one: &Measurement, figures: &Figures) -> Vec<String> {
    let (area, frequency) = (&figures.area, figures.frequency);
    let known = |text: Option<String>| text.unwrap_or_else(|| NONE.to_owned());
    let count = |number: Option<u64>| known(number.map(|it| it.to_string()));
    let whole = |number: Option<f64>| known(number.map(|it| format!("{it:.0}")));
    let decimal = |number: Option<f64>| known(number.map(|it| format!("{it:.2}")));
    let spread = frequency.filter(|it| it.runs > 1);
    let rate = one.rate(figures);
    vec![
        one.one.core.config.name.clone(),
        figures.target.to_string(),
        count(area.luts),
        count(area.dsps),
        count(area.block_rams),
        area.flip_flops.to_string(),
        whole(area.gates),
        whole(area.square_micrometres),
        decimal(frequency.map(|it| it.median)),
        known(spread.map(|it| format!("{:.1}–{:.1}", it.lowest, it.highest))),
        format!("{:.3}", one.clocks_per_point)
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        decimal(rate.map(|it| it.points)),
        decimal(rate.and_then(|it| it.per_lut).map(|it| it * 1000.0)),
        decimal(rate.and_then(|it| it.per_dsp)),
    ]
}

#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    recorded: FigureRecord<'a>,
    #[serde(flatten)]
    rate: Option<Rate>,
}

pub fn as_json(measured: &[Measurement], notes: &[String]) {
    let all = measured.iter().map(|one| {
        let targets = one.figures.iter().map(|figures| {
            json!(Told { recorded: one.recorded(figures), rate: one.rate(figures) })
        });
        json!({
            "config": one.one.path,
            "name": one.one.core.config.name,
            "device": one.one.core.device.name,
            "clocks_per_point": one.clocks_per_point,
            "targets": targets.collect::<Vec<Value>>(),
        })
    });
    let all: Vec<Value> = all.collect();
    tables::print_json(&json!({ "ok": true, "synthesis": all, "notes": notes }));
}

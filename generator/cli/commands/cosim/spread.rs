//! Prints how many results of a co-simulation run had values of the reflectance `f` in each of nine classes.

use serde_json::{Value, json};

use crate::say;
use glint_core::cosim::{CLASSES, Histogram};

/// Prints the share of the results in each class in per cent.
pub fn print(histogram: &Histogram) {
    let counts = histogram.counts();
    let all = counts.iter().sum::<u64>().max(1) as f64;
    let cell = |text: String| format!("{text:>8}");
    let classes: String = CLASSES.map(|class| cell(class.to_owned())).concat();
    let shares = counts.map(|count| cell(format!("{:.1} %", 100.0 * count as f64 / all)));
    say!("  f     {classes}");
    say!("  points{}", shares.concat());
}

/// Returns the number of results in each class, and the share of results with `f` strictly between 0 and 1.
pub fn as_json(histogram: &Histogram) -> Value {
    let classes = CLASSES.iter().zip(histogram.counts());
    let classes: Vec<Value> =
        classes.map(|(class, points)| json!({ "f": class, "points": points })).collect();
    json!({ "classes": classes, "share_between_0_and_1": histogram.share_inside() })
}

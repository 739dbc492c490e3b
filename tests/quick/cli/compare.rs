//! Tests `glint compare`: the test computes the errors, clocks and bits of several devices a second time and compares them with
//! the output.

use serde_json::{Value, json};

use crate::common::files::{json, root};
use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Run, Workspace};

/// Returns a comparison without synthesis.
fn compare(arguments: &[&str]) -> Run {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.glint(["compare", "--no-synthesis"].iter().chain(arguments))
}

#[track_caller]
fn compared(arguments: &[&str]) -> Value {
    let run = compare(&[arguments, &["--json"]].concat()).quiet();
    run.json()
}

fn entry<'a>(value: &'a Value, name: &str) -> &'a Value {
    value["entries"].of("name", name)
}

/// Returns the cosines of the grid, from 0 to 90 degrees by a hundredth, as 20 fraction bits hold them; and unrounded.
fn cosines() -> impl Iterator<Item = (i64, f64)> {
    (0..=9000).map(|step| {
        let cosine = (f64::from(step) / 100.0).to_radians().cos();
        ((cosine * 1048576.0).round() as i64, cosine)
    })
}

/// Returns the largest and the mean.
fn spread(errors: impl Iterator<Item = f64>) -> (f64, f64) {
    let errors: Vec<f64> = errors.map(f64::abs).collect();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    (largest, errors.iter().sum::<f64>() / errors.len() as f64)
}

#[track_caller]
fn assert_spread(told: &Value, (largest, mean): (f64, f64)) {
    for (name, wanted) in [("largest", largest), ("mean", mean)] {
        let told = told[name].number();
        assert!((told - wanted).abs() < 1e-12, "{name}: {told}, not {wanted}");
    }
}

#[test]
fn the_formula_of_cosine_power_agrees_at_35() {
    let value = compared(&["--exponent", "35"]);
    assert_eq!(value["angles"]["count"], 9001);
    let errors = &entry(&value, "cosine-power")["errors"];
    // (35/16·(c − 1) + 1)¹⁶ against c³⁵.
    let formula = cosines().map(|(raw, _)| {
        let cosine = raw as f64 / 1048576.0;
        (35.0 / 16.0 * (cosine - 1.0) + 1.0).max(0.0).powi(16) - cosine.powi(35)
    });
    assert_spread(&errors["formula"], spread(formula));
    let operands =
        cosines().map(|(raw, cosine)| (raw as f64 / 1048576.0).powi(35) - cosine.powi(35));
    assert_spread(&errors["operands"], spread(operands));
}

#[test]
fn errors_of_schlick_at_20_agree_with_integers() {
    let value = compared(&["-n", "20"]);
    let schlick = entry(&value, "schlick");
    // In integers: ten bits of c / (20·(1 − c) + c).
    let word = |raw: i64| (1024 * raw / (20 * (1048576 - raw) + raw)).min(1023) as f64 / 1024.0;
    let whole = cosines().map(|(raw, cosine)| word(raw) - cosine.powi(20));
    assert_spread(&schlick["errors"]["error"], spread(whole));
    let fixed_point = cosines().map(|(raw, _)| {
        let cosine = raw as f64 / 1048576.0;
        word(raw) - cosine / (20.0 - 20.0 * cosine + cosine)
    });
    assert_spread(&schlick["errors"]["fixed_point"], spread(fixed_point));
    // Words 0, 1 and 3, ten bits, and the clock of `start`; four words of control ROM, nine bits each.
    assert_eq!(schlick["clocks_per_point"], 14.0);
    assert_eq!(schlick["rom_bits"], 36);
    assert_eq!(schlick["multipliers"], json!([[21, 10], [10, 8], [10, 8], [10, 8]]));
    assert_eq!(schlick.get("synthesis"), None);
}

#[test]
fn every_device_is_there_and_configurations_as_they_are() {
    let dir = Workspace::new();
    let devices = dir.glint(["list", "--json"]).json()["devices"].clone();
    let mut names = devices.each("name");
    // These are no highlights.
    names.retain(|name| {
        !["function", "expression", "unit", "normaliser", "dot-product", "shading"].contains(name)
    });
    let value = compared(&["core.toml", "--bits", "10"]);
    names.push("core.toml");
    assert_eq!(value["entries"].each("name"), names);
    // The width is of the devices; the configuration has its own.
    let toml = |name| entry(&value, name)["toml"].text().to_owned();
    assert!(toml("cosine-power").contains("bits = 10\n"), "{}", toml("cosine-power"));
    assert!(toml("core.toml").contains("[colour]\nbits = 8\n"), "{}", toml("core.toml"));
    let bits = |name| entry(&value, name)["multipliers"][1].clone();
    assert_eq!((bits("cosine-power"), bits("core.toml")), (json!([16, 10]), json!([16, 8])));
}

/// The record of a device in `records/synthesis/`; frequency over clocks a point, eight of `cosine-power`, are points a second.
#[test]
fn figures_of_a_record_stand_beside_its_device() {
    let directory = root().join("records/synthesis").display().to_string();
    let record = json(format!("{directory}/cosine_power.json"));
    let ecp5 = record["targets"].of("target", "ecp5");
    let value = compared(&["core.toml", "--figures", &directory]);
    let speed = &entry(&value, "cosine-power")["speed"]["ecp5"];
    assert_eq!(speed["mhz"], ecp5["frequency"]);
    let points = ecp5["frequency"]["median"].number() / 8.0;
    let told = |key: &str| speed[key].number();
    assert!((told("million_points_per_second") - points).abs() < 1e-9, "{speed}");
    for (key, count) in [("lut", "luts"), ("dsp", "dsps")] {
        let share = points / ecp5["area"][count].number();
        let told = told(&format!("million_points_per_second_per_{key}"));
        assert!((told - share).abs() < 1e-9, "{speed}");
    }
    // The same core under another name; another core; no records.
    assert_eq!(entry(&value, "core.toml")["speed"]["ecp5"], *speed);
    let wide = compared(&["--bits", "10", "--figures", &directory]);
    assert_eq!(entry(&wide, "cosine-power").get("speed"), None);
    assert_eq!(entry(&compared(&[]), "cosine-power").get("speed"), None);

    let text = compare(&["--figures", &directory]).out;
    let row = format!("{points:.1}");
    let cells = |line: &str| line.split('|').map(|it| it.trim().to_owned()).collect::<Vec<_>>();
    let mut rows = text.lines().map(cells).filter(|row| row.len() > 5 && row[2] == "ECP5");
    let found = rows.find(|row| row[1] == "cosine-power").expect("a row");
    assert_eq!(found[5], row, "{text}");
    let csv = compare(&["--figures", &directory, "--csv"]).out;
    let heading: Vec<&str> = csv.lines().next().expect("a heading").split(',').collect();
    let at = heading.iter().position(|it| *it == "ecp5_mhz").expect("a column");
    // From the right: an earlier field has commas inside.
    let line = csv.lines().find(|line| line.starts_with("cosine-power,")).expect("a row");
    let field = line.rsplit(',').nth(heading.len() - 1 - at).expect("a field");
    assert_eq!(field, ecp5["frequency"]["median"].to_string());
}

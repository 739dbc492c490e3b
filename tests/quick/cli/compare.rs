//! `compare`: figures that are computed here a second time, the three forms of output, widths, and tools
//! that are missing, fail or hang.

use serde_json::{Value, json};

use crate::workspace::{COSINE_POWER, Run, Workspace};

/// A comparison without synthesis.
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
    let entries = value["entries"].as_array().expect("entries");
    let found = entries.iter().find(|entry| entry["name"] == name);
    found.unwrap_or_else(|| panic!("no {name} in {value}"))
}

/// The cosines of the grid, from 0 to 90 degrees by a hundredth, as 20 fraction bits hold them; and unrounded.
fn cosines() -> impl Iterator<Item = (i64, f64)> {
    (0..=9000).map(|step| {
        let cosine = (f64::from(step) / 100.0).to_radians().cos();
        ((cosine * 1048576.0).round() as i64, cosine)
    })
}

/// The largest and the mean.
fn spread(errors: impl Iterator<Item = f64>) -> (f64, f64) {
    let errors: Vec<f64> = errors.map(f64::abs).collect();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    (largest, errors.iter().sum::<f64>() / errors.len() as f64)
}

#[track_caller]
fn assert_spread(told: &Value, (largest, mean): (f64, f64)) {
    for (name, wanted) in [("largest", largest), ("mean", mean)] {
        let told = told[name].as_f64().expect("a number");
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
    let mut names: Vec<&str> = devices
        .as_array()
        .expect("a list")
        .iter()
        .map(|device| device["name"].as_str().expect("a name"))
        // It is no highlight.
        .filter(|name| *name != "function")
        .collect();
    let value = compared(&["core.toml", "--bits", "10"]);
    let told: Vec<&str> = value["entries"]
        .as_array()
        .expect("entries")
        .iter()
        .map(|entry| entry["name"].as_str().expect("a name"))
        .collect();
    names.push("core.toml");
    assert_eq!(told, names);
    // The width is of the devices; the configuration has its own.
    let toml = |name| entry(&value, name)["toml"].as_str().expect("TOML").to_owned();
    assert!(toml("cosine-power").contains("bits = 10\n"), "{}", toml("cosine-power"));
    assert!(toml("core.toml").contains("[colour]\nbits = 8\n"), "{}", toml("core.toml"));
    let bits = |name| entry(&value, name)["multipliers"][1].clone();
    assert_eq!((bits("cosine-power"), bits("core.toml")), (json!([16, 10]), json!([16, 8])));
}

/// The record of a device in `synthesis/`; frequency over clocks a point, eight of `cosine-power`, are points a second.
#[test]
fn figures_of_a_record_stand_beside_its_device() {
    let directory = format!("{}/synthesis", env!("CARGO_MANIFEST_DIR"));
    let record = std::fs::read_to_string(format!("{directory}/cosine_power.json")).expect("it");
    let record: Value = serde_json::from_str(&record).expect("JSON");
    let targets = record["targets"].as_array().expect("targets");
    let ecp5 = targets.iter().find(|it| it["target"] == "ecp5").expect("figures for ECP5");
    let value = compared(&["core.toml", "--figures", &directory]);
    let speed = &entry(&value, "cosine-power")["speed"]["ecp5"];
    assert_eq!(speed["mhz"], ecp5["frequency"]);
    let points = ecp5["frequency"]["median"].as_f64().expect("a frequency") / 8.0;
    let told = |key: &str| speed[key].as_f64().expect("a number");
    assert!((told("million_points_per_second") - points).abs() < 1e-9, "{speed}");
    for (key, count) in [("lut", "luts"), ("dsp", "dsps")] {
        let share = points / ecp5["area"][count].as_f64().expect("a count");
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

#[test]
fn csv_has_a_row_for_each_core() {
    let dir = Workspace::with("a, \"b\".toml", format!("{COSINE_POWER}name = \"mine\"\n"));
    let run = dir.glint(["compare", "--no-synthesis", "--csv", "a, \"b\".toml"]).quiet();
    let lines: Vec<&str> = run.out.lines().collect();
    assert!(lines[0].starts_with("name,device,exponent,error_largest,error_mean,formula_largest,"));
    assert!(lines[0].ends_with(",bound_units,clocks_per_point,rom_bits,multipliers"));
    let row = lines.last().expect("a row");
    assert!(row.starts_with("\"a, \"\"b\"\".toml\",cosine-power,35,0."), "{row}");
    assert!(row.ends_with(",8,40,\"21x16, 3 of 16x8\""), "{row}");
    // What is to be told beside the rows does not disturb them.
    dir.write("narrow.toml", "device = \"schlick\"\ndomain.exponent_max = 100\n");
    let noted = ["compare", "--no-synthesis", "--csv", "--exponent", "200", "narrow.toml"];
    let noted = dir.glint(noted);
    assert!(!noted.out.contains("domain"), "{noted:?}");
    assert!(noted.err.contains("warning: narrow.toml: n = 200"), "{noted:?}");
}

/// A comparison with `PATH` leading to this `yosys` alone, if to any.
#[cfg(unix)]
fn with_yosys(script: Option<&str>, arguments: &[&str]) -> Run {
    let dir = Workspace::new();
    if let Some(script) = script {
        dir.script("tools/yosys", script);
    }
    dir.with_own_tools(["compare"].iter().chain(arguments))
}

/// Writes statistics of the module that the script names.
#[cfg(unix)]
const COUNTS: &str = r#"
s=${3#*-check -top }
cells='"SB_LUT4": 11, "SB_MAC16": 3, "SB_RAM40_4K": 2, "LUT4": 20, "CCU2C": 4, "MULT18X18D": 5, "DP16KD": 1,
"LUT1": 1, "LUT6": 40, "DSP48E1": 6, "RAMB18E1": 1, "RAMB36E1": 1, "FDRE": 99'
printf '{"modules": {"\\\\%s": {"num_cells_by_type": {%s}}}}' "${s%%;*}" "$cells" >statistics.json"#;

#[cfg(unix)]
#[test]
fn figures_of_yosys_stand_in_every_form_of_output() {
    let run = with_yosys(Some(COUNTS), &["--json"]).quiet();
    let value = run.json();
    let told = &entry(&value, "schlick")["synthesis"];
    // A carry cell of ECP5 is two tables, the larger RAM of Xilinx two of the smaller.
    assert_eq!(
        *told,
        json!({
            "ice40": { "luts": 11, "dsps": 3, "block_rams": 2 },
            "ecp5": { "luts": 20 + 4 * 2, "dsps": 5, "block_rams": 1 },
            "xilinx7": { "luts": 20 + 41, "dsps": 6, "block_rams": 3 },
        })
    );
    let text = with_yosys(Some(COUNTS), &[]).out;
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| schlick ")).collect();
    let cells: Vec<&str> = rows[1].split('|').map(str::trim).collect();
    assert_eq!(cells[5..14], ["11", "3", "2", "28", "5", "1", "61", "6", "3"]);
    let csv = with_yosys(Some(COUNTS), &["--csv"]).out;
    assert!(csv.lines().next().is_some_and(|line| line.ends_with(",xilinx7_block_rams")), "{csv}");
    assert!(csv.contains(",11,3,2,28,5,1,61,6,3\n"), "{csv}");
}

#[cfg(unix)]
#[test]
fn yosys_hangs() {
    // Only for one family, so that this does not take long.
    let hangs = format!("case $3 in *synth_ecp5*) exec /bin/sleep 100;; esac\n{COUNTS}");
    let run = with_yosys(Some(&hangs), &["--time-limit", "1"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.out.contains("FAILS: schlick, ECP5: `yosys` did not end within"), "{run:?}");
}

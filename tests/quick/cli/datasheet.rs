//! `datasheet`: what is in its pages, and whose they are.

use serde_json::Value;

use crate::workspace::{COSINE_POWER, Run, Workspace};

fn dir() -> Workspace {
    Workspace::with("core.toml", COSINE_POWER)
}

fn datasheet(dir: &Workspace, arguments: &[&str]) -> Run {
    let start = ["datasheet", "core.toml", "--no-synthesis"];
    dir.glint(start.iter().chain(arguments))
}

#[test]
fn pages_are_the_same_wherever_they_go() {
    let dir = dir();
    datasheet(&dir, &[]).good();
    datasheet(&dir, &["--out", "one.html"]).good();
    let page = dir.read("one.html");
    assert_eq!(page, dir.read("datasheets/core.html"));
    let directory = dir.path().display().to_string();
    assert!(!page.contains(&directory), "a path of this machine");
}

#[test]
fn waves_have_one_length() {
    let dir = dir();
    datasheet(&dir, &["--out", "core.html", "--wavedrom"]);
    let waves: Value = dir.json("core.wavedrom.json");
    let signal = waves["signal"].as_array().expect("signals");
    let lengths = signal.iter().map(|lane| {
        let wave = lane["wave"].as_str().expect("a wave");
        // A value for each frame.
        let data = lane["data"].as_array().map_or(0, Vec::len);
        assert_eq!(wave.matches('=').count(), data, "{lane}");
        wave.len()
    });
    let mut lengths: Vec<usize> = lengths.collect();
    lengths.dedup();
    assert_eq!(lengths.len(), 1, "{lengths:?}");
}

#[test]
fn edited_files_stay() {
    let dir = dir();
    let arguments = ["--out", "core.html", "--wavedrom"];
    datasheet(&dir, &arguments);
    for file in ["core.html", "core.wavedrom.json"] {
        let ours = dir.read(file);
        for mine in [&ours.replace("core", "mine"), "my notes\n"] {
            dir.write(file, mine);
            let run = datasheet(&dir, &arguments);
            run.refused(1, &[file, "was edited since; nothing was changed", "--force"]);
            assert_eq!(dir.read(file), mine);
        }
        datasheet(&dir, &["--out", "core.html", "--wavedrom", "--force"]);
        assert_eq!(dir.read(file), ours);
    }
}

#[test]
fn a_record_must_be_of_the_configuration() {
    let dir = dir();
    let record = include_str!("../../../proofs/cosine_power.json");
    dir.write("records/any_name.json", record);
    dir.write("records/beside.json", "{}");
    datasheet(&dir, &["--proofs", "records"]).good();
    let page = dir.read("datasheets/core.html");
    // 1 048 577 cosines and 1000 exponents.
    assert!(page.contains("1\u{202f}048\u{202f}577\u{202f}000 evaluations"));
    dir.write("core.toml", "device = \"cosine-power\"\npower = 2\n");
    datasheet(&dir, &["--proofs", "records", "--force"]).good();
    assert!(dir.read("datasheets/core.html").contains("There is no record of such a check"));
    // Of this configuration, but what it was made with had another domain.
    dir.write("core.toml", "device = \"cosine-power\"\n");
    dir.write("records/any_name.json", record.replace("\"to\": 1000", "\"to\": 999"));
    let run = datasheet(&dir, &["--proofs", "records"]);
    run.refused(1, &["records/any_name.json", "another version of Glint", "--exhaustive --json"]);
    // Half of it, and without a figure.
    for damaged in
        [&record[..record.len() / 2], &record.replace("\"colour_products\"", "\"other\"")]
    {
        dir.write("records/any_name.json", damaged);
        let run = datasheet(&dir, &["--proofs", "records"]);
        run.refused(1, &["records/any_name.json` is damaged: restore it"]);
    }
}

#[cfg(unix)]
#[test]
fn synthesis_has_its_section() {
    let dir = dir();
    Run::of(dir.with_yosys().args(["datasheet", "core.toml"]).output()).good();
    let page = dir.read("datasheets/core.html");
    assert!(page.contains("by Yosys 0."));
    // The families count other cells, of which the made-up netlist has 100 of each kind.
    for (family, luts) in [("iCE40", 100), ("ECP5", 100), ("Xilinx 7", 200)] {
        let row = format!("<th scope=\"row\">{family}</th><td class=\"number\">{luts}</td>");
        assert!(page.contains(&row), "{family}");
    }
}

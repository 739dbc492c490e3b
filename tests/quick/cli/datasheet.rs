//! Tests the WaveDrom file of `glint datasheet`: all lanes have the same length, and every `=` has its value.

use serde_json::Value;

use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Workspace};

#[test]
fn waves_have_one_length() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let datasheet = ["datasheet", "core.toml", "--no-synthesis"];
    dir.done(datasheet.iter().chain(&["--out", "core.html", "--wavedrom"]));
    let waves: Value = dir.json("core.wavedrom.json");
    let signal = waves["signal"].list();
    let lengths = signal.iter().map(|lane| {
        let wave = lane["wave"].text();
        // A value for each frame.
        let data = lane["data"].as_array().map_or(0, Vec::len);
        assert_eq!(wave.matches('=').count(), data, "{lane}");
        wave.len()
    });
    let mut lengths: Vec<usize> = lengths.collect();
    lengths.dedup();
    assert_eq!(lengths.len(), 1, "{lengths:?}");
}

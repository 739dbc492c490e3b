//! Tests that generated files are written correctly after a killed run, and next to outdated or foreign files.

use std::fs;
use std::path::Path;

use super::*;
use glint_core::package::{FileKind, digest};

/// Returns files with `text`. The last is a manifest with the digests of the other files.
fn files(text: &str) -> Vec<OutputFile> {
    let mut files = vec![
        OutputFile::new(FileKind::CoreVerilog, "rtl_out/core/core.v", text),
        OutputFile::new(FileKind::Bench, "testbench/core/core_tb.v", text),
    ];
    let digests: serde_json::Map<_, _> = files
        .iter()
        .map(|file| (file.path.clone(), digest(file.contents.as_bytes()).into()))
        .collect();
    let contents = serde_json::json!({ "sha256": digests }).to_string();
    files.push(OutputFile::new(FileKind::Manifest, "rtl_out/core/core.json", contents));
    files
}

fn written(text: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "core", &files(text), false).unwrap();
    fs::write(dir.path().join("rtl_out/core/.DS_Store"), "mine").unwrap();
    dir
}

/// Checks that `out` has only the new files and the foreign one.
#[track_caller]
fn assert_renewed(out: &Path) {
    assert_eq!(differences(out, "core", &files("new")).unwrap(), Vec::<String>::new());
    assert_eq!(fs::read_to_string(out.join("rtl_out/core/.DS_Store")).unwrap(), "mine");
    let entries = fs::read_dir(out).unwrap().map(|entry| entry.unwrap().file_name());
    let mut entries: Vec<_> = entries.collect();
    entries.sort();
    assert_eq!(entries, ["rtl_out", "testbench"]);
}

/// Starts several runs in one directory at the same time. Each run must recognise the files of the run before it as Glint's.
#[test]
fn runs_at_the_same_time_wait_for_each_other() {
    let dir = tempfile::tempdir().unwrap();
    std::thread::scope(|scope| {
        for text in ["one", "another"] {
            let out = dir.path();
            scope.spawn(move || {
                for _ in 0..100 {
                    write(out, "core", &files(text), false).unwrap();
                }
            });
        }
    });
}

#[test]
fn a_run_that_was_killed_between_the_moves_is_done_again() {
    for moves in 0..=3 {
        let dir = written("old");
        for file in &files("new")[..moves] {
            fs::write(dir.path().join(&file.path), &file.contents).unwrap();
        }
        write(dir.path(), "core", &files("new"), false).unwrap();
        assert_renewed(dir.path());
    }
}

#[test]
fn what_is_stale_goes_and_what_is_foreign_stays() {
    let dir = written("old");
    let at = |path: &str| dir.path().join(path);
    let mut less = files("new");
    less.retain(|file| file.kind != FileKind::Bench);
    fs::remove_file(at("rtl_out/core/core.v")).unwrap();
    fs::create_dir(at("rtl_out/core/core.v")).unwrap();
    assert!(write(dir.path(), "core", &less, false).is_err() && at("testbench/core").is_dir());
    write(dir.path(), "core", &less, true).unwrap();
    assert!(at("rtl_out/core/core.v").is_file() && !at("testbench/core").exists());
    assert_eq!(fs::read_to_string(at("rtl_out/core/.DS_Store")).unwrap(), "mine");
    assert_eq!(differences(dir.path(), "core", &less).unwrap(), Vec::<String>::new());
}

//! Remains of a run that is killed at each of its steps, and how the next one goes on.

use std::fs;
use std::path::Path;

use super::*;
use crate::package::digest;

/// A manifest that vouches for the other files, last.
fn files(text: &str) -> Vec<OutputFile> {
    let mut files: Vec<OutputFile> = ["rtl_out/core/core.v", "testbench/core/core_tb.v"]
        .map(|path| OutputFile { path: path.to_owned(), contents: text.to_owned() })
        .into();
    let digests: serde_json::Map<_, _> = files
        .iter()
        .map(|file| (file.path.clone(), digest(file.contents.as_bytes()).into()))
        .collect();
    let contents = serde_json::json!({ "sha256": digests }).to_string();
    files.push(OutputFile { path: "rtl_out/core/core.json".to_owned(), contents });
    files
}

fn written(text: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "core", &files(text), false).unwrap();
    fs::write(dir.path().join("rtl_out/core/.DS_Store"), "mine").unwrap();
    dir
}

/// Nothing but the new files and the foreign one is there.
#[track_caller]
fn assert_renewed(out: &Path) {
    assert_eq!(differences(out, "core", &files("new")).unwrap(), Vec::<String>::new());
    assert_eq!(fs::read_to_string(out.join("rtl_out/core/.DS_Store")).unwrap(), "mine");
    let entries = fs::read_dir(out).unwrap().map(|entry| entry.unwrap().file_name());
    let mut entries: Vec<_> = entries.collect();
    entries.sort();
    assert_eq!(entries, ["rtl_out", "testbench"]);
}

/// The staging directory as a process leaves it that is killed: nothing is dropped, but the lock is gone.
fn killed(staging: Staging) -> PathBuf {
    staging.abandon()
}

#[test]
fn one_that_was_killed_before_the_moves() {
    let dir = written("old");
    let staging = killed(Staging::new(dir.path(), &files("half")).unwrap());
    fs::remove_file(staging.join("testbench/core/core_tb.v")).unwrap();
    write(dir.path(), "core", &files("new"), false).unwrap();
    assert_renewed(dir.path());
}

#[test]
fn one_that_was_killed_between_the_moves() {
    let out = |dir: &tempfile::TempDir, path: &str| dir.path().join(path);
    for moves in 1..=3 {
        let dir = written("old");
        let staging = killed(Staging::new(dir.path(), &files("new")).unwrap());
        let aside = staging.join("old/rtl_out");
        fs::create_dir_all(&aside).unwrap();
        fs::rename(out(&dir, "rtl_out/core"), aside.join("core")).unwrap();
        if moves > 1 {
            fs::rename(staging.join("rtl_out/core"), out(&dir, "rtl_out/core")).unwrap();
        }
        if moves > 2 {
            fs::create_dir_all(staging.join("old/testbench")).unwrap();
            fs::rename(out(&dir, "testbench/core"), staging.join("old/testbench/core")).unwrap();
        }
        staging::recover(dir.path()).unwrap();
        assert_renewed(dir.path());
    }
}

#[test]
fn what_is_not_provably_glints_stays() {
    let dir = written("old");
    // One in use, one with a note in it, and two that only look like one.
    let used = Staging::new(dir.path(), &files("half")).unwrap();
    let noted = killed(Staging::new(dir.path(), &files("half")).unwrap());
    fs::write(noted.join("rtl_out/core/note"), "mine").unwrap();
    for (name, lock) in [(".glint-a", None), (".glint-b", Some("my own lock\n"))] {
        fs::create_dir(dir.path().join(name)).unwrap();
        fs::write(dir.path().join(name).join("file"), "mine").unwrap();
        if let Some(text) = lock {
            fs::write(dir.path().join(name).join("glint.lock"), text).unwrap();
        }
    }
    write(dir.path(), "core", &files("new"), false).unwrap();
    assert_eq!(fs::read_to_string(noted.join("rtl_out/core/note")).unwrap(), "mine");
    for name in [".glint-a/file", ".glint-b/file"] {
        assert_eq!(fs::read_to_string(dir.path().join(name)).unwrap(), "mine");
    }
    let used = killed(used);
    assert!(used.join("rtl_out/core/core.v").exists());
}

//! Tests output that cannot be written, for example to a full disk: the files from before the run stay byte for byte the same.
#![cfg(unix)]

use std::fs;
use std::process::Command;

use crate::refusals::unprivileged;
use crate::workspace::{COSINE_POWER, Run, Workspace};

/// Output of one configuration, and the file of another of that name.
fn stale() -> Workspace {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.done(["generate", "core.toml"]);
    dir.write("core.toml", "device = \"rough\"\n");
    dir
}

#[test]
fn moved_files_are_moved_back() {
    // The second of the two directories cannot be made, when the first is in its place already.
    let dir = stale();
    fs::remove_dir_all(dir.at("testbench")).unwrap();
    dir.write("testbench", "a file");
    let before = dir.files();
    let run = dir.glint(["generate", "core.toml"]);
    run.refused(1, &["cannot create the directory `./testbench`"]);
    assert_eq!(dir.files(), before);
    dir.assert_no_staging();
}

#[test]
fn a_read_only_directory() {
    use std::os::unix::fs::PermissionsExt;
    let dir = stale();
    let before = dir.files();
    fs::set_permissions(dir.path(), PermissionsExt::from_mode(0o555)).unwrap();
    let run = unprivileged(&dir, &["generate", "core.toml"]);
    fs::set_permissions(dir.path(), PermissionsExt::from_mode(0o755)).unwrap();
    run.refused(
        1,
        &["cannot write to `.`; choose another directory with --out", "Permission denied"],
    );
    assert_eq!(dir.files(), before);
}

/// Runs the program with no file to be larger than `blocks` of 512 bytes: writing more fails, as it does
/// on a full disk.
fn limited(dir: &Workspace, blocks: u32, arguments: &str) -> Run {
    let program = env!("CARGO_BIN_EXE_glint");
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec '{program}' {arguments}");
    Run::of(Command::new("sh").args(["-c", &script]).current_dir(dir.path()).output())
}

#[test]
fn a_full_disk_costs_nothing() {
    let dir = stale();
    let before = dir.files();
    // The sine ROM alone is larger than that.
    let run = limited(&dir, 8, "generate core.toml");
    run.refused(1, &["cannot write `", "the existing files are unchanged", "File too large"]);
    assert_eq!(dir.files(), before);
    dir.assert_no_staging();
    dir.done(["generate", "core.toml"]);
    assert_ne!(dir.files(), before);
}

#[test]
fn a_waveform_that_does_not_fit() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.write("wave.vcd", "the last one");
    let args = "cosim core.toml --points 100 --vcd wave.vcd";
    let run = limited(&dir, 8, args);
    run.refused(1, &["`wave.vcd` exists already", "--force"]);
    let run = limited(&dir, 8, &format!("{args} --force"));
    run.refused(1, &["cannot write the waveform `wave.vcd`"]);
    assert_eq!(dir.read("wave.vcd"), "the last one");
    dir.assert_no_staging();
}

#[test]
fn a_device_is_written_not_replaced() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.done(["cosim", "core.toml", "--points", "5", "--vcd", "/dev/null"]);
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn a_reader_that_went_away_is_nobodys_error() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    for arguments in
        [&["list"][..], &["new", "rough"], &["eval", "core.toml", "--json"], &["--help"]]
    {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = Run::of(dir.command().args(arguments).stdout(writer).output());
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{arguments:?}: {run:?}");
    }
    // Nor is it a panic, whose exit code is 101, when there is nobody to read the error.
    for arguments in [&["generate", "absent.toml"][..], &["new", "absent"], &["--absent"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = Run::of(dir.command().args(arguments).stderr(writer).output());
        assert!((1..=2).contains(&run.code), "{arguments:?}: {run:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_on_a_full_disk_is_an_error() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let run = Run::of(Workspace::new().command().args(["new", "rough"]).stdout(full).output());
    run.refused(1, &["cannot write standard output: No space left on device"]);
}

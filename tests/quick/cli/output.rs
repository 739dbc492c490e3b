//! Output that cannot be written: the previous one stays byte for byte.
#![cfg(unix)]

use std::fs;
use std::process::Command;

use crate::place::{COSINE_POWER, Place, Run};
use crate::refusals::unprivileged;

/// Output of one configuration, and the file of another of that name.
fn stale() -> Place {
    let place = Place::with("core.toml", COSINE_POWER);
    place.done(["generate", "core.toml"]);
    place.write("core.toml", "device = \"rough\"\n");
    place
}

#[test]
fn a_file_where_the_directory_should_be() {
    let place = Place::with("core.toml", COSINE_POWER);
    place.write("taken", "a file");
    let before = place.files();
    let run = place.glint(["generate", "core.toml", "--out", "taken"]);
    run.refused(1, &["`core.toml` was not generated", "cannot create the directory `taken`"]);
    assert_eq!(place.files(), before);
    place.write("rtl_out", "a file");
    let before = place.files();
    let run = place.glint(["generate", "core.toml"]);
    run.refused(1, &["cannot create the directory `./rtl_out`"]);
    assert_eq!(place.files(), before);
    place.assert_no_staging();
}

#[test]
fn what_was_moved_is_moved_back() {
    // The second of the two directories cannot be made, when the first is in its place already.
    let place = stale();
    fs::remove_dir_all(place.at("testbench")).unwrap();
    place.write("testbench", "a file");
    let before = place.files();
    let run = place.glint(["generate", "core.toml"]);
    run.refused(1, &["cannot create the directory `./testbench`"]);
    assert_eq!(place.files(), before);
    place.assert_no_staging();
}

#[test]
fn a_read_only_directory() {
    use std::os::unix::fs::PermissionsExt;
    let place = stale();
    let before = place.files();
    fs::set_permissions(place.path(), PermissionsExt::from_mode(0o555)).unwrap();
    let run = unprivileged(&place, &["generate", "core.toml"]);
    fs::set_permissions(place.path(), PermissionsExt::from_mode(0o755)).unwrap();
    run.refused(
        1,
        &["cannot write to `.`; choose another directory with --out", "Permission denied"],
    );
    assert_eq!(place.files(), before);
}

/// Runs the program with no file to be larger than `blocks` of 512 bytes: writing more fails, as it does
/// on a full disk.
fn limited(place: &Place, blocks: u32, arguments: &str) -> Run {
    let program = env!("CARGO_BIN_EXE_glint");
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec '{program}' {arguments}");
    Run::of(Command::new("sh").args(["-c", &script]).current_dir(place.path()).output())
}

#[test]
fn a_full_disk_costs_nothing() {
    let place = stale();
    let before = place.files();
    // The sine ROM alone is larger than that.
    let run = limited(&place, 8, "generate core.toml");
    run.refused(1, &["cannot write `", "what was there before is unchanged", "File too large"]);
    assert_eq!(place.files(), before);
    place.assert_no_staging();
    place.done(["generate", "core.toml"]);
    assert_ne!(place.files(), before);
}

#[test]
fn a_waveform_that_does_not_fit() {
    let place = Place::with("core.toml", COSINE_POWER);
    place.write("wave.vcd", "the last one");
    let run = limited(&place, 8, "cosim core.toml --points 100 --vcd wave.vcd");
    run.refused(1, &["cannot write the waveform `wave.vcd`"]);
    assert_eq!(place.read("wave.vcd"), "the last one");
    place.assert_no_staging();
    let run = place.glint(["cosim", "core.toml", "--points", "5", "--vcd", "absent/wave.vcd"]);
    run.refused(1, &["cannot write `absent/wave.vcd`"]);
    let run = place.glint(["cosim", "core.toml", "--points", "5", "--vcd", "."]);
    run.refused(1, &["cannot write `.`"]);
}

#[test]
fn a_device_is_written_not_replaced() {
    let place = Place::with("core.toml", COSINE_POWER);
    place.done(["cosim", "core.toml", "--points", "5", "--vcd", "/dev/null"]);
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

#[test]
fn a_reader_that_went_away_is_nobodys_error() {
    let place = Place::with("core.toml", COSINE_POWER);
    for arguments in
        [&["list"][..], &["new", "rough"], &["eval", "core.toml", "--json"], &["--help"]]
    {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = Run::of(place.command().args(arguments).stdout(writer).output());
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{arguments:?}: {run:?}");
    }
    // Nor is it a panic, whose exit code is 101, when there is nobody to read the error.
    for arguments in [&["generate", "absent.toml"][..], &["new", "absent"], &["--absent"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = Run::of(place.command().args(arguments).stderr(writer).output());
        assert!((1..=2).contains(&run.code), "{arguments:?}: {run:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_on_a_full_disk_is_an_error() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let run = Run::of(Place::new().command().args(["new", "rough"]).stdout(full).output());
    run.refused(1, &["cannot write standard output: No space left on device"]);
}

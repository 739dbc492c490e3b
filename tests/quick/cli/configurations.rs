//! Configurations that are no text, no files, or none at all.

use std::fs;

use crate::workspace::{COSINE_POWER, Run, Workspace};

#[test]
fn a_file_in_another_encoding() {
    let dir = Workspace::with("latin.toml", b"device = \"rough\"\n# gl\xe4nzend\n");
    let latin = dir.glint(["eval", "latin.toml"]);
    latin.refused(1, &["the file is not UTF-8: byte 21 is 0xe4", "--> latin.toml:2:5"]);
}

/// Neither ends, for all that is known.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_configurations() {
    let dir = Workspace::new();
    crate::workspace::shell("mkfifo \"$1\"", &dir.at("pipe.toml"), "".as_ref());
    for path in ["pipe.toml", "/dev/zero"] {
        let run = dir.glint(["cosim", path]);
        run.refused(1, &["this is a pipe or a device, not a file", "- for standard input"]);
    }
}

#[test]
fn a_configuration_may_come_from_standard_input() {
    let dir = Workspace::with("core.toml", format!("{COSINE_POWER}name = \"piped\"\n"));
    let with = |file: &str, arguments: &[&str]| {
        let input = fs::File::open(dir.at(file)).expect("a file");
        Run::of(dir.command().args(arguments).stdin(input).output())
    };
    with("core.toml", &["generate", "-"]).good();
    assert!(dir.at("rtl_out/piped/piped.v").exists());
    dir.write("nameless.toml", COSINE_POWER);
    let run = with("nameless.toml", &["generate", "-"]);
    run.refused(1, &["the module has no name", "--> standard input", "add `name = \"…\"`"]);
    let run = with("core.toml", &["generate", "-", "-"]);
    run.refused(2, &["standard input, `-`, is read once"]);
}

#[cfg(unix)]
#[test]
fn a_file_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let dir = Workspace::with("core.toml", COSINE_POWER);
    fs::set_permissions(dir.at("core.toml"), PermissionsExt::from_mode(0o000)).unwrap();
    let run = crate::refusals::unprivileged(&dir, &["generate", "core.toml"]);
    run.refused(
        1,
        &["the file cannot be read: Permission denied", "check the path and its permissions"],
    );
}

#[test]
fn no_configuration_at_all() {
    let dir = Workspace::new();
    dir.glint([] as [&str; 0]).refused(1, &["cannot read `configs/`", "glint new DEVICE"]);
    fs::create_dir(dir.at("configs")).unwrap();
    dir.glint(["generate"]).refused(1, &["there is no configuration in `configs/`"]);
}

//! Tests configuration files that Glint cannot read: a file that is not UTF-8, a pipe, a device such as `/dev/zero`, and a file
//! without read permission.

use std::fs;

use crate::workspace::{COSINE_POWER, Workspace};

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
        run.refused(1, &["the path is a pipe or a device, not a file", "- for standard input"]);
    }
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

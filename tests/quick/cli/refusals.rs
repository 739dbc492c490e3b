//! Gives the program wrong files and wrong arguments. Tests that its exit code is from 0 to 2, that it never panics, and that a
//! refused file writes nothing.

use std::ffi::OsString;

use crate::common::said::{Case, cases};
use crate::workspace::{COSINE_POWER, Workspace};

/// Runs a copy of the program as a user who may not do everything, if this one may.
#[cfg(unix)]
pub fn unprivileged(dir: &Workspace, arguments: &[&str]) -> crate::workspace::Run {
    use std::fs;
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;
    use std::process::Command;

    use crate::workspace::shell;

    // Its own directory may be closed to others.
    let elsewhere = Workspace::new();
    let program = elsewhere.at("glint");
    let original = env!("CARGO_BIN_EXE_glint");
    shell("cp \"$2\" \"$1\"", &program, original.as_ref());
    let mut command = Command::new(&program);
    command.args(arguments).current_dir(dir.path());
    // The owner of what a process makes is the user that it runs as.
    if fs::metadata(&program).expect("a copy").uid() == 0 {
        for (path, mode) in [(elsewhere.path(), 0o755), (&program, 0o755)] {
            fs::set_permissions(path, PermissionsExt::from_mode(mode)).expect("permissions");
        }
        let mode = fs::metadata(dir.path()).expect("a directory").permissions().mode();
        let open = PermissionsExt::from_mode(mode | 0o055);
        fs::set_permissions(dir.path(), open).expect("permissions");
        command.uid(65534).gid(65534);
    }
    crate::workspace::Run::of(command.output())
}

#[test]
fn nothing_panics() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.write("null.toml", [0; 64]);
    dir.write("deep.toml", format!("a = {}", "[".repeat(100_000)));
    dir.write("long.toml", format!("{COSINE_POWER}{} = 1\n", "k".repeat(100_000)));
    let odd = "- -- = # core.toml null.toml deep.toml long.toml / ü=1 🙂".split(' ');
    let mut odd: Vec<OsString> = odd.chain([""]).map(OsString::from).collect();
    #[cfg(unix)]
    odd.push(std::os::unix::ffi::OsStringExt::from_vec(vec![0xff, 0xfe, b'=', 0x80]));
    for command in ["generate", "cosim", "eval", "setup", "render", "new", "list", ""] {
        for argument in &odd {
            for second in ["cos_gamma=1e-400", "--json"] {
                let arguments = [command.into(), argument.clone(), second.into()];
                if command == "cosim" && argument == "core.toml" {
                    continue; // 100 000 points, which other tests check fewer of.
                }
                let run = dir.glint(&arguments);
                assert!((0..=2).contains(&run.code), "{arguments:?}: {run:?}");
            }
        }
    }
}

/// A core that cannot be is refused where the file asks for it, with a remedy, and nothing is written.
#[test]
fn refused_files_write_nothing() {
    for Case { heading: commands, file, said } in cases(include_str!("refused.txt")) {
        let dir = Workspace::with("core.toml", &file);
        for command in commands.split(' ') {
            dir.glint([command, "core.toml"]).refused(1, &said);
            let value = dir.glint([command, "core.toml", "--json"]).json();
            assert!(value["problems"][0]["line"].as_u64().is_some(), "{value}");
        }
        assert_eq!(dir.files().len(), 1, "something was written: {file}");
    }
}

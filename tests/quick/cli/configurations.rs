//! Configuration files that are refused: exit code 1, the location, the remedy.

use std::fs;

use serde_json::json;

use crate::workspace::{COSINE_POWER, Run, Workspace};

#[test]
fn files_that_cannot_be_read() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let missing = dir.glint(["generate", "cores.toml"]);
    missing.refused(1, &["there is no such file", "--> cores.toml", "did you mean `core.toml`?"]);
    fs::create_dir(dir.at("directory.toml")).unwrap();
    let directory = dir.glint(["cosim", "directory.toml"]);
    directory.refused(1, &["this is a directory", "--> directory.toml"]);
    dir.write("latin.toml", b"device = \"rough\"\n# gl\xe4nzend\n");
    let latin = dir.glint(["eval", "latin.toml"]);
    latin.refused(1, &["the file is not UTF-8: byte 21 is 0xe4", "--> latin.toml:2:5"]);
    dir.write("empty.toml", "");
    dir.glint(["generate", "empty.toml"])
        .refused(1, &["the file is empty", "devices: quad-cosine, cosine-squared, lyon, rough"]);
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

/// Three files: two wrong in two lines each, one that is missing, and a good one.
fn wrong() -> Workspace {
    let dir = Workspace::with("a.toml", "device = \"rough\"\nclamp = 1\n[colour]\nbits = 0\n");
    dir.write("b.toml", "device = \"cosine-power\"\npower = 3\nname = \"wire\"\n");
    dir.write("good.toml", COSINE_POWER);
    dir
}

const WRONG: [&str; 4] = ["a.toml", "good.toml", "b.toml", "missing.toml"];

#[test]
fn all_problems_of_all_files_are_reported() {
    for command in ["generate", "cosim"] {
        let run = wrong().glint([command].iter().chain(&WRONG));
        run.refused(
            1,
            &["a.toml:2:9", "a.toml:4:8", "b.toml:2:9", "b.toml:3:8", "--> missing.toml"],
        );
        assert_eq!(run.out, "");
    }
}

#[test]
fn all_problems_are_json_for_scripts() {
    for command in ["generate", "cosim"] {
        let run = wrong().glint([command, "--json"].iter().chain(&WRONG));
        assert_eq!((run.code, run.err.as_str()), (1, ""), "{run:?}");
        let value = run.json();
        assert_eq!(value["ok"], false);
        let locations: Vec<_> = value["problems"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|problem| {
                json!([problem["file"], problem["line"], problem["column"], problem["key"]])
            })
            .collect();
        assert_eq!(
            locations,
            [
                json!(["a.toml", 2, 9, "clamp"]),
                json!(["a.toml", 4, 8, "colour.bits"]),
                json!(["b.toml", 2, 9, "power"]),
                json!(["b.toml", 3, 8, "name"]),
                json!(["missing.toml", null, null, null]),
            ]
        );
    }
}

#[test]
fn two_configurations_of_one_name() {
    let dir = Workspace::with("a.toml", format!("{COSINE_POWER}name = \"same\"\n"));
    dir.write("b.toml", format!("{COSINE_POWER}name = \"same\"\n"));
    let run = dir.glint(["generate", "a.toml", "b.toml"]);
    run.refused(1, &["`a.toml` and `b.toml` both name their module `same`"]);
    let run = dir.glint(["generate", "a.toml", "b.toml", "--json"]);
    assert_eq!(run.code, 1);
    let message = &run.json()["problems"][0]["message"];
    assert!(message.as_str().unwrap().contains("both name their module `same`"), "{message}");
}

#[test]
fn outside_the_accuracy_contract() {
    // Six fraction bits of f move an output of 255 by about 4.
    let coarse = "[intensity]\nfraction = 6\n";
    let dir = Workspace::with("core.toml", format!("{COSINE_POWER}{coarse}"));
    let run = dir.glint(["generate", "core.toml"]).good();
    // Most is the base's, times 16: in all 31 ulp, of which 255 are half a unit with 14 bits.
    let parts = [
        "warning: core.toml: outside the accuracy contract",
        "not below 1; most of it, 63.750, is of `intensity.fraction`",
        "; `intensity.fraction = 14` in place of 6 would bring the bound to 0.98",
        &format!(" units: see core.toml:{}:12", COSINE_POWER.lines().count() + 2),
    ];
    for part in parts {
        assert!(run.err.contains(part), "{}", run.err);
    }
    let dir = Workspace::with("core.toml", format!("{COSINE_POWER}strict = true\n{coarse}"));
    let run = dir.glint(["generate", "core.toml"]);
    run.refused(
        1,
        &["outside the accuracy contract", "`intensity.fraction`", "`strict = true` refuses that"],
    );
    assert!(!dir.at("rtl_out").exists());
}

/// Its rounding is at its best already: another key is named.
#[test]
fn advice_is_what_still_helps() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let page = dir.done(["describe", "core.toml"]);
    assert!(page.contains("output.rounding | nearest") || page.contains("`output.rounding`"));
    let advice = "The key that helps most: `intensity.fraction = 17` in place of 16 would bring the bound to";
    assert!(page.contains(advice), "{page}");
}

#[test]
fn no_configuration_at_all() {
    let dir = Workspace::new();
    dir.glint([] as [&str; 0]).refused(1, &["cannot read `configs/`", "glint new DEVICE"]);
    fs::create_dir(dir.at("configs")).unwrap();
    dir.glint(["generate"]).refused(1, &["there is no configuration in `configs/`"]);
}

/// Ranges of two bits each, more than there are bits.
#[test]
fn no_count_is_negative() {
    let segments = "[decay]\nsegments = [2, 2, 2, 2, 2, 2, 2, 2, 2, 2]\ntail = 1\n";
    let text = format!("device = \"blinn\"\n[cosine]\nfraction = 12\n{segments}");
    let dir = Workspace::with("core.toml", text);
    let run = dir.glint(["generate", "core.toml"]);
    run.refused(1, &["0 of the 11 bits of 1 - cos", "has 1 bits of 1 - cos"]);
    let negative = run.err.split_whitespace().find(|word| {
        word.strip_prefix('-').is_some_and(|count| count.starts_with(|c: char| c.is_ascii_digit()))
    });
    assert_eq!(negative, None, "{}", run.err);
}

//! `glint certify` as a user meets it, with a Gappa that says what a test wants.

use super::workspace::{COSINE_POWER, Run, Workspace};

/// A program called gappa that refuses what is false for x = 1, and does `script` with the rest.
#[cfg(unix)]
fn place_gappa(dir: &Workspace, script: &str) {
    let refuse =
        "read -r line < \"$1\"; case \"$line\" in '# True'*) exit 0;; '# False'*) exit 1;; esac";
    dir.script("tools/gappa", &format!("{refuse}\n{script}"));
}

fn certify(dir: &Workspace, arguments: &[&str]) -> Run {
    dir.with_own_tools(["certify", "core.toml"].iter().chain(arguments))
}

#[cfg(unix)]
#[test]
fn only_certificates_are_overwritten_and_old_ones_go() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    place_gappa(&dir, "exit 0");
    let run = certify(&dir, &["--out", "out"]).good();
    assert!(run.out.contains("certified: |output - formula| <= "), "{run:?}");
    let first = dir.read("out/core/red_out_1.g");
    dir.write("out/core/red_out_99.g", first.replace("gappa red_out_1.g", "gappa red_out_99.g"));
    dir.write("out/core/copy.g", &first);
    dir.write("out/core/notes.g", "mine");
    assert_eq!(certify(&dir, &["--out", "out"]).code, 0);
    assert_eq!(dir.read("out/core/red_out_1.g"), first);
    assert_eq!(dir.read("out/core/notes.g"), "mine");
    assert_eq!(dir.read("out/core/copy.g"), first);
    assert!(!dir.at("out/core/red_out_99.g").exists());
    let edited = format!("{first}# tried\n");
    dir.write("out/core/red_out_1.g", &edited);
    certify(&dir, &["--out", "out"])
        .refused(1, &["red_out_1.g", "was edited since Glint wrote it"]);
    assert_eq!(dir.read("out/core/red_out_1.g"), edited);
    dir.write("out/core/red_out_1.g", "mine");
    certify(&dir, &["--out", "out"]).refused(1, &["red_out_1.g", "not of Glint's making"]);
    assert_eq!(dir.read("out/core/red_out_1.g"), "mine");
}

/// The scripts that another configuration of this name left would still say that they are accepted.
#[cfg(unix)]
#[test]
fn what_has_no_statements_has_no_scripts() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    place_gappa(&dir, "exit 0");
    assert_eq!(certify(&dir, &["--out", "out"]).code, 0);
    dir.write("core.toml", "device = \"rough\"\nname = \"core\"\n");
    let run = certify(&dir, &["--out", "out"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.out.contains("not certified: the function `sqrt`"), "{run:?}");
    assert_eq!(std::fs::read_dir(dir.at("out/core")).unwrap().count(), 0);
}

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

#[test]
fn a_missing_tool_is_named_with_the_way_to_get_it() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    certify(&dir, &[]).refused(1, &["`gappa` is not on PATH", "apt install gappa"]);
    #[cfg(unix)]
    {
        place_gappa(&dir, "exit 0");
        let refused = ["`coqc` is not on PATH", "apt install coq libcoq-gappa"];
        certify(&dir, &["--coq"]).refused(1, &refused);
    }
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
    certify(&dir, &["--out", "core.toml"]).refused(1, &["`core.toml` is no directory"]);
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

#[cfg(unix)]
#[test]
fn a_gappa_that_is_killed_is_no_open_statement() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    place_gappa(&dir, "kill -9 $$");
    certify(&dir, &[]).refused(1, &["`gappa` failed (signal: 9"]);
}

#[cfg(unix)]
#[test]
fn a_bound_beyond_the_contract_is_told() {
    let dir = Workspace::with(
        "core.toml",
        format!("{COSINE_POWER}intensity.fraction = 6\nstrict = true\n"),
    );
    place_gappa(&dir, "exit 0");
    certify(&dir, &[]).refused(1, &["outside the accuracy contract", "`strict = true` refuses"]);
}

#[cfg(unix)]
#[test]
fn what_gappa_refuses_or_assumes_is_not_certified() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    std::fs::create_dir(dir.at("tools")).unwrap();
    for script in [
        "echo 'Error: some properties were not satisfied:'; exit 1",
        "echo 'Warning: a and b are not trivially equal.'; exit 0",
    ] {
        place_gappa(&dir, script);
        let run = certify(&dir, &[]);
        assert_eq!(run.code, 1, "{run:?}");
        assert!(run.out.contains("not certified: 0 of "), "{run:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_program_that_accepts_everything_is_no_gappa() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.script("tools/gappa", "exit 0");
    certify(&dir, &[]).refused(1, &["`gappa` accepts a statement that does not hold"]);
    dir.script("tools/gappa", "echo cannot open shared object file; exit 127");
    let refused = ["`gappa` refuses a statement that holds", "cannot open shared object file"];
    certify(&dir, &[]).refused(1, &refused);
}

//! `glint certify` as a user meets it, with a Gappa that says what a test wants.

use super::place::{COSINE_POWER, Place, Run};

/// A program called gappa that refuses what is false for x = 1, and does `script` with the rest.
#[cfg(unix)]
fn place_gappa(place: &Place, script: &str) {
    let refuse =
        "read -r line < \"$1\"; case \"$line\" in '# True'*) exit 0;; '# False'*) exit 1;; esac";
    place.script("tools/gappa", &format!("{refuse}\n{script}"));
}

fn certify(place: &Place, arguments: &[&str]) -> Run {
    place.with_own_tools(["certify", "core.toml"].iter().chain(arguments))
}

#[test]
fn a_missing_tool_is_named_with_the_way_to_get_it() {
    let place = Place::with("core.toml", COSINE_POWER);
    certify(&place, &[]).refused(1, &["`gappa` is not on PATH", "apt install gappa"]);
    #[cfg(unix)]
    {
        place_gappa(&place, "exit 0");
        let refused = ["`coqc` is not on PATH", "apt install coq libcoq-gappa"];
        certify(&place, &["--coq"]).refused(1, &refused);
    }
}

#[cfg(unix)]
#[test]
fn only_certificates_are_overwritten_and_old_ones_go() {
    let place = Place::with("core.toml", COSINE_POWER);
    place_gappa(&place, "exit 0");
    let run = certify(&place, &["--out", "out"]).good();
    assert!(run.out.contains("certified: |output - formula| <= "), "{run:?}");
    let first = place.read("out/core/red_out_1.g");
    place.write("out/core/red_out_99.g", first.replace("gappa red_out_1.g", "gappa red_out_99.g"));
    place.write("out/core/copy.g", &first);
    place.write("out/core/notes.g", "mine");
    assert_eq!(certify(&place, &["--out", "out"]).code, 0);
    assert_eq!(place.read("out/core/red_out_1.g"), first);
    assert_eq!(place.read("out/core/notes.g"), "mine");
    assert_eq!(place.read("out/core/copy.g"), first);
    assert!(!place.at("out/core/red_out_99.g").exists());
    let edited = format!("{first}# tried\n");
    place.write("out/core/red_out_1.g", &edited);
    certify(&place, &["--out", "out"])
        .refused(1, &["red_out_1.g", "was edited since Glint wrote it"]);
    assert_eq!(place.read("out/core/red_out_1.g"), edited);
    place.write("out/core/red_out_1.g", "mine");
    certify(&place, &["--out", "out"]).refused(1, &["red_out_1.g", "not of Glint's making"]);
    assert_eq!(place.read("out/core/red_out_1.g"), "mine");
    certify(&place, &["--out", "core.toml"]).refused(1, &["`core.toml` is no directory"]);
}

/// The scripts that another configuration of this name left would still say that they are accepted.
#[cfg(unix)]
#[test]
fn what_has_no_statements_has_no_scripts() {
    let place = Place::with("core.toml", COSINE_POWER);
    place_gappa(&place, "exit 0");
    assert_eq!(certify(&place, &["--out", "out"]).code, 0);
    place.write("core.toml", "device = \"rough\"\nname = \"core\"\n");
    let run = certify(&place, &["--out", "out"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.out.contains("not certified: the function `sqrt`"), "{run:?}");
    assert_eq!(std::fs::read_dir(place.at("out/core")).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn a_gappa_that_is_killed_is_no_open_statement() {
    let place = Place::with("core.toml", COSINE_POWER);
    place_gappa(&place, "kill -9 $$");
    certify(&place, &[]).refused(1, &["`gappa` failed (signal: 9"]);
}

#[cfg(unix)]
#[test]
fn a_bound_beyond_the_contract_is_told() {
    let place =
        Place::with("core.toml", format!("{COSINE_POWER}intensity.fraction = 6\nstrict = true\n"));
    place_gappa(&place, "exit 0");
    certify(&place, &[]).refused(1, &["outside the accuracy contract", "`strict = true` refuses"]);
}

#[cfg(unix)]
#[test]
fn what_gappa_refuses_or_assumes_is_not_certified() {
    let place = Place::with("core.toml", COSINE_POWER);
    std::fs::create_dir(place.at("tools")).unwrap();
    for script in [
        "echo 'Error: some properties were not satisfied:'; exit 1",
        "echo 'Warning: a and b are not trivially equal.'; exit 0",
    ] {
        place_gappa(&place, script);
        let run = certify(&place, &[]);
        assert_eq!(run.code, 1, "{run:?}");
        assert!(run.out.contains("not certified: 0 of "), "{run:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_program_that_accepts_everything_is_no_gappa() {
    let place = Place::with("core.toml", COSINE_POWER);
    place.script("tools/gappa", "exit 0");
    certify(&place, &[]).refused(1, &["`gappa` accepts a statement that does not hold"]);
    place.script("tools/gappa", "echo cannot open shared object file; exit 127");
    let refused = ["`gappa` refuses a statement that holds", "cannot open shared object file"];
    certify(&place, &[]).refused(1, &refused);
}

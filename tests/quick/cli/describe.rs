//! `describe`: pages printed and written, and whose they are.

use crate::place::{COSINE_POWER, Place};

fn place() -> Place {
    Place::with("core.toml", COSINE_POWER)
}

#[test]
fn a_page_is_printed() {
    let page = place().done(["describe", "core.toml"]);
    let headings = "# Specular intensity, ## Ports, ## Blocks, ## ROMs, ## Microprogram, ## Clocks, \
        ## Accuracy, ## A worked example, ## Configuration";
    for heading in headings.split(", ") {
        assert!(page.lines().any(|line| line.starts_with(heading)), "{heading}\n{page}");
    }
    // n/m of m = 16 by wiring: u10.0 becomes u6.4.
    let zeta = page.lines().find(|line| line.starts_with("| `zeta`")).expect("a block");
    assert!(zeta.contains("u6.4"), "{zeta}");
    assert!(page.contains("`glint describe core.toml`"), "{page}");
}

#[test]
fn pages_are_written_where_they_are_told_to_go() {
    let place = place();
    let page = place.done(["describe", "core.toml"]);
    let out = place.done(["describe", "core.toml", "--out", "docs/pages"]);
    assert_eq!(out, "core.toml: core.md written\n");
    assert_eq!(place.read("docs/pages/core.md"), page);
    let again = place.done(["describe", "core.toml", "--out", "docs/pages"]);
    assert_eq!(again, "core.toml: core.md up to date\n");
    let names: Vec<String> = place.files().into_keys().collect();
    assert_eq!(names, ["core.toml", "docs/pages/core.md"]);
}

#[test]
fn a_page_of_glints_is_replaced() {
    let place = place();
    place.done(["describe", "core.toml", "--out", "."]);
    place.write("core.toml", "device = \"cosine-power\"\npower = 2\n");
    place.done(["describe", "core.toml", "--out", "."]);
    let page = place.done(["describe", "core.toml"]);
    assert_eq!(place.read("core.md"), page);
    place.assert_no_staging();
}

#[test]
fn an_edited_or_foreign_page_is_not_overwritten() {
    let place = place();
    let page = place.done(["describe", "core.toml"]);
    for mine in ["my notes\n", &page.replace("## Clocks", "## Times")] {
        place.write("core.md", mine);
        let run = place.glint(["describe", "core.toml", "--out", "."]);
        run.refused(1, &["core.md", "was edited since; nothing was changed", "--force"]);
        assert_eq!(place.read("core.md"), mine);
        place.done(["describe", "core.toml", "--out", ".", "--force"]);
        assert_eq!(place.read("core.md"), page);
    }
    place.assert_no_staging();
}

#[test]
fn a_page_is_text_for_scripts_too() {
    let place = place();
    let page = place.done(["describe", "core.toml"]);
    let value = place.glint(["describe", "core.toml", "--json"]).json();
    assert_eq!(value["described"][0]["name"], "core");
    assert_eq!(value["described"][0]["page"], page.as_str());
}

#[test]
fn a_directory_that_cannot_be_is_said() {
    let place = place();
    place.write("taken", "a file");
    let run = place.glint(["describe", "core.toml", "--out", "taken"]);
    run.refused(1, &["`core.toml` was not described", "taken"]);
    place.glint(["describe", "core.toml", "--force"]).refused(2, &["--out"]);
}

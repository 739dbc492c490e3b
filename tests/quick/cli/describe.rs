//! `describe`: pages printed and written, and whose they are.

use crate::workspace::{COSINE_POWER, Workspace};

fn dir() -> Workspace {
    Workspace::with("core.toml", COSINE_POWER)
}

#[test]
fn a_page_is_printed() {
    let page = dir().done(["describe", "core.toml"]);
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
    let dir = dir();
    let page = dir.done(["describe", "core.toml"]);
    let out = dir.done(["describe", "core.toml", "--out", "docs/pages"]);
    assert_eq!(out, "core.toml: core.md written\n");
    assert_eq!(dir.read("docs/pages/core.md"), page);
    let again = dir.done(["describe", "core.toml", "--out", "docs/pages"]);
    assert_eq!(again, "core.toml: core.md up to date\n");
    let names: Vec<String> = dir.files().into_keys().collect();
    assert_eq!(names, ["core.toml", "docs/pages/core.md"]);
}

#[test]
fn a_page_of_glints_is_replaced() {
    let dir = dir();
    dir.done(["describe", "core.toml", "--out", "."]);
    dir.write("core.toml", "device = \"cosine-power\"\npower = 2\n");
    dir.done(["describe", "core.toml", "--out", "."]);
    let page = dir.done(["describe", "core.toml"]);
    assert_eq!(dir.read("core.md"), page);
    dir.assert_no_staging();
}

#[test]
fn an_edited_or_foreign_page_is_not_overwritten() {
    let dir = dir();
    let page = dir.done(["describe", "core.toml"]);
    for mine in ["my notes\n", &page.replace("## Clocks", "## Times")] {
        dir.write("core.md", mine);
        let run = dir.glint(["describe", "core.toml", "--out", "."]);
        run.refused(1, &["core.md", "was edited since; nothing was changed", "--force"]);
        assert_eq!(dir.read("core.md"), mine);
        dir.done(["describe", "core.toml", "--out", ".", "--force"]);
        assert_eq!(dir.read("core.md"), page);
    }
    dir.assert_no_staging();
}

#[test]
fn a_page_is_text_for_scripts_too() {
    let dir = dir();
    let page = dir.done(["describe", "core.toml"]);
    let value = dir.glint(["describe", "core.toml", "--json"]).json();
    assert_eq!(value["described"][0]["name"], "core");
    assert_eq!(value["described"][0]["page"], page.as_str());
}

#[test]
fn a_directory_that_cannot_be_is_said() {
    let dir = dir();
    dir.write("taken", "a file");
    let run = dir.glint(["describe", "core.toml", "--out", "taken"]);
    run.refused(1, &["`core.toml` was not described", "taken"]);
    dir.glint(["describe", "core.toml", "--force"]).refused(2, &["--out"]);
}

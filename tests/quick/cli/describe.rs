//! `describe`: pages that were edited, and pages for scripts.

use crate::workspace::{COSINE_POWER, Workspace};

fn dir() -> Workspace {
    Workspace::with("core.toml", COSINE_POWER)
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

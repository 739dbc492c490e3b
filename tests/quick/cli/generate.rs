//! Tests `glint generate` and the main job: the files that they write, symbolic links, and names that they refuse.

use crate::common::json::Json;
use crate::workspace::{COSINE_POWER, Workspace};

const FILES: [&str; 2] = ["rtl_out/core/core.v", "testbench/core/core_tb.v"];

fn generated() -> Workspace {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.done(["generate", "core.toml"]);
    dir
}

/// Changes the configuration, so that other files would be generated.
fn reconfigure(dir: &Workspace) {
    dir.write("core.toml", format!("{COSINE_POWER}power = 4\n"));
}

#[test]
fn whole_configurations_of_the_pages_give_no_warning() {
    let pages =
        [include_str!("../../../README.md"), include_str!("../../../docs/pipelines.md")].concat();
    let blocks = pages.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    let whole: Vec<&str> = blocks.filter(|text| text.contains("device = ")).collect();
    assert_eq!(whole.len(), 2, "angle.toml and my_pipeline.toml");
    for text in whole {
        Workspace::with("core.toml", text).glint(["generate", "core.toml"]).quiet();
    }
}

#[test]
fn json_lists_the_files_in_another_directory() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let run = dir.glint(["generate", "core.toml", "--out", "a/b", "--json"]).good();
    let value = run.json();
    assert_eq!(value["ok"], true);
    let one = &value["generated"][0];
    assert_eq!(
        (&one["config"], &one["name"], &one["written"]),
        (&"core.toml".into(), &"core".into(), &true.into())
    );
    let files = |list: &serde_json::Value| list.list().clone();
    let listed: Vec<String> = files(&one["files"])
        .iter()
        .chain(&files(&value["shared"]))
        .map(|file| format!("a/b/{}", file.text()))
        .collect();
    let mut sorted = listed.clone();
    sorted.sort();
    let found: Vec<String> = dir.files().into_keys().filter(|name| name != "core.toml").collect();
    assert_eq!(found, sorted);
}

#[test]
fn the_main_job_generates_and_checks_everything() {
    let dir = Workspace::with("configs/one.toml", COSINE_POWER);
    dir.write("configs/two.toml", format!("{COSINE_POWER}power = 2\n"));
    dir.write("configs/notes.txt", "no configuration");
    dir.write("configs/studies/three.toml", COSINE_POWER);
    // A bound of 1.5 units: outside the contract, and right within it.
    dir.write(
        "configs/wide.toml",
        format!("{COSINE_POWER}output.rounding = \"truncate\"\nintensity.fraction = 9\n"),
    );
    let run = dir.glint([] as [&str; 0]);
    assert_eq!(run.code, 0, "{run:?}");
    let row = |name: &str| {
        let name = format!("| {name} ");
        run.out.lines().find(|line| line.starts_with(&name)).expect("a row")
    };
    for config in ["one", "two"] {
        assert!(row(config).contains("100 000") && row(config).contains(" holds "), "{run:?}");
    }
    assert!(row("wide").contains(" outside the contract "), "{run:?}");
    let advice = "configs/wide.toml: outside the accuracy contract";
    assert!(run.err.contains(advice) && run.err.contains(" would bring the bound to "), "{run:?}");
    // What the formula is no good for is a detail, and no warning.
    assert!(!run.err.contains("warning: configs/one.toml"), "{run:?}");
    // The table and the line that counts are the last on the screen.
    let count = "2 of 3 hold; 1 outside the accuracy contract, within their own bound.";
    let mut last = run.out.lines().rev();
    assert_eq!(last.next(), Some(count));
    assert!(last.next().expect("the table").starts_with("| wide "), "{run:?}");
    let details = dir.done(["--details"]);
    assert!(details.contains("configs/one.toml: ") && details.contains("the largest error is at"));
    assert!(details.contains("configs/one.toml: power = 16 is above some n of the domain"));
    std::fs::remove_file(dir.at("configs/wide.toml")).expect("removed");
    assert!(dir.at("rtl_out/one/one.v").exists() && dir.at("testbench/two/two_tb.v").exists());
    let run = dir.glint(["--json"]).good();
    let value = run.json();
    assert_eq!(value["ok"], true);
    assert_eq!(value["configurations"][1]["config"], "configs/two.toml");
    assert_eq!(value["configurations"][1]["points"], 100_000);
    assert_eq!(value["configurations"][1]["faults"], serde_json::json!([]));
}

/// Links above the directories of a configuration are followed. These directories and their files are replaced, and what they
/// lead to is not Glint's.
#[test]
#[cfg(unix)]
fn symbolic_links_are_followed_or_refused() {
    use std::os::unix::fs::symlink;
    let moved = |name: &str| {
        let dir = generated();
        dir.write("rtl_out/core/notes.txt", "mine");
        dir.write("elsewhere/before.txt", "mine");
        std::fs::rename(dir.at(name), dir.at("elsewhere/it")).expect("moved");
        symlink(dir.at("elsewhere/it"), dir.at(name)).expect("a link");
        dir.done(["generate", "core.toml", "--check"]);
        reconfigure(&dir);
        dir
    };
    let dir = moved("rtl_out");
    dir.done(["generate", "core.toml"]);
    dir.done(["generate", "core.toml", "--check"]);
    assert!(dir.at("rtl_out").is_symlink() && dir.at("elsewhere/it/core/notes.txt").exists());
    assert_eq!(dir.read("elsewhere/it/core/core.v"), dir.read("rtl_out/core/core.v"));

    for name in ["rtl_out/core", "testbench/core", FILES[0], "rtl_out/core/core.json"] {
        let dir = moved(name);
        let before = dir.files();
        for force in [None, Some("--force")] {
            if name.contains('.') && force.is_some() {
                continue;
            }
            let run = dir.glint(["generate", "core.toml"].into_iter().chain(force));
            run.refused(1, &["nothing was changed", name, "--out"]);
            assert!(dir.at(name).is_symlink() && dir.files() == before, "{name}: {run:?}");
            dir.assert_no_staging();
        }
    }

    // The output directory, and the driver that configurations share.
    let dir = Workspace::with("core.toml", COSINE_POWER);
    dir.write("elsewhere/notes.txt", "mine");
    symlink("elsewhere", dir.at("out")).expect("a link");
    dir.done(["generate", "core.toml", "--out", "out"]);
    let driver = dir.at("elsewhere/testbench/glint_cocotb.py");
    std::fs::rename(&driver, dir.at("driver.py")).expect("moved");
    symlink(dir.at("driver.py"), &driver).expect("a link");
    let text = dir.read("driver.py");
    dir.write("driver.py", "old");
    dir.done(["generate", "core.toml", "--out", "out", "--force"]);
    assert!(driver.is_symlink() && dir.at("elsewhere/notes.txt").exists());
    assert_eq!(dir.read("driver.py"), text);
    let page = dir.done(["describe", "core.toml"]);
    dir.write("page.md", &page);
    symlink("page.md", dir.at("core.md")).expect("a link");
    dir.done(["describe", "core.toml", "--out", "."]);
    assert!(dir.at("core.md").is_symlink());
    reconfigure(&dir);
    dir.done(["describe", "core.toml", "--out", "."]);
    assert!(dir.at("core.md").is_symlink() && dir.read("page.md") != page);
}

/// Files have the same bytes wherever the user stands, and name no directory of theirs.
#[test]
fn files_name_the_configuration_without_its_path() {
    let dir = generated();
    let path = dir.at("core.toml");
    let path = path.to_str().expect("a plain name");
    dir.done(["generate", path, "--out", "far"]);
    for (name, text) in dir.files() {
        if let Some(near) = name.strip_prefix("far/") {
            assert_eq!(text, dir.files()[near], "{name}");
        }
    }
    assert!(dir.read("rtl_out/core/core.v").contains("glint generate core.toml\n"));
    let page = dir.done(["describe", path]);
    assert!(page == dir.done(["describe", "core.toml"]) && page.contains("describe core.toml"));
    let odd = "a \"*b.toml";
    dir.write(odd, format!("name = \"odd\"\n{COSINE_POWER}"));
    dir.done(["generate", odd]);
    assert!(dir.read("rtl_out/odd/odd.v").contains("glint generate a%20%22%2Ab.toml\n"));
}

#[test]
#[cfg(unix)]
fn a_name_with_control_characters_is_refused() {
    let dir = Workspace::with("a\nendmodule.toml", COSINE_POWER);
    let run = dir.glint(["generate", "a\nendmodule.toml"]);
    run.refused(
        1,
        &["\"a\\nendmodule.toml\" has control characters, and Glint", "rename the file"],
    );
    assert_eq!(dir.files().len(), 1);
}

/// The order of the numbers is stated, and it is that of the ports.
#[test]
fn computations_name_their_columns_in_the_order_of_the_ports() {
    for device in ["quad-cosine", "rough", "lyon"] {
        let dir = Workspace::with("core.toml", format!("device = \"{device}\"\n"));
        dir.done(["generate", "core.toml"]);
        let manifest: serde_json::Value = dir.json("rtl_out/core/core.json");
        let ports = |role: &str| -> Vec<&str> {
            let ports = manifest["ports"].list().iter();
            let ports = ports.filter(|port| port["role"] == role);
            ports.map(|port| port["name"].text()).collect()
        };
        let computations = &manifest["computations"];
        let names =
            |key: &str| -> Vec<&str> { computations[key].list().iter().map(Json::text).collect() };
        assert_eq!(names("operands"), ports("operand"), "{device}");
        assert_eq!(names("results"), ports("result"), "{device}");
        for point in computations["points"].list() {
            // Each number is of its column's domain.
            let operands = point["operands"].list().iter();
            for (name, raw) in names("operands").into_iter().zip(operands) {
                let domain = &manifest["accuracy"]["domain"][name];
                let within = domain["low"].as_i64()..=domain["high"].as_i64();
                assert!(within.contains(&raw.as_i64()), "{device}: {name} = {raw}");
            }
        }
    }
}

//! `eval`, `list`, `new`, `-V`.

use glint::registry::Registry;
use serde_json::{Value, json};

use crate::workspace::{Run, Workspace};

/// (n/2·(cos γ − 1) + 1)², six bits of which would do for these points.
const SQUARE: &str = "device = \"cosine-power\"\npower = 2\n";

fn eval(operands: &[&str]) -> Run {
    let dir = Workspace::with("core.toml", SQUARE);
    dir.glint(["eval", "core.toml"].iter().chain(operands))
}

fn named<'a>(list: &'a Value, name: &str) -> &'a Value {
    let list = list.as_array().expect("a list");
    list.iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

/// Whatever is left out, the point is lit and its error is in the bound.
#[test]
fn a_point_of_the_evaluators_choice_is_lit() {
    let registry = Registry::catalogue();
    let names: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
    for name in names {
        let dir = Workspace::with("core.toml", format!("device = \"{name}\"\n"));
        let value = dir.glint(["eval", "core.toml", "--json"]).quiet().json();
        let formula = &value["formula"];
        // A function has no reflectance.
        assert_eq!(formula["f"].is_null(), name == "function", "{name}: {formula}");
        assert!(formula["f"].as_f64().is_none_or(|f| (0.1..0.9).contains(&f)), "{name}: {formula}");
        assert!(value["inside_the_domain"] == true, "{name}: {formula}");
        let errors = formula["errors"].as_array().expect("errors").iter();
        let errors: Vec<f64> = errors.map(|error| error.as_f64().expect("a number")).collect();
        assert!(!errors.is_empty() && errors.iter().all(|it| *it < 1.0), "{name}: {errors:?}");
    }
    // Around what is given: n/2·(c − 1) + 1 is 0 at c = 0.98 for n = 100.
    let value = eval(&["exponent=100", "--json"]).quiet().json();
    let (f, cosine) = (&value["formula"]["f"], named(&value["operands"], "cos_gamma"));
    assert!((0.4..0.8).contains(&f.as_f64().expect("f")), "{f}");
    assert!(cosine["value"].as_f64().expect("a cosine") > 0.98, "{cosine}");
}

#[test]
fn a_point_is_evaluated_for_scripts() {
    let run =
        eval(&["cos_gamma=#524288", "exponent=#2", "red=200", "green=100", "blue=0", "--json"])
            .quiet();
    let value = run.json();
    let cosine = named(&value["operands"], "cos_gamma");
    assert_eq!(
        *cosine,
        json!({ "name": "cos_gamma", "raw": 524_288, "value": 0.5, "format": "u1.20" })
    );
    assert_eq!(value["inside_the_domain"], true);
    let formula = json!({ "f": 0.25, "f_error": 1.0, "outputs": [50.0, 25.0, 0.0], "errors": [0.0, 0.0, 0.0] });
    assert_eq!(value["formula"], formula);
    for (name, raw) in [("red_out", 50), ("green_out", 25), ("blue_out", 0), ("valid", 1)] {
        assert_eq!(named(&value["signals"], name)["raw"], raw, "{name}");
    }
}

/// The registers have the formats of the sequential core's; the handshake is another.
#[test]
fn a_point_of_a_pipeline_is_evaluated() {
    let dir = Workspace::with("core.toml", "device = \"lyon\"\narchitecture = \"pipelined\"\n");
    let value = dir.glint(["eval", "core.toml", "dx=-0.5", "--json"]).quiet().json();
    let raw = named(&value["operands"], "dx")["raw"].clone();
    let held = named(&value["signals"], "dx_reg");
    assert_eq!((&held["raw"], &held["value"]), (&raw, &json!(-0.5)), "{held}");
    let signals = value["signals"].as_array().expect("a list");
    assert!(signals.iter().all(|it| it["format"] != "" && it["name"] != "busy"), "{signals:?}");
}

#[test]
fn points_come_from_standard_input() {
    let dir = Workspace::with("core.toml", SQUARE);
    dir.write("points.csv", "cos_gamma,red\n0.5,200\n0.25,\n");
    let input = std::fs::File::open(dir.at("points.csv")).expect("a file");
    let mut command = dir.command();
    let run = Run::of(command.args(["eval", "core.toml", "--batch", "-"]).stdin(input).output());
    assert_eq!(run.out, dir.done(["eval", "core.toml", "--batch", "points.csv"]));
}

#[test]
fn lines_of_a_batch_are_counted_whatever_their_ends() {
    let dir = Workspace::with("core.toml", SQUARE);
    dir.write("points.csv", "red,green\r\n\r\n1,2\r\n1.5,2");
    dir.glint(["eval", "core.toml", "--batch", "points.csv"])
        .refused(1, &["`points.csv`, line 4: operand `red`"]);
}

#[test]
fn every_device_is_listed() {
    let value = Workspace::new().glint(["list", "--json"]).json();
    let names: Vec<&Value> =
        value["devices"].as_array().unwrap().iter().map(|device| &device["name"]).collect();
    let registry = Registry::shipped();
    let all: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
    assert_eq!(names, all);
}

#[test]
fn a_new_configuration_is_accepted() {
    for (device, name) in [("rough", "rough"), ("function", "my_function"), ("sin", "sin")] {
        let dir = Workspace::new();
        let text = dir.done(["new", device]);
        dir.write("file.toml", &text);
        let run = dir.glint(["generate", "file.toml"]);
        // Defaults are inside the contract: there is no warning of it.
        assert_eq!(run.code, 0, "{run:?}");
        assert!(!run.err.contains("outside the accuracy contract"), "{run:?}");
        assert!(dir.at(&format!("rtl_out/{name}/{name}.v")).exists());
        let value = dir.glint(["new", device, "--json", "--name", "mine"]).json();
        assert_eq!((&value["device"], &value["name"]), (&device.into(), &"mine".into()));
        let renamed = text.replace(&format!("name = \"{name}\""), "name = \"mine\"");
        assert_eq!(value["text"], renamed);
    }
}

#[test]
fn the_version_is_told() {
    for flag in ["-V", "--version"] {
        assert_eq!(Workspace::new().done([flag]), format!("glint {}\n", env!("CARGO_PKG_VERSION")));
    }
}

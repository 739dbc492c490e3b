//! `eval`, `list`, `-V`: every device of the catalogue.

use glint::registry::Registry;

use crate::common::json::Json;
use crate::workspace::Workspace;

/// Whatever is left out, the point is lit and its error is in the bound.
#[test]
fn a_point_of_the_evaluators_choice_is_lit() {
    for device in Registry::catalogue().devices() {
        let name = device.name;
        let dir = Workspace::with("core.toml", format!("device = \"{name}\"\n"));
        let value = dir.glint(["eval", "core.toml", "--json"]).quiet().json();
        let formula = &value["formula"];
        // A function has no reflectance.
        assert_eq!(formula["f"].is_null(), name == "function", "{name}: {formula}");
        assert!(formula["f"].as_f64().is_none_or(|f| (0.1..0.9).contains(&f)), "{name}: {formula}");
        assert!(value["inside_the_domain"] == true, "{name}: {formula}");
        let errors = formula["errors"].list().iter();
        let errors: Vec<f64> = errors.map(|error| error.number()).collect();
        assert!(!errors.is_empty() && errors.iter().all(|it| *it < 1.0), "{name}: {errors:?}");
    }
}

#[test]
fn every_device_is_listed() {
    let value = Workspace::new().glint(["list", "--json"]).json();
    let registry = Registry::shipped();
    let all: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
    assert_eq!(value["devices"].each("name"), all);
}

#[test]
fn a_new_configuration_of_a_function_is_accepted() {
    for (device, name) in [("function", "my_function"), ("sin", "sin")] {
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

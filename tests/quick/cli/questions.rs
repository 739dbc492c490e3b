//! Tests `glint eval`, `glint list`, `glint new` and `-V`.

use glint::registry::{Device, Registry};

use crate::common::json::Json;
use crate::common::sample::sampled_by_name;
use crate::config_device::uncommented;
use crate::workspace::Workspace;

/// With `--typical` the point is lit and its error is in the bound.
#[test]
fn a_typical_point_is_lit() {
    for device in Registry::catalogue().devices() {
        let name = device.name;
        let dir = Workspace::with("core.toml", format!("device = \"{name}\"\n"));
        let value = dir.glint(["eval", "core.toml", "--typical", "--json"]).quiet().json();
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

/// One light of two, and one colour: what is not given adds nothing. `diffuse·(N·L)` is 100 with N = L.
#[test]
fn operands_that_are_not_given_are_zero() {
    let dir = Workspace::with("core.toml", "device = \"shading\"\nlights = 2\n");
    let point = "nx=0 ny=0 nz=1 lx=0 ly=0 lz=1 hx=0 hy=0 hz=0 diffuse_red=100".split(' ');
    let arguments: Vec<&str> = ["eval", "core.toml"].into_iter().chain(point).collect();
    let value = dir.glint([&arguments[..], &["--json"]].concat()).json();
    let outputs: Vec<f64> =
        value["formula"]["outputs"].list().iter().map(|it| it.number()).collect();
    assert_eq!(outputs[0].round(), 100.0, "{value}");
    assert_eq!(outputs[1..], [0.0, 0.0], "{value}");
    assert!(value["not_given"].list().contains(&"lz2 = 0".into()), "{value}");
    let text = dir.done(arguments);
    assert!(text.contains("Operands that were not given: lx2 = 0, "), "{text}");
}

#[test]
fn every_device_is_listed() {
    let value = Workspace::new().glint(["list", "--json"]).json();
    let registry = Registry::shipped();
    let all: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
    assert_eq!(value["devices"].each("name"), all);
}

/// `cosine-power` has eight products and eight clocks, so that one multiplier serves a pipeline with an interval of eight. The
/// sequential core has five multipliers and half the clock. Who has chosen an architecture gets no proposal.
#[test]
fn the_longest_interval_is_proposed() {
    let dir = Workspace::new();
    let listed = dir.done(["list"]);
    let cells = |line: &str| -> Vec<String> {
        line.split('|').map(|cell| cell.trim().to_owned()).filter(|cell| !cell.is_empty()).collect()
    };
    let rows: Vec<Vec<String>> = listed.lines().map(cells).collect();
    let row = rows.iter().find(|row| row.len() == 6 && row[0] == "cosine-power").expect("a row");
    let numbers: Vec<f64> = row[1..].iter().map(|cell| cell.parse().expect("a number")).collect();
    assert_eq!((numbers[0], numbers[2], numbers[3]), (5.0, 8.0, 1.0), "{row:?}");
    assert!(numbers[4] > numbers[1], "{row:?}");
    let proposed = dir.done(["new", "cosine-power"]);
    assert!(
        proposed.contains(
            "# With architecture = \"pipelined\", pipeline.interval = 8, the core has 1 DSP block, "
        ),
        "{proposed}"
    );
    let chosen = dir.done(["new", "cosine-power", "--pipelined"]);
    assert!(!chosen.contains("the core has"), "{chosen}");
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

/// The printed file is short, and generates as it is: with its defaults, with them written out, and as a pipeline.
#[test]
fn every_new_configuration_is_short_and_generates() {
    let registry = Registry::shipped();
    let name_of = |device: &&Device| device.name.to_owned();
    for device in sampled_by_name("new configurations", registry.devices(), name_of) {
        for options in [&[][..], &["--all"], &["--pipelined", "--stream", "--clock", "60"]] {
            let dir = Workspace::new();
            let text = dir.done([&["new", device.name], options].concat());
            dir.write("file.toml", &text);
            let is_pipeline = options.contains(&"--stream");
            assert!(options == ["--all"] || text.lines().count() <= 33, "{text}");
            // Devices along a scan line compute a point a clock as they are.
            let run = dir.glint(["estimate", "file.toml"]);
            let refused = is_pipeline && run.err.contains("architecture");
            assert!(run.code == 0 || refused, "{}: {run:?}", device.name);
            dir.write("file.toml", uncommented(&text));
            assert_eq!(dir.glint(["estimate", "file.toml"]).out, run.out, "{}", device.name);
        }
    }
}

#[test]
fn options_of_new_set_keys() {
    let dir = Workspace::new();
    let options = ["--clock", "50", "--set", "exponent.bits=8", "--set", "power=4"];
    let text = dir.done([&["new", "cosine-power"][..], &options].concat());
    for line in [
        "package.clock_mhz = 50.0 ",
        "package.constraints = true ",
        "exponent.bits = 8 ",
        "# domain.exponent_max = 255 ",
    ] {
        assert!(text.contains(&format!("\n{}", line)), "no `{line}` in {text}");
    }
    // A key that the user edits moves the defaults.
    dir.write("file.toml", text.replace("exponent.bits = 8", "exponent.bits = 6"));
    dir.done(["generate", "file.toml"]);
    for (setting, part) in [
        ("exponent.bits", "expected KEY=VALUE"),
        ("a b=1", "`a b` cannot be the name of a key"),
        ("exponent.bit=8", "did you mean `exponent.bits`?"),
        ("exponent.bits=80", "`exponent.bits` = 80 is out of range"),
    ] {
        let run = dir.glint(["new", "cosine-power", "--set", setting]);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.err.contains(part), "{part}: {run:?}");
    }
    assert_eq!(dir.glint(["new", "rsqrt", "--target", "ice40"]).code, 2);
}

#[test]
fn the_version_is_told() {
    for flag in ["-V", "--version"] {
        assert_eq!(Workspace::new().done([flag]), format!("glint {}\n", env!("CARGO_PKG_VERSION")));
    }
}

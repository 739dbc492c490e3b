//! `eval`, `list`, `new`, `--help`, `-V`.

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

#[test]
fn a_point_is_evaluated() {
    // n = 2, cos γ = 1/2: (−1/2 + 1)² = 1/4 of 200.
    let run = eval(&["cos_gamma=0.5", "exponent=2", "red=200"]).quiet();
    let rows = run.out.lines().filter(|line| line.contains("red_out") || line.contains("| f "));
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let rows: Vec<Vec<String>> = rows.map(cells).collect();
    let wanted = [
        ["red_out", "u8.0", "50", "50"],
        // (1/2 - 2^-16)^2, cut off: the inverse of what is subtracted from 1 is a unit short.
        ["f", "0.2499847412109375", "0.250000000", "1.000"],
        ["red_out", "50", "50.000000000", "0.000"],
    ];
    assert_eq!(rows.len(), wanted.len(), "{}", run.out);
    rows.iter().zip(wanted).for_each(|(row, wanted)| assert_eq!(row[1..5], wanted));
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
fn a_point_outside_the_domain_is_marked() {
    let run = eval(&["exponent=0"]);
    assert_eq!(run.code, 0);
    let first = run.out.lines().next().expect("a line");
    assert_eq!(
        first,
        "Outside the domain for which the contract is stated: exponent = 0 is not in 1 to 1000."
    );
}

#[test]
fn points_are_evaluated_in_batch() {
    let dir = Workspace::with("core.toml", SQUARE);
    // (n/2·(c − 1) + 1)² at n = 2 is c².
    let points = "cos_gamma, exponent ,red\n0.5,2,200\n#1048576,2,#100\n0.25,2,\n";
    dir.write("points.csv", points);
    let table = dir.done(["eval", "core.toml", "--batch", "points.csv", "green=0", "blue=64"]);
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(
        rows[0].join(","),
        "cos_gamma,exponent,red,green,blue,f,red_out,green_out,blue_out,formula_f,formula_red_out,\
         formula_green_out,formula_blue_out,inside_the_domain"
    );
    assert_eq!(rows[1][..5], ["0.5", "2", "200", "0", "64"]);
    assert_eq!(rows[1][6..9], ["50", "0", "16"]);
    assert_eq!(rows[1][9..], ["0.25", "50", "0", "16", "true"]);
    assert_eq!(rows[2][9..], ["1", "100", "0", "64", "true"]);
    // What is empty is taken from the top: a sixteenth of 255.
    assert_eq!((rows[3][2], rows[3][6], rows.len()), ("255", "16", 4));
    let json = ["eval", "core.toml", "--batch", "points.csv", "--json"];
    let told: Value = serde_json::from_str(&dir.done(json)).expect("JSON");
    assert_eq!(told["points"][0]["outputs"]["red_out"], 50);
    assert_eq!(told["points"][0]["operands"]["cos_gamma"], 524_288);
    // From standard input the same.
    let input = std::fs::File::open(dir.at("points.csv")).expect("a file");
    let mut command = dir.command();
    command.args(["eval", "core.toml", "--batch", "-", "green=0", "blue=64"]).stdin(input);
    assert_eq!(Run::of(command.output()).out, table);
}

#[test]
fn a_batch_that_is_wrong_is_refused_with_its_line() {
    let dir = Workspace::with("core.toml", SQUARE);
    for (text, message) in [
        ("cos_gama\n1\n", "there is no operand `cos_gama`; did you mean `cos_gamma`?"),
        ("red,red\n1,1\n", "operand `red` is given twice"),
        ("red,green\n1,2\n1.5,2\n", "`points.csv`, line 3: operand `red`: 1.5 is not an integer"),
        ("red,green\n1,2\n\n\n1.5,2\n", "`points.csv`, line 5: operand `red`"),
        ("red,green\r\n\r\n1,2\r\n1.5,2", "`points.csv`, line 4: operand `red`"),
        ("red,green\n1\n", "cannot read `points.csv`"),
        ("red\n", "has no row of operands"),
    ] {
        dir.write("points.csv", text);
        dir.glint(["eval", "core.toml", "--batch", "points.csv"]).refused(1, &[message]);
    }
    let twice = ["eval", "core.toml", "red=1", "--batch", "points.csv"];
    dir.write("points.csv", "red\n1\n");
    dir.glint(twice).refused(1, &["operand `red` is given twice"]);
    dir.glint(["eval", "core.toml", "--batch", "none.csv"]).refused(1, &["cannot read `none.csv`"]);
}

#[test]
fn operands_that_are_wrong_usage() {
    for (operands, message) in [
        (
            &["cos_gama=1"][..],
            "there is no operand `cos_gama`; did you mean `cos_gamma`? The operands are: cos_gamma, exponent, red",
        ),
        (&["zzz=1"], "there is no operand `zzz`. The operands are: cos_gamma"),
        (&["red=1", "green=2", "red=1"], "operand `red` is given twice"),
        (&["red=256"], "operand `red`: 256 is beyond u8.0: 0 to 255"),
        (&["red=-1"], "operand `red`: -1 is beyond u8.0"),
        (&["red=#256"], "operand `red`: raw integer 256 is beyond u8.0: 0 to 255"),
        (&["red=#-1"], "raw integer -1 is beyond"),
        (&["red=#99999999999999999999"], "raw integer 99999999999999999999 is beyond"),
        (&["red=#1.5"], "operand `red`: `#1.5` is not a raw integer, as in #1038090"),
        (&["red=bright"], "operand `red`: `bright` is not a number"),
        (&["red=nan"], "`nan` is not a finite number"),
        (&["red=1e999"], "`1e999` is not a finite number"),
        (&["red=1.5"], "operand `red`: 1.5 is not an integer, and u8.0 holds integers"),
        (&["red="], "operand `red`: `` is not a number"),
        (&["red"], "`red` is not operand=value, as in cos_gamma=0.99"),
    ] {
        eval(operands).refused(2, &[message]);
        let run = eval(&[operands, &["--json"]].concat());
        assert_eq!((run.code, run.err.as_str()), (2, ""), "{run:?}");
        let told = run.json()["problems"][0]["message"].as_str().unwrap().to_owned();
        assert!(told.contains(message), "{told}");
    }
}

#[test]
fn devices_and_configurations_are_listed() {
    let dir = Workspace::with("configs/mine.toml", SQUARE);
    let text = dir.done(["list"]);
    for part in ["| rough ", "| cosine-power ", "\nconfigs/mine.toml\n"] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    let value = dir.glint(["list", "--json"]).json();
    assert_eq!(value["configs"], json!(["configs/mine.toml"]));
    let names: Vec<&Value> =
        value["devices"].as_array().unwrap().iter().map(|device| &device["name"]).collect();
    let registry = Registry::catalogue();
    let all: Vec<&str> = registry.devices().iter().map(|device| device.name).collect();
    assert_eq!(names, all);
    assert_eq!(Workspace::new().glint(["list", "--json"]).json()["configs"], json!([]));
}

#[test]
fn a_new_configuration_is_accepted() {
    for (device, name) in
        [("rough", "rough"), ("cosine-power", "cosine_power"), ("schlick", "schlick")]
    {
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
fn new_with_wrong_words() {
    let dir = Workspace::new();
    let run = dir.glint(["new", "cosine_powr"]);
    run.refused(2, &["there is no device `cosine_powr`; did you mean `cosine-power`? The devices are: quad-cosine, cosine-squared"]);
    assert_eq!(run.out, "");
    dir.glint(["new", "cosine"])
        .refused(2, &["`cosine`; did you mean `cosine-squared`? The devices"]);
    for (name, message) in [
        ("always", "\"always\" is a keyword"),
        ("a/b", "\"a/b\" looks like a path"),
        ("1st", "\"1st\" starts with a digit"),
        ("a\"\nb", "has the character"),
        ("", "is empty"),
    ] {
        let run = dir.glint(["new", "rough", "--name", name]);
        run.refused(2, &[message, "give a Verilog identifier"]);
        assert_eq!(run.out, "");
    }
}

#[test]
fn help_teaches_by_example() {
    let dir = Workspace::new();
    for command in ["generate", "cosim", "eval", "setup", "compare", "list", "new"] {
        let text = dir.done([command, "--help"]);
        let (_, examples) = text.split_once("Example").expect("an example");
        assert!(examples.contains(&format!("  glint {command} ")), "{text}");
    }
    let text = dir.done(["--help"]);
    assert!(text.contains("Examples:\n  glint ") && text.contains("Exit codes: 0"), "{text}");
    for flag in ["-V", "--version"] {
        assert_eq!(dir.done([flag]), format!("glint {}\n", env!("CARGO_PKG_VERSION")));
    }
}

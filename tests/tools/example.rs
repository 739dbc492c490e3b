//! Tests the device of `examples/fresnel`, which is not in the catalogue, with the commands of its own command line.

// The example's own source; its `main` is run as a program below.
#[allow(dead_code)]
#[path = "../../examples/fresnel/main.rs"]
pub mod fresnel;

use std::fs;
use std::path::Path;
use std::process::Output;

use fresnel::FRESNEL;
use glint::config::{Config, sample};

use crate::common::cores::{assert_agrees, random};
use crate::common::files::read;
use crate::common::json::Json;
use crate::common::tools::cargo_example;

/// Runs the example as its user does.
fn run(directory: &Path, arguments: &[&str]) -> Output {
    let output = cargo_example("fresnel").args(arguments).current_dir(directory).output();
    output.expect("cargo runs")
}

/// Runs it to exit code 0; returns what it prints.
fn succeed(directory: &Path, arguments: &[&str]) -> String {
    let output = run(directory, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    assert_eq!(errors, "", "{arguments:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn every_command_works() {
    let directory = tempfile::tempdir().expect("a directory");
    let directory = directory.path();
    let file = succeed(directory, &["new", "fresnel"]);
    fs::write(directory.join("f.toml"), file).expect("written");

    let generate = ["generate", "f.toml", "--out", "out", "--quiet"];
    succeed(directory, &generate);
    for file in ["rtl_out/fresnel/fresnel.v", "testbench/fresnel/fresnel_tb.v"] {
        assert!(directory.join("out").join(file).is_file(), "{file}");
    }
    let core = read(directory.join("out/rtl_out/fresnel/fresnel.v"));
    assert!(core.contains("To regenerate: fresnel generate f.toml\n"), "{core}");
    succeed(directory, &[&generate[..], &["--check"]].concat());
    assert!(succeed(directory, &["--help"]).contains("\n  fresnel generate my_core.toml"));

    for simulator in ["rust-hdl", "icarus", "verilator"] {
        let cosim = ["cosim", "f.toml", "--quiet", "--simulator", simulator];
        succeed(directory, &cosim);
    }

    // 0.04 + 0.96·0.5⁵ = 0.07, where f0 = 10/256 is nearest to 0.04: 255·0.0691 = 17.6.
    // It has no exponent: there is nothing to hold against cosⁿγ.
    let compare = succeed(directory, &["compare", "--no-synthesis"]);
    assert!(
        compare.contains(
            "fresnel: no errors are shown, because the device has no operands for gamma and n"
        ),
        "{compare}"
    );

    let eval = ["eval", "f.toml", "cos_half=0.5", "f0=0.04", "red=255"];
    let text = succeed(directory, &eval);
    let out = text.lines().find(|line| line.starts_with("| red_out"));
    assert!(out.is_some_and(|line| line.contains(" 18 |")), "{text}");

    // A picture has no f0.
    let refused = run(directory, &["render", "f.toml", "--out", "out.png"]);
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(1), "{errors}");
    for part in ["cannot compute `cos_half`", "`f0` (", "it computes only cos_gamma, exponent"] {
        assert!(errors.contains(part), "no `{part}` in {errors}");
    }
}

#[test]
fn the_catalogue_is_not_there() {
    let directory = tempfile::tempdir().expect("a directory");
    let list = succeed(directory.path(), &["list", "--json"]);
    let list: serde_json::Value = serde_json::from_str(&list).expect("JSON");
    assert_eq!(list["devices"].each("name"), ["fresnel"]);
    let rough = run(directory.path(), &["new", "rough"]);
    assert_eq!(rough.status.code(), Some(2));
}

#[test]
fn a_configuration_outside_the_contract_is_refused_when_strict() {
    let directory = tempfile::tempdir().expect("a directory");
    let text = "device = \"fresnel\"\nstrict = true\n[colour]\nbits = 12\n";
    fs::write(directory.path().join("f.toml"), text).expect("written");
    let output = run(directory.path(), &["generate", "f.toml"]);
    assert_eq!(output.status.code(), Some(1));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("power."), "{errors}");
    assert!(!directory.path().join("rtl_out").exists());
}

#[test]
fn the_schema_is_sound() {
    assert_eq!((FRESNEL.schema)().mistakes(), Vec::<String>::new());
}

/// Every cosine and every reflectance, against the formula written out here.
#[test]
fn the_bound_holds_everywhere() {
    let schema = (FRESNEL.schema)();
    let mut configs = vec![Config::defaults(&schema, "fresnel")];
    configs.extend((0..40).map(|seed| sample(&schema, seed, &|_| None)));
    for (at, config) in configs.iter().enumerate() {
        let contract = fresnel::golden::contract(config);
        let bound = contract.bounds();
        if at == 0 {
            assert!(bound.governing_units() < 1.0, "{bound:?}");
        }
        let [c, f0] = [&contract.operands()[0], &contract.operands()[1]];
        // All of a small domain, a few hundred of a large one, both ends always.
        let values = |(low, high): (i64, i64)| {
            let stride = ((high - low) / 400).max(1) as usize;
            (low..=high).step_by(stride).chain([high])
        };
        let highlight = contract.highlight().expect("it multiplies colours");
        let ulp = highlight.f_format().to_f64(1);
        let mut worst: f64 = 0.0;
        for raw_c in values(c.domain) {
            for raw_f0 in values(f0.domain) {
                let x = 1.0 - raw_c as f64 / f64::from(1 << c.format.frac);
                let r = raw_f0 as f64 / f64::from(1 << f0.format.frac);
                let exact = r + (1.0 - r) * x * x * x * x * x;
                let f = highlight.f(&[raw_c, raw_f0]) as f64 * ulp;
                worst = worst.max((f - exact).abs());
            }
        }
        assert!(worst <= bound.f, "{}: {worst} > {}", config.name, bound.f);
        // A bound that nothing comes near proves little.
        assert!(worst > bound.f / 8.0, "{}: {worst} ≪ {}", config.name, bound.f);
    }
}

#[test]
fn random_configurations_agree_on_every_clock() {
    for seed in 0..40 {
        let (toml, core) = random(FRESNEL, seed);
        assert_agrees(&core, 500, seed, &toml);
    }
}

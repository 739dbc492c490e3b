//! Tests crates outside the workspace that use Glint: by a path to the checkout, and by the packages as they would be
//! published.
//!
//! It also tests the crate that `glint new-device` writes.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::common::files::{put, read, root};
use crate::common::tools::succeeded;

/// Returns the directory that all builds here share, beside that of the tests.
fn target() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR");
    target.map_or_else(|| root().join("target"), PathBuf::from).join("foreign")
}

/// A crate in a temporary directory.
struct Foreign(tempfile::TempDir);

impl Foreign {
    /// A crate with these lines under `[dependencies]`, and the versions of others that the workspace has.
    fn new(name: &str, dependencies: &str, main: &str) -> Self {
        let foreign = Self(tempfile::tempdir().expect("a directory"));
        let package =
            format!("[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n");
        foreign.write(
            "Cargo.toml",
            &format!("{package}[dependencies]\n{dependencies}\n[workspace]\n"),
        );
        fs::copy(root().join("Cargo.lock"), foreign.0.path().join("Cargo.lock")).expect("copied");
        foreign.write("src/main.rs", main);
        foreign
    }

    /// The program of `tests/tools/foreign`, with the device of the example beside it.
    fn with_devices(dependencies: &str) -> Self {
        let foreign = Self::new("foreign", dependencies, &read("tests/tools/foreign/program.rs"));
        for file in ["main", "description", "golden"] {
            let name = format!("fresnel/{file}.rs");
            foreign.write(&format!("src/{name}"), &read(format!("examples/{name}")));
        }
        foreign
    }

    fn write(&self, name: &str, text: &str) {
        put(self.0.path().join(name), text);
    }

    /// Runs a subcommand of Cargo, and returns what it prints.
    fn cargo(&self, arguments: &[&str]) -> String {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(arguments).current_dir(&self.0).env("CARGO_TARGET_DIR", target());
        succeeded(&mut cargo)
    }
}

/// Returns the packages, unpacked, each in place of the one in the registry.
fn packages() -> String {
    let unpacked = succeeded(Command::new("bash").arg(root().join("tools/package")));
    let crates = unpacked.lines().map(|path| {
        let name =
            path.rsplit('/').next().and_then(|name| name.rsplit_once('-')).expect("a name").0;
        format!("{name} = {{ path = {path:?} }}\n")
    });
    crates.collect()
}

#[test]
fn a_program_made_of_the_packages_generates_and_simulates() {
    let packages = packages();
    assert_eq!(packages.lines().count(), published(), "{packages}");
    let foreign = Foreign::with_devices("glint-hdl = \"0.1\"");
    let manifest = read(foreign.0.path().join("Cargo.toml"));
    foreign.write("Cargo.toml", &format!("{manifest}[patch.crates-io]\n{packages}"));
    for (device, name) in [("fresnel", "fresnel"), ("function", "my_function"), ("root", "root")] {
        let run =
            |arguments: &[&str]| foreign.cargo(&[&["run", "--quiet", "--"], arguments].concat());
        foreign.write("core.toml", &run(&["new", device]));
        run(&["generate", "core.toml", "--out", "out", "--quiet"]);
        let core = foreign.0.path().join("out/rtl_out").join(name).join(format!("{name}.v"));
        let core = read(core);
        assert!(core.contains(&format!("module {name}")), "{core}");
        let cosim = run(&["cosim", "core.toml", "--points", "200", "--quiet", "--json"]);
        let cosim: serde_json::Value = serde_json::from_str(&cosim).expect("JSON");
        assert_eq!(cosim["configurations"][0]["verdict"], "holds", "{cosim}");
    }
}

/// The crate that `glint new-device` writes: its tests pass, and its program generates and simulates.
#[test]
fn a_new_device_is_a_crate_that_works() {
    let directory = tempfile::tempdir().expect("a directory");
    let glint = root().display().to_string();
    let new = ["new-device", "soft-blend", "--glint", &glint];
    succeeded(Command::new(env!("CARGO_BIN_EXE_glint")).args(new).current_dir(&directory));
    let foreign = directory.path().join("soft-blend");
    fs::copy(root().join("Cargo.lock"), foreign.join("Cargo.lock")).expect("copied");
    let cargo = |arguments: &[&str]| {
        let mut cargo = Command::new(env!("CARGO"));
        succeeded(cargo.args(arguments).current_dir(&foreign).env("CARGO_TARGET_DIR", target()))
    };
    cargo(&["test", "--quiet"]);
    let run = |arguments: &[&str]| cargo(&[&["run", "--quiet", "--"], arguments].concat());
    put(foreign.join("core.toml"), run(&["new", "soft-blend"]));
    run(&["generate", "core.toml", "--quiet"]);
    let core = read(foreign.join("rtl_out/soft_blend/soft_blend.v"));
    assert!(core.contains("module soft_blend"), "{core}");
    let cosim = run(&["cosim", "core.toml", "--exhaustive", "--quiet", "--json"]);
    let cosim: serde_json::Value = serde_json::from_str(&cosim).expect("JSON");
    assert_eq!(cosim["configurations"][0]["verdict"], "proved", "{cosim}");
}

/// Returns how many crates the workspace publishes: the root, and the members whose manifest does not say otherwise.
fn published() -> usize {
    let manifest: toml::Table = read("Cargo.toml").parse().expect("TOML");
    let members = manifest["workspace"]["members"].as_array().expect("a list").iter();
    let paths = members.map(|member| format!("{}/Cargo.toml", member.as_str().expect("a path")));
    1 + paths.filter(|path| !read(path).contains("publish = false")).count()
}

#[test]
fn a_crate_by_a_path_compiles_without_the_command_line_too() {
    let path = root().display();
    let foreign = Foreign::with_devices(&format!("glint-hdl = {{ path = \"{path}\" }}"));
    foreign.cargo(&["check", "--quiet"]);
    let dependency = format!("glint-hdl = {{ path = \"{path}\", default-features = false }}");
    let main =
        "fn main() { println!(\"{}\", glint::registry::Registry::shipped().devices().len()); }";
    Foreign::new("listing", &dependency, main).cargo(&["check", "--quiet"]);
}

/// The example at the head of `glint-rtl`.
#[test]
fn a_program_of_the_hardware_crate_alone_runs() {
    let head = read("generator/hdl/lib.rs");
    let lines = head.lines().skip_while(|line| *line != "//! ```").skip(1);
    let lines = lines.take_while(|line| *line != "//! ```");
    let code = lines.map(|line| line.trim_start_matches("//!").trim_start_matches(" # "));
    let code = code.collect::<Vec<_>>().join("\n");
    let at = |folder: &str| root().join(folder).display().to_string();
    let dependencies = format!(
        "anyhow = \"1\"\nglint-base = {{ path = {:?} }}\nglint-rtl = {{ path = {:?} }}",
        at("generator/base"),
        at("generator/hdl")
    );
    let main = format!("fn main() -> anyhow::Result<()> {{\n{code}\n}}\n");
    Foreign::new("hardware", &dependencies, &main).cargo(&["run", "--quiet"]);
}

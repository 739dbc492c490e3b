//! Tests crates outside the workspace that use Glint's packages, as they would be published: a program with a device of its own,
//! the crate that `glint new-device` writes, the library without the command line, and the hardware crate alone.
//!
//! All of these crates are compiled with the dependencies that the tests have in the target directory already. Only Glint's packages
//! are compiled once more, without optimisation.

use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::common::files::{put, read, root};
use crate::common::tools::succeeded;

/// The packages of the workspace's crates, unpacked.
struct Packages {
    /// The name of each package, and its directory.
    unpacked: Vec<(String, String)>,
}

impl Packages {
    /// Packs and unpacks the crates.
    ///
    /// # Panics
    /// A crate cannot be packed, or one is missing.
    fn new() -> Self {
        let printed = succeeded(Command::new("bash").arg(root().join("tools/package")));
        let mut unpacked = Vec::new();
        for path in printed.lines() {
            let (_, directory) = path.rsplit_once('/').expect("a directory");
            let (name, _) = directory.rsplit_once('-').expect("a name and a version");
            unpacked.push((name.to_owned(), path.to_owned()));
        }
        assert_eq!(unpacked.len(), published(), "{printed}");
        Self { unpacked }
    }

    /// Returns the directory of a package.
    fn path(&self, name: &str) -> &str {
        let found = self.unpacked.iter().find(|(package, _)| package == name);
        &found.unwrap_or_else(|| panic!("no package {name}")).1
    }

    /// Returns the lines of a manifest that put the packages in place of those in the registry, and set the profile `release` of the
    /// workspace, so that other dependencies need not be compiled again.
    fn manifest_lines(&self) -> String {
        let manifest: toml::Table = read("Cargo.toml").parse().expect("TOML");
        let mut release = manifest["profile"]["release"].clone();
        let profiles = release["package"].as_table_mut().expect("a table");
        let mut patch = String::from("[patch.crates-io]\n");
        for (name, path) in &self.unpacked {
            let unoptimised = toml::Table::from_iter([("opt-level".to_owned(), 0.into())]);
            let _ = profiles.insert(name.clone(), unoptimised.into());
            patch += &format!("{name} = {{ path = {path:?} }}\n");
        }
        let profile = toml::Table::from_iter([("release".to_owned(), release)]);
        let profile = toml::Table::from_iter([("profile".to_owned(), profile.into())]);
        format!("{patch}{profile}")
    }
}

/// Returns how many crates the workspace publishes: the root, and the members whose manifest does not say otherwise.
fn published() -> usize {
    let manifest: toml::Table = read("Cargo.toml").parse().expect("TOML");
    let members = manifest["workspace"]["members"].as_array().expect("a list").iter();
    let paths = members.map(|member| format!("{}/Cargo.toml", member.as_str().expect("a path")));
    1 + paths.filter(|path| !read(path).contains("publish = false")).count()
}

/// A crate in a temporary directory.
struct Foreign(TempDir);

impl Foreign {
    /// A crate with these lines under `[dependencies]`.
    fn new(packages: &Packages, name: &str, dependencies: &str, main: &str) -> Self {
        let foreign = Self(tempfile::tempdir().expect("a directory"));
        let package =
            format!("[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n");
        let lines = packages.manifest_lines();
        foreign.write(
            "Cargo.toml",
            &format!("{package}[dependencies]\n{dependencies}\n[workspace]\n{lines}"),
        );
        foreign.write("Cargo.lock", &read("Cargo.lock"));
        foreign.write("src/main.rs", main);
        foreign
    }

    fn write(&self, name: &str, text: &str) {
        put(self.0.path().join(name), text);
    }

    /// Runs a subcommand of Cargo, and returns what it prints.
    fn cargo(&self, arguments: &[&str]) -> String {
        cargo(self.0.path(), arguments)
    }
}

/// Runs a subcommand of Cargo in a directory, with the profile and the target directory of the tests, and returns what it prints.
fn cargo(directory: &Path, arguments: &[&str]) -> String {
    let target = std::env::var_os("CARGO_TARGET_DIR");
    let target = target.map_or_else(|| root().join("target"), PathBuf::from);
    let (subcommand, rest) = arguments.split_first().expect("a subcommand");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args([subcommand, "--release", "--quiet"]).args(rest);
    succeeded(cargo.current_dir(directory).env("CARGO_TARGET_DIR", target))
}

#[test]
fn crates_made_of_the_packages_work() {
    let packages = Packages::new();
    a_program_generates_and_simulates(&packages);
    a_new_device_is_a_crate_that_works(&packages);
    the_library_compiles_without_the_command_line(&packages);
    a_program_of_the_hardware_crate_alone_compiles(&packages);
}

/// Tests the program of `tests/tools/foreign`, with the device of the example beside it.
fn a_program_generates_and_simulates(packages: &Packages) {
    let program = read("tests/tools/foreign/program.rs");
    let foreign = Foreign::new(packages, "foreign", "glint-hdl = \"0.1\"", &program);
    for file in ["main", "description", "golden"] {
        let name = format!("fresnel/{file}.rs");
        foreign.write(&format!("src/{name}"), &read(format!("examples/{name}")));
    }
    for (device, name) in [("fresnel", "fresnel"), ("function", "my_function"), ("root", "root")] {
        let run = |arguments: &[&str]| foreign.cargo(&[&["run", "--"], arguments].concat());
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

/// Tests the crate that `glint new-device` writes: its tests pass, and its program generates and simulates.
fn a_new_device_is_a_crate_that_works(packages: &Packages) {
    let directory = tempfile::tempdir().expect("a directory");
    let new = ["new-device", "soft-blend", "--glint", packages.path("glint-hdl")];
    succeeded(Command::new(env!("CARGO_BIN_EXE_glint")).args(new).current_dir(&directory));
    let foreign = directory.path().join("soft-blend");
    let manifest = read(foreign.join("Cargo.toml"));
    put(foreign.join("Cargo.toml"), format!("{manifest}\n{}", packages.manifest_lines()));
    put(foreign.join("Cargo.lock"), read("Cargo.lock"));
    cargo(&foreign, &["test"]);
    let run = |arguments: &[&str]| cargo(&foreign, &[&["run", "--"], arguments].concat());
    put(foreign.join("core.toml"), run(&["new", "soft-blend"]));
    run(&["generate", "core.toml", "--quiet"]);
    let core = read(foreign.join("rtl_out/soft_blend/soft_blend.v"));
    assert!(core.contains("module soft_blend"), "{core}");
    let cosim = run(&["cosim", "core.toml", "--exhaustive", "--quiet", "--json"]);
    let cosim: serde_json::Value = serde_json::from_str(&cosim).expect("JSON");
    assert_eq!(cosim["configurations"][0]["verdict"], "proved", "{cosim}");
}

fn the_library_compiles_without_the_command_line(packages: &Packages) {
    let dependency = "glint-hdl = { version = \"0.1\", default-features = false }";
    let main =
        "fn main() { println!(\"{}\", glint::registry::Registry::shipped().devices().len()); }";
    Foreign::new(packages, "listing", dependency, main).cargo(&["check"]);
}

/// Tests the example at the head of `glint-rtl`, which runs as a test of its documentation, too.
fn a_program_of_the_hardware_crate_alone_compiles(packages: &Packages) {
    let head = read("generator/hdl/lib.rs");
    let lines = head.lines().skip_while(|line| *line != "//! ```").skip(1);
    let lines = lines.take_while(|line| *line != "//! ```");
    let code = lines.map(|line| line.trim_start_matches("//!").trim_start_matches(" # "));
    let code = code.collect::<Vec<_>>().join("\n");
    let dependencies = "anyhow = \"1\"\nglint-base = \"0.1\"\nglint-rtl = \"0.1\"";
    let main = format!("fn main() -> anyhow::Result<()> {{\n{code}\n}}\n");
    Foreign::new(packages, "hardware", dependencies, &main).cargo(&["check"]);
}

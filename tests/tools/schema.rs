//! Tests the JSON Schema of the keys with two validators: they accept the configurations below `configs/` and of
//! `examples/soc`, and refuse unknown keys, keys without a device, and values that are out of range or of a wrong type.

use std::path::Path;
use std::process::Command;

use crate::common::Sure;
use crate::common::files::{paths, put, root};
use crate::common::tools::{LIMIT, tool};

/// Returns every configuration of the repository.
fn configurations() -> Vec<String> {
    let mut found = vec![root().join("examples/soc/shade.toml").display().to_string()];
    for directory in ["configs", "configs/studies", "configs/reduced"] {
        found.extend(paths(root().join(directory), ".toml"));
    }
    assert!(found.len() > 20, "{found:?}");
    found
}

/// Returns a directory with the schema, by `glint schema`.
fn with_schema() -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a directory");
    let glint = Command::new(env!("CARGO_BIN_EXE_glint")).arg("schema").output().expect("glint");
    assert!(glint.status.success() && glint.stderr.is_empty(), "{glint:?}");
    put(dir.path().join("schema.json"), glint.stdout);
    dir
}

/// Returns each validator's verdict on some files: whether they are valid.
fn verdicts(dir: &Path, files: &[String]) -> [(bool, String); 2] {
    let options = |all: &[&str]| all.iter().map(|&it| it.to_owned()).collect::<Vec<_>>();
    let schema = format!("file://{}", dir.join("schema.json").display());
    let check = options(&["--schemafile", "schema.json", "--default-filetype", "toml"]);
    let taplo = options(&["lint", "--no-auto-config", "--schema", &schema]);
    [("check-jsonschema", check), ("taplo", taplo)].map(|(name, arguments)| {
        let run = tool(name).run(arguments.iter().chain(files), dir, LIMIT);
        let run = run.sure_of(name);
        (run.status.success(), run.output)
    })
}

#[test]
fn every_configuration_is_valid() {
    let dir = with_schema();
    for (valid, output) in verdicts(dir.path(), &configurations()) {
        assert!(valid, "{output}");
    }
}

#[test]
fn mistakes_are_found() {
    let dir = with_schema();
    let mistakes = [
        "device = \"cosine-powr\"\n",
        "device = \"cosine-power\"\npower = 3\n",
        "device = \"cosine-power\"\n[cosine]\nfraction = 25\n",
        "device = \"cosine-power\"\n[cosine]\nfractoin = 20\n",
        "device = \"cosine-power\"\n[interface]\nregisters = \"wishbon\"\n",
        "device = \"cosine-power\"\n[interface]\nstream = \"yes\"\n",
        "device = \"cosine-power\"\n[package]\nconstraints = true\nclock_mhz = 0.5\n",
        "device = \"quad-cosine\"\npower = 4\n",
        "power = 4\n",
    ];
    for (at, mistake) in mistakes.iter().enumerate() {
        let file = dir.path().join(format!("mistake_{at}.toml"));
        put(&file, mistake);
        for (valid, output) in verdicts(dir.path(), &[file.display().to_string()]) {
            assert!(!valid, "{mistake} is valid: {output}");
        }
    }
}

//! Tests the wheel for Python's installer `pip`: it installs the module `glint` and the program `glint`.

use std::path::Path;
use std::process::Command;

use crate::common::files::{self, put, root};
use crate::common::tools::{checkout, ran, succeeded, tool};

#[test]
fn a_wheel_has_the_module_and_the_program() {
    let dir = tempfile::TempDir::new().expect("a directory");
    let [out, place] = ["wheels", "place"].map(|name| dir.path().join(name));
    let paths = [&out, &place].map(|path| path.to_str().expect("a path"));
    ran("maturin", ["build", "--release", "--out", paths[0]], checkout());
    let wheel = files::paths(&out, ".whl").swap_remove(0);
    let install = ["-m", "pip", "install", "-q", "--no-deps", "--no-index", "--target", paths[1]];
    ran("python", install.into_iter().chain([wheel.as_str()]), dir.path());
    let run_beside = |libraries: &[&Path], program: &Path, arguments: &[&str]| {
        let search = std::env::join_paths(libraries).expect("folders without a colon");
        let mut command = Command::new(program);
        command.args(arguments).env("PYTHONPATH", search).current_dir(dir.path());
        succeeded(&mut command);
    };
    let run = |program: &Path, arguments: &[&str]| run_beside(&[&place], program, arguments);
    put(dir.path().join("core.toml"), "device = \"cosine-power\"\n");
    run(&place.join("bin/glint"), &["generate", "core.toml"]);
    assert!(dir.path().join("rtl_out/core/core.v").is_file());
    let tests = root().join("bindings/python/tests").display().to_string();
    let python = tool("python");
    let pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider"];
    run(python.path(), &[&pytest[..], &[&tests]].concat());
    // The oldest NumPy that the wheel promises; what needs Matplotlib, which wants a newer one, is left out.
    let oldest = root().join("target/tools/oldest-numpy");
    let core = root().join("bindings/python/tests/test_core.py").display().to_string();
    run_beside(&[&place, &oldest], python.path(), &[&pytest[..], &[&core]].concat());
}

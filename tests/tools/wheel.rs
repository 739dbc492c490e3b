//! The wheel for Python's installer: the module `glint`, and a `glint` on PATH.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::tools::{LIMIT, ran, tool};

#[test]
fn a_wheel_has_the_module_and_the_program() {
    let dir = tempfile::TempDir::new().expect("a directory");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [out, place] = ["wheels", "place"].map(|name| dir.path().join(name));
    let paths = [&out, &place].map(|path| path.to_str().expect("a path"));
    ran("maturin", ["build", "--release", "--out", paths[0]], root);
    let wheel = fs::read_dir(&out).expect("wheels").next().expect("a wheel").expect("an entry");
    let wheel = wheel.path();
    let install = ["-m", "pip", "install", "-q", "--no-deps", "--no-index", "--target", paths[1]];
    let install = install.into_iter().chain([wheel.to_str().expect("a path")]);
    tool("python").run_to_success(install, dir.path(), LIMIT).expect("it installs");
    let run = |program: &Path, arguments: &[&str]| {
        let mut command = Command::new(program);
        let done =
            command.args(arguments).env("PYTHONPATH", &place).current_dir(dir.path()).output();
        let done = done.expect("it starts");
        let said =
            [done.stdout, done.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        assert!(done.status.success(), "{arguments:?}:\n{}", said.concat());
    };
    fs::write(dir.path().join("core.toml"), "device = \"cosine-power\"\n").expect("written");
    run(&place.join("bin/glint"), &["generate", "core.toml"]);
    assert!(dir.path().join("rtl_out/core/core.v").is_file());
    let tests = root.join("python/tests");
    let tests = tests.to_str().expect("a path");
    run(tool("python").path(), &["-m", "pytest", "-q", "-p", "no:cacheprovider", tests]);
}

//! The program as a wheel for Python's installer: `pip install` puts a `glint` on PATH that needs nothing else.

use std::fs;
use std::path::Path;

use crate::common::tools::{LIMIT, ran, tool};
use glint::tools::Tool;

#[test]
fn a_wheel_has_the_program() {
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
    let program = Tool::find_in("glint", place.join("bin").as_os_str()).expect("a program");
    fs::write(dir.path().join("core.toml"), "device = \"cosine-power\"\n").expect("written");
    program.run_to_success(["generate", "core.toml"], dir.path(), LIMIT).expect("it generates");
    assert!(dir.path().join("rtl_out/core/core.v").is_file());
}

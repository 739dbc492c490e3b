//! `glint new-device`: writes a Rust crate that defines a device of the user's own, as a starting point.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::{Value, json};

use crate::report::CommandReport;
use crate::{OutputOptions, say, wrong_usage};
use glint_base::identifier;
use glint_core::registry::Registry;

/// Write a crate with a device of your own: description, golden model, contract, command line and test
///
/// The device computes x². Change its formula in four places: the keys, the description, the golden model and the test.
#[derive(Args)]
#[command(after_help = "\
Example:
  glint new-device sine-wave --glint ../glint
  cd sine-wave
  cargo test
  cargo run -- new sine-wave > sine.toml
  cargo run -- generate sine.toml")]
pub struct Arguments {
    /// The name of the device and of its crate: lower-case letters, digits and `-`
    name: String,
    /// The directory to create [default: the name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The path of Glint's checkout, relative to the new directory
    #[arg(long, value_name = "DIR", default_value = "../glint")]
    glint: String,
}

/// The template, the crate of the device `parabola`: the path of each file in the crate, and its contents.
const FILES: [(&str, &str); 6] = [
    ("Cargo.toml", include_str!("../new_device/manifest.toml")),
    ("src/lib.rs", include_str!("../new_device/lib.rs")),
    ("src/description.rs", include_str!("../new_device/description.rs")),
    ("src/golden.rs", include_str!("../new_device/golden.rs")),
    ("src/main.rs", include_str!("../new_device/main.rs")),
    ("tests/device.rs", include_str!("../new_device/test.rs")),
];

/// Writes the crate. Fails if the name cannot be a new device's name, or if the crate cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let name = &arguments.name;
    check_name(registry, name)?;
    let directory = arguments.out.clone().unwrap_or_else(|| PathBuf::from(name));
    let files = FILES.map(|(path, text)| (path, text_for(text, name, &arguments.glint)));
    write(&directory, &files)?;
    output.report(&NewCrate { name, directory: directory.display().to_string() })?;
    Ok(true)
}

struct NewCrate<'a> {
    name: &'a str,
    directory: String,
}

impl CommandReport for NewCrate<'_> {
    fn json(&self) -> Result<Value> {
        let paths = FILES.map(|(path, _)| path);
        Ok(json!({ "ok": true, "directory": self.directory, "files": paths }))
    }

    fn print(&self) -> Result<()> {
        let Self { name, directory } = self;
        say!("{directory}: {} files written. Next:", FILES.len());
        say!("  cd {directory}");
        say!("  cargo test");
        say!("  cargo run -- new {name} > {name}.toml");
        say!("  cargo run -- generate {name}.toml");
        Ok(())
    }
}

/// Writes all files below a new directory, or none.
fn write(directory: &Path, files: &[(&str, String)]) -> Result<()> {
    if directory.symlink_metadata().is_ok() {
        bail!(
            "`{}` exists already; move it away, or give another directory with --out",
            directory.display()
        );
    }
    let parent = match directory.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let cannot = || format!("cannot write `{}`", directory.display());
    let staging = tempfile::tempdir_in(parent).with_context(cannot)?;
    let made = staging.path().join("crate");
    for (path, text) in files {
        let path = made.join(path);
        fs::create_dir_all(path.parent().unwrap_or(&made)).with_context(cannot)?;
        fs::write(path, text).with_context(cannot)?;
    }
    fs::rename(&made, directory).with_context(cannot)
}

/// Checks a new device's name. For example, `sine-wave` is a possible name, and `Sine`, `2x` and `sine--wave` are not.
///
/// # Errors
///
/// Fails if the name does not begin with a lower-case letter, or has other characters than lower-case letters, digits and single
/// `-`. Fails if the name is a reserved word of Verilog, or the name of a device in `registry` or of a crate that the new crate
/// uses.
fn check_name(registry: &Registry, name: &str) -> Result<()> {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let begins = name.starts_with(|c: char| c.is_ascii_lowercase());
    if !begins || !name.chars().all(is_letter) || name.ends_with('-') || name.contains("--") {
        wrong_usage!(
            "`{name}` is not a valid name: use lower-case letters and digits with single `-` between them, \
             and begin with a letter"
        );
    }
    if let Err(why) = identifier::check(&name.replace('-', "_")) {
        wrong_usage!("`{name}`: {why} of Verilog or SystemVerilog");
    }
    if ["anyhow", "glint-hdl"].contains(&name) {
        wrong_usage!(
            "`{name}` is the name of a crate that the new crate uses; choose another name"
        );
    }
    if registry.device(name).is_some() {
        wrong_usage!("a device `{name}` exists already; choose another name");
    }
    Ok(())
}

/// Changes the text of a template file to the device `name`. `glint` is the path of Glint's checkout. For example, `sine-wave`
/// changes `parabola_device` to `sine_wave_device`.
fn text_for(text: &str, name: &str, glint: &str) -> String {
    let module = name.replace('-', "_");
    let glint = toml::Value::from(glint.replace('\\', "/")).to_string();
    text.replace("parabola_device", &format!("{module}_device"))
        .replace("parabola", name)
        .replace("\"GLINT\"", &glint)
}

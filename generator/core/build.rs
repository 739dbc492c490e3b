//! Build script: sets `GLINT_SOURCES` to a digest of the source files that an exhaustive check depends on.
//!
//! `Core::fingerprint` includes this digest, so that an interrupted or divided check continues only with the same sources.
//! `glint cosim --exhaustive --resume` and `glint merge` compare it.

use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Everything whose change can alter the result of an exhaustive check, from formats to the check itself.
const SOURCES: [&str; 11] = [
    "../approximate",
    "../base",
    "../catalogue",
    "../config",
    "../formula",
    "../golden",
    "../hdl",
    "../keys",
    "../plan",
    "../../Cargo.lock",
    "cosim",
];

fn main() {
    let mut files = Vec::new();
    println!("cargo::rerun-if-changed=build.rs");
    for source in SOURCES {
        // An installed crate has only some of them. Cargo would run the script, and compile the crate, each time for a missing one.
        if Path::new(source).exists() {
            println!("cargo::rerun-if-changed={source}");
            collect(Path::new(source), &mut files);
        }
    }
    files.sort();
    let mut digest = Sha256::new();
    for path in files {
        // File names have `/`, and lines have no carriage returns, so that the digest is the same on every machine.
        let name = path.to_string_lossy().replace('\\', "/");
        let text = fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
        digest.update(format!("{name}\n{}\n{text}", text.len()));
    }
    let digest: String = digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    println!("cargo::rustc-env=GLINT_SOURCES={digest}");
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    match fs::read_dir(path) {
        Ok(entries) => entries.flatten().for_each(|entry| collect(&entry.path(), files)),
        Err(_) => files.push(path.to_owned()),
    }
}

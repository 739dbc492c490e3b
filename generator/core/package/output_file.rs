//! Defines one emitted file: its kind, path, contents and digest.

use super::file_kind::FileKind;
use sha2::{Digest, Sha256};

/// A generated file that is not written yet: its kind, path and contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    pub kind: FileKind,
    /// The path relative to the output directory, with `/`: `rtl_out/<name>/<name>.v`.
    pub path: String,
    /// The text, which must end with a newline.
    pub contents: String,
    /// The names of the modules that the file defines, the main one first. For example,
    /// `testbench/rough/rough_registers_formal.sv` defines `rough_registers_formal`, and `rough` as a stub.
    pub modules: Vec<String>,
    /// The target of a [`FileKind::TargetVerilog`], for example `ecp5`.
    pub target: Option<String>,
}

impl OutputFile {
    /// Makes a file that defines no modules and is for all targets.
    pub fn new(kind: FileKind, path: impl Into<String>, contents: impl Into<String>) -> Self {
        Self {
            kind,
            path: path.into(),
            contents: contents.into(),
            modules: Vec::new(),
            target: None,
        }
    }

    /// Returns the last part of the path: `rtl_out/rough/rough.v` gives `rough.v`.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }

    /// Returns the file as outside tools read it: its name without directory, and its contents.
    pub fn source(&self) -> (&str, &str) {
        (self.name(), &self.contents)
    }

    /// Returns the path inside the directory of the configuration. For example,
    /// `rtl_out/blinn_pipelined/ecp5/blinn_pipelined_multiplier.v` gives `ecp5/blinn_pipelined_multiplier.v`.
    pub(super) fn local_path(&self) -> String {
        match &self.target {
            Some(target) => format!("{target}/{}", self.name()),
            None => self.name().to_owned(),
        }
    }

    /// Returns the first module's name, or an empty text for a file without modules.
    pub fn main_module(&self) -> &str {
        self.modules.first().map_or("", String::as_str)
    }
}

/// Returns the SHA-256 of a file's contents as 64 hexadecimal digits in lower case.
pub fn digest(contents: &[u8]) -> String {
    Sha256::digest(contents).iter().map(|byte| format!("{byte:02x}")).collect()
}

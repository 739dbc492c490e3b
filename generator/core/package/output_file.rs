//! The files that emission returns: their paths, their digests, and the selection that tools read.

use sha2::{Digest, Sha256};

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// Relative to the output directory, with `/`: `rtl_out/<name>/<name>.v`.
    pub path: String,
    /// The whole text, which must end with a newline.
    pub contents: String,
}

impl OutputFile {
    /// Returns the last part of the path. For example, `rtl_out/rough/rough.v` gives `rough.v`.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or(&self.path)
    }

    /// Returns the target of a file that is in a target's directory, `rtl_out/<name>/<target>/…`, and `None` for any other
    /// file. For example, `rtl_out/blinn_pipelined/ecp5/blinn_pipelined_multiplier.v` gives `ecp5`.
    fn target(&self) -> Option<&str> {
        match self.path.split('/').collect::<Vec<_>>()[..] {
            [_, _, target, _] => Some(target),
            _ => None,
        }
    }
}

/// Returns the files that simulators and synthesisers read, Verilog and memories, each with its plain name.
pub fn sources(files: Vec<OutputFile>) -> Vec<(String, String)> {
    sources_for(files, "")
}

/// Returns the files for a target, whose own take the place of portable ones of the same name.
pub fn sources_for(files: Vec<OutputFile>, target: &str) -> Vec<(String, String)> {
    let needed = |file: &OutputFile| [".v", ".mem"].iter().any(|it| file.name().ends_with(it));
    let (primitives, portable): (Vec<_>, Vec<_>) =
        files.into_iter().filter(needed).partition(|file| file.target().is_some());
    let own =
        |name: &str| primitives.iter().find(|it| it.target() == Some(target) && it.name() == name);
    portable
        .into_iter()
        .map(|file| {
            let name = file.name().to_owned();
            let contents = own(&name).map_or(file.contents, |own| own.contents.clone());
            (name, contents)
        })
        .collect()
}

/// Returns the digest of a file, as the manifest holds it: SHA-256 in hexadecimal.
pub fn digest(contents: &[u8]) -> String {
    Sha256::digest(contents).iter().map(|byte| format!("{byte:02x}")).collect()
}

//! Collects the files of a configuration while they are made. The kind of a file decides its folder, and its place in the
//! list of files.

use super::bus::Bus;
use super::inputs::EmitInputs;
use super::map::Map;
use super::output_file::OutputFile;
use glint_rtl::netlist::Design;
use glint_rtl::verilog::naming::Naming;

/// The purpose of a file, in the order in which files are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ArtifactKind {
    /// Verilog of the core, the top module first. For example, `rough.v`, `rough_control.v` and `rough_datapath.v`.
    Rtl,
    /// Verilog of a target, `<target>/<file>`, in place of the file of that name among the portable ones.
    Primitive,
    /// Verilog around the core.
    Wrapper,
    /// ROM contents. For example, `rough_sine.mem`.
    Memory,
    /// The FuseSoC core of the device. For example, `rough.core`.
    Core,
    /// Timing constraints.
    Constraint,
    /// Scripts and descriptions for vendors' tools.
    Script,
    /// Files for designs in other languages.
    Language,
    /// Benches in Python.
    Python,
    /// Proofs of wrappers.
    WrapperProof,
    /// The proof of the core.
    Proof,
    /// Benches in Verilog with their vectors. The bench of the core comes first. For example, `rough_tb.v` with
    /// `rough_stimulus.mem` and `rough_expected.mem`.
    Bench,
    /// The FuseSoC core of the benches.
    BenchCore,
    /// The model in C, and the other files for software.
    Software,
}

impl ArtifactKind {
    fn folder(self) -> &'static str {
        match self {
            Self::Software => "software",
            Self::Python | Self::WrapperProof | Self::Proof | Self::Bench | Self::BenchCore => {
                "testbench"
            }
            _ => "rtl_out",
        }
    }
}

/// A file: a plain name, and its text.
struct Artifact {
    kind: ArtifactKind,
    name: String,
    text: String,
}

/// The files that were made so far, in any order.
#[derive(Default)]
pub struct Artifacts(Vec<Artifact>);

impl Artifacts {
    /// Adds a file.
    pub fn add(&mut self, kind: ArtifactKind, name: impl Into<String>, text: String) {
        self.0.push(Artifact { kind, name: name.into(), text });
    }

    /// Returns the names of the files of some kinds, in the order of the kinds and, among one kind, in which they were added.
    pub fn names(&self, kinds: &[ArtifactKind]) -> Vec<String> {
        let all = kinds.iter().flat_map(|kind| self.0.iter().filter(move |it| it.kind == *kind));
        all.map(|file| file.name.clone()).collect()
    }

    /// Returns all files in order, with their paths.
    pub fn files(mut self, design: &str) -> Vec<OutputFile> {
        self.0.sort_by_key(|file| file.kind);
        let file = |Artifact { kind, name, text }| OutputFile {
            path: format!("{}/{design}/{name}", ArtifactKind::folder(kind)),
            contents: text,
        };
        self.0.into_iter().map(file).collect()
    }
}

/// A design with everything that its files are made of.
pub struct EmitJob<'a> {
    pub design: &'a Design,
    pub inputs: &'a EmitInputs,
    pub naming: &'a Naming,
    /// The bus that the configuration asks for, and the registers on it.
    pub registers: Option<(&'static Bus, Map)>,
}

impl<'a> EmitJob<'a> {
    /// Returns the name of the core.
    pub fn name(&self) -> &'a str {
        &self.design.name
    }

    /// Returns the command that makes the files again.
    pub fn regenerate(&self) -> &'a str {
        &self.inputs.regenerate
    }

    /// Returns whether the core computes lines of points.
    pub fn is_line(&self) -> bool {
        self.inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some())
    }
}

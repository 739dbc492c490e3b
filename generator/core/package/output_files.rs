//! Collects the emitted files of a configuration, and selects among them by kind.
//!
//! For example, a simulator reads the files of the kinds [`FileKind::SIMULATED`].

use std::slice::Iter;
use std::vec::IntoIter;

use super::file_kind::FileKind;
use super::output_file::OutputFile;

/// The emitted files of a configuration, in the order of their kinds (see [`FileKind`]). Files at one position are in the
/// order in which they were added.
#[derive(Clone, Debug)]
pub struct OutputFiles {
    /// The name of the configuration and of its directories.
    name: String,
    files: Vec<OutputFile>,
}

impl OutputFiles {
    pub(super) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), files: Vec::new() }
    }

    /// Adds a file that defines no modules.
    pub(super) fn add(&mut self, kind: FileKind, file: impl AsRef<str>, contents: String) {
        let path = self.path(kind, file.as_ref());
        self.insert(OutputFile::new(kind, path, contents));
    }

    /// Adds a file in Verilog that defines `modules`, and has the name of the first module. For example, a file that defines
    /// `rough_axis` and `rough_axis_buffer` is `rough_axis.v`.
    pub(super) fn add_verilog(&mut self, kind: FileKind, modules: Vec<String>, contents: String) {
        self.add_modules(kind, "v", modules, contents);
    }

    /// Does the same as [`OutputFiles::add_verilog`] in SystemVerilog, for example for `rough_formal.sv`.
    pub(super) fn add_system_verilog(
        &mut self,
        kind: FileKind,
        modules: Vec<String>,
        contents: String,
    ) {
        self.add_modules(kind, "sv", modules, contents);
    }

    /// Adds the Verilog of `module` for one target, in a directory with the name of the target. For example,
    /// `blinn_pipelined_multiplier` for `ecp5` is in `ecp5/blinn_pipelined_multiplier.v`.
    pub(super) fn add_for_target(&mut self, target: &str, module: &str, contents: String) {
        let kind = FileKind::TargetVerilog;
        let path = self.path(kind, &format!("{target}/{module}.v"));
        self.insert(OutputFile {
            modules: vec![module.to_owned()],
            target: Some(target.to_owned()),
            ..OutputFile::new(kind, path, contents)
        });
    }

    fn add_modules(
        &mut self,
        kind: FileKind,
        extension: &str,
        modules: Vec<String>,
        contents: String,
    ) {
        let path = self.path(kind, &format!("{}.{extension}", modules[0]));
        self.insert(OutputFile { modules, ..OutputFile::new(kind, path, contents) });
    }

    fn path(&self, kind: FileKind, file: &str) -> String {
        format!("{}/{}/{file}", kind.folder(), self.name)
    }

    fn insert(&mut self, file: OutputFile) {
        let kind = file.kind.listed_with();
        let place = self.files.partition_point(|other| other.kind.listed_with() <= kind);
        self.files.insert(place, file);
    }

    pub fn of(&self, kinds: &[FileKind]) -> Vec<&OutputFile> {
        self.files.iter().filter(|file| kinds.contains(&file.kind)).collect()
    }

    /// Returns paths relative to the directory of the configuration: [`FileKind::Memory`] gives `rough_sine.mem`.
    pub(super) fn local_paths(&self, kinds: &[FileKind]) -> Vec<String> {
        self.of(kinds).into_iter().map(OutputFile::local_path).collect()
    }

    /// Returns the name of the main module of each file. For example, [`FileKind::Bench`] gives `rough_tb` and
    /// `rough_axis_tb`. A file without modules gives an empty name.
    pub fn modules(&self, kinds: &[FileKind]) -> Vec<&str> {
        self.of(kinds).into_iter().map(OutputFile::main_module).collect()
    }

    /// Returns the names of the modules that a system can instantiate, the core first. For example, `rough`, `rough_axis` and
    /// `rough_axil`.
    pub fn top_modules(&self) -> Vec<&str> {
        let mut tops = Vec::new();
        for kind in [
            FileKind::CoreVerilog,
            FileKind::StreamWrapper,
            FileKind::BusWrapper,
            FileKind::ProcessorWrapper,
        ] {
            tops.extend(self.modules(&[kind]).first());
        }
        tops
    }

    /// Returns the files as outside tools read them: pairs of a name without directory, and the contents. A module that also
    /// has a version for one target is in the portable version.
    pub fn sources(&self, kinds: &[FileKind]) -> Vec<(String, String)> {
        self.sources_for(kinds, "")
    }

    /// Does the same as [`OutputFiles::sources`], but a file that has a version for `target` has the contents of this version.
    pub fn sources_for(&self, kinds: &[FileKind], target: &str) -> Vec<(String, String)> {
        let mut sources = Vec::new();
        for file in self.of(kinds) {
            let chosen = self.form_for(target, file.name()).unwrap_or(file);
            sources.push((file.name().to_owned(), chosen.contents.clone()));
        }
        sources
    }

    fn form_for(&self, target: &str, name: &str) -> Option<&OutputFile> {
        let forms = self.of(&[FileKind::TargetVerilog]);
        let is_form =
            |file: &&OutputFile| file.target.as_deref() == Some(target) && file.name() == name;
        forms.into_iter().find(is_form)
    }

    pub fn iter(&self) -> Iter<'_, OutputFile> {
        self.files.iter()
    }

    pub fn as_slice(&self) -> &[OutputFile] {
        &self.files
    }

    #[expect(clippy::len_without_is_empty, reason = "emission always makes the core's Verilog")]
    pub fn len(&self) -> usize {
        self.files.len()
    }
}

impl IntoIterator for OutputFiles {
    type Item = OutputFile;
    type IntoIter = IntoIter<OutputFile>;

    fn into_iter(self) -> Self::IntoIter {
        self.files.into_iter()
    }
}

impl<'a> IntoIterator for &'a OutputFiles {
    type Item = &'a OutputFile;
    type IntoIter = Iter<'a, OutputFile>;

    fn into_iter(self) -> Self::IntoIter {
        self.files.iter()
    }
}

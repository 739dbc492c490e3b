//! Decides for each file in the directories of a configuration whether Glint wrote it, whether a user edited it, or whether it is
//! foreign.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use super::{differs, directories};
use glint_core::package::{OutputFile, digest};
use glint_tools::transient::{files_below, relative_name};

/// The differences between the files in the directories of a configuration and the files that should be there. All lists are
/// sorted.
pub struct Survey {
    /// The paths below `out` of the files that must be written or replaced, and of outdated files that must be deleted.
    pub different: Vec<String>,
    /// The files that Glint wrote and somebody edited, and foreign files in the place of a file to be written.
    pub edited: Vec<PathBuf>,
    /// The files that Glint wrote and no longer needs.
    pub stale: Vec<PathBuf>,
}

impl Survey {
    /// Compares `files`, which should be there, with the directories of the configuration `name` below `out`.
    ///
    /// # Errors
    ///
    /// Fails if a file or a directory cannot be read.
    pub fn new(out: &Path, name: &str, files: &[OutputFile]) -> Result<Self> {
        let manifest = out.join("rtl_out").join(name).join(format!("{name}.json"));
        let digests = Digests::read(&manifest, out);
        let mut survey = Self { different: Vec::new(), edited: Vec::new(), stale: Vec::new() };
        for file in files {
            if differs(out, file)? {
                survey.different.push(file.path.clone());
            }
        }
        for path in present(out, name)? {
            let relative = relative_name(out, &path);
            let wanted = files.iter().any(|file| file.path == relative);
            let below = format!("{relative}/");
            let in_the_way = files.iter().any(|file| file.path.starts_with(&below));
            // A symbolic link to a file with the right text is no file of Glint, and would be replaced like an edited file.
            if wanted && !path.is_symlink() && !survey.different.contains(&relative) {
                continue;
            }
            match digests.owner(&relative, &path) {
                Owner::Glint if wanted => {}
                Owner::Glint => {
                    survey.different.push(relative);
                    survey.stale.push(path);
                }
                Owner::Editor => {
                    survey.edited.push(path);
                    if !wanted {
                        survey.different.push(relative);
                    }
                }
                Owner::Other if wanted || in_the_way => survey.edited.push(path),
                Owner::Other => {}
            }
        }
        // Directories that are in the place of a file.
        let directories =
            files.iter().map(|file| out.join(&file.path)).filter(|path| path.is_dir());
        survey.edited.extend(directories);
        survey.edited.sort();
        survey.different.sort();
        Ok(survey)
    }
}

enum Owner {
    /// Glint wrote the file, and nobody edited it.
    Glint,
    /// Glint wrote the file, and somebody edited it.
    Editor,
    /// A foreign file. A symbolic link counts as a foreign file.
    Other,
}

/// The digests in a manifest such as `rtl_out/rough/rough.json`, or `None` if the file is missing or is no manifest of Glint.
struct Digests {
    manifest: String,
    digests: Option<BTreeMap<String, String>>,
}

impl Digests {
    fn read(manifest: &Path, out: &Path) -> Self {
        Self { manifest: relative_name(out, manifest), digests: parsed(manifest) }
    }

    /// Returns who wrote the file at `path`, which has the path `relative` below `out`. Without a manifest of Glint, every file
    /// is foreign.
    fn owner(&self, relative: &str, path: &Path) -> Owner {
        let Some(digests) = &self.digests else {
            return Owner::Other;
        };
        if path.is_symlink() {
            return Owner::Other;
        }
        if relative == self.manifest {
            return Owner::Glint;
        }
        match digests.get(relative) {
            Some(right) if fs::read(path).is_ok_and(|found| digest(&found) == *right) => {
                Owner::Glint
            }
            Some(_) => Owner::Editor,
            None => Owner::Other,
        }
    }
}

fn parsed(manifest: &Path) -> Option<BTreeMap<String, String>> {
    let value: Value = serde_json::from_slice(&fs::read(manifest).ok()?).ok()?;
    let digests = value.get("sha256")?.as_object()?;
    digests.iter().map(|(path, digest)| Some((path.clone(), digest.as_str()?.to_owned()))).collect()
}

/// Returns the files in the directories of the configuration `name`, at any depth and sorted. A file in the place of one of these
/// directories is included.
fn present(out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for directory in directories(out, name) {
        match fs::read_dir(&directory) {
            Ok(_) => {
                found.extend(files_below(&directory).with_context(|| cannot_read(&directory))?);
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            // A file is in the place of the directory, or of a directory above. Only a file in the place of the directory
            // itself exists at this path.
            Err(error) if error.kind() == ErrorKind::NotADirectory => {
                found.extend(fs::symlink_metadata(&directory).is_ok().then_some(directory));
            }
            Err(error) => return Err(error).with_context(|| cannot_read(&directory)),
        }
    }
    found.sort();
    Ok(found)
}

fn cannot_read(path: &Path) -> String {
    format!("cannot read `{}`", path.display())
}

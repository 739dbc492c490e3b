//! Finds the files that are in the directories of a configuration, and decides for each whether Glint wrote it, the user edited
//! it, or it is foreign.

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
    /// Names of files that are to be written, replaced, or deleted because Glint wrote them once.
    pub different: Vec<String>,
    /// The paths of files that Glint wrote and somebody edited, and of foreign files in the place of a file to be written.
    pub edited: Vec<PathBuf>,
    /// The paths of files that Glint wrote and that are no longer needed.
    pub stale: Vec<PathBuf>,
}

impl Survey {
    /// Compares the files of the configuration `name` below `out` with `files`, which should be there.
    ///
    /// # Errors
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
            // A link to the right text is none of Glint's files all the same: it would be replaced with the others.
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
        // A directory where a file is to be.
        let directories =
            files.iter().map(|file| out.join(&file.path)).filter(|path| path.is_dir());
        survey.edited.extend(directories);
        survey.edited.sort();
        survey.different.sort();
        Ok(survey)
    }
}

/// The owner of a file.
enum Owner {
    /// As Glint wrote it.
    Glint,
    /// Glint wrote it, and somebody edited it.
    Editor,
    /// Glint never wrote it.
    Other,
}

/// The digests that a manifest holds; none when it is no manifest of Glint's. For example, the manifest
/// `rtl_out/rough/rough.json` has the digest of `rtl_out/rough/rough.v`.
struct Digests {
    manifest: String,
    digests: Option<BTreeMap<String, String>>,
}

impl Digests {
    /// Reads a manifest below `out`.
    fn read(manifest: &Path, out: &Path) -> Self {
        Self { manifest: relative_name(out, manifest), digests: parsed(manifest) }
    }

    /// Returns the owner of the file `relative`, whose path is `path`.
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

/// Returns the files in the directories of a configuration, at any depth, sorted.
fn present(out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for directory in directories(out, name) {
        match fs::read_dir(&directory) {
            Ok(_) => {
                found.extend(files_below(&directory).with_context(|| cannot_read(&directory))?);
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            // A file where the directory should be, unless it is one above that is no directory.
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

//! Writes new files completely in a temporary directory, and then moves each to its place.
//!
//! If a run is killed, some files may have been moved already, and the next run generates all files again. The manifest, which
//! lists the digests of all other files, is moved last.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::directories::{create_directory, create_parent};
use glint_core::package::OutputFile;
use glint_tools::transient::{self, Directory};

/// A temporary directory with complete new files, next to the directories to which the files will be moved.
pub struct Staging {
    directory: Directory,
    made: Vec<String>,
}

impl Staging {
    /// Writes `files` to a temporary directory beside their places. Fails if `out` cannot be written.
    pub fn new(out: &Path, files: &[OutputFile]) -> Result<Self> {
        let cannot =
            || format!("cannot write to `{}`; choose another directory with --out", out.display());
        let directory = Directory::beside(out).with_context(cannot)?;
        for file in files {
            let path = directory.path().join(&file.path);
            create_parent(&path)?;
            fs::write(&path, &file.contents).with_context(|| {
                format!("cannot write `{}`; the existing files are unchanged", file.path)
            })?;
        }
        Ok(Self { directory, made: files.iter().map(|file| file.path.clone()).collect() })
    }

    /// Deletes the files `stale`, which the configuration no longer needs, and moves the new files to their places. The caller
    /// must have checked that the files in these places may be replaced.
    ///
    /// # Errors
    /// Fails if a directory cannot be made or is a symbolic link, and then changes no file. Fails if a file cannot be deleted or
    /// moved. Some files are then new, and the next run writes the rest.
    pub fn place(self, out: &Path, stale: &[PathBuf]) -> Result<()> {
        for path in &self.made {
            // `rtl_out/<name>/…`
            let mut parts = path.split('/');
            let above = out.join(parts.next().unwrap_or_default());
            create_directory(&above)?;
            let own = above.join(parts.next().unwrap_or_default());
            ensure!(
                !own.is_symlink(),
                "`{}` is a symbolic link, and Glint does not write through links; nothing was changed\ngive \
                 --out the directory to which the link leads, or replace the link by a directory",
                own.display()
            );
        }
        transient::undivided(|| {
            for path in stale {
                fs::remove_file(path)
                    .with_context(|| format!("cannot delete `{}`", path.display()))?;
                // With the last file, the configuration's directories are removed. The directories above them must stay.
                let parents = path.ancestors().skip(1);
                let below = parents
                    .take_while(|it| it.strip_prefix(out).is_ok_and(|it| it.iter().count() > 1));
                let _ = below.map(fs::remove_dir).take_while(Result::is_ok).count();
            }
            place(out, self.directory.path(), &self.made)
        })
    }
}

/// Moves the files in the order of `made`. The manifest, which has the digests of the other files, must be the last one.
fn place(out: &Path, staging: &Path, made: &[String]) -> Result<()> {
    for path in made {
        let (new, place) = (staging.join(path), out.join(path));
        make_room(out, path)?;
        create_parent(&place)?;
        fs::rename(&new, &place)
            .with_context(|| format!("cannot move `{}` into its place", place.display()))?;
    }
    Ok(())
}

/// Deletes everything in the way of the file `path`: a directory in its place, or a file in the place of one of its directories.
/// For example, a file `rtl_out/rough` is in the way of `rtl_out/rough/rough.v`.
fn make_room(out: &Path, path: &str) -> Result<()> {
    let cannot = |path: &Path| format!("cannot delete `{}`, which is in the way", path.display());
    let ends = path.match_indices('/').map(|(at, _)| at).skip(1);
    for above in ends.map(|end| out.join(&path[..end])) {
        if fs::symlink_metadata(&above).is_ok_and(|found| !found.is_dir()) {
            fs::remove_file(&above).with_context(|| cannot(&above))?;
        }
    }
    let place = out.join(path);
    if fs::symlink_metadata(&place).is_ok_and(|found| found.is_dir()) {
        fs::remove_dir_all(&place).with_context(|| cannot(&place))?;
    }
    Ok(())
}

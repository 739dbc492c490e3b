//! The directory in which new files are made whole before they are moved into place.
//!
//! It says in a file of its own that it is Glint's, and holds a lock on that file while it is in use: one that
//! a killed run has left is known by both, and what the run had begun is then finished or taken back.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use super::survey::{Digests, Owner, files_below};
use super::{create_parent, directories, relative_name};
use crate::base::transient::{self, Directory};
use crate::package::OutputFile;

/// The prefix of the directory's name.
const PREFIX: &str = ".glint-";
/// The file that says whose the directory is.
const LOCK: &str = "glint.lock";
/// Its first line; the others name the files that are made here.
const TITLE: &str =
    "Glint makes these files here. The next run deletes what a killed one has left:";
/// Where the old directories stand while the new ones are moved into place.
const OLD: &str = "old";

/// Complete new files, beside the directories that they are for.
pub struct Staging {
    // Closed before the directory goes.
    lock: File,
    directory: Directory,
    /// The files, as [`OutputFile::path`] has them.
    made: Vec<String>,
}

impl Staging {
    /// Writes the files of a configuration.
    ///
    /// # Errors
    /// `out` cannot be written; then nothing is left of it.
    pub fn new(out: &Path, files: &[OutputFile]) -> Result<Self> {
        let cannot =
            || format!("cannot write to `{}`; choose another directory with --out", out.display());
        let directory = Directory::beside(out, PREFIX).with_context(cannot)?;
        let mut lock = File::create(directory.path().join(LOCK)).with_context(cannot)?;
        // Before it says anything: what is empty is nobody's. A system without locks goes without.
        let _ = lock.try_lock();
        let paths = files.iter().fold(TITLE.to_owned(), |text, file| text + "\n" + &file.path);
        lock.write_all(format!("{paths}\n").as_bytes()).with_context(cannot)?;
        for file in files {
            let path = directory.path().join(&file.path);
            create_parent(&path)?;
            fs::write(&path, &file.contents).with_context(|| {
                format!("cannot write `{}`; what was there before is unchanged", file.path)
            })?;
        }
        let made = files.iter().map(|file| file.path.clone()).collect();
        Ok(Self { lock, directory, made })
    }

    /// Leaves everything as it is, as a process does that is killed.
    #[cfg(test)]
    pub fn abandon(self) -> PathBuf {
        drop(self.lock);
        self.directory.keep()
    }

    /// Moves the old directories of configuration `name` out of the way, the new ones into their place, and
    /// those of the files `kept` back that nothing new replaces. What is left of the old goes.
    ///
    /// # Errors
    /// Something cannot be moved; then everything is as it was, or the error says where it is.
    pub fn swap(self, out: &Path, name: &str, kept: &[PathBuf]) -> Result<()> {
        transient::undivided(|| {
            let mut moves = Moves::default();
            let moved = swap_each(out, self.directory.path(), name, &self.made, &mut moves)
                .and_then(|()| bring_back(out, self.directory.path(), kept, &mut moves));
            let Err(error) = moved else {
                return Ok(());
            };
            if moves.undo().is_err() {
                let _ = fs::remove_file(self.directory.path().join(LOCK));
                drop(self.lock);
                let kept = self.directory.keep();
                return Err(error)
                    .context(format!("what was there before is now in `{}`", kept.display()));
            }
            Err(error)
        })
    }
}

fn swap_each(
    out: &Path,
    staging: &Path,
    name: &str,
    made: &[String],
    moves: &mut Moves,
) -> Result<()> {
    let aside = staging.join(OLD);
    let (new, old) = (directories(staging, name), directories(&aside, name));
    for place in directories(out, name) {
        ensure!(
            !place.is_symlink(),
            "`{}` is a symbolic link, and directories are replaced as a whole; nothing was changed\n\
             give --out where it leads, or make a directory of it",
            place.display()
        );
    }
    for ((place, new), old) in directories(out, name).into_iter().zip(new).zip(old) {
        let below = relative_name(out, &place) + "/";
        // One that the configuration no longer asks for goes. One that it asks for and that is not here any more
        // is in its place.
        let asked = made.iter().any(|path| path.starts_with(&below));
        let is_new = new.exists();
        if (is_new || !asked) && fs::symlink_metadata(&place).is_ok() {
            create_parent(&old)?;
            moves.rename(&place, &old)?;
        }
        if is_new {
            create_parent(&place)?;
            moves.rename(&new, &place)?;
        }
    }
    Ok(())
}

/// Moves files back from the old directories, where nothing new stands.
fn bring_back(out: &Path, staging: &Path, kept: &[PathBuf], moves: &mut Moves) -> Result<()> {
    for path in kept {
        let old = staging.join(OLD).join(path.strip_prefix(out).unwrap_or(path));
        if fs::symlink_metadata(path).is_err() && fs::symlink_metadata(&old).is_ok() {
            create_parent(path)?;
            moves.rename(&old, path)?;
        }
    }
    Ok(())
}

/// Finishes what killed runs have begun in `out`, and deletes their directories.
///
/// # Errors
/// Something cannot be moved or deleted.
pub fn recover(out: &Path) -> Result<()> {
    let Ok(entries) = fs::read_dir(out) else {
        // Whatever is wrong with it shows in writing.
        return Ok(());
    };
    for entry in entries.flatten() {
        if entry.file_name().to_string_lossy().starts_with(PREFIX) {
            recover_one(out, &entry.path())
                .with_context(|| format!("a killed run has left `{}`", entry.path().display()))?;
        }
    }
    Ok(())
}

/// Leaves the directory alone if it is in use, or if anything in it may be somebody's.
fn recover_one(out: &Path, staging: &Path) -> Result<()> {
    let Ok(lock) = File::open(staging.join(LOCK)) else {
        return Ok(());
    };
    let text = fs::read_to_string(staging.join(LOCK)).unwrap_or_default();
    let mut lines = text.lines();
    if lines.next() != Some(TITLE) || lock.try_lock().is_err() {
        return Ok(());
    }
    let made: Vec<String> = lines.map(str::to_owned).collect();
    let old = staging.join(OLD);
    let mut names: Vec<String> = Vec::new();
    for path in files_below(staging)? {
        let name = relative_name(staging, &path);
        let ours = name == LOCK || path.starts_with(&old) || made.contains(&name);
        if !ours {
            return Ok(());
        }
    }
    for path in &made {
        // `rtl_out/<name>/…`
        let name = path.split('/').nth(1).unwrap_or_default().to_owned();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    if old.exists() {
        // All was made, and the moves had begun.
        for name in names {
            finish(out, staging, &name, &made)?;
        }
    }
    fs::remove_dir_all(staging).with_context(|| format!("cannot delete `{}`", staging.display()))
}

/// Goes on with [`Staging::swap`]: what is not in its place yet is moved there.
fn finish(out: &Path, staging: &Path, name: &str, made: &[String]) -> Result<()> {
    let aside = staging.join(OLD);
    swap_each(out, staging, name, made, &mut Moves::default())?;
    let manifest = aside.join("rtl_out").join(name).join(format!("{name}.json"));
    let digests = Digests::read(&manifest, &aside);
    let mut kept = Vec::new();
    for directory in directories(&aside, name).into_iter().filter(|path| path.is_dir()) {
        for path in files_below(&directory)? {
            let relative = relative_name(&aside, &path);
            if !matches!(digests.owner(&relative, &path), Owner::Glint) {
                kept.push(out.join(relative));
            }
        }
    }
    bring_back(out, staging, &kept, &mut Moves::default())
}

/// Renames that can be undone.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn rename(&mut self, from: &Path, to: &Path) -> Result<()> {
        fs::rename(from, to)
            .with_context(|| format!("cannot move `{}` to `{}`", from.display(), to.display()))?;
        self.0.push((from.to_owned(), to.to_owned()));
        Ok(())
    }

    /// Takes back what was done, the last first.
    fn undo(self) -> io::Result<()> {
        self.0.into_iter().rev().try_for_each(|(from, to)| fs::rename(to, from))
    }
}

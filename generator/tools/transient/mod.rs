//! Keeps a list of the child processes and temporary directories of this process, so Glint can end the processes and delete the
//! directories.
//!
//! If the process is interrupted, [`clear`] kills all children and deletes all directories on the list. A lock prevents that new
//! ones appear meanwhile. If the process is killed and cannot call [`clear`], a guard process kills its children (not on
//! Windows). The next run of Glint with a temporary directory in the same place deletes the old directories, and recognises them
//! by their unlocked lock files.

mod child;
#[cfg(unix)]
mod guard;
mod scratch;

#[cfg(all(test, unix))]
mod tests;

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

pub use child::{Child, adopt_orphans};
pub use scratch::{Directory, files_below, relative_name};

/// The longest time that [`clear`] waits for killed processes, and again for directories in which files still appear.
const CLEARING_LIMIT: Duration = Duration::from_secs(5);
/// The time between two checks of a condition for which this module waits.
const PAUSE: Duration = Duration::from_millis(10);

static LIST: Mutex<List> = Mutex::new(List {
    children: BTreeSet::new(),
    #[cfg(unix)]
    guard: guard::Guard::new(),
    paths: BTreeSet::new(),
});
static UNDIVIDED: Mutex<()> = Mutex::new(());

struct List {
    /// The process numbers of the children whose exit status has not been read.
    children: BTreeSet<u32>,
    #[cfg(unix)]
    guard: guard::Guard,
    paths: BTreeSet<PathBuf>,
}

impl List {
    fn add(&mut self, child: u32) {
        self.children.insert(child);
        #[cfg(unix)]
        self.guard.tell(&self.children);
    }

    fn remove(&mut self, child: u32) {
        self.children.remove(&child);
        #[cfg(unix)]
        self.guard.tell(&self.children);
    }
}

fn list() -> MutexGuard<'static, List> {
    LIST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs `work` without interruption by [`clear`]: a signal that arrives meanwhile takes effect when `work` has ended. A caller
/// must use this for renames that belong together.
pub fn undivided<T>(work: impl FnOnce() -> T) -> T {
    let _guard = UNDIVIDED.lock().unwrap_or_else(PoisonError::into_inner);
    work()
}

/// A proof that [`clear`] has run. As long as this value exists, no child process can start, and no temporary directory can be
/// made.
pub struct Cleared {
    _undivided: MutexGuard<'static, ()>,
    _list: MutexGuard<'static, List>,
}

/// Kills all children with their descendants, and deletes all temporary directories. Each of these two steps takes at most 5
/// seconds. Other threads stop at their next child or temporary directory until the result is dropped. The program calls this
/// function at its end, for example after Ctrl-C during a bench.
pub fn clear() -> Cleared {
    let undivided = UNDIVIDED.lock().unwrap_or_else(PoisonError::into_inner);
    let list = list();
    for &child in &list.children {
        child::kill_tree(child);
    }
    child::kill_own_descendants(Instant::now() + CLEARING_LIMIT);
    let deadline = Instant::now() + CLEARING_LIMIT;
    for path in &list.paths {
        // A thread of this process may be writing into the directory.
        while !delete(path) && Instant::now() < deadline {
            thread::sleep(PAUSE);
        }
    }
    Cleared { _undivided: undivided, _list: list }
}

/// Deletes a file or a directory. Returns whether nothing exists at `path` afterwards.
fn delete(path: &Path) -> bool {
    let done = match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    done.map_or_else(|error| error.kind() == ErrorKind::NotFound, |()| true)
}

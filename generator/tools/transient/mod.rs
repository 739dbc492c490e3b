//! Keeps a list of the child processes and temporary directories of this process, so that none is left behind.
//!
//! If the process is interrupted, [`clear`] kills all children and deletes all directories on the list. A lock on the list
//! prevents that a new child or directory appears meanwhile. If the process is killed and cannot call [`clear`], a guard process
//! kills its children. The next run of Glint then deletes its temporary directories; it recognises them because nobody holds
//! their lock files.

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

/// How long [`clear`] waits for killed processes, and for a directory that something still writes to.
const CLEARING_LIMIT: Duration = Duration::from_secs(5);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(10);

static LIST: Mutex<List> = Mutex::new(List {
    children: BTreeSet::new(),
    #[cfg(unix)]
    guard: guard::Guard::new(),
    paths: BTreeSet::new(),
});
static UNDIVIDED: Mutex<()> = Mutex::new(());

struct List {
    /// Process numbers of children that are not collected yet.
    children: BTreeSet<u32>,
    #[cfg(unix)]
    guard: guard::Guard,
    /// Temporary directories.
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

/// Runs `work` without interruption: a signal that arrives meanwhile waits for its end. A caller must use it for renames that
/// belong together.
pub fn undivided<T>(work: impl FnOnce() -> T) -> T {
    let _guard = UNDIVIDED.lock().unwrap_or_else(PoisonError::into_inner);
    work()
}

/// The locks of this module. While they are held, no child process can start, and no temporary directory can be made.
pub struct Cleared {
    _undivided: MutexGuard<'static, ()>,
    _list: MutexGuard<'static, List>,
}

/// Kills all children with everything that they have started, and deletes all temporary directories. Other threads stop
/// at their next child or temporary path until the result is dropped, which is meant for the end of the process. For
/// example, Ctrl-C during a bench kills `vvp` and deletes the bench's directory.
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

/// Returns whether there is nothing at `path` afterwards.
fn delete(path: &Path) -> bool {
    let done = match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    done.map_or_else(|error| error.kind() == ErrorKind::NotFound, |()| true)
}

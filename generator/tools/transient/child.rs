//! Starts child processes, and kills them together with their descendants. On Windows, only the child is killed.

use std::io;
use std::process::{self, Command, ExitStatus};
use std::time::Instant;

use super::list;

/// A child process in a process group of its own. Dropping the value kills the process and its descendants, so an early return
/// cannot leave a simulator running.
#[derive(Debug)]
pub struct Child {
    child: process::Child,
    ended: bool,
}

impl Child {
    /// Starts `command` and adds the process to the list of children. Fails if the command does not start.
    pub fn spawn(command: &mut Command) -> io::Result<Self> {
        // A terminal's Ctrl-C reaches this process alone, which then ends its children itself.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let mut list = list();
        let child = command.spawn()?;
        list.add(child.id());
        Ok(Self { child, ended: false })
    }

    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Returns the exit status, or `None` if the process still runs.
    ///
    /// # Errors
    ///
    /// Fails if the system cannot report the child's status.
    pub fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        // As soon as the status is read, another process may get this process number. In the same step, the child therefore
        // leaves the list.
        let mut list = list();
        let status = self.child.try_wait()?;
        if status.is_some() {
            list.remove(self.child.id());
            self.ended = true;
        }
        Ok(status)
    }

    /// Kills the process and all processes that it has started, and waits for the end of the process. Does nothing if the exit
    /// status has already been read.
    pub fn kill(&mut self) {
        if self.ended {
            return;
        }
        let mut list = list();
        kill_tree(self.child.id());
        // An error means that the process has just ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
        list.remove(self.child.id());
        self.ended = true;
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Kills a child, its process group, and its descendants in other groups, because yosys-smtbmc runs its solver in a session of
/// its own. The child's exit status must not have been read, because another process could then have the number.
#[cfg(unix)]
pub fn kill_tree(child: u32) {
    use rustix::process::{Pid, Signal, kill_process_group};
    kill_all(|| tree::descendants(child as i32, true));
    if let Some(group) = Pid::from_raw(child as i32) {
        let _ = kill_process_group(group, Signal::KILL);
    }
}

/// Does nothing, because the system has no process groups. [`Child::kill`] kills only the child.
#[cfg(not(unix))]
pub fn kill_tree(_child: u32) {}

/// Kills all descendants of this process, including descendants whose parents have ended, until none is alive or
/// `deadline` has passed.
#[cfg(unix)]
pub fn kill_own_descendants(deadline: Instant) {
    loop {
        kill_all(|| tree::descendants(process::id() as i32, false));
        let left = tree::descendants(process::id() as i32, false);
        if left.is_empty() || Instant::now() >= deadline {
            return;
        }
        std::thread::sleep(super::PAUSE);
    }
}

/// Does nothing, because Glint cannot find descendants on this system.
#[cfg(not(unix))]
pub fn kill_own_descendants(_deadline: Instant) {}

/// Kills the processes that `list` returns. The function first stops all of them, so they start no further processes, and calls
/// `list` until no new process appears.
#[cfg(unix)]
fn kill_all(list: impl Fn() -> Vec<i32>) {
    use rustix::process::{Pid, Signal, kill_process};
    let send = |process: i32, signal| {
        // An error means that the process has just ended.
        let _ = Pid::from_raw(process).map(|pid| kill_process(pid, signal));
    };
    let mut stopped: Vec<i32> = Vec::new();
    loop {
        let new: Vec<i32> = list().into_iter().filter(|pid| !stopped.contains(pid)).collect();
        if new.is_empty() {
            break;
        }
        new.iter().for_each(|&pid| send(pid, Signal::STOP));
        stopped.extend(new);
    }
    stopped.into_iter().for_each(|pid| send(pid, Signal::KILL));
}

/// Makes this process the parent of descendants whose own parent has ended, so `kill_own_descendants` finds them.
pub fn adopt_orphans() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_child_subreaper(Some(rustix::process::getpid()));
}

/// Finds processes in `/proc`.
#[cfg(unix)]
mod tree {
    use std::fs;

    struct Process {
        number: i32,
        parent: i32,
    }

    /// Returns the descendants of `root`, and `root` itself if `with_root`. The list is empty on a system without `/proc`.
    pub fn descendants(root: i32, with_root: bool) -> Vec<i32> {
        let all = all();
        let mut found = vec![root];
        let mut at = 0;
        while let Some(&parent) = found.get(at) {
            found.extend(all.iter().filter(|one| one.parent == parent).map(|one| one.number));
            at += 1;
        }
        let alive = |number: &i32| all.iter().any(|one| one.number == *number);
        found.into_iter().skip(usize::from(!with_root)).filter(alive).collect()
    }

    fn all() -> Vec<Process> {
        let Ok(entries) = fs::read_dir("/proc") else {
            return Vec::new();
        };
        entries
            .filter_map(|entry| {
                let number = entry.ok()?.file_name().to_str()?.parse().ok()?;
                let text = fs::read_to_string(format!("/proc/{number}/stat")).ok()?;
                // The name, in parentheses, can contain any characters; state and parent follow it.
                let mut rest = text.rsplit_once(')')?.1.split_whitespace();
                let state = rest.next()?;
                let parent = rest.next()?.parse().ok()?;
                (!matches!(state, "Z" | "X")).then_some(Process { number, parent })
            })
            .collect()
    }
}

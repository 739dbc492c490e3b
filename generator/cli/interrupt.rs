//! Ends the program on Ctrl-C and on other signals that ask a process to end. Before the end, the module ends the child
//! processes and deletes the temporary files. On a system without such signals, it does nothing.
//!
//! A command can delay the end until it has saved its work. A second signal then ends the program at once.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

/// Whether the first signal is only recorded, because a command wants to save its work.
static DEFERRED: AtomicBool = AtomicBool::new(false);
/// The number of the signal that was recorded, or 0.
static NOTED: AtomicI32 = AtomicI32::new(0);

/// The error of a command that was interrupted after it saved its work.
#[derive(Debug)]
pub struct Interrupted {
    signal: i32,
    saved: String,
}

impl Interrupted {
    /// Returns the exit code that shells use for a signal: 130 for SIGINT, which is signal 2.
    pub fn exit_code(&self) -> u8 {
        128 + self.signal as u8
    }
}

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "interrupted; {}", self.saved)
    }
}

/// A value during whose life the first signal only sets a flag, so that the command can save its work. The second signal ends the
/// process. For example, `cosim --exhaustive --resume FILE` saves its progress after the first signal.
pub struct Deferred(());

impl Deferred {
    /// Begins to defer signals. When the caller drops the returned value, a signal ends the process at once again.
    pub fn begin() -> Self {
        DEFERRED.store(true, Ordering::SeqCst);
        Self(())
    }

    /// Returns whether a signal has arrived. The command must then save its work and end.
    pub fn noted(&self) -> bool {
        NOTED.load(Ordering::SeqCst) != 0
    }

    /// Returns the error with which the command must end if a signal has arrived, and otherwise `None`. `saved` describes the
    /// saved work.
    pub fn end(self, saved: impl FnOnce() -> String) -> Option<Interrupted> {
        match NOTED.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(Interrupted { signal, saved: saved() }),
        }
    }
}

impl Drop for Deferred {
    fn drop(&mut self) {
        DEFERRED.store(false, Ordering::SeqCst);
    }
}

/// Installs the signal handler. From then on, SIGINT, SIGTERM and SIGHUP end this process with all its child processes, and
/// delete its temporary files. A signal that the process was told to ignore, as under `nohup`, stays ignored.
///
/// # Errors
///
/// Fails if the system cannot install the handler.
#[cfg(unix)]
pub fn listen() -> std::io::Result<()> {
    use std::io::Write;

    use glint_tools::transient;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

    let ignored = ignored();
    let signals = [SIGINT, SIGTERM, SIGHUP].into_iter();
    let signals = signals.filter(|&signal| ignored & (1 << (signal - 1)) == 0);
    let mut signals = signal_hook::iterator::Signals::new(signals)?;
    transient::adopt_orphans();
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if DEFERRED.load(Ordering::SeqCst) && NOTED.swap(signal, Ordering::SeqCst) == 0 {
                continue;
            }
            let _cleared = transient::clear();
            // This writes without the lock of standard error, because a stopped thread may have the lock. A failure to write is
            // ignored.
            let _ = writeln!(std::io::stderr(), "\nglint: interrupted");
            std::process::exit(128 + signal);
        }
    });
    Ok(())
}

/// Does nothing: this system has no such signals, and ends the process itself.
#[cfg(not(unix))]
pub fn listen() -> std::io::Result<()> {
    Ok(())
}

/// Returns the signals that this process was told to ignore, as a mask: bit i is 1 for signal i + 1. Under `nohup`, bit 0 is
/// 1, because SIGHUP is signal 1. The mask is 0 if the system does not state it.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

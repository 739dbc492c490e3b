//! Kills the child processes of Glint if Glint itself is killed, on systems with a shell at `/bin/sh`.
//!
//! The guard is a shell that runs in parallel to Glint and outlives it. Glint writes the process numbers of its children to the
//! guard. When the pipe between them closes, Glint has ended, and the guard kills the children that are left.

use std::collections::BTreeSet;
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::process::{ChildStdin, Command, Stdio};

/// A script that reads lists of children, one list a line such as `4711 4712`, until the pipe closes, at the latest when Glint
/// ends. Then it kills the children on the last line, with their process groups and with their descendants in other groups. After
/// an orderly end, the last line is empty.
///
/// The pipe closes shortly before Glint's process is gone. When the process ends, the groups of its children become orphans. The
/// system sends SIGHUP and SIGCONT to an orphaned group with a stopped process. A child that the guard stopped too early would
/// therefore end before its own children are listed. The shell therefore waits until its own parent has changed. The `sleep`
/// after this wait forks, which the system does only after it has dealt with all children.
pub(super) const SCRIPT: &str = r#"
tree() {
    for task in /proc/"$1"/task/*/children; do
        list=
        read -r list <"$task"
        for it in $list; do tree "$it"; done
    done
    case " $all " in
    *" $1 "*) ;;
    *) kill -STOP "$1"; all="$all $1"; more=yes ;;
    esac
}
while read -r line; do children=$line; done
[ "$children" ] || exit 0
while read -r _ _ _ parent _ <"/proc/$$/stat" && [ "$parent" = "$PPID" ]; do sleep 0.01; done
sleep 0.01
more=yes
while [ "$more" ]; do
    more=
    for child in $children; do tree "$child"; done
done
kill -KILL $all
for child in $children; do kill -KILL "-$child"; done
"#;

/// The pipe to the shell, or `None` before the first child and on a system without a shell.
pub struct Guard(Option<ChildStdin>);

impl Guard {
    pub const fn new() -> Self {
        Self(None)
    }

    /// Tells the guard which children it must kill if Glint ends without a clean-up. The first call starts the guard.
    pub fn tell(&mut self, children: &BTreeSet<u32>) {
        let pipe = self.0.take().or_else(|| shell(SCRIPT).spawn().ok()?.stdin);
        let line: Vec<String> = children.iter().map(u32::to_string).collect();
        self.0 = pipe.filter(|mut pipe| writeln!(pipe, "{}", line.join(" ")).is_ok());
    }
}

/// Returns the command of a shell that has its own process group and reads a pipe.
pub(super) fn shell(script: &str) -> Command {
    let mut command = Command::new("/bin/sh");
    // A signal to the group of this process does not reach the shell.
    command.args(["-c", script]).current_dir("/").process_group(0);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

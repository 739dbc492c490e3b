//! The guard: a shell that outlives this process, and kills what it has started if it is killed itself.

use std::collections::BTreeSet;
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::process::{ChildStdin, Command, Stdio};

/// Reads lists of children, a line each, until the pipe closes, as it does with the end of this process. Those on the last
/// line, which is empty after an end in order, are killed with their descendants in other groups and with their own group.
const SCRIPT: &str = r#"
tree() {
    kill -STOP "$1"
    for task in /proc/"$1"/task/*/children; do
        list=
        read -r list <"$task"
        for it in $list; do tree "$it"; done
    done
    kill -KILL "$1"
}
while read -r line; do children=$line; done
for child in $children; do tree "$child"; kill -KILL "-$child"; done
"#;

/// The pipe to the shell; none before the first child, and none on a system without a shell.
pub struct Guard(Option<ChildStdin>);

impl Guard {
    /// Before the first child.
    pub const fn new() -> Self {
        Self(None)
    }

    /// Tells which children are to be killed from now on.
    pub fn tell(&mut self, children: &BTreeSet<u32>) {
        let pipe = self.0.take().or_else(|| {
            let mut command = Command::new("/bin/sh");
            // A group of its own: what is sent to that of this process does not reach it.
            command.args(["-c", SCRIPT]).current_dir("/").process_group(0);
            let shell = command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
            shell.spawn().ok()?.stdin
        });
        let line: Vec<String> = children.iter().map(u32::to_string).collect();
        self.0 = pipe.filter(|mut pipe| writeln!(pipe, "{}", line.join(" ")).is_ok());
    }
}

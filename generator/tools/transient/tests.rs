//! Tests that children which hide their own children are killed, and that temporary directories are deleted.

use std::fs;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::*;

/// Waits until a script has written a number and a newline to the file `path`, and returns the number.
fn number_in(path: &Path) -> u32 {
    let deadline = Instant::now() + Duration::from_secs(60);
    loop {
        let text = fs::read_to_string(path).unwrap_or_default();
        if let (true, Ok(number)) = (text.ends_with('\n'), text.trim().parse()) {
            return number;
        }
        assert!(Instant::now() < deadline, "nothing in {}", path.display());
        thread::sleep(PAUSE);
    }
}

/// Returns whether the process is alive. A zombie is not alive.
fn is_alive(number: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
    stat.rsplit_once(')').is_some_and(|(_, rest)| !rest.trim_start().starts_with('Z'))
}

/// Checks that the process ends within ten seconds.
#[track_caller]
fn assert_ends(number: u32, message: &str) {
    let deadline = Instant::now() + Duration::from_secs(10);
    while is_alive(number) && Instant::now() < deadline {
        thread::sleep(PAUSE);
    }
    assert!(!is_alive(number), "{message}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_killed_child_takes_a_session_of_its_child_along() {
    let dir = Directory::new().unwrap();
    let script = "setsid sh -c 'echo $$ > inner; exec sleep 1000' & sleep 1000";
    let mut child =
        Child::spawn(Command::new("sh").args(["-c", script]).current_dir(&dir)).unwrap();
    let inner = number_in(&dir.path().join("inner"));
    assert!(is_alive(inner) && is_alive(child.id()));
    child.kill();
    assert_ends(inner, "the solver of a killed tool runs on");
}

/// Checks that a slow guard still kills a tool's descendants in another session. The guarded process ends while the guard works.
/// This end must not send SIGHUP to the tool before the tool's children are listed. The guarded process is this test, started a
/// second time.
#[test]
#[cfg(target_os = "linux")]
fn a_slow_guard_ends_a_session_of_a_child_too() {
    const PLACE: &str = "GLINT_TEST_OF_GUARD";
    let Some(place) = std::env::var_os(PLACE) else {
        let dir = Directory::new().unwrap();
        let mut parent = Command::new(std::env::current_exe().unwrap());
        parent.args(["--exact", "transient::tests::a_slow_guard_ends_a_session_of_a_child_too"]);
        // A tool that is not killed must not delay this test by an open output.
        parent.env(PLACE, dir.path()).stdout(Stdio::null()).stderr(Stdio::null());
        assert!(parent.status().unwrap().success());
        let inner = number_in(&dir.path().join("inner"));
        return assert_ends(inner, "the solver of a tool runs on");
    };
    use std::io::Write;
    use std::os::unix::process::CommandExt;
    let slow = r#"kill() { command kill "$@"; sleep 0.1; }"#;
    let mut guard = guard::shell(&format!("{slow}\n{}", guard::SCRIPT)).spawn().unwrap();
    let script = "setsid sh -c 'echo $$ > inner; exec sleep 1000' & sleep 1000";
    let mut tool = Command::new("sh");
    let tool = tool.args(["-c", script]).current_dir(&place).process_group(0).spawn().unwrap();
    number_in(&PathBuf::from(place).join("inner"));
    writeln!(guard.stdin.as_ref().unwrap(), "{}", tool.id()).unwrap();
    drop(guard.stdin.take());
    thread::sleep(Duration::from_millis(50));
    std::process::exit(0);
}

#[test]
fn what_is_dropped_is_gone_and_off_the_list() {
    let dir = Directory::new().unwrap();
    let inner = Directory::beside(dir.path()).unwrap();
    let path = inner.path().to_owned();
    assert!(path.is_dir() && list().paths.contains(&path));
    drop(inner);
    assert!(!path.exists() && !list().paths.contains(&path));
}

#[test]
fn what_killed_processes_have_left_goes() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let says = |name: &str| {
        format!(
            "Glint works in {name}. The next run deletes the files that a killed run has left.\n"
        )
    };
    for (name, text) in [
        (".glint-left", says(".glint-left")),
        (".glint-used", says(".glint-used")),
        (".glint-copy", says(".glint-left")),
        (".glint-mine", "mine".to_owned()),
        ("other", says("other")),
    ] {
        fs::create_dir(at(name)).unwrap();
        fs::write(at(name).join("glint.lock"), text).unwrap();
        fs::write(at(name).join("made.v"), "").unwrap();
    }
    let used = fs::File::open(at(".glint-used/glint.lock")).unwrap();
    used.try_lock().unwrap();
    drop(Directory::beside(place.path()).unwrap());
    let entries = fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().file_name());
    let mut entries: Vec<_> = entries.collect();
    entries.sort();
    assert_eq!(entries, [".glint-copy", ".glint-mine", ".glint-used", "other"]);
}

//! Children that hide their own children, and temporary paths.

use std::fs;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use super::*;

/// Waits for what a script writes.
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

/// Whether a process is there and no zombie.
fn is_alive(number: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
    stat.rsplit_once(')').is_some_and(|(_, rest)| !rest.trim_start().starts_with('Z'))
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
    let deadline = Instant::now() + Duration::from_secs(10);
    while is_alive(inner) && Instant::now() < deadline {
        thread::sleep(PAUSE);
    }
    assert!(!is_alive(inner), "the solver of a killed tool runs on");
}

#[test]
fn what_is_dropped_is_gone_and_off_the_list() {
    let dir = Directory::new().unwrap();
    let inner = Directory::beside(dir.path(), ".glint-").unwrap();
    let path = inner.path().to_owned();
    assert!(path.is_dir() && list().paths.contains(&path));
    drop(inner);
    assert!(!path.exists() && !list().paths.contains(&path));

    let file = File::made(|| tempfile::NamedTempFile::new_in(dir.path())).unwrap();
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    file.persist(&dir.path().join("kept")).unwrap();
    assert!(dir.path().join("kept").is_file());
    assert!(!list().paths.iter().any(|path| path.parent() == Some(dir.path())));

    let kept = Directory::beside(dir.path(), "k").unwrap().keep();
    assert!(kept.is_dir() && !list().paths.contains(&kept));
}

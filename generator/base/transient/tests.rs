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
    let inner = Directory::beside(dir.path()).unwrap();
    let path = inner.path().to_owned();
    assert!(path.is_dir() && list().paths.contains(&path));
    drop(inner);
    assert!(!path.exists() && !list().paths.contains(&path));
}

/// Directories in use stay, and so do those of somebody else.
#[test]
fn what_killed_processes_have_left_goes() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let says = |name: &str| {
        format!("Glint works in {name}. The next run deletes what a killed one has left.\n")
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

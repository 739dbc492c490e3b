//! Tests `glint verify --without-tools`, which leaves out the checks that need other programs.
//!
//! Two runs give the same record, and the same page except for the timings. The record has the expected verdicts and the
//! digests of the files that `glint generate` writes.

use crate::common::json::Json;
use crate::workspace::Workspace;

const WITHOUT_TOOLS: [&str; 3] = ["verify", "core.toml", "--without-tools"];

/// With a configuration that is narrow enough for every check.
fn dir() -> Workspace {
    let narrow = include_str!("../../../configs/reduced/schlick.toml");
    Workspace::with("core.toml", narrow.replace("schlick_reduced", "core"))
}

#[test]
fn page_and_record_are_the_same_every_time_but_for_the_timings() {
    let dir = dir();
    let verify = [&WITHOUT_TOOLS[..], &["--out", "made"]].concat();
    let run = dir.glint(&verify).quiet();
    assert!(run.out.contains("core.toml: verified in part: "), "{}", run.out);
    assert!(run.out.contains("Proof of the error bound, "), "{}", run.out);
    let made = || {
        let page = dir.read("made/core.html");
        let (before, after) = page.split_once("id=\"timings\"").expect("timings");
        assert!(after.contains("Seconds"));
        (dir.read("made/core.json"), before.to_owned())
    };
    let first = made();
    // Written over what is there.
    let again = dir.glint(verify.iter().chain(&["--json"])).quiet();
    assert_eq!(made(), first);
    let (record, page) = first;
    for reference in ["http", "src=", "url(", "<link", "<script", "file:"] {
        assert!(!page.contains(reference), "`{reference}` in the page");
    }
    let here = dir.path().display().to_string();
    assert!(!page.contains(&here) && !record.contains(&here));

    let found = dir.json("made/core.json");
    assert_eq!(found["conclusion"], "in-part");
    assert!(page.contains("badge in-part\">verified in part"), "the headline is green");
    assert_eq!(found["full"], false);
    // The digests are those of the files that `generate` writes.
    dir.glint(["generate", "core.toml"]).good();
    let files = found["files"].list();
    assert!(files.iter().any(|file| file["path"] == "rtl_out/core/core.v"), "{files:?}");
    for file in files {
        let [path, digest] = ["path", "sha256"].map(|it| file[it].text());
        assert_eq!(glint::package::digest(dir.read(path).as_bytes()), digest, "{path}");
        assert!(page.contains(digest), "{path}");
    }
    let checks = &found["checks"];
    let counts = found["counts"].object();
    assert_eq!(counts.values().map(Json::count).sum::<u64>(), checks.list().len() as u64);
    assert_eq!(counts["left-out"], 11);
    for (check, verdict) in [
        ("design", "proved"),
        ("lockstep", "passed"),
        ("clocks", "proved"),
        ("contract", "proved"),
        ("mutation", "passed"),
        ("icarus", "left-out"),
    ] {
        assert_eq!(checks.of("check", check)["verdict"], verdict, "{check}");
    }
    assert!(page.contains("--without-tools leaves this check out."));
    // The file has one member more, the digest of the others.
    let mut record = found.clone();
    record.as_object_mut().expect("an object").remove("sha256").expect("a digest");
    assert_eq!(again.json()["configurations"][0]["record"], record);
    let timings = dir.json("made/core.timings.json");
    assert_eq!(timings["seconds"].list().len(), checks.list().len());
    assert_eq!(dir.files().keys().filter(|it| it.starts_with("made")).count(), 3);
}

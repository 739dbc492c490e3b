//! Tests the program `papers`: two runs give the same report, the page needs no other file, and timings are in files of their
//! own.

#[path = "../evidence/mod.rs"]
mod evidence;

use glint::registry::Registry;
use serde_json::Value;

use evidence::{benchmark, page};

#[allow(dead_code)]
#[path = "../../../tests/common/json.rs"]
mod json;
use json::Json;

#[test]
fn the_report_is_the_same_twice_and_self_contained() {
    let made = || {
        let evidence = evidence::gather(&Registry::shipped(), None).expect("the evidence");
        let figures = serde_json::to_string(&evidence).expect("JSON");
        (page::page(&evidence, None).expect("a page"), figures)
    };
    let (page, figures) = made();
    assert_eq!((page.clone(), figures.clone()), made());
    for reference in ["http", "src=", "url(", "@import", "<link", "<script", "file:"] {
        assert!(!page.contains(reference), "`{reference}` in the page");
    }
    links_lead_somewhere(&page);
    plots_are_described(&page);

    let figures: Value = serde_json::from_str(&figures).expect("JSON");
    assert_eq!(figures["rom_9"].as_array().map(Vec::len), Some(1000));
    // √(7/16), and √(1000/16).
    for (n, root) in [(7, 0.661_437_827_766_147_7), (1000, 7.905_694_150_420_948)] {
        let word = &figures["rom_9"][n - 1]["root"];
        assert!((word.number() - root).abs() < 1e-15);
    }
    let devices = figures["devices"].list();
    assert!(devices.iter().any(|device| device["device"] == "rough"));
    // All ten in each chart of all.
    let overview = figures["overview"].list();
    let lines = overview.iter().map(|chart| chart["series"].list().len());
    assert_eq!(lines.collect::<Vec<_>>(), [10, 10]);
    assert_eq!(figures["hardware"], Value::Null);
}

#[test]
fn timings_stand_apart() {
    let timed = benchmark::run();
    let evidence = evidence::gather(&Registry::shipped(), None).expect("the evidence");
    let page = |timed| page::page(&evidence, timed).expect("a page");
    assert!(page(Some(&timed)).contains("id=\"speed\"") && !page(None).contains("id=\"speed\""));
    let timings = serde_json::to_value(&timed).expect("JSON");
    assert_eq!(timings["claimed"], 2.3);
    // m = 2, 4, 8, 16; two precisions; one by one and many at once.
    let pairs = timings["pairs"].list();
    assert_eq!(pairs.len(), 16);
    for pair in pairs {
        let ratio = pair["ratio"].list();
        let ratio: Vec<f64> = ratio.iter().filter_map(Value::as_f64).collect();
        assert!(ratio[0] > 0.0 && ratio.is_sorted(), "{pair}");
    }
}

/// Returns values of an attribute, in order.
fn attributes<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let opening = format!(" {name}=\"");
    page.split(&opening).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

fn links_lead_somewhere(page: &str) {
    let mut ids = attributes(page, "id");
    ids.sort_unstable();
    let count = ids.len();
    ids.dedup();
    assert_eq!(ids.len(), count, "an id twice");
    for link in attributes(page, "href") {
        let target = link.strip_prefix('#').expect("a link within the page");
        assert!(ids.binary_search(&target).is_ok(), "{link}");
    }
    for name in ["aria-labelledby", "aria-describedby"] {
        for target in attributes(page, name) {
            assert!(ids.binary_search(&target).is_ok(), "{target}");
        }
    }
}

fn plots_are_described(page: &str) {
    let plots = page.matches("role=\"img\"").count();
    assert!(plots > 10, "{plots}");
    assert_eq!(page.matches("<figure>").count(), plots);
    assert_eq!(page.matches("<figcaption").count(), plots);
    assert_eq!(page.matches("Figures of this plot").count(), plots);
}

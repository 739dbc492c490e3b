//! Tests the pages of the repository: the pages in `docs/devices/` are what Glint writes today, and the relative links in
//! `README.md`, `CONTRIBUTING.md` and the handwritten pages below `docs/` lead to existing files and headings.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::Sure;
use crate::common::cores::{configuration, configurations};
use crate::common::files::{paths, read};
use glint::cosim::exhaustive::PROOFS;
use glint::registry::Registry;

/// Returns the default configurations, their pipelines and the pipelines for UP5K, each with the name of its module.
fn names() -> Vec<(String, String)> {
    let catalogue = Registry::shipped();
    let devices = catalogue.devices().iter();
    let cores = devices.map(|device| device.name.replace('-', "_"));
    let both = cores.flat_map(|core| {
        ["_pipelined", "_up5k_pipelined", ""].map(|kind| format!("configs/{core}{kind}.toml"))
    });
    let both = both.filter(|path| Path::new(path).exists());
    both.map(|path| (configuration(&path).config().name.clone(), path)).collect()
}

#[test]
fn notes_have_no_runs_of_blanks() {
    for (path, unit) in configurations() {
        for note in unit.design.about.paragraphs() {
            assert!(!note.contains("  ") && !note.contains('\n'), "{path}: {note}");
        }
    }
}

#[test]
fn every_device_has_its_page() {
    let readme = read("README.md");
    for (name, config) in names() {
        let file = format!("docs/devices/{name}.md");
        let today =
            glint::pages::of(&configuration(&config), &config, Path::new(PROOFS)).sure_of(&config);
        let found = fs::read_to_string(&file).unwrap_or_default();
        assert!(
            found == today,
            "{file} is not what Glint writes today; cargo run --release -- describe {config} --out docs/devices"
        );
        assert!(readme.contains(&file), "README.md does not lead to {file}");
    }
}

#[test]
fn there_are_no_other_pages() {
    let wanted: BTreeSet<String> =
        names().into_iter().map(|(name, _)| format!("docs/devices/{name}.md")).collect();
    assert_eq!(BTreeSet::from_iter(paths("docs/devices", "")), wanted);
}

/// Returns the cells of the rows of a page's table that begin with a number, from the heading on.
fn rows(page: &str, heading: &str) -> Vec<Vec<String>> {
    let section = page.split(&format!("\n## {heading}\n")).nth(1).expect("a heading");
    let section = section.split("\n## ").next().expect("a section");
    let rows = section.lines().map(|line| {
        let cells = line.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    });
    rows.filter(|cells: &Vec<String>| cells[0].parse::<u32>().is_ok()).collect()
}

#[test]
fn the_page_of_rough_reads_as_the_patent() {
    let page = glint::pages::of(
        &configuration("configs/rough.toml"),
        "configs/rough.toml",
        Path::new(PROOFS),
    )
    .expect("a page");
    // Table 1 of UA 60139: V1 ... V9.
    let table = "000000001 000110001 011000001 011001001 101000001 \
        101000101 111000001 111000101 101000011 000000000";
    let words: Vec<String> = rows(&page, "Microprogram")
        .iter()
        .map(|cells| cells[1..9].concat().replace(' ', ""))
        .collect();
    assert_eq!(words.join(" "), table);
    // The blocks of its figure 1 that are registers, muxes, adders, multipliers or the sine's ROM.
    let numbers: Vec<u32> =
        rows(&page, "Blocks").iter().map(|cells| cells[0].parse().expect("a number")).collect();
    let figure: Vec<u32> = (1..=22).chain([31]).collect();
    assert_eq!(numbers, figure);
}

/// The interval is the number in the configuration; without one, a pipeline takes a point every clock.
#[test]
fn a_page_says_when_the_next_point_is_taken() {
    for (name, clocks) in [("lyon_up5k", 2), ("rough_up5k", 3), ("cosine_power", 1)] {
        let page = read(format!("docs/devices/{name}_pipelined.md"));
        let row = format!("| the next point is taken        | {clocks:>3} |");
        assert!(page.contains(&row), "{name}: {row}");
        // A line directly below a table would become a row of the table.
        let mut lines = page.lines().zip(page.lines().skip(1));
        let stuck = lines.find(|(row, next)| {
            row.starts_with("| ") && !next.is_empty() && !next.starts_with('|')
        });
        assert_eq!(stuck, None, "{name}");
    }
}

#[test]
fn a_line_has_all_its_points_and_clocks_in_its_length() {
    for name in ["quad_cosine", "cosine_squared"] {
        let path = format!("configs/{name}.toml");
        let page =
            glint::pages::of(&configuration(&path), &path, Path::new(PROOFS)).expect("a page");
        // A point a clock: register 8 and the synchronous ROM after the first word, done with the last point.
        for row in [
            "| `valid` is high, last     | 4 + `length` |",
            "| `done` is high            | 4 + `length` |",
            "| the next `start` is taken | 5 + `length` |",
        ] {
            assert!(page.contains(row), "{path}: {row}");
        }
        assert!(!page.contains("depends on the operands"), "{path}");
        // The example has 20 intervals.
        let points = page.matches("`intensity_out`, point ").count();
        assert_eq!(points, 21, "{path}");
    }
}

#[test]
fn the_readme_is_a_path_and_no_reference() {
    let words = read("README.md").split_whitespace().count();
    assert!(words <= 1500, "README.md has {words} words; figures stand in docs/measurements.md");
}

/// Paths and anchors in the pages that people write.
#[test]
fn links_lead_somewhere() {
    let anchors = |page: &str| -> BTreeSet<String> {
        let headings = read(page);
        let headings = headings.lines().filter_map(|line| line.strip_prefix('#'));
        let anchor = |heading: &str| {
            let heading = heading.trim_start_matches('#').trim().to_lowercase();
            let kept = heading.chars().filter(|it| it.is_alphanumeric() || " -_".contains(*it));
            kept.collect::<String>().replace(' ', "-")
        };
        headings.map(anchor).collect()
    };
    let pages = ["README.md", "CONTRIBUTING.md"].map(String::from);
    let folders = ["docs", "docs/design", "docs/evidence", "docs/flows"];
    let in_folders = folders.iter().flat_map(|folder| paths(folder, ".md"));
    for page in pages.into_iter().chain(in_folders) {
        let text = read(&page);
        for link in text.split("](").skip(1) {
            let link = link.split(')').next().unwrap_or_default();
            if link.contains("://") {
                continue;
            }
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let folder = Path::new(&page).parent().expect("a folder");
            let path = if path.is_empty() { Path::new(&page).into() } else { folder.join(path) };
            assert!(path.exists(), "{page}: {link}");
            let there = || anchors(&path.display().to_string());
            assert!(anchor.is_empty() || there().contains(anchor), "{page}: {link}");
        }
    }
}

#[test]
fn every_device_stands_in_the_readme() {
    let text = read("README.md");
    let rows = text.split("| device | computes |").nth(1).expect("a table").lines().skip(2);
    let rows = rows.take_while(|line| line.starts_with("| `"));
    let listed: BTreeSet<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
    let shipped = Registry::shipped();
    assert_eq!(listed, shipped.devices().iter().map(|it| it.name).collect());
}

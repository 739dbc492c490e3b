//! Builds the pages of docs/ as a book with mdBook, and tests that every link in the book leads to a page, a heading or a file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use regex::Regex;

use crate::common::files::{read, root};
use crate::common::tools::{checkout, ran};
use glint::tools::transient::files_below;

/// Resolves `.` and `..` without asking the file system.
fn resolved(path: &Path) -> PathBuf {
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                parts.pop();
            }
            other => parts.push(other),
        }
    }
    parts
}

/// Returns the values of an attribute in a page.
fn attributes(page: &str, name: &str) -> BTreeSet<String> {
    let attribute = Regex::new(&format!(r#"\s{name}="([^"]*)""#)).expect("an expression");
    attribute.captures_iter(page).map(|found| found[1].to_owned()).collect()
}

#[test]
fn every_link_of_the_book_leads_somewhere() {
    let dir = tempfile::tempdir().expect("a directory");
    let book = dir.path().join("book");
    let docs = root().join("docs");
    ran("mdbook", ["build", "docs", "-d", book.to_str().expect("a path")], checkout());
    let files = files_below(&book).expect("a book");
    let is_page = |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "html");
    // The page to print has all others in one, and the one for wrong addresses knows no place.
    let is_whole =
        |path: &&PathBuf| ["print.html", "404.html"].iter().any(|name| path.ends_with(name));
    let pages: BTreeMap<&PathBuf, String> = files
        .iter()
        .filter(is_page)
        .filter(|path| !is_whole(path))
        .map(|path| (path, read(path)))
        .collect();
    assert!(pages.len() > 30, "{} pages", pages.len());
    for (path, text) in &pages {
        let place = path.parent().expect("a folder");
        for link in attributes(text, "href") {
            if link.is_empty() || link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target =
                if file.is_empty() { (*path).clone() } else { resolved(&place.join(file)) };
            let shown = || format!("`{link}` in {}", path.display());
            match target.strip_prefix(&book) {
                Ok(inside) if target.is_file() => {
                    let has = |page: &String| attributes(page, "id").contains(anchor);
                    let is_there = anchor.is_empty() || pages.get(&target).is_none_or(has);
                    assert!(is_there, "{}: no such place in {}", shown(), inside.display());
                }
                Ok(_) => panic!("{}: no such page", shown()),
                Err(_) => {
                    // Beside the book, in the repository, whose Markdown mdBook takes for pages.
                    let outside = pathdiff(&target, &book);
                    let source = resolved(&docs.join(outside));
                    let is_there = source.exists() || source.with_extension("md").exists();
                    assert!(is_there, "{}: no such file", shown());
                }
            }
        }
    }
}

/// Returns the way from a folder to a path that is not below it, both without `..`.
fn pathdiff(path: &Path, folder: &Path) -> PathBuf {
    let common = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    up.chain(path.components().skip(common)).collect()
}
